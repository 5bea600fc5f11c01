!> What a run of a scene will need of the machine's memory, known from its cards before anything is
!! allocated; and what there is.
!!
!! The number of particles follows from the volume of the shapes, the bytes of each from the columns
!! of its streams and the unused lanes of its bins, the grid from the cells that the particles fill.
!! Measured peaks were within 20 % of it (tests/regression/folder.py); materials with much history
!! need more.
module sgmp_memory_need
  use sgmp_columns, only: pair_sums
  use sgmp_errors, only: error_make, error_t, exit_deck
  use sgmp_kernels, only: bin_span, method_kernel
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_parallel, only: parallel_any, parallel_ranks, parallel_ranks_here
  use sgmp_process, only: memory_available_bytes
  use sgmp_scene, only: body_card_t, layout_file, layout_gauss, scene_t
  use sgmp_seeding, only: seeding_check_lattices, seeding_shape_volume
  use sgmp_springs, only: scene_springs
  use sgmp_text, only: real_text
  implicit none
  private
  public :: memory_need, memory_need_here, memory_refuse, particles_expected

  real(dp), parameter :: bytes_of_process = 2.0e7_dp  !! libraries; with MPI 2.6e7
  real(dp), parameter :: gibibyte = 1024.0_dp**3
  integer, parameter :: history_columns = 1
    !! besides volume and stress: of a simple plastic material

contains

  !> Peak of the bytes of all ranks together.
  function memory_need(scene) result(bytes)
    type(scene_t), intent(in) :: scene
    real(dp) :: bytes, in_cell
    integer :: b
    bytes = bytes_of_process*parallel_ranks()
    do b = 1, size(scene%bodies)
      if (scene%bodies(b)%layout == layout_file) cycle  ! its size is that of a file
      in_cell = per_cell(scene, scene%bodies(b))
      bytes = bytes + of_body(scene, b)*(of_particle(scene, in_cell) + of_grid(scene)/in_cell)
    end do
  end function memory_need

  !> Particles of all bodies together; `huge` where files bring some.
  function particles_expected(scene) result(particles)
    type(scene_t), intent(in) :: scene
    real(dp) :: particles
    integer :: b
    particles = 0.0_dp
    if (any(scene%bodies%layout == layout_file)) particles = huge(particles)
    do b = 1, size(scene%bodies)
      if (particles < huge(particles)) particles = particles + of_body(scene, b)
    end do
  end function particles_expected

  !> Particles of a body that is a shape.
  function of_body(scene, number) result(particles)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: number
    real(dp) :: particles
    associate (body => scene%bodies(number), d => scene%dimension)
      particles = per_cell(scene, body)/scene%grid%cell**d* &
                  seeding_shape_volume(body, d, size(scene%bodies), section=.true.)
    end associate
  end function of_body

  !> Bytes that the ranks of this machine will need, and those they can have; an error where the
  !! bodies cannot be counted.
  subroutine memory_need_here(scene, need, available, error)
    type(scene_t), intent(in) :: scene
    real(dp), intent(out) :: need, available
    type(error_t), allocatable, intent(out) :: error
    need = 0.0_dp
    available = 0.0_dp
    call seeding_check_lattices(scene, error)
    if (allocated(error)) return
    need = memory_need(scene)*parallel_ranks_here()/parallel_ranks()
    available = real(memory_available_bytes(), dp)
  end subroutine memory_need_here

  !> An error on all ranks where a machine has less memory than its ranks will need.
  subroutine memory_refuse(scene, error)
    type(scene_t), intent(in) :: scene
    type(error_t), allocatable, intent(out) :: error
    real(dp) :: need, available
    call memory_need_here(scene, need, available, error)
    if (allocated(error)) return
    if (.not. parallel_any(need > available)) return
    call error_make(error, exit_deck, 'the run needs about '//real_text(need/gibibyte)// &
                    ' GiB of memory, and there are '//real_text(available/gibibyte), &
                    'use fewer particles, or ranks on more machines; --check shows what needs '// &
                    'how much', scene%file)
  end subroutine memory_refuse

  !> Particles of a body in a full cell.
  pure function per_cell(scene, body) result(number)
    type(scene_t), intent(in) :: scene
    type(body_card_t), intent(in) :: body
    real(dp) :: number, spacing
    spacing = body%spacing
    if (body%layout == layout_gauss) spacing = scene%grid%cell/body%ppc
    number = (scene%grid%cell/spacing)**scene%dimension
  end function per_cell

  !> Bytes of a particle: its columns, its part of the lanes that stay empty in its bin, and an
  !! entry of each list that orders it; a copy where output is written.
  pure function of_particle(scene, in_cell) result(bytes)
    type(scene_t), intent(in) :: scene
    real(dp), intent(in) :: in_cell
    real(dp) :: bytes, in_bin
    integer :: columns, stresses
    stresses = merge(6, scene%dimension + 2, scene%dimension == 3 .or. scene%swirl)
    columns = 2*scene%dimension + 2 + stresses + history_columns
    in_bin = max(min(in_cell, 1.0e8_dp), 1.0_dp)*bin_span(method_kernel(scene%method%kind), &
                                                          scene%dimension)
    bytes = 8.0_dp*columns*lanes*ceiling(in_bin/lanes)/in_bin + 12.0_dp
    if (writes_particles(scene)) bytes = bytes + 8.0_dp*(stresses + 12)
  end function of_particle

  !> Bytes of a point of the grid.
  function of_grid(scene) result(bytes)
    type(scene_t), intent(in) :: scene
    real(dp) :: bytes
    integer :: d, turns
    d = scene%dimension
    bytes = 8.0_dp*(1 + d + d*(d + 1)/2 + 2*d + 1 + d)
    if (takes_consistent(scene)) bytes = bytes + 8.0_dp*5*d
    if (d == 1) return
    if (scene%method%surfaces) then
      bytes = bytes + 8.0_dp*(1 + 2*pair_sums(d) + merge(2, 12, d == 2) + d**2)
    end if
    if (scene%method%rotation) then
      turns = merge(1, 3, d == 2)
      bytes = bytes + 8.0_dp*(3*d + turns + 2*turns**2 + 1.5_dp)
    end if
  end function of_grid

  !> Whether the mass of nodes is consistent (sgmp_build_columns).
  function takes_consistent(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    integer :: b
    yes = scene%method%consistent
    if (.not. scene%method%consistent_auto) return
    do b = 1, size(scene%bodies)
      yes = yes .and. (scene%bodies(b)%rigid .or. scene_springs(scene, b))
    end do
  end function takes_consistent

  pure function writes_particles(scene) result(yes)
    type(scene_t), intent(in) :: scene
    logical :: yes
    associate (output => scene%output)
      yes = any(output%writes) .or. output%csv_end
    end associate
  end function writes_particles

end module sgmp_memory_need
