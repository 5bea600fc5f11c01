!> Which sums a velocity field needs: each feature that a scene has asks for its own.
!!
!! The order in which they ask is that of the columns of a stage.
module sgmp_build_columns
  use sgmp_absorbing_columns, only: absorbing_ask
  use sgmp_averaging, only: averaging_sums
  use sgmp_body, only: body_t
  use sgmp_columns, only: block_t, columns_ask, columns_make, columns_t, stage_mass, stage_stress
  use sgmp_constitutive, only: law_bends, law_is_spherical, law_liquid
  use sgmp_debris, only: debris_possible
  use sgmp_debris_columns, only: debris_ask
  use sgmp_images, only: image_t
  use sgmp_kernels, only: kernel_centred
  use sgmp_kinds, only: dp
  use sgmp_loads_columns, only: loads_ask, loads_ask_faces
  use sgmp_method, only: method_t
  use sgmp_model, only: model_t
  use sgmp_one_sided_columns, only: one_sided_ask
  use sgmp_surface_columns, only: pairs_ask, room_ask, surfaces_ask, surfaces_ask_faces
  use sgmp_swirl_columns, only: swirl_ask
  use sgmp_volumes_columns, only: volumes_ask
  implicit none
  private
  public :: matter_t, matter_of, columns_build

  !> What some of the bodies of a field are.
  type :: matter_t
    logical :: solid = .false.
    logical :: bends = .false.      !! solids that are no soils
    logical :: flows = .false.      !! liquids
    logical :: flowing = .false.    !! fluids, explosives, soils
    logical :: yields = .false.     !! what does not spring back
    logical :: crumbles = .false.   !! what can come apart
    logical :: averages = .false.   !! what averages its plastic strain
  end type matter_t

contains

  !> Columns of a field, by what moves in it; so many parts of its bodies are driven.
  pure function columns_build(model, kernel, matter, parts) result(columns)
    type(model_t), intent(in) :: model
    integer, intent(in) :: kernel, parts
    type(matter_t), intent(in) :: matter
    type(columns_t) :: columns
    logical :: corrected, turns, normalised
    integer :: a
    associate (method => model%method, ndim => model%mesh%ndim, space => model%mesh%space, &
               solid => matter%solid)
      ! Liquids move with the divergence of plain strains (doc/volumes.md, 7).
      corrected = ndim > 1 .and. applies(method%surfaces, method%surfaces_solids, &
                                         solid .and. .not. matter%flows)
      ! In unequal cells exact rotation moves what has next to no strength (doc/grids.md, 2).
      turns = applies(method%rotation, method%rotation_solids, &
                      merge(matter%bends, solid, model%mesh%graded))
      normalised = applies(method%normalised, method%normalised_solids, solid)
      columns = columns_make(space, kernel)
      if (parts > 0) then
        call columns_ask(columns, block_t('drives', stage_mass, [(image_t(), a=1, parts)]))
      end if
      if (matter%averages) call columns_ask(columns, block_t('average', stage_mass, &
                                                     [(image_t(), a=1, averaging_sums)]))
      if (corrected .or. turns) call pairs_ask(columns, ndim)
      if (corrected) call surfaces_ask(columns, ndim)
      if (matter%crumbles .and. (corrected .or. turns .or. normalised)) call room_ask(columns)
      columns%turns = turns
      columns%consistent = takes_consistent(method, matter)
      columns%remapped = applies(method%drift_remapped, method%drift_solids, solid .and. normalised)
      if (method%swirl) call swirl_ask(columns)
      call ask_forces(model, columns)
      call ask_volumes(model, normalised, columns)
      call ask_faces(model, kernel, corrected, columns)
      if (method%debris_speed > 0.0_dp) call debris_ask(columns, ndim)
    end associate
  end function columns_build

  !> What the volumes of particles need.
  pure subroutine ask_volumes(model, normalised, columns)
    type(model_t), intent(in) :: model
    logical, intent(in) :: normalised            !! the stress is
    type(columns_t), intent(inout) :: columns
    if (normalised) call columns_ask(columns, block_t('volume', stage_stress, [image_t()]))
    if (model%method%relaxed) call volumes_ask(columns)
  end subroutine ask_volumes

  !> What moves in a field.
  pure function matter_of(bodies, moves) result(matter)
    type(body_t), intent(in) :: bodies(:)
    logical, intent(in) :: moves(:)              !! which of them
    type(matter_t) :: matter
    associate (laws => bodies%law)
      matter%solid = any(moves .and. .not. law_is_spherical(laws))
      matter%bends = any(moves .and. law_bends(laws))
      matter%flows = any(moves .and. law_liquid(laws))
      matter%flowing = any(moves .and. .not. law_bends(laws))
      matter%yields = any(moves .and. .not. bodies%springs)
      matter%crumbles = any(moves .and. debris_possible(laws))
      matter%averages = any(moves .and. laws%history%averaged)
    end associate
  end function matter_of

  !> Whether a field has what a method uses, which may be for solids only.
  pure logical function applies(used, solids_only, solid) result(yes)
    logical, intent(in) :: used, solids_only, solid
    yes = used .and. (solid .or. .not. solids_only)
  end function applies

  !> Whether the mass of the nodes of a field is consistent.
  pure logical function takes_consistent(method, matter) result(yes)
    type(method_t), intent(in) :: method
    type(matter_t), intent(in) :: matter
    yes = method%consistent .and. matter%solid .and. .not. (matter%flowing .or. matter%crumbles)
    if (method%consistent_springs) yes = yes .and. .not. matter%yields
  end function takes_consistent

  !> What forces from outside need that particles bring.
  pure subroutine ask_forces(model, columns)
    type(model_t), intent(in) :: model
    type(columns_t), intent(inout) :: columns
    if (any(model%bodies%forced)) call loads_ask(columns, model%mesh%ndim)
    call one_sided_ask(columns, model%mesh)
  end subroutine ask_forces

  !> What forces on faces of particles need, behind all that particles bring with the stress.
  pure subroutine ask_faces(model, kernel, corrected, columns)
    type(model_t), intent(in) :: model
    integer, intent(in) :: kernel
    logical, intent(in) :: corrected             !! strains are, at surfaces
    type(columns_t), intent(inout) :: columns
    associate (bodies => model%bodies, ndim => model%mesh%ndim, centred => kernel_centred(kernel))
      if (.not. any(bodies%faced)) return
      call loads_ask_faces(columns, ndim, centred)
      if (corrected .and. centred) call surfaces_ask_faces(columns, ndim)
      if (any(bodies%absorbs)) call absorbing_ask(columns, ndim, centred)
    end associate
  end subroutine ask_faces

end module sgmp_build_columns
