!> Particle data gathered for output: plain arrays ordered by particle id, independent of the
!! solver's own layout.
module sgmp_snapshot
  use sgmp_kinds, only: dp, i4
  implicit none
  private
  public :: snapshot_t, snapshot_field_t

  !> One named field: `values(component, particle)`; components named for CSV and Tecplot headers.
  type :: snapshot_field_t
    character(32) :: name = ''                        !! e.g. 'stress', 'pressure'
    character(32), allocatable :: components(:)  !! e.g. 'stress_xx', …; size 1: the name itself
    real(dp), allocatable :: values(:, :)  !! (components, particles), physical units of the deck
  end type snapshot_field_t

  !> All particles at one time, ordered by id.
  type :: snapshot_t
    integer :: dimension = 3
    integer :: step = 0
    real(dp) :: time = 0.0_dp
    integer(i4), allocatable :: id(:)                 !! (n) ascending; see snapshot_give_ids
    integer(i4), allocatable :: body(:)               !! (n) body number, from 1
    real(dp), allocatable :: path(:)  !! (n) from the particle that was split, ascending in each id;
                                      !! allocated only where particles are split
    real(dp), allocatable :: position(:, :)           !! (3, n), unused components zero
    real(dp), allocatable :: initial_position(:, :)   !! (3, n); allocated only where asked for
    real(dp), allocatable :: velocity(:, :)           !! (3, n)
    type(snapshot_field_t), allocatable :: fields(:)  !! further fields, in the order asked for
    character(32), allocatable :: body_names(:)
  end type snapshot_t

end module sgmp_snapshot
