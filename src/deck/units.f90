!> Units of a deck's numbers: what they are called, their sizes, and orders of magnitude worth a
!! warning.
module sgmp_units
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_keys, only: key_t, kind_real
  use sgmp_kinds, only: dp
  use sgmp_spelling, only: word_position
  use sgmp_text, only: real_text_about, real_text_plain
  implicit none
  private
  public :: length_units, mass_units, time_units, units_check, units_in_si, units_sizes

  !> A unit and its size in SI units (m kg s).
  character(2), parameter :: length_units(*) = [character(2) :: 'm', 'mm', 'cm', 'um', 'km']
  real(dp), parameter :: metres(*) = [1.0_dp, 1.0e-3_dp, 1.0e-2_dp, 1.0e-6_dp, 1.0e3_dp]
  character(2), parameter :: mass_units(*) = [character(2) :: 'kg', 'g', 'mg', 't']
  real(dp), parameter :: kilograms(*) = [1.0_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e3_dp]
  character(2), parameter :: time_units(*) = [character(2) :: 's', 'ms', 'us', 'ns']
  real(dp), parameter :: seconds(*) = [1.0_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp]

contains

  !> Warns where a number of a card, in SI units, is outside of what matter does.
  subroutine units_check(keys, card, units, errors)
    type(key_t), intent(in) :: keys(:)    !! of the card
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: units(3)  !! length, mass, time of the deck
    type(deck_errors_t), intent(inout) :: errors
    real(dp) :: si, low, high, factor
    integer :: i
    do i = 1, size(keys)
      associate (key => keys(i), value => card%values(i))
        if (key%kind /= kind_real .or. .not. value%given) cycle
        if (abs(value%number) <= 0.0_dp) cycle
        call plausible(key%unit, units, factor, low, high)
        si = abs(value%number)*factor
        if (si >= low .and. si <= high) cycle
        call errors%warn(value%position, key%name//' = '//real_text_plain(value%number)//' is '// &
                         real_text_about(si)//' in SI units (m kg s)', &
                         'is it in '//trim(units(1))//' '//trim(units(2))//' '//trim(units(3))//'?')
      end associate
    end do
  end subroutine units_check

  !> Metres, kilograms and seconds of the units of a deck.
  pure function units_sizes(units) result(sizes)
    character(*), intent(in) :: units(3)   !! length, mass, time
    real(dp) :: sizes(3)
    sizes = [metres(word_position(units(1), length_units)), &
             kilograms(word_position(units(2), mass_units)), &
             seconds(word_position(units(3), time_units))]
  end function units_sizes

  !> How many SI units (m kg s) one unit of a key has where length, mass and time are counted in
  !! these; 1 for what does not depend on them.
  subroutine units_in_si(unit, units, factor, known)
    character(*), intent(in) :: unit       !! of the key; '' for a pure number
    character(*), intent(in) :: units(3)   !! length, mass, time
    real(dp), intent(out) :: factor
    logical, intent(out) :: known          !! the unit of the key is one of those below
    real(dp) :: length, mass, time, sizes(3)
    sizes = units_sizes(units)
    length = sizes(1)
    mass = sizes(2)
    time = sizes(3)
    known = .true.
    select case (unit)
    case ('length')
      factor = length
    case ('time')
      factor = time
    case ('mass')
      factor = mass
    case ('1/time')
      factor = 1.0_dp/time
    case ('density')
      factor = mass/length**3
    case ('1/volume')
      factor = 1.0_dp/length**3
    case ('stress')
      factor = mass/(length*time**2)
    case ('1/stress')
      factor = length*time**2/mass
    case ('stress time')
      factor = mass/(length*time)
    case ('stress length')
      factor = mass/time**2
    case ('stress length^1/2')
      factor = mass/(sqrt(length)*time**2)
    case ('speed')
      factor = length/time
    case ('acceleration')
      factor = length/time**2
    case ('speed^2', 'specific heat')
      factor = (length/time)**2
    case ('', 'temperature', '1/temperature', 'degrees')
      factor = 1.0_dp
    case default
      factor = 1.0_dp
      known = .false.
    end select
  end subroutine units_in_si

  !> Factor to SI units, and the range in which materials and motions are found.
  subroutine plausible(unit, units, factor, low, high)
    character(*), intent(in) :: unit       !! of the key
    character(*), intent(in) :: units(3)   !! length, mass, time of the deck
    real(dp), intent(out) :: factor, low, high
    logical :: known
    call units_in_si(unit, units, factor, known)
    low = 0.0_dp
    high = huge(1.0_dp)
    select case (unit)
    case ('density')
      low = 1.0e-2_dp
      high = 3.0e4_dp
    case ('stress')
      low = 1.0e-3_dp
      high = 1.0e13_dp
    case ('speed')
      high = 1.0e5_dp
    case ('specific heat')
      low = 1.0e1_dp
      high = 2.0e4_dp
    case default  ! lengths and times may be anything
    end select
  end subroutine plausible

end module sgmp_units
