!> A scene in the making: what the cards read so far say, and what is wrong with them.
module sgmp_scene_draft
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t
  use sgmp_name_set, only: name_set_t
  use sgmp_scene, only: scene_space, scene_t
  use sgmp_space, only: axis_names
  use sgmp_spelling, only: suggestion, word_items, word_position, words_joined
  use sgmp_text, only: integer_text
  implicit none
  private
  public :: draft_t, named_bodies, named_materials, named_gauges, named_sections

  integer, parameter :: named_bodies = 1, named_materials = 2, named_gauges = 3, named_sections = 4
  character(9), parameter :: plurals(*) = [character(9) :: 'bodies', 'materials', 'gauges', &
                                                          'sections']

  !> Scene and errors, and how names in cards become numbers in the scene.
  type :: draft_t
    type(scene_t) :: scene
    integer :: bodies = 0  !! read so far; the scene has room for all, since to move one costs a lot
    integer :: gauges = 0  !! so, too
    type(name_set_t) :: names(size(plurals))  !! of what is named
    type(deck_errors_t) :: errors
  contains
    procedure :: axis_key
    procedure :: in_space
    procedure :: turns_about
    procedure :: material_of
    procedure :: body_of
    procedure :: new_name
  end type draft_t

contains

  !> Name that an axis has in the keys of the scene.
  pure function axis_key(self, axis) result(name)
    class(draft_t), intent(in) :: self
    integer, intent(in) :: axis
    character(1) :: name
    name = axis_names(axis, scene_space(self%scene))
  end function axis_key

  !> The scene's dimension in words, to end a message.
  pure function in_space(self) result(text)
    class(draft_t), intent(in) :: self
    character(:), allocatable :: text
    text = 'in '//integer_text(self%scene%dimension)//'D'
    if (self%scene%axisymmetric) text = 'in an axisymmetric scene'
  end function in_space

  !> Whether bodies can turn about an axis in the scene.
  pure function turns_about(self, axis) result(yes)
    class(draft_t), intent(in) :: self
    integer, intent(in) :: axis
    logical :: yes
    yes = self%scene%dimension == 3 .or. &
          (self%scene%dimension == 2 .and. axis == 3 .and. .not. self%scene%axisymmetric)
  end function turns_about

  !> Number of the material that a card names, 0 and an error where there is none.
  integer function material_of(self, card) result(number)
    class(draft_t), intent(inout) :: self
    type(deck_card_t), intent(in) :: card
    number = word_position(card%word('material'), self%scene%materials%name)
    if (number == 0) call unknown(self, card, 'material', 'material', self%scene%materials%name)
  end function material_of

  !> Number of the body that a key names, 0 for all, negative and an error where there is none.
  integer function body_of(self, card, key) result(number)
    class(draft_t), intent(inout) :: self
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key
    number = 0
    if (card%word(key) == 'all') return
    number = word_position(card%word(key), self%scene%bodies%name)
    if (number > 0) return
    number = -1
    call unknown(self, card, key, 'body', self%scene%bodies%name)
  end function body_of

  !> Whether the name that a card gives is one, and new among those of its kind; else an error.
  logical function new_name(self, card, kind) result(new)
    class(draft_t), intent(inout) :: self
    type(deck_card_t), intent(in) :: card
    integer, intent(in) :: kind  !! one of the named_...
    new = card%word('name') /= ''
    if (.not. new) return
    new = .not. self%names(kind)%has(card%word('name'))
    if (new) then
      call self%names(kind)%add(card%word('name'))
    else
      call self%errors%add(card%place('name'), 'there are two '//trim(plurals(kind))//" '"// &
                           card%word('name')//"'", 'rename one of them')
    end if
  end function new_name

  subroutine unknown(draft, card, key, what, names)
    type(draft_t), intent(inout) :: draft
    type(deck_card_t), intent(in) :: card
    character(*), intent(in) :: key, what
    character(*), intent(in) :: names(:)
    character(:), allocatable :: plural
    plural = what//'s'
    if (what == 'body') plural = 'bodies'
    call draft%errors%add(card%place(key), 'there is no '//what//" '"//card%word(key)//"'", &
                          suggestion(card%word(key), word_items(words_joined(names)), &
                                     plural//' of this deck'))
  end subroutine unknown

end module sgmp_scene_draft
