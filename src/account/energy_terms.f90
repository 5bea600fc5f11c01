!> Terms that features add to the energy balance (sgmp_energy) beside those of the scheme itself.
!!
!! A term has a name, says what of the balance it changes and with which sign, where its amount in a
!! step comes from, and whether the drift takes it for explained. Bodies, history.csv, summary.json
!! and checkpoints know terms by this table alone; terms are booked in the order of the table.
module sgmp_energy_terms
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: energy_term_t, energy_terms_t
  public :: changes_internal, changes_kinetic, changes_momentum, changes_nothing
  public :: from_elsewhere, from_nodes, from_particles, from_removed
  public :: terms_add, terms_book, terms_explained, terms_find, terms_gain, terms_open, &
            terms_take, terms_value

  integer, parameter :: changes_nothing = 0, changes_kinetic = 1, changes_internal = 2, &
                        changes_momentum = 3
  !> What feeds a term: sums over particles, forces on nodes (which count times the velocity step),
  !! sums over particles that are removed (sgmp_sums), or its feature at the end of the step.
  integer, parameter :: from_elsewhere = 0, from_particles = 1, from_nodes = 2, from_removed = 3

  !> A term, of one component or of three.
  type :: energy_term_t
    character(32) :: name = ''         !! in summary.json, with its group: 'energy.split_energy'
    character(32) :: column = ''       !! of history.csv; of a vector its beginning; '': none
    integer :: changes = changes_nothing
    real(dp) :: sign = 1.0_dp          !! +1: the balance gains it; -1: the balance loses it
    logical :: explained = .false.     !! the drift does not count it
    integer :: source = from_elsewhere
    integer :: entry = 0               !! of the sums of the source, the first one
    integer :: components = 1
    logical :: whole = .false.         !! a number of particles
    real(dp) :: step(3) = 0.0_dp       !! in the step at hand
    real(dp) :: value(3) = 0.0_dp      !! since the start
  end type energy_term_t

  !> The table.
  type :: energy_terms_t
    integer :: n = 0
    type(energy_term_t), allocatable :: term(:)
  end type energy_terms_t

contains

  !> Adds a term to the end of the table.
  pure subroutine terms_add(terms, term)
    type(energy_terms_t), intent(inout) :: terms
    type(energy_term_t), intent(in) :: term
    if (.not. allocated(terms%term)) allocate (terms%term(0))
    terms%term = [terms%term, term]
    terms%n = size(terms%term)
  end subroutine terms_add

  !> Forgets the amounts of the step before.
  pure subroutine terms_open(terms)
    type(energy_terms_t), intent(inout) :: terms
    integer :: t
    do t = 1, terms%n
      terms%term(t)%step = 0.0_dp
    end do
  end subroutine terms_open

  !> Adds the sums of a source, of one body or of all nodes, to the amounts of the step.
  pure subroutine terms_take(terms, source, sums)
    type(energy_terms_t), intent(inout) :: terms
    integer, intent(in) :: source                !! one of from_*
    real(dp), intent(in) :: sums(:)
    integer :: t
    do t = 1, terms%n
      associate (term => terms%term(t), n => terms%term(t)%components)
        if (term%source /= source) cycle
        term%step(:n) = term%step(:n) + sums(term%entry:term%entry + n - 1)
      end associate
    end do
  end subroutine terms_take

  !> Kinetic energy with what terms add to it that sums of its particles feed.
  pure function terms_gain(terms, kinetic, sums) result(gained)
    type(energy_terms_t), intent(in) :: terms
    real(dp), intent(in) :: kinetic              !! of a body, after the kick
    real(dp), intent(in) :: sums(:)              !! over its particles
    real(dp) :: gained
    integer :: t
    gained = kinetic
    do t = 1, terms%n
      associate (term => terms%term(t))
        if (term%source /= from_particles .or. term%changes /= changes_kinetic) cycle
        gained = gained + term%sign*sums(term%entry)
      end associate
    end do
  end function terms_gain

  !> Books the amounts of a step.
  pure subroutine terms_book(terms, dt_kick, kinetic, internal, momentum, predicted)
    type(energy_terms_t), intent(inout) :: terms
    real(dp), intent(in) :: dt_kick              !! velocity step
    real(dp), intent(inout) :: kinetic, internal, momentum(3)
    real(dp), intent(inout) :: predicted         !! change of the total energy
    real(dp) :: amount(3)
    integer :: t
    do t = 1, terms%n
      associate (term => terms%term(t))
        amount = term%step
        if (term%source == from_nodes) amount = dt_kick*amount
        term%value = term%value + amount
        amount = term%sign*amount
        select case (term%changes)
        case (changes_kinetic)
          kinetic = kinetic + amount(1)
          predicted = predicted + amount(1)
        case (changes_internal)
          internal = internal + amount(1)
          predicted = predicted + amount(1)
        case (changes_momentum)
          momentum = momentum + amount
        case default  ! changes_nothing
          cycle
        end select
      end associate
    end do
  end subroutine terms_book

  !> What the balance has lost by terms that the drift takes for explained.
  pure function terms_explained(terms) result(lost)
    type(energy_terms_t), intent(in) :: terms
    real(dp) :: lost
    integer :: t
    lost = 0.0_dp
    do t = 1, terms%n
      if (terms%term(t)%explained) lost = lost - terms%term(t)%sign*terms%term(t)%value(1)
    end do
  end function terms_explained

  !> Place of a term in the table, by its name in summary.json; 0: it has none.
  pure function terms_find(terms, name) result(place)
    type(energy_terms_t), intent(in) :: terms
    character(*), intent(in) :: name
    integer :: place
    do place = terms%n, 1, -1
      if (terms%term(place)%name == name) return
    end do
  end function terms_find

  !> What a term has counted since the start; 0 where there is none.
  pure function terms_value(terms, name) result(value)
    type(energy_terms_t), intent(in) :: terms
    character(*), intent(in) :: name
    real(dp) :: value
    integer :: t
    value = 0.0_dp
    t = terms_find(terms, name)
    if (t > 0) value = terms%term(t)%value(1)
  end function terms_value

end module sgmp_energy_terms
