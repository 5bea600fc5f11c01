!> The order of a step: when stresses are updated, and with which velocity of the nodes (theory 2).
module sgmp_update
  implicit none
  private
  public :: update_names, update_strains_before, update_usf, update_musl, update_usl, update_usavg

  integer, parameter :: update_usf = 1, update_musl = 2, update_usl = 3, update_usavg = 4
  character(8), parameter :: update_names(4) = [character(8) :: 'usf', 'musl', 'usl', 'usavg']

contains

  !> Whether a step begins with a stress update, by the velocity before the kick. That of USAVG has
  !! none before its first step.
  pure function update_strains_before(update, steps) result(yes)
    integer, intent(in) :: update                !! one of update_*
    integer, intent(in) :: steps                 !! that have been taken
    logical :: yes
    yes = update == update_usf .or. (update == update_usavg .and. steps > 0)
  end function update_strains_before

end module sgmp_update
