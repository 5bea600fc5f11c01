!> The table of everything a deck may say, group by group.
!!
!! A card is registered, read and checked in one of the files cards_*.f90; what it says is kept in
!! `scene_t`.
module sgmp_deck_table
  use sgmp_cards_body, only: register_body
  use sgmp_cards_contact, only: register_contact
  use sgmp_cards_general, only: register_general
  use sgmp_cards_grid, only: register_grid
  use sgmp_cards_load, only: register_load
  use sgmp_cards_material, only: register_material
  use sgmp_cards_method, only: register_method
  use sgmp_cards_output, only: register_output
  use sgmp_registry, only: registry_t
  implicit none
  private
  public :: deck_table

contains

  !> Builds the table.
  function deck_table() result(registry)
    type(registry_t) :: registry
    call register_general(registry)
    call register_grid(registry)
    call register_method(registry)
    call register_material(registry)
    call register_body(registry)
    call register_load(registry)
    call register_contact(registry)
    call register_output(registry)
  end function deck_table

end module sgmp_deck_table
