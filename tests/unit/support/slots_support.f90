!> Columns of particles as tests want them, in the order in which a model has them.
module slots_support
  use sgmp_kinds, only: dp
  use sgmp_material_history, only: history_t, slots_ask, slots_ask_history, slots_t
  implicit none
  private
  public :: slots_make

contains

  pure function slots_make(stresses, plastic, temperature, damage, energy, lighting, deformation, &
                           stretch, initial, distention, pore_shift, bulking, &
                           preconsolidation, compaction) result(slots)
    integer, intent(in) :: stresses            !! stress components
    logical, intent(in) :: plastic, temperature, damage, energy, lighting
    integer, intent(in) :: deformation, stretch, initial  !! components wanted
    logical, intent(in), optional :: distention, pore_shift, bulking, preconsolidation, compaction
    type(slots_t) :: slots
    type(history_t) :: wants
    wants = history_t(plastic=plastic, temperature=temperature, damage=damage, energy=energy, &
                      lighting=lighting, deformation=deformation > 0)
    if (present(distention)) wants%distention = distention
    if (present(pore_shift)) wants%pore_shift = pore_shift
    if (present(bulking)) wants%bulking = bulking
    if (present(preconsolidation)) wants%preconsolidation = preconsolidation
    if (present(compaction)) wants%compaction = compaction
    call slots_ask_history(slots, wants, nint(sqrt(real(deformation))), stresses)
    call slots_ask(slots, 'stretch', spread(1.0_dp, 1, stretch))
    call slots_ask(slots, 'initial', spread(0.0_dp, 1, initial))
  end function slots_make

end module slots_support
