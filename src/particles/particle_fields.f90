!> The fields of particles that can be written, each a line of one table: name, components, whether
!! the initial position is needed, and the procedure that takes the values from a particle; behind
!! them the columns that particles keep and that may be written (sgmp_material_history).
module sgmp_particle_fields
  use sgmp_body, only: body_t
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: kept_columns, slots_column
  use sgmp_motion, only: motion_mass
  use sgmp_voigt, only: voigt_name, voigt_names
  implicit none
  private
  public :: particle_field_t, particle_place_t, particle_field_find, particle_field_names, &
            particle_field_components, particle_field_values, most_components

  integer, parameter :: scalar = 1, vector = 2, tensor = 3
  integer, parameter :: most_components = size(voigt_names)
  character(1), parameter :: vector_ends(3) = ['x', 'y', 'z']

  !> Where a particle of a body is stored and where it is.
  type :: particle_place_t
    integer :: ndim = 3, lane = 1, chunk = 1
    real(dp) :: position(3) = 0.0_dp, initial(3) = 0.0_dp  !! now and at t = 0 (length)
  end type particle_place_t

  abstract interface
    !> Values of a field at one particle; a scalar fills the first of them.
    pure function take_values(body, at) result(values)
      import :: body_t, dp, most_components, particle_place_t
      implicit none
      type(body_t), intent(in) :: body
      type(particle_place_t), intent(in) :: at
      real(dp) :: values(most_components)
    end function take_values
  end interface

  !> One field.
  type :: particle_field_t
    character(16) :: name
    integer :: kind                        !! scalar, vector or tensor
    logical :: from_start                  !! the initial position must be known
    procedure(take_values), pointer, nopass :: take  !! null: the column of its name
  end type particle_field_t

contains

  !> The table, in the order in which the deck reference lists the names.
  function field_table() result(fields)
    type(particle_field_t), allocatable :: fields(:)
    integer :: k
    fields = [particle_field_t('initial_position', vector, .true., initial_position), &
              particle_field_t('displacement', vector, .true., displacement), &
              particle_field_t('stress', tensor, .false., stress), &
              particle_field_t('pressure', scalar, .false., pressure), &
              particle_field_t('von_mises', scalar, .false., von_mises), &
              particle_field_t('density', scalar, .false., density), &
              particle_field_t('volume', scalar, .false., volume), &
              particle_field_t('mass', scalar, .false., mass)]
    do k = 1, size(kept_columns)
      if (kept_columns(k)%written) fields = [fields, &
                                             particle_field_t(kept_columns(k)%name, scalar, &
                                                                      .false., null())]
    end do
  end function field_table

  !> Values of a field at one particle; a scalar fills the first of them.
  pure function particle_field_values(field, body, at) result(values)
    type(particle_field_t), intent(in) :: field
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components)
    if (associated(field%take)) then
      values = field%take(body, at)
    else
      values = stored(body, at, slots_column(body%law%slots, field%name))
    end if
  end function particle_field_values

  !> All names with blanks between them.
  function particle_field_names() result(names)
    character(:), allocatable :: names
    type(particle_field_t), allocatable :: fields(:)
    integer :: f
    fields = field_table()
    names = trim(fields(1)%name)
    do f = 2, size(fields)
      names = names//' '//trim(fields(f)%name)
    end do
  end function particle_field_names

  !> The field of a name that is in the table.
  function particle_field_find(name) result(field)
    character(*), intent(in) :: name
    type(particle_field_t) :: field
    type(particle_field_t), allocatable :: fields(:)
    fields = field_table()
    field = fields(findloc(fields%name == name, .true., 1))
  end function particle_field_find

  !> Names of a field's components as columns of a table have them; a scalar's is its own.
  pure function particle_field_components(field, space, stresses) result(names)
    type(particle_field_t), intent(in) :: field
    integer, intent(in) :: space
    integer, intent(in) :: stresses              !! components of a tensor
    character(32), allocatable :: names(:)
    integer :: c
    select case (field%kind)
    case (tensor)
      names = [character(32) :: (trim(field%name)//'_'//voigt_name(c, space), &
                                 c=1, stresses)]
    case (vector)
      names = trim(field%name)//'_'//vector_ends
    case default  ! scalar
      names = [character(32) :: field%name]
    end select
  end function particle_field_components

  pure function initial_position(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components)
    values = 0.0_dp
    values(:3) = at%initial
  end function initial_position

  pure function displacement(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components)
    values = 0.0_dp
    values(:3) = at%position - at%initial
  end function displacement

  !> Stress in Voigt's order; where only a pressure is stored, that of a fluid.
  pure function stress(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components)
    values = 0.0_dp
    associate (first => body%law%slots%stress, n => body%law%slots%stresses)
      if (n == 1) then
        values(:3) = body%particles%state(at%lane, first, at%chunk)
      else
        values(:n) = body%particles%state(at%lane, first:first + n - 1, at%chunk)
      end if
    end associate
  end function stress

  pure function pressure(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components), s(most_components)
    s = stress(body, at)
    values = 0.0_dp
    values(1) = -sum(s(:3))/3.0_dp
  end function pressure

  pure function von_mises(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components), s(most_components)
    s = stress(body, at)
    values = 0.0_dp
    values(1) = sqrt(0.5_dp*((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2) + &
                     3.0_dp*sum(s(4:)**2))
  end function von_mises

  pure function density(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components), m(most_components), v(most_components)
    m = mass(body, at)
    v = volume(body, at)
    values = 0.0_dp
    values(1) = m(1)/v(1)
  end function density

  pure function mass(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components)
    values = 0.0_dp
    values(1) = body%particles%motion(at%lane, motion_mass(at%ndim), at%chunk)
  end function mass

  pure function volume(body, at) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    real(dp) :: values(most_components)
    values = stored(body, at, body%law%slots%volume)
  end function volume

  !> A column of the second stream; zero where the body's material has no such history.
  pure function stored(body, at, column) result(values)
    type(body_t), intent(in) :: body
    type(particle_place_t), intent(in) :: at
    integer, intent(in) :: column
    real(dp) :: values(most_components)
    values = 0.0_dp
    if (column > 0) values(1) = body%particles%state(at%lane, column, at%chunk)
  end function stored

end module sgmp_particle_fields
