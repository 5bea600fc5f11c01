!> Von Mises plasticity with isotropic hardening: perfect, linear, or power law (theory 4).
module sgmp_material_j2
  use sgmp_keys, only: key, key_t, kind_word, values_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: history_t
  use sgmp_radial_return, only: hardening_keys, hardening_power_term, hardening_t, &
                                radial_return_linear, radial_return_power
  use sgmp_spelling, only: word_position, words_joined
  implicit none
  private
  public :: j2_t, j2_init, j2_yield_stress, j2_return
  public :: j2_keys, j2_read
  public :: j2_perfect, j2_linear, j2_power

  integer, parameter :: j2_perfect = 1  !! sigma_y = yield
  integer, parameter :: j2_linear = 2  !! sigma_y = yield + modulus ep
  integer, parameter :: j2_power = 3   !! sigma_y = yield + modulus ep^exponent
  character(8), parameter :: j2_names(*) = [character(8) :: 'perfect', 'linear', 'power']

  !> Hardening law.
  type :: j2_t
    integer :: kind = j2_perfect      !! one of j2_*
    real(dp) :: yield = 0.0_dp        !! initial yield stress (stress)
    real(dp) :: modulus = 0.0_dp      !! hardening modulus, or factor of the power law (stress)
    real(dp) :: exponent = 1.0_dp     !! exponent of the power law
  end type j2_t

contains

  !> Keys of the law, besides the moduli.
  function j2_keys() result(keys)
    type(key_t), allocatable :: keys(:)
    type(key_t), allocatable :: shared(:)
    shared = hardening_keys()
    keys = [shared(1), &
            key('hardening', kind_word, 'hardening law', choices=words_joined(j2_names), &
                default=trim(j2_names(j2_perfect))), &
            shared(2:)]
  end function j2_keys

  !> Law from the values of its keys.
  pure subroutine j2_read(values, law, history)
    class(values_t), intent(in) :: values
    type(j2_t), intent(out) :: law
    type(history_t), intent(inout) :: history
    law = j2_init(word_position(values%word('hardening'), j2_names), values%number('yield'), &
                  values%number('hardening_modulus'), values%number('hardening_exponent'))
    history%plastic = .true.
  end subroutine j2_read

  !> Hardening law from plain numbers; a power law of exponent 1 is treated as linear, and so
  !! exactly.
  pure function j2_init(kind, yield, modulus, exponent) result(law)
    integer, intent(in) :: kind      !! one of j2_*
    real(dp), intent(in) :: yield    !! initial yield stress (stress)
    real(dp), intent(in) :: modulus  !! hardening modulus (stress); ignored by j2_perfect
    real(dp), intent(in) :: exponent  !! > 0; ignored unless j2_power
    type(j2_t) :: law
    law%kind = kind
    law%yield = yield
    if (kind /= j2_perfect) law%modulus = modulus
    if (kind == j2_power) law%exponent = exponent
    if (kind == j2_power .and. abs(exponent - 1.0_dp) <= 0.0_dp) law%kind = j2_linear
  end function j2_init

  !> Yield stress at the equivalent plastic strain `ep` (stress).
  pure function j2_yield_stress(law, ep) result(stress)
    type(j2_t), intent(in) :: law  !! hardening law
    real(dp), intent(in) :: ep    !! equivalent plastic strain, >= 0
    real(dp) :: stress
    if (law%kind == j2_power) then
      stress = law%yield + law%modulus*hardening_power_term(ep, law%exponent)
    else
      stress = law%yield + law%modulus*ep
    end if
  end function j2_yield_stress

  !> Lane kernel: radial return of the trial deviator; closed form unless the law is a power.
  pure subroutine j2_return(law, shear3, trial, ep, factor, dep, scatter)
    type(j2_t), intent(in) :: law           !! hardening law
    real(dp), intent(in) :: shear3          !! three times the shear modulus (stress)
    real(dp), intent(in) :: trial(lanes)    !! von Mises norm of the trial deviator (stress)
    real(dp), intent(inout) :: ep(lanes)    !! equivalent plastic strain, updated
    real(dp), intent(out) :: factor(lanes)  !! scales the trial deviator
    real(dp), intent(out) :: dep(lanes)     !! plastic strain increment
    real(dp), intent(in), optional :: scatter(lanes)  !! factor on the yield stress
    type(hardening_t) :: hardening
    real(dp) :: softening(lanes)
    hardening%shear3 = shear3
    hardening%yield = law%yield
    hardening%modulus = law%modulus
    hardening%exponent = law%exponent
    softening = 1.0_dp
    if (present(scatter)) softening = scatter
    if (law%kind == j2_power) then
      call radial_return_power(hardening, softening, trial, ep, factor, dep)
    else
      call radial_return_linear(hardening, softening, trial, ep, factor, dep)
    end if
  end subroutine j2_return

end module sgmp_material_j2
