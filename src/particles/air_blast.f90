!> Pressure of a charge of TNT in air on a surface, without computing the air: the fits of Kingery
!! and Bulmash (1984, ARBRL-TR-02555) to measured arrival times, peak overpressures, impulses and
!! durations of spherical charges in free air and of hemispherical ones on the ground, in metric
!! units as they are printed in later manuals: with Z the distance in m over the cube root of the
!! mass in kg,
!!   U = u0 + u1 log10(Z),   log10(value) = sum_i y_i U^i.
!! Times and impulses are per cube root of the mass; pressures are in kPa, times in ms.
!!
!! In time both the incident and the reflected pressure decay as Friedlander's wave,
!!   p(t) = P (1 - s) exp(-a s),   s = (t - arrival)/duration, 0 <= s <= 1,
!! where a is what gives the impulse I: I/(P duration) = 1/a - (1 - exp(-a))/a^2. The suction that
!! follows is left out. On a face whose normal has the cosine c to the way back to the charge
!!   p = c^2 p_reflected + (1 + c^2 - 2 c) p_incident,   c > 0,
!!   p = p_incident                                      else
!! (Randers-Pehrson and Bannister 1997, ARL-TR-1310).
module sgmp_air_blast
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: air_blast_t, air_blast_make, air_blast_pressure, air_blast_values, air_blast_wave
  public :: air_blast_decay, air_blast_farthest, air_blast_nearest
  public :: burst_free_air, burst_names, burst_surface
  public :: blast_arrival, blast_duration, blast_incident, blast_incident_impulse, &
            blast_reflected, blast_reflected_impulse

  integer, parameter :: burst_free_air = 1, burst_surface = 2
  character(8), parameter :: burst_names(2) = [character(8) :: 'free_air', 'surface']

  !> Scaled distances (m/kg^(1/3)) between which all six fits hold, by burst.
  real(dp), parameter :: air_blast_nearest(2) = [0.147_dp, 0.178_dp]
  real(dp), parameter :: air_blast_farthest = 40.0_dp

  ! What the fits tell.
  integer, parameter :: blast_arrival = 1, blast_incident = 2, blast_reflected = 3, &
                        blast_incident_impulse = 4, blast_reflected_impulse = 5, blast_duration = 6
  integer, parameter :: fitted = 6

  ! Columns of the table over the scaled distance.
  integer, parameter :: at_arrival = 1, at_duration = 2, at_incident = 3, at_reflected = 4, &
                        at_incident_decay = 5, at_reflected_decay = 6, tabled = 6
  integer, parameter :: degree = 11    !! largest of the polynomials
  integer, parameter :: steps = 4000   !! of the table, uniform in log10(Z)

  !> A charge, in the units of the deck.
  type :: air_blast_t
    real(dp) :: point(3) = 0.0_dp      !! centre of the charge (length)
    real(dp) :: time = 0.0_dp          !! of its detonation
    integer :: burst = burst_free_air  !! one of burst_*
    real(dp) :: scale = 1.0_dp         !! scaled distance of a unit of length
    real(dp) :: nearest = 0.0_dp       !! distance of the nearest face at the start (length)
    real(dp), allocatable :: table(:, :)  !! (tabled, 0:steps) over log10(Z)
  end type air_blast_t

  !> One piece of a fit.
  type :: fit_t
    real(dp) :: last = air_blast_farthest  !! up to this scaled distance
    real(dp) :: u(2) = 0.0_dp
    real(dp) :: y(0:degree) = 0.0_dp
  end type fit_t

