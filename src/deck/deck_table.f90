!> The table of everything a deck may say, group by group.
!!
!! A card is registered, read and checked in one of the files cards_*.f90; what it says is kept in
!! `scene_t`.
module sgmp_deck_table
  use sgmp_cards_body, only: register_body
  use sgmp_cards_contact, only: register_contact
  use sgmp_cards_general, only: register_general
  use sgmp_cards_grid, only: register_grid
  use sgmp_cards_initial_stress, only: register_initial_stress
  use sgmp_cards_load, only: register_load
  use sgmp_cards_material, only: register_material
  use sgmp_cards_method, only: register_method
  use sgmp_cards_motion, only: register_motion
  use sgmp_cards_output, only: register_output
  use sgmp_cards_surface, only: register_surface
  use sgmp_reference_card, only: register_reference
  use sgmp_registry, only: registry_t
  use sgmp_removal_card, only: register_removal
  use sgmp_section_card, only: register_section
  use sgmp_splitting_card, only: register_splitting
  use sgmp_wall_friction_card, only: register_wall_friction
  implicit none
  private
  public :: deck_table

  type(registry_t) :: table  !! built when first asked for

contains

  !> The table.
  function deck_table() result(registry)
    type(registry_t) :: registry
    if (.not. allocated(table%cards)) call build
    registry = table
  end function deck_table

  !> Has every group register its cards.
  subroutine build()
    table%group = 'General'
    call register_general(table)
    table%group = 'Space'
    call register_grid(table)
    call register_wall_friction(table)
    table%group = 'Method and time'
    call register_method(table)
    call register_splitting(table)
    call register_reference(table)
    table%group = 'Materials'
    call register_material(table)
    table%group = 'Bodies'
    call register_body(table)
    table%group = 'Motion and loads'
    call register_load(table)
    call register_initial_stress(table)
    call register_surface(table)
    call register_motion(table)
    call register_removal(table)
    table%group = 'Contact'
    call register_contact(table)
    table%group = 'Output'
    call register_output(table)
    call register_section(table)
  end subroutine build

end module sgmp_deck_table
