!> How many threads a run takes: as many as it may, but no more than have enough to do.
!!
!! Threads meet a dozen times per step and field, which costs 40 to 300 microseconds on a machine
!! without other work (doc/performance.md). Results have the same bits for any number.
module sgmp_thread_choice
  use omp_lib, only: omp_set_num_threads
  use sgmp_errors, only: error_make, error_t, exit_usage
  use sgmp_kernels, only: method_kernel, stencil_width
  use sgmp_kinds, only: dp
  use sgmp_memory_need, only: particles_expected
  use sgmp_parallel, only: parallel_ranks
  use sgmp_scene, only: scene_t
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: thread_choice_t, thread_choice_read

  !> Particles of a velocity field below which a thread does not pay, by the width of stencils:
  !! those with wide ones take 2.5 times as long.
  integer, parameter :: least_share(2:3) = [1000, 400]

  !> Threads of each rank.
  type :: thread_choice_t
    integer :: most = 1                    !! that may be taken
    logical :: exact = .false.             !! that many, whatever the scene
    integer :: threads = 1                 !! that are taken
    character(:), allocatable :: reason    !! why not all
  contains
    procedure :: choose
  end type thread_choice_t

contains

  !> What the command line and the environment allow: `SGMP_THREADS=exact` takes all.
  subroutine thread_choice_read(most, choice, error)
    integer, intent(in) :: most
    type(thread_choice_t), intent(out) :: choice
    type(error_t), allocatable, intent(out) :: error
    character(32) :: value
    choice%most = most
    choice%reason = ''
    call get_environment_variable('SGMP_THREADS', value)
    choice%exact = value == 'exact'
    if (choice%exact .or. value == '') return
    call error_make(error, exit_usage, "SGMP_THREADS='"//trim(value)//"' in the environment is "// &
                    'not known', 'say exact, for as many threads as --threads allows whatever '// &
                    'the scene, or nothing; the number itself is that of --threads or '// &
                    'OMP_NUM_THREADS')
  end subroutine thread_choice_read

  !> Chooses for a scene whose bodies can be counted.
  subroutine choose(choice, scene)
    class(thread_choice_t), intent(inout) :: choice
    type(scene_t), intent(in) :: scene
    real(dp) :: particles
    integer :: share, fields
    choice%threads = choice%most
    if (scene%dimension == 1 .and. choice%most > 1) then
      choice%threads = 1
      choice%reason = 'a line is not divided'
    else if (.not. choice%exact .and. choice%most > 1) then
      share = least_share(stencil_width(method_kernel(scene%method%kind)))
      fields = merge(max(1, size(scene%bodies)), 1, size(scene%contacts) > 0)
      particles = particles_expected(scene)/parallel_ranks()
      if (particles < real(share, dp)*fields*choice%most) then
        choice%threads = max(1, int(particles/(real(share, dp)*fields)))
        choice%reason = 'about '//integer_text(nint(particles))//' particles: a thread pays '// &
                        'from '//integer_text(share*fields)//' on'
      end if
    end if
    call omp_set_num_threads(choice%threads)
  end subroutine choose

end module sgmp_thread_choice