contains

  !> A charge of some mass of TNT, given with the sizes of the deck's units in SI units.
  pure subroutine air_blast_make(mass, burst, point, time, units, blast)
    real(dp), intent(in) :: mass, point(3), time   !! in the units of the deck
    integer, intent(in) :: burst                   !! one of burst_*
    real(dp), intent(in) :: units(3)               !! metres, kilograms, seconds of a unit
    type(air_blast_t), intent(out) :: blast
    real(dp) :: root, values(fitted), milliseconds, kilopascals
    integer :: i
    root = (mass*units(2))**(1.0_dp/3.0_dp)
    milliseconds = 1.0e-3_dp/units(3)
    kilopascals = 1.0e3_dp*units(1)*units(3)**2/units(2)
    blast%point = point
    blast%time = time
    blast%burst = burst
    blast%scale = units(1)/root
    allocate (blast%table(tabled, 0:steps))
    do i = 0, steps
      values = air_blast_values(burst, 10.0_dp**table_place(burst, i))
      associate (row => blast%table(:, i))
        row(at_arrival) = root*milliseconds*values(blast_arrival)
        row(at_duration) = root*milliseconds*values(blast_duration)
        row(at_incident) = kilopascals*values(blast_incident)
        row(at_reflected) = kilopascals*values(blast_reflected)
        row(at_incident_decay) = air_blast_decay(values(blast_incident_impulse)/ &
                                            (values(blast_incident)*values(blast_duration)))
        row(at_reflected_decay) = air_blast_decay(values(blast_reflected_impulse)/ &
                                             (values(blast_reflected)*values(blast_duration)))
      end associate
    end do
  end subroutine air_blast_make

  !> log10 of the scaled distance of a row of the table.
  pure function table_place(burst, row) result(place)
    integer, intent(in) :: burst, row
    real(dp) :: place
    associate (first => log10(air_blast_nearest(burst)), last => log10(air_blast_farthest))
      place = first + (last - first)*row/steps
    end associate
  end function table_place

  !> Pressure on a face at some time. Nearer than the fits hold it is that of the nearest distance;
  !! farther away there is none.
  pure function air_blast_pressure(blast, place, normal, time) result(pressure)
    type(air_blast_t), intent(in) :: blast
    real(dp), intent(in) :: place(3)               !! of the face (length)
    real(dp), intent(in) :: normal(3)              !! of the face, outwards, of any length
    real(dp), intent(in) :: time
    real(dp) :: pressure
    real(dp) :: way(3), distance, row(tabled), s, cosine
    pressure = 0.0_dp
    way = blast%point - place
    distance = max(norm2(way), tiny(1.0_dp))
    if (distance*blast%scale >= air_blast_farthest) return
    row = table_row(blast, distance)
    s = (time - blast%time - row(at_arrival))/row(at_duration)
    if (s < 0.0_dp .or. s > 1.0_dp) return
    cosine = dot_product(way, normal)/(distance*max(norm2(normal), tiny(1.0_dp)))
    pressure = row(at_incident)*friedlander(row(at_incident_decay), s)
    if (cosine <= 0.0_dp) return
    pressure = cosine**2*row(at_reflected)*friedlander(row(at_reflected_decay), s) + &
               (1.0_dp + cosine**2 - 2.0_dp*cosine)*pressure
  end function air_blast_pressure

  !> The wave at a distance, in the units of the deck: time of arrival, peaks, impulses, duration.
  pure function air_blast_wave(blast, distance) result(values)
    type(air_blast_t), intent(in) :: blast
    real(dp), intent(in) :: distance               !! from the charge (length)
    real(dp) :: values(fitted)                     !! by blast_*
    real(dp) :: row(tabled)
    row = table_row(blast, distance)
    values(blast_arrival) = blast%time + row(at_arrival)
    values(blast_duration) = row(at_duration)
    values(blast_incident) = row(at_incident)
    values(blast_reflected) = row(at_reflected)
    values(blast_incident_impulse) = row(at_incident)*row(at_duration)* &
                                     impulse_ratio(row(at_incident_decay))
    values(blast_reflected_impulse) = row(at_reflected)*row(at_duration)* &
                                      impulse_ratio(row(at_reflected_decay))
  end function air_blast_wave

  !> What the table says at a distance; at its ends where that lies beyond them.
  pure function table_row(blast, distance) result(row)
    type(air_blast_t), intent(in) :: blast
    real(dp), intent(in) :: distance               !! (length)
    real(dp) :: row(tabled)
    real(dp) :: x
    integer :: i
    x = log10(distance*blast%scale/air_blast_nearest(blast%burst))* &
        steps/log10(air_blast_farthest/air_blast_nearest(blast%burst))
    x = min(max(x, 0.0_dp), real(steps, dp))
    i = min(int(x), steps - 1)
    x = x - i
    row = (1.0_dp - x)*blast%table(:, i) + x*blast%table(:, i + 1)
  end function table_row

  !> Friedlander's wave over its peak.
  pure function friedlander(decay, s) result(part)
    real(dp), intent(in) :: decay
    real(dp), intent(in) :: s                      !! time since arrival over duration
    real(dp) :: part
    part = (1.0_dp - s)*exp(-decay*s)
  end function friedlander

  !> Decay a of Friedlander's wave from its impulse over peak and duration, which falls with a.
  pure function air_blast_decay(ratio) result(decay)
    real(dp), intent(in) :: ratio
    real(dp) :: decay
    real(dp) :: low, high
    integer :: i
    low = -50.0_dp
    high = 1.0e4_dp
    do i = 1, 80
      decay = 0.5_dp*(low + high)
      if (impulse_ratio(decay) > ratio) then
        low = decay
      else
        high = decay
      end if
    end do
  end function air_blast_decay

  !> Impulse over peak and duration: 1/a - (1 - exp(-a))/a^2; near 0 its series.
  pure function impulse_ratio(decay) result(ratio)
    real(dp), intent(in) :: decay
    real(dp) :: ratio
    if (abs(decay) < 1.0e-3_dp) then
      ratio = 0.5_dp - decay/6.0_dp + decay**2/24.0_dp
    else
      ratio = (decay - 1.0_dp + exp(-decay))/decay**2
    end if
  end function impulse_ratio

  !> All six values at a scaled distance (m/kg^(1/3)): kPa, ms/kg^(1/3), kPa ms/kg^(1/3).
  pure function air_blast_values(burst, distance) result(values)
    integer, intent(in) :: burst                   !! one of burst_*
    real(dp), intent(in) :: distance
    real(dp) :: values(fitted)
    integer :: what
    do what = 1, fitted
      values(what) = fit_value(distance, fit_pieces(burst, what))
    end do
  end function air_blast_values

  !> The value of a fit: of the first piece that reaches as far.
  pure function fit_value(distance, pieces) result(value)
    real(dp), intent(in) :: distance
    type(fit_t), intent(in) :: pieces(:)
    real(dp) :: value
    real(dp) :: u, power
    integer :: p, i
    do p = 1, size(pieces) - 1
      if (distance < pieces(p)%last) exit
    end do
    u = pieces(p)%u(1) + pieces(p)%u(2)*log10(distance)
    power = pieces(p)%y(degree)
    do i = degree - 1, 0, -1
      power = power*u + pieces(p)%y(i)
    end do
    value = 10.0_dp**power
  end function fit_value

  !> Constants of a fit, piece by piece.
  pure function fit_pieces(burst, what) result(pieces)
    integer, intent(in) :: burst, what             !! burst_*; blast_*
    type(fit_t), allocatable :: pieces(:)
    if (burst == burst_free_air) then
      pieces = free_air_pieces(what)
    else
      pieces = surface_pieces(what)
    end if
  end function fit_pieces

  !> Spherical charges in free air.
  pure function free_air_pieces(what) result(pieces)
    integer, intent(in) :: what                    !! one of blast_*
    type(fit_t), allocatable :: pieces(:)
    select case (what)
    case (blast_arrival)
      pieces = [piece(-0.253273111999_dp, 1.37407043777_dp, &
        [0.0720707787637_dp, 1.36456871214_dp, -0.0570035692784_dp, -0.182832224796_dp, &
         0.0118851436014_dp, 0.0432648687627_dp, -0.0007997367834_dp, -0.00436073555033_dp])]
    case (blast_incident)
      pieces = [piece(-0.214362789151_dp, 1.35034249993_dp, &
        [2.611368669_dp, -1.69012801396_dp, 0.00804973591951_dp, 0.336743114941_dp, &
         -0.00516226351334_dp, -0.0809228619888_dp, -0.00478507266747_dp, 0.00793030472242_dp, &
         0.0007684469735_dp])]
    case (blast_reflected)
      pieces = [piece(-0.214362789151_dp, 1.35034249993_dp, &
        [3.22958031387_dp, -2.21400538997_dp, 0.035119031446_dp, 0.657599992109_dp, &
         0.0141818951887_dp, -0.243076636231_dp, -0.0158699803158_dp, 0.0492741184234_dp, &
         0.00227639644004_dp, -0.00397126276058_dp])]
    case (blast_incident_impulse)
      pieces = [piece(2.34723921354_dp, 3.24299066475_dp, &
        [2.38830516757_dp, -0.443749377691_dp, 0.168825414684_dp, 0.0348138030308_dp, &
         -0.010435192824_dp], last=0.792_dp), &
                piece(-1.75305660315_dp, 2.30629231803_dp, &
        [1.55197227115_dp, -0.40463292088_dp, -0.0142721946082_dp, 0.00912366316617_dp, &
         -0.0006750681404_dp, -0.00800863718901_dp, 0.00314819515931_dp, 0.00152044783382_dp, &
         -0.0007470265899_dp])]
    case (blast_reflected_impulse)
      pieces = [piece(-0.204004553231_dp, 1.37882996018_dp, &
        [2.55875660396_dp, -0.903118886091_dp, 0.101771877942_dp, -0.0242139751146_dp])]
    case default  ! blast_duration
      pieces = [piece(2.26367268496_dp, 5.11588554305_dp, &
        [-0.686608550419_dp, 0.164953518069_dp, 0.127788499497_dp, 0.00291430135946_dp, &
         0.00187957449227_dp, 0.0173413962543_dp, 0.00269739758043_dp, -0.00361976502798_dp, &
         -0.00100926577934_dp], last=0.888_dp), &
                piece(-1.33361206714_dp, 9.2996288611_dp, &
        [0.23031841078_dp, -0.0297944268969_dp, 0.0306329542941_dp, 0.0183405574074_dp, &
         -0.0173964666286_dp, -0.00106321963576_dp, 0.0056206003128_dp, 0.0001618217499_dp, &
         -0.0006860188944_dp], last=2.28_dp), &
                piece(-3.13005805346_dp, 3.1524725364_dp, &
        [0.621036276475_dp, 0.0967031995552_dp, -0.00801302059667_dp, 0.00482705779732_dp, &
         0.00187587272287_dp, -0.00246738509321_dp, -0.000841116668_dp, 0.0006193291052_dp])]
    end select
  end function free_air_pieces

  !> Hemispherical charges on the ground.
  pure function surface_pieces(what) result(pieces)
    integer, intent(in) :: what                    !! one of blast_*
    type(fit_t), allocatable :: pieces(:)
    select case (what)
    case (blast_arrival)
      pieces = [piece(-0.202425716178_dp, 1.37784223635_dp, &
        [-0.0591634288046_dp, 1.35706496258_dp, 0.052492798645_dp, -0.196563954086_dp, &
         -0.0601770052288_dp, 0.0696360270891_dp, 0.0215297490092_dp, -0.0161658930785_dp, &
         -0.00232531970294_dp, 0.00147752067524_dp])]
    case (blast_incident)
      pieces = [piece(-0.214362789151_dp, 1.35034249993_dp, &
        [2.78076916577_dp, -1.6958988741_dp, -0.154159376846_dp, 0.514060730593_dp, &
         0.0988534365274_dp, -0.293912623038_dp, -0.0268112345019_dp, 0.109097496421_dp, &
         0.00162846756311_dp, -0.0214631030242_dp, 0.0001456723382_dp, 0.00167847752266_dp])]
    case (blast_reflected)
      pieces = [piece(-0.240657322658_dp, 1.36637719229_dp, &
        [3.40283217581_dp, -2.21030870597_dp, -0.218536586295_dp, 0.895319589372_dp, &
         0.24989009775_dp, -0.569249436807_dp, -0.11791682383_dp, 0.224131161411_dp, &
         0.0245620259375_dp, -0.0455116002694_dp, -0.00190930738887_dp, 0.00361471193389_dp])]
    case (blast_incident_impulse)
      pieces = [piece(2.06761908721_dp, 3.0760329666_dp, &
        [2.52455620925_dp, -0.502992763686_dp, 0.171335645235_dp, 0.0450176963051_dp, &
         -0.0118964626402_dp], last=0.955_dp), &
                piece(-1.94708846747_dp, 2.40697745406_dp, &
        [1.67281645863_dp, -0.384519026965_dp, -0.0260816706301_dp, 0.00595798753822_dp, &
         0.014544526107_dp, -0.00663289334734_dp, -0.00284189327204_dp, 0.0013644816227_dp])]
    case (blast_reflected_impulse)
      pieces = [piece(-0.246208804814_dp, 1.33422049854_dp, &
        [2.70588058103_dp, -0.949516092853_dp, 0.112136118689_dp, -0.0250659183287_dp])]
    case default  ! blast_duration
      pieces = [piece(1.92946154068_dp, 5.25099193925_dp, &
        [-0.614227603559_dp, 0.130143717675_dp, 0.134872511954_dp, 0.0391574276906_dp, &
         -0.00475933664702_dp, -0.00428144598008_dp], last=1.01_dp), &
                piece(-2.12492525216_dp, 9.2996288611_dp, &
        [0.315409245784_dp, -0.0297944268976_dp, 0.030632954288_dp, 0.0183405574086_dp, &
         -0.0173964666211_dp, -0.00106321963633_dp, 0.00562060030977_dp, 0.0001618217499_dp, &
         -0.0006860188944_dp], last=2.78_dp), &
                piece(-3.53626218091_dp, 3.46349745571_dp, &
        [0.686906642409_dp, 0.0933035304009_dp, -0.0005849420883_dp, -0.00226884995013_dp, &
         -0.00295908591505_dp, 0.00148029868929_dp])]
    end select
  end function surface_pieces

  !> A piece of a fit from its constants.
  pure function piece(u0, u1, y, last) result(fit)
    real(dp), intent(in) :: u0, u1, y(0:)
    real(dp), intent(in), optional :: last
    type(fit_t) :: fit
    fit%u = [u0, u1]
    fit%y(:ubound(y, 1)) = y
    if (present(last)) fit%last = last
  end function piece

end module sgmp_air_blast
