!> Names of the columns that particles keep beside their motion, as checkpoints and particle files
!! have them.
module sgmp_state_columns
  use sgmp_material_history, only: kept_columns, slots_t
  use sgmp_particle_fields, only: particle_field_components, particle_field_find
  use sgmp_text, only: integer_text
  use sgmp_voigt, only: voigt_names
  implicit none
  private
  public :: state_column_names, state_columns_of_files, state_name_length

  integer, parameter :: state_name_length = 16

contains

  !> Names of the columns behind the motion; the mean stress where it is the only one, and `spin+2`
  !! for the third component of the spin.
  function state_column_names(slots, space) result(names)
    type(slots_t), intent(in) :: slots
    integer, intent(in) :: space
    character(state_name_length) :: names(slots%total)
    integer :: i, q
    names(slots%volume) = 'volume'
    do i = 1, size(slots%list)
      associate (slot => slots%list(i))
        names(slot%first) = slot%name
        do q = 1, size(slot%start) - 1
          names(slot%first + q) = trim(slot%name)//'+'//integer_text(q)
        end do
      end associate
    end do
    if (slots%stresses > 1) then
      names(slots%stress:slots%stress + slots%stresses - 1) = &
        particle_field_components(particle_field_find('stress'), space, slots%stresses)
    else
      names(slots%stress) = 'mean_stress'
    end if
  end function state_column_names

  !> Names that a particle file may have beside places, volumes and velocities, with blanks between
  !! them.
  pure function state_columns_of_files() result(names)
    character(:), allocatable :: names
    integer :: q
    names = 'density'
    do q = 1, size(voigt_names)
      names = names//' stress_'//voigt_names(q)
    end do
    do q = 1, size(kept_columns)
      if (kept_columns(q)%given) names = names//' '//trim(kept_columns(q)%name)
    end do
  end function state_columns_of_files

end module sgmp_state_columns
