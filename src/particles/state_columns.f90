!> Names of the columns that particles keep beside their motion, as checkpoints and particle files
!! have them.
module sgmp_state_columns
  use sgmp_constitutive, only: slots_t
  use sgmp_particle_fields, only: particle_field_components, particle_field_find
  use sgmp_voigt, only: voigt_names
  implicit none
  private
  public :: state_column_names, state_columns_of_files, state_name_length

  integer, parameter :: state_name_length = 16

  !> A column of the material, which a particle file may give at the start.
  character(state_name_length), parameter :: material_columns(*) = [ &
    character(state_name_length) :: &
    'plastic_strain', 'temperature', 'damage', 'energy', 'distention', 'pore_shift', 'bulking', &
    'preconsolidation', 'lighting_time', 'strength', 'yield_factor']

contains

  !> Names of the columns behind the motion; '' for those that only their feature knows. The mean
  !! stress where it is the only one, and `spin+2` for the third component of the spin.
  function state_column_names(slots, space) result(names)
    type(slots_t), intent(in) :: slots
    integer, intent(in) :: space
    character(state_name_length) :: names(slots%total)
    names = ''
    names(slots%volume) = 'volume'
    if (slots%stresses > 1) then
      names(slots%stress:slots%stress + slots%stresses - 1) = &
        particle_field_components(particle_field_find('stress'), space, slots%stresses)
    else
      call name_column(slots%stress, 'mean_stress')
    end if
    call name_column(slots%plastic, 'plastic_strain')
    call name_column(slots%temperature, 'temperature')
    call name_column(slots%damage, 'damage')
    call name_column(slots%energy, 'energy')
    call name_column(slots%distention, 'distention')
    call name_column(slots%pore_shift, 'pore_shift')
    call name_column(slots%bulking, 'bulking')
    call name_column(slots%preconsolidation, 'preconsolidation')
    call name_column(slots%lighting, 'lighting_time')
    call name_column(slots%deformation, 'deformation')
    call name_column(slots%stretch, 'stretch')
    call name_column(slots%initial, 'initial')
    call name_column(slots%swirl, 'swirl')
    call name_column(slots%surface, 'surface')
    call name_column(slots%compliance, 'compliance')
    call name_column(slots%strength, 'strength')
    call name_column(slots%yield_factor, 'yield_factor')
    call name_column(slots%path, 'path')
  contains
    subroutine name_column(column, name)
      integer, intent(in) :: column
      character(*), intent(in) :: name
      if (column > 0) names(column) = name
    end subroutine name_column
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
    do q = 1, size(material_columns)
      names = names//' '//trim(material_columns(q))
    end do
  end function state_columns_of_files

end module sgmp_state_columns
