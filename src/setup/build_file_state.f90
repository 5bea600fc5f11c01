!> State of particles at the start, where their file gives one: density, stress, and what their
!! material keeps.
module sgmp_build_file_state
  use sgmp_body, only: body_t
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kinds, only: dp, lanes
  use sgmp_motion, only: motion_mass
  use sgmp_parallel, only: parallel_agree
  use sgmp_particle_file, only: file_particles_t, particle_file_names, particle_file_read
  use sgmp_scene, only: body_card_t, layout_file
  use sgmp_space, only: space_axisymmetric
  use sgmp_state_columns, only: state_column_names, state_name_length
  implicit none
  private
  public :: file_state_fill

contains

  !> Gives the particles of a body the state of its file, if that has any; an error where the
  !! material keeps no such thing, or a density is not positive. All ranks must call it.
  subroutine file_state_fill(card, space, body, error)
    type(body_card_t), intent(in) :: card
    integer, intent(in) :: space
    type(body_t), intent(inout) :: body
    type(error_t), allocatable, intent(out) :: error
    type(file_particles_t) :: file
    integer, allocatable :: column(:)
    if (card%layout /= layout_file .or. body%rigid) return
    if (.not. particle_file_names(card%file)) return
    call particle_file_read(card%file, card%location, space, card%choice, file, error)
    if (.not. allocated(error)) call find_columns(card, space, body, file, column, error)
    call parallel_agree(error)
    if (allocated(error) .or. size(column) == 0) return
    call fill(file, column, body)
    body%stressed = .true.
    body%lit = any(file%names == 'lighting_time')
  end subroutine file_state_fill

  !> The column of the particles of each column of the file: 0 for the density, -1 for what this
  !! material does not keep and the file has nothing of.
  subroutine find_columns(card, space, body, file, column, error)
    type(body_card_t), intent(in) :: card
    integer, intent(in) :: space
    type(body_t), intent(in) :: body
    type(file_particles_t), intent(in) :: file
    integer, allocatable, intent(out) :: column(:)
    type(error_t), allocatable, intent(out) :: error
    character(state_name_length) :: kept(body%law%slots%total)
    integer :: q
    kept = state_column_names(body%law%slots, space)
    allocate (column(size(file%names)))
    do q = 1, size(file%names)
      column(q) = findloc(kept, file%names(q), 1)
      if (file%names(q) == 'density') then
        if (.not. all(file%state(q, :) > 0.0_dp)) call refuse(card, 'a density that is not '// &
                     'positive', 'density is mass over volume as they are at the start', error)
      else if (column(q) == 0) then
        column(q) = -1
        if (body%law%slots%stresses == 1 .and. file%names(q)(:7) == 'stress_') cycle
        if (any(abs(file%state(q, :)) > 0.0_dp)) call refuse(card, trim(file%names(q))// &
             ", which material of body '"//trim(body%name)//"' does not keep", &
             'remove the column, or take the material that the file was written with', error)
      end if
      if (allocated(error)) return
    end do
    if (card%stress%given .and. size(column) > 0) call refuse(card, "a state, and body '"// &
        trim(body%name)//"' has a card initial_stress", 'remove the card', error)
  end subroutine find_columns

  !> Copies the state of the file to the particles; a fluid keeps the mean of its stresses.
  subroutine fill(file, column, body)
    type(file_particles_t), intent(in) :: file
    integer, intent(in) :: column(:)
    type(body_t), intent(inout) :: body
    integer :: c, l, p, q, mass
    real(dp) :: mean
    associate (particles => body%particles, slots => body%law%slots)
      mass = motion_mass(particles%ndim)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          p = particles%id(l, c) - body%first_id + 1
          mean = 0.0_dp
          do q = 1, size(column)
            if (column(q) > 0) particles%state(l, column(q), c) = file%state(q, p)
            if (file%names(q) == 'density') particles%motion(l, mass, c) = &
              file%state(q, p)*particles%state(l, slots%volume, c)
            if (any(file%names(q) == ['stress_xx', 'stress_yy', 'stress_zz'])) then
              mean = mean + file%state(q, p)/3.0_dp
            end if
          end do
          if (slots%stresses == 1) particles%state(l, slots%stress, c) = mean
        end do
      end do
    end associate
  end subroutine fill

  !> An error about the file of a body.
  subroutine refuse(card, what, remedy, error)
    type(body_card_t), intent(in) :: card
    character(*), intent(in) :: what, remedy
    type(error_t), allocatable, intent(out) :: error
    call error_make(error, exit_deck, "the particle file '"//card%file//"' gives "//what, remedy, &
                    card%location)
  end subroutine refuse

end module sgmp_build_file_state
