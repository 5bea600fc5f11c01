!> How matter moves on the grid at the end of a run: by how much points differ from neighbours.
!!
!! The grid then holds what particles have given it for the step to come; what nodes had in the last
!! one may be gone, for particles that change bins may have asked for another layout.
module sgmp_node_motion
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_parallel, only: parallel_sum
  use sgmp_rows, only: key_j, key_k
  implicit none
  private
  public :: node_motion

  integer, parameter :: terms = 6                !! of the sums over nodes
  real(dp), parameter :: unit = 2.0_dp**50       !! of sums: whole numbers, in any order the same

contains

  !> Mean square velocity of a field's points by mass, as seen from the mean velocity, and the mean
  !! square of what neighbours differ by; 0 if next to nothing moves. All ranks must call it.
  subroutine node_motion(model, f, square, change)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    real(dp), intent(out) :: square, change  !! (speed squared)
    integer(i8) :: sums(terms)             !! mass, momentum, mass v^2, mass (change of v)^2
    real(dp) :: means(terms), mass
    integer :: i
    square = 0.0_dp
    change = 0.0_dp
    mass = sum(model%totals%bodies%mass, mask=model%bodies%field == f)
    if (.not. min(mass, model%findings%fastest) > 0.0_dp) return
    sums = 0_i8
    call add_field(model%fields(f), model%ranks%partition%own, mass, model%findings%fastest, sums)
    do i = 1, size(sums)
      means(i) = real(parallel_sum(sums(i)), dp)/unit
    end do
    if (.not. means(1) > 0.0_dp) return
    square = (means(5)/means(1) - sum((means(2:4)/means(1))**2))*model%findings%fastest**2
    change = means(6)/means(1)*model%findings%fastest**2
  end subroutine node_motion

  !> Adds the points of the own planes to the sums, in units of the mass and the speed given. Ranks
  !! know all that was given to the centres of the plane before theirs, and to the nodes of the
  !! plane behind.
  pure subroutine add_field(field, own, mass, speed, sums)
    type(field_t), intent(in) :: field
    integer, intent(in) :: own(2)          !! first and last plane of this rank
    real(dp), intent(in) :: mass, speed
    integer(i8), intent(inout) :: sums(terms)
    real(dp) :: v(3), m, change
    integer :: s, i, n, j, k, here, next
    n = field%ndim
    next = merge(-1, 1, kernel_centred(field%kernel))
    do s = 1, field%store%n
      j = key_j(field%store%key(s))
      k = key_k(field%store%key(s))
      if (k < own(1) .or. k > own(2)) cycle
      here = field%base(s)
      do i = field%store%first(s), field%store%last(s)
        m = field%moment(here + i, field%columns%mass)
        if (.not. m > 0.0_dp) cycle
        v = velocity(field, here + i, speed)
        change = beside(field, i + next, j, k, v, speed)
        if (n == 3) change = change + beside(field, i, j + next, k, v, speed)
        if (n > 1) change = change + beside(field, i, j, k + next, v, speed)
        sums = sums + nint(unit*(m/mass)*[1.0_dp, v, sum(v**2), change], i8)
      end do
    end do
  end subroutine add_field

  !> Mean velocity of what has given to a point.
  pure function velocity(field, record, speed) result(v)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record
    real(dp), intent(in) :: speed
    real(dp) :: v(3)
    integer :: first
    first = field%columns%momentum
    v = 0.0_dp
    v(:field%ndim) = field%moment(record, first:first + field%ndim - 1)/ &
                     (speed*field%moment(record, field%columns%mass))
  end function velocity

  !> Square of the difference of a velocity from that of a neighbour; 0 where there is none.
  pure real(dp) function beside(field, i, j, k, v, speed) result(square)
    type(field_t), intent(in) :: field
    integer, intent(in) :: i, j, k         !! place of the neighbour
    real(dp), intent(in) :: v(3), speed
    integer :: base
    base = field_base(field, j, k, i)
    square = 0.0_dp
    if (base == huge(1)) return
    if (field%moment(base + i, field%columns%mass) > 0.0_dp) then
      square = sum((velocity(field, base + i, speed) - v)**2)
    end if
  end function beside

end module sgmp_node_motion
