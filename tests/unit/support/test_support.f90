!> What several unit tests share: models from the text of a deck, repeatable random numbers, particles ordered by id.
module test_support
  use sgmp_build_model, only: model_build
  use sgmp_deck, only: deck_read
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_errors, only: error_t
  use sgmp_kinds, only: dp, i8, lanes
  use sgmp_model, only: model_t
  use sgmp_scene, only: scene_t
  use sgmp_step, only: step_take
  implicit none
  private
  public :: nl, random_t, model_from_text, model_particles, model_steps
  public :: paper_scheme

  character(1), parameter :: nl = new_line('a')

  !> Park and Miller's generator: the same numbers everywhere.
  type :: random_t
    integer(i8) :: state = 20210817_i8
  contains

   procedure :: uniform
    procedure :: whole
  end type random_t

contains

  !> The next number in (0, 1).
  impure elemental function uniform(this) result(u)
    class(random_t), intent(inout) :: this
    real(dp) :: u
    this%state = modulo(16807_i8*this%state, 2147483647_i8)
    u = real(this%state, dp)/2147483647.0_dp
  end function uniform

  !> The next whole number in low..high.
  impure elemental function whole(this, low, high) result(n)
    class(random_t), intent(inout) :: this
    integer, intent(in) :: low, high
    integer :: n
    n = low + int(this%uniform()*(high - low + 1))
  end function whole

  !> Builds a model from a deck given as text; `ok` is false, with the errors printed, where that fails.
  subroutine model_from_text(text, threads, model, ok)
    character(*), intent(in) :: text
    integer, intent(in) :: threads
    type(model_t), intent(out) :: model
    logical, intent(out) :: ok
    type(scene_t) :: scene
    type(deck_errors_t) :: errors
    type(error_t), allocatable :: error
    character(1) :: none(0)
    character(32) :: file
    integer :: unit
    write (file, '(a,i0,a)') 'deck_', process_number(), '.inp'
    open (newunit=unit, file=file, access='stream', form='unformatted', status='replace', action='write')
    write (unit) text
    close (unit)
    call deck_read(trim(file), none, scene, errors)
    open (newunit=unit, file=file)
    close (unit, status='delete')
    ok = errors%count() == 0
    if (.not. ok) then
      call errors%print()
      return
    end if
    call model_build(scene, threads, model, error)
    ok = .not. allocated(error)
    if (allocated(error)) print '(a)', error%message
  end subroutine model_from_text

  !> A number that no other process of this machine has.
  function process_number() result(n)
    integer :: n
    interface
      function getpid() bind(c) result(pid)
        use, intrinsic :: iso_c_binding, only: c_int
        integer(c_int) :: pid
      end function getpid
    end interface
    n = int(getpid())
  end function process_number

  !> Positions (cells), velocities, masses and second streams of all particles of a body, by id.
  subroutine model_particles(model, x, v, mass, b, body)
    type(model_t), intent(in) :: model
    real(dp), allocatable, intent(out) :: x(:, :), v(:, :), mass(:), b(:, :)
    integer, intent(in), optional :: body        !! absent: 1; ids of others have no mass
    integer :: c, l, id, n, d, last, number
    number = 1
    if (present(body)) number = body
    associate (particles => model%bodies(number)%particles)
      d = particles%ndim
      n = particles%count
      last = 0
      do c = 1, particles%chunks
        last = max(last, maxval(particles%id(:, c)))
      end do
      allocate (x(d, last), v(d, last), mass(last), b(particles%state_columns, last), source=0.0_dp)
      do c = 1, particles%chunks
        do l = 1, lanes
          id = particles%id(l, c)
          if (id == 0) cycle
          x(:, id) = particles%motion(l, :d, c)
          v(:, id) = particles%motion(l, d + 1:2*d, c)
          mass(id) = particles%motion(l, 2*d + 1, c)
          b(:, id) = particles%state(l, :, c)
        end do
      end do
    end associate
  end subroutine model_particles

  !> Takes steps of a fixed size, as the time loop does.
  subroutine model_steps(model, dt, steps)
    type(model_t), intent(inout) :: model
    real(dp), intent(in) :: dt
    integer, intent(in) :: steps
    integer :: k
    do k = 1, steps
      model%clock%dt = dt
      call step_take(model)
      model%clock%step = model%clock%step + 1
      model%clock%time = model%clock%time + dt
      model%clock%dt_before = dt
    end do
  end subroutine model_steps

  !> A method with its words; those of sgmp that are not given are the paper's.
  function paper_scheme(method) result(text)
    character(*), intent(in) :: method
    character(:), allocatable :: text
    text = trim(method)
    if (index(method, 'sgmp') == 0) return
    if (index(method, 'stress=') == 0 .and. index(method, 'volumes=kept') == 0) text = text//' stress=plain'
    if (index(method, 'rotation=') == 0) text = text//' rotation=plain'
    if (index(method, 'surfaces=') == 0) text = text//' surfaces=plain'
  end function paper_scheme
 end module test_support
