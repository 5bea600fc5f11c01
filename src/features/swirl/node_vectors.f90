!> Vectors of the nodes as those see them who act on single nodes: walls that rub, contact, parts
!! that are moved. Where matter turns about the axis they have a third component, around it.
!!
!! Nodes have the rate w = v_theta/X there. The component is k w, with k^2 the node's moment of
!! inertia over its mass: it has the mass of the other components, and k w and k alpha have the
!! kinetic energy and the power of the rate (theory 8). Where several fields meet k is that of all
!! of them, X_n^2 = sum J/sum m, and the inverse mass of a field is X_n^2/J: the slip is that of
!! surfaces at one radius. Rigid bodies do not turn about the axis.
module sgmp_node_vectors
  use sgmp_body, only: body_t
  use sgmp_columns, only: node_gyration, node_inverse_mass, node_swirl
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  use sgmp_shared_nodes, only: shared_nodes_t
  implicit none
  private
  public :: vector_length
  public :: shared_vector_add, shared_vector_around, shared_vector_length

  integer, parameter :: around = 3             !! component around the axis
  integer, parameter :: inverse_at = node_inverse_mass(2)

contains

  !> By what component `a` of a node's vectors is multiplied, so that all have its mass: 1, around
  !! the axis k (cells).
  pure function vector_length(field, record, a) result(length)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record, a
    real(dp) :: length
    length = 1.0_dp
    if (field%columns%swirl > 0 .and. a == around) length = sqrt(field%node(record, node_gyration))
  end function vector_length

  !> Radius X_n (cells) of a node where fields meet; 0: nothing turns.
  pure function shared_vector_length(shared, n, bodies, fields) result(length)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    real(dp) :: length
    real(dp) :: mass, inertia
    integer :: m
    length = 0.0_dp
    if (.not. shared%around) return
    mass = 0.0_dp
    inertia = 0.0_dp
    do m = shared%member_start(n), shared%member_start(n + 1) - 1
      if (.not. turns(bodies(shared%body(m)), fields(shared%field(m)))) cycle
      associate (node => fields(shared%field(m))%node(shared%record(m), :))
        if (.not. node(inverse_at) > 0.0_dp) cycle
        mass = mass + 1.0_dp/node(inverse_at)
        inertia = inertia + node(node_gyration)/node(inverse_at)
      end associate
    end do
    if (mass > 0.0_dp) length = sqrt(inertia/mass)
  end function shared_vector_length

  !> The component around the axis of a vector of a node's members, and its inverse mass.
  pure subroutine shared_vector_around(shared, n, bodies, fields, column, vector, inverse_mass)
    type(shared_nodes_t), intent(in) :: shared
    integer, intent(in) :: n, column             !! node, first column of the vector
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(inout) :: vector(:, :)        !! (3, members)
    real(dp), intent(inout) :: inverse_mass(:, :)  !! (3, members) of each component
    real(dp) :: length
    integer :: k, m
    length = shared_vector_length(shared, n, bodies, fields)
    if (.not. length > 0.0_dp) return
    do k = 1, size(vector, 2)
      m = shared%member_start(n) + k - 1
      if (.not. turns(bodies(shared%body(m)), fields(shared%field(m)))) cycle
      associate (node => fields(shared%field(m))%node(shared%record(m), :))
        if (.not. node(inverse_at) > 0.0_dp) cycle
        if (.not. shared%held(around, n)) vector(around, k) = length*node(node_swirl(column))
        inverse_mass(around, k) = inverse_mass(around, k)*(length**2/node(node_gyration))
      end associate
    end do
  end subroutine shared_vector_around

  !> Adds to the vector of a member that begins at a column.
  pure subroutine shared_vector_add(field, record, column, change, length)
    type(field_t), intent(inout) :: field
    integer, intent(in) :: record, column
    real(dp), intent(in) :: change(3)
    real(dp), intent(in) :: length               !! X_n
    integer :: d
    do d = 1, field%ndim
      field%node(record, column + d - 1) = field%node(record, column + d - 1) + change(d)
    end do
    if (field%columns%swirl == 0 .or. .not. length > 0.0_dp) return
    associate (rate => field%node(record, node_swirl(column)))
      rate = rate + change(around)/length
    end associate
  end subroutine shared_vector_add

  !> Whether a member has a velocity around the axis.
  pure function turns(body, field) result(yes)
    type(body_t), intent(in) :: body
    type(field_t), intent(in) :: field
    logical :: yes
    yes = field%columns%swirl > 0 .and. .not. body%rigid
  end function turns

end module sgmp_node_vectors
