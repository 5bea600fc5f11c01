!> What waves of few cells say about a run with a liquid under gravity (doc/verdict.md).
!!
!! Gravity waves of the wave number k are too slow on cells of the side h: with sgmp by 0.9 (kh)^2,
!! at any depth, with bspline by 0.55 (kh)^2; the others add noise (class Slosh of the random
!! scenes). A flow with a potential has |grad v|^2 = 2 k^2 v^2 in the mean, so that the velocities
!! of neighbouring nodes at the end say which k is in it; where waves stand just then, noise may
!! make it larger.
module sgmp_judge_waves
  use sgmp_columns, only: node_inverse_mass, node_velocity
  use sgmp_constitutive, only: law_liquid
  use sgmp_field, only: field_base, field_t
  use sgmp_kernels, only: method_bspline, method_sgmp
  use sgmp_kinds, only: dp, i8
  use sgmp_model, only: model_t
  use sgmp_opinion, only: opinion_t
  use sgmp_parallel, only: parallel_sum
  use sgmp_rows, only: key_j, key_k
  use sgmp_scene, only: scene_t
  use sgmp_text, only: real_text_about
  implicit none
  private
  public :: judge_waves

  real(dp), parameter :: wave_weight = 1.0_dp    !! error over (kh)^2, sgmp 0.86 to 1.02
  real(dp), parameter :: noisy_weight = 4.0_dp   !! of methods that are neither sgmp nor bspline
  real(dp), parameter :: least_told = 0.06_dp, least_error = 0.1_dp
  real(dp), parameter :: most_error = 0.35_dp
  real(dp), parameter :: least_motion = 1.0e-6_dp  !! v^2 over g and the liquid's extent
  integer, parameter :: terms = 6                !! of the sums over nodes
  real(dp), parameter :: unit = 2.0_dp**50       !! of sums: whole numbers, in any order the same

contains

  !> Waves that the cells hardly resolve.
  subroutine judge_waves(opinion, scene, model)
    type(opinion_t), intent(inout) :: opinion
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    real(dp) :: square, lost
    integer :: f
    if (.not. any(abs(scene%gravity) > 0.0_dp) .or. model%mesh%ndim == 1) return
    do f = 1, size(model%fields)
      if (.not. any(law_liquid(model%bodies%law) .and. .not. model%bodies%rigid .and. &
                    model%bodies%field == f)) cycle
      square = wave_number(scene, model, f)
      lost = square*merge(wave_weight, noisy_weight, any(scene%method%kind == [method_sgmp, &
                                                                               method_bspline]))
      if (lost < least_told) cycle
      text = 'waves of the liquid are about '// &
             real_text_about(2.0_dp*acos(-1.0_dp)/sqrt(square))//' cells long: '
      call opinion%expect(min(most_error, max(least_error, lost)), text//'they are slower than '// &
                          'they should be; use smaller cells')
      return
    end do
  end subroutine judge_waves

  !> The mean (kh)^2 of a field's motion; 0 if next to nothing moves. All ranks must call it.
  function wave_number(scene, model, f) result(square)
    type(scene_t), intent(in) :: scene
    type(model_t), intent(in) :: model
    integer, intent(in) :: f
    real(dp) :: square
    integer(i8) :: sums(terms)             !! mass, momentum, mass v^2, mass (change of v)^2
    real(dp) :: means(terms), mass, volume, motion
    integer :: i
    mass = sum(model%totals%bodies%mass, mask=model%bodies%field == f)
    volume = sum(model%totals%bodies%mass/model%bodies%law%density, mask=model%bodies%field == f)
    square = 0.0_dp
    if (.not. min(mass, model%findings%fastest) > 0.0_dp) return
    sums = 0_i8
    call add_field(model%fields(f), model%ranks%partition%own, mass, model%findings%fastest, sums)
    do i = 1, size(sums)
      means(i) = real(parallel_sum(sums(i)), dp)/unit
    end do
    if (.not. means(1) > 0.0_dp) return
    motion = means(5)/means(1) - sum((means(2:4)/means(1))**2)
    if (motion*model%findings%fastest**2 < least_motion*norm2(scene%gravity)* &
        volume**(1.0_dp/merge(3, model%mesh%ndim, scene%axisymmetric))) return
    square = 0.5_dp*means(6)/(means(1)*motion)
  end function wave_number

  !> Adds the nodes of the own planes to the sums, in units of the mass and the speed given.
  pure subroutine add_field(field, own, mass, speed, sums)
    type(field_t), intent(in) :: field
    integer, intent(in) :: own(2)          !! first and last plane of this rank
    real(dp), intent(in) :: mass, speed
    integer(i8), intent(inout) :: sums(terms)
    real(dp) :: v(3), m, change
    integer :: s, i, n, j, k, here, inverse
    n = field%ndim
    inverse = node_inverse_mass(n)
    do s = 1, field%work%n
      j = key_j(field%work%key(s))
      k = key_k(field%work%key(s))
      if (k < own(1) .or. k > own(2)) cycle
      here = field_base(field, j, k, field%work%first(s))
      do i = field%work%first(s), field%work%last(s)
        if (.not. field%node(here + i, inverse) > 0.0_dp) cycle
        m = unit/(mass*field%node(here + i, inverse))
        v = velocity(field, here + i, speed)
        change = apart(field, here + i + 1, i < field%work%last(s), v, speed)
        if (n == 2) change = change + beside(field, i, j, k + 1, v, speed)
        if (n == 3) change = change + beside(field, i, j + 1, k, v, speed) + &
                             beside(field, i, j, k + 1, v, speed)
        sums = sums + nint(m*[1.0_dp, v, sum(v**2), change], i8)
      end do
    end do
  end subroutine add_field

  !> Velocity of a node.
  pure function velocity(field, record, speed) result(v)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record
    real(dp), intent(in) :: speed
    real(dp) :: v(3)
    integer :: first
    first = node_velocity(field%ndim)
    v = 0.0_dp
    v(:field%ndim) = field%node(record, first:first + field%ndim - 1)/speed
  end function velocity

  !> Square of the difference of a velocity from that of another node; 0 where there is none.
  pure real(dp) function apart(field, record, stored, v, speed) result(square)
    type(field_t), intent(in) :: field
    integer, intent(in) :: record
    logical, intent(in) :: stored
    real(dp), intent(in) :: v(3), speed
    square = 0.0_dp
    if (.not. stored) return
    if (field%node(record, node_inverse_mass(field%ndim)) > 0.0_dp) then
      square = sum((velocity(field, record, speed) - v)**2)
    end if
  end function apart

  !> The same of a node in another row.
  pure real(dp) function beside(field, i, j, k, v, speed) result(square)
    type(field_t), intent(in) :: field
    integer, intent(in) :: i, j, k
    real(dp), intent(in) :: v(3), speed
    integer :: base
    base = field_base(field, j, k, i)
    square = 0.0_dp
    if (base /= huge(1)) square = apart(field, base + i, .true., v, speed)
  end function beside

end module sgmp_judge_waves
