!> The table of what goes with what.
!!
!! A feature is something that a deck asks for by a word of a card. A refusal says that a deck which
!! asks for one feature cannot ask for another, why, and what to do instead. Errors of the deck,
!! `sgmp help` and the deck reference come from these two lists; what they do not name goes
!! together.
module sgmp_combinations
  use sgmp_deck_card, only: deck_card_t
  use sgmp_deck_errors, only: deck_errors_t, position_t
  use sgmp_kinds, only: dp
  use sgmp_spelling, only: string_t, word_in_list, word_items
  implicit none
  private
  public :: feature_t, refusal_t, combinations_check, combinations_choose, combinations_parts, &
            combinations_features, combinations_refusals, feature_label, feature_of_card
  public :: combinations_bodies, combinations_walls

  !> Features that let something rub.
  character(*), parameter :: combinations_bodies = 'friction'
  character(*), parameter :: combinations_walls = 'wallfriction'

  !> How the value of a key shows that a card asks for the feature.
  integer, parameter :: ask_card = 0     !! the card itself, of which there is none by default
  integer, parameter :: ask_given = 1    !! the key, or one of several, is written
  integer, parameter :: ask_word = 2     !! it is the word
  integer, parameter :: ask_number = 3   !! it is the number
  integer, parameter :: ask_above = 4    !! it is above the number
  integer, parameter :: ask_below = 5    !! it is below the number
  integer, parameter :: ask_yes = 6      !! it is yes
  integer, parameter :: ask_any = 7      !! any key of the card is the word

  !> Something that a deck asks for.
  type :: feature_t
    character(16) :: name = ''        !! in lists of this table, without blanks
    character(24) :: label = ''       !! in messages; '': the name
    character(24) :: cards = ''       !! that ask for it
    character(32) :: key = ''         !! or several, for ask_given
    integer :: ask = ask_card         !! one of ask_*
    character(12) :: word = ''
    integer :: number = 0
  end type feature_t

  !> Why a feature and others exclude each other.
  type :: refusal_t
    character(16) :: feature = ''     !! errors stand at its word
    character(32) :: with = ''        !! names of the others
    character(12) :: unless = ''      !! a feature with which they go together; '': none
    character(128) :: reason = ''
    character(96) :: remedy = ''
  end type refusal_t

  !> What `auto` leaves out beside others, though it goes with them.
  type :: caution_t
    character(16) :: feature = ''
    character(48) :: with = ''        !! names of the others
  end type caution_t

  type(feature_t), parameter :: features(*) = [ &
    feature_t('1D', 'dimension 1', 'dimension', 'value', ask_number, '', 1), &
    feature_t('2D', 'dimension 2', 'dimension', 'value', ask_number, '', 2), &
    feature_t('3D', 'dimension 3', 'dimension', 'value', ask_number, '', 3), &
    feature_t('axisymmetric', 'dimension axisymmetric', 'dimension', 'value', ask_word, &
              'axisymmetric', 0), &
    feature_t('swirl', 'swirl=yes', 'dimension', 'swirl', ask_yes, '', 0), &
    feature_t('mpm', 'method mpm', 'method', 'kind', ask_word, 'mpm', 0), &
    feature_t('gimp', 'method gimp', 'method', 'kind', ask_word, 'gimp', 0), &
    feature_t('cpgimp', 'method cpgimp', 'method', 'kind', ask_word, 'cpgimp', 0), &
    feature_t('sgmp', 'method sgmp', 'method', 'kind', ask_word, 'sgmp', 0), &
    feature_t('bspline', 'method bspline', 'method', 'kind', ask_word, 'bspline', 0), &
    feature_t('usf', 'update=usf', 'method', 'update', ask_word, 'usf', 0), &
    feature_t('musl', 'update=musl', 'method', 'update', ask_word, 'musl', 0), &
    feature_t('usl', 'update=usl', 'method', 'update', ask_word, 'usl', 0), &
    feature_t('usavg', 'update=usavg', 'method', 'update', ask_word, 'usavg', 0), &
    feature_t('flip<1', '', 'method', 'flip', ask_below, '', 1), &
    feature_t('normalised', 'stress=normalised', 'method', 'stress', ask_word, 'normalised', 0), &
    feature_t('kept', 'volumes=kept', 'method', 'volumes', ask_word, 'kept', 0), &
    feature_t('rotation', 'rotation=exact', 'method', 'rotation', ask_word, 'exact', 0), &
    feature_t('surfaces', 'surfaces=corrected', 'method', 'surfaces', ask_word, 'corrected', 0), &
    feature_t('consistent', 'mass=consistent', 'method', 'mass', ask_word, 'consistent', 0), &
    feature_t('drift', 'drift=remapped', 'method', 'drift', ask_word, 'remapped', 0), &
    feature_t('split', 'split=…', 'method', 'split', ask_above, '', 0), &
    feature_t('reference', 'frame=reference', 'method', 'frame', ask_word, 'reference', 0), &
    feature_t('contact', 'contact', 'contact', '', ask_card, '', 0), &
    feature_t('failure', 'failure', 'failure', '', ask_card, '', 0), &
    feature_t('erode', 'erode', 'erode', '', ask_card, '', 0), &
    feature_t('remove', 'remove', 'remove', '', ask_card, '', 0), &
    feature_t('rigid', 'rigid', 'rigid', '', ask_card, '', 0), &
    feature_t('hoop', 'hoop=…', 'method', 'hoop', ask_given, '', 0), &
    feature_t('cfl=auto', '', 'time', 'cfl', ask_word, 'auto', 0), &
    feature_t('friction', 'contact with friction', 'contact', 'friction', ask_above, '', 0), &
    feature_t('self', 'contact self=yes', 'contact', 'self', ask_yes, '', 0), &
    feature_t('absorbing', 'an absorbing wall', 'wall', '', ask_any, 'absorbing', 0), &
    feature_t('wallfriction', '', 'wallfriction', 'friction', ask_above, '', 0), &
    feature_t('motion', '', 'motion', '', ask_card, '', 0), &
    feature_t('wallmotion', '', 'wallmotion', '', ask_card, '', 0), &
    feature_t('reactions', 'reactions=yes', 'wall', 'reactions', ask_yes, '', 0), &
    feature_t('blast', '', 'blast', '', ask_card, '', 0), &
    feature_t('graded', 'a grid of unequal cells', 'grid', 'fine_x fine_y fine_z fine_r', &
              ask_given, '', 0), &
    feature_t('detonation', '', 'detonation', '', ask_card, '', 0), &
    feature_t('average', 'length=…', 'failure', 'length', ask_given, '', 0)]

  type(refusal_t), parameter :: refusals(*) = [ &
    refusal_t('swirl', '1D 2D 3D', '', &
              'it is the motion around the axis of a body of revolution', &
              'remove swirl, or write dimension axisymmetric'), &
    refusal_t('swirl', 'mpm gimp cpgimp bspline', '', &
              'only sgmp has the terms of the motion around the axis', &
              'use method sgmp, or remove swirl'), &
    refusal_t('normalised', 'mpm gimp cpgimp bspline', '', &
              'it divides by what fills the cells of the auxiliary grid, which only sgmp has', &
              'remove stress=normalised or use method sgmp'), &
    refusal_t('kept', 'mpm gimp cpgimp bspline', '', &
              'particles relax to the centres of the auxiliary grid, which only sgmp has', &
              'remove volumes=kept or use method sgmp'), &
    refusal_t('kept', 'usf usl', '', &
              'particles relax to means of velocities after the kick, which take a sweep of '// &
              'their own', &
              'remove volumes=kept or use update=musl or usavg'), &
    refusal_t('rotation', 'mpm gimp cpgimp bspline', '', &
              'it corrects the strain of the auxiliary grid, which only sgmp has', &
              'remove rotation=exact or use method sgmp'), &
    refusal_t('rotation', 'flip<1', '', &
              'velocities of the grid, which PIC takes, lose rotation', &
              'remove flip or rotation=exact'), &
    refusal_t('drift', 'usf usl', '', &
              'nothing is mapped to the nodes anew after the kick', &
              'remove drift=remapped or use update=musl'), &
    refusal_t('surfaces', 'mpm gimp cpgimp bspline', '', &
              'it corrects the strain of the auxiliary grid, which only sgmp has', &
              'remove surfaces=corrected or use method sgmp'), &
    refusal_t('surfaces', 'absorbing', '', &
              'forces of edges are not spread for corrected strains: ground at rest on one '// &
              'comes apart', &
              'remove surfaces=corrected'), &
    refusal_t('consistent', 'mpm gimp cpgimp bspline', '', &
              'it is worked out for the means over nodes that sgmp takes', &
              'remove mass=consistent or use method sgmp'), &
    refusal_t('consistent', 'axisymmetric graded', '', &
              'it is worked out for cells that are all alike', &
              'remove mass=consistent'), &
    refusal_t('consistent', 'flip<1 kept', '', &
              'particles take velocities of the grid, which it sharpens', &
              'remove mass=consistent'), &
    refusal_t('consistent', 'absorbing wallfriction motion', '', &
              'not worked out: forces of edges, walls and parts that are held, at single nodes', &
              'remove mass=consistent'), &
    refusal_t('consistent', 'wallmotion reactions', '', &
              'not worked out: what walls bear of nodes next to those on them', &
              'remove mass=consistent'), &
    refusal_t('consistent', 'self', '', &
              'along the seams between the fields of one body each would take its edge for a '// &
              'surface', &
              'remove one of them'), &
    refusal_t('reference', 'sgmp', '', &
              'its auxiliary grid carries symmetric stresses, and those per first area are not', &
              'use method gimp, or leave out frame=reference'), &
    refusal_t('reference', 'cpgimp bspline', '', &
              'particles keep their first sizes, as gimp has them; with those of bspline what '// &
              'turns comes apart', &
              'use method gimp'), &
    refusal_t('reference', 'contact rigid', '', &
              'bodies meet where they are now, and the grid knows where they were', &
              'leave out frame=reference'), &
    refusal_t('reference', 'failure erode remove split', '', &
              'what comes apart has other neighbours than at the start', &
              'leave out frame=reference'), &
    refusal_t('reference', 'absorbing', '', &
              'not worked out: edges that move along with what they hold', &
              'leave out frame=reference'), &
    refusal_t('reference', 'wallfriction', '', &
              'nodes at a wall slide along it with their first places', &
              'leave out frame=reference'), &
    refusal_t('hoop', '1D 2D 3D', '', &
              'hoop strains are those of axisymmetric scenes', &
              'remove hoop'), &
    refusal_t('hoop', 'mpm gimp cpgimp bspline', '', &
              'only sgmp corrects the hoop strain', &
              'remove hoop'), &
    refusal_t('self', '1D', '', &
              'on a line no part of a body comes to another', &
              'remove self=yes'), &
    refusal_t('self', 'swirl kept rotation', '', &
              'not worked out: along the seams between the fields of one body it would act on '// &
              'each by itself', &
              'remove one of them'), &
    refusal_t('self', 'surfaces', '', &
              'along the seams between the fields of one body each would take its edge for a '// &
              'surface', &
              'write surfaces=plain, or leave the word out'), &
    refusal_t('self', 'motion', '', &
              'not worked out: parts that are moved and get another field', &
              'remove one of them, or move a rigid body that touches this one'), &
    refusal_t('absorbing', 'swirl', '', &
              'not worked out: what it does to waves around the axis', &
              'remove swirl, or put the edge where no wave comes in time'), &
    refusal_t('wallfriction', '1D', '', &
              'nothing slides along a wall', &
              'remove this card'), &
    refusal_t('blast', '2D', '', &
              'the blast of a charge is a sphere, not a cylinder', &
              'write dimension axisymmetric or dimension 3'), &
    refusal_t('graded', 'mpm gimp cpgimp bspline', '', &
              'their weights are those of equal cells; the auxiliary grid of sgmp has tables', &
              'use method sgmp'), &
    refusal_t('graded', 'detonation', '', &
              'a front that has crossed unequal cells leaves pressures worse than coarse cells', &
              'remove that card, or the fine intervals'), &
    refusal_t('graded', 'average', '', &
              'averages over a length are worked out for equal cells alone', &
              'remove length from the card failure, or the fine intervals')]

  ! Corrected strains of rings have forces along the axis that are not those which the masses next
  ! to it want (doc/surfaces.md, 6); the rest is not measured widely enough to be a default.
  type(caution_t), parameter :: cautions(*) = [ &
    caution_t('surfaces', 'axisymmetric'), &
    caution_t('drift', 'kept'), &
    caution_t('consistent', 'contact split usl usf'), &
    caution_t('kept', 'cfl=auto usavg'), &
    caution_t('rotation', 'friction absorbing kept wallfriction'), &
    caution_t('normalised', 'absorbing self')]

contains

  !> All features.
  function combinations_features() result(list)
    type(feature_t), allocatable :: list(:)
    list = features
  end function combinations_features

  !> All refusals.
  function combinations_refusals() result(list)
    type(refusal_t), allocatable :: list(:)
    list = refusals
  end function combinations_refusals

  !> Reports what a deck asks for that does not go together, each refusal once.
  subroutine combinations_check(cards, errors)
    type(deck_card_t), intent(in) :: cards(:)      !! of the deck, defaults among them
    type(deck_errors_t), intent(inout) :: errors
    integer :: asker(size(features)), r
    asker = askers(cards)
    do r = 1, size(refusals)
      call check_refusal(refusals(r), asker, cards, errors)
    end do
  end subroutine combinations_check

  !> Whether `auto` takes a feature: it goes with all that a deck asks for, and nothing of that is
  !! among the cautions.
  function combinations_choose(cards, name, beside) result(yes)
    type(deck_card_t), intent(in) :: cards(:)      !! of the deck, defaults among them
    character(*), intent(in) :: name               !! of the feature
    character(*), intent(in), optional :: beside   !! features of which no caution is needed
    logical :: yes
    logical :: asked(size(features))
    type(string_t), allocatable :: others(:)
    integer :: q, i
    asked = askers(cards) > 0
    asked(feature_number(name)) = .true.
    yes = allowed(asked, name)
    if (present(beside)) then
      others = word_items(beside)
      do i = 1, size(others)
        asked(feature_number(others(i)%text)) = .false.
      end do
    end if
    do q = 1, size(cautions)
      if (cautions(q)%feature == name) yes = yes .and. .not. asks_any(asked, cautions(q)%with)
    end do
  end function combinations_choose

  !> Whether particles that grow too large may be parted.
  function combinations_parts(cards) result(yes)
    type(deck_card_t), intent(in) :: cards(:)      !! of the deck, defaults among them
    logical :: yes
    yes = combinations_choose(cards, 'split')
  end function combinations_parts

  !> Whether one of some features is asked for.
  function asks_any(asked, names) result(yes)
    logical, intent(in) :: asked(:)
    character(*), intent(in) :: names
    logical :: yes
    type(string_t), allocatable :: others(:)
    integer :: i
    others = word_items(trim(names))
    yes = any([(asked(feature_number(others(i)%text)), i=1, size(others))])
  end function asks_any

  !> Whether a feature goes with all that are asked for.
  function allowed(asked, name) result(yes)
    logical, intent(in) :: asked(:)
    character(*), intent(in) :: name               !! of the feature
    logical :: yes
    type(string_t), allocatable :: others(:)
    integer :: r, i
    yes = .true.
    do r = 1, size(refusals)
      if (.not. asked(feature_number(trim(refusals(r)%feature)))) cycle
      if (refusals(r)%unless /= '') then
        if (asked(feature_number(trim(refusals(r)%unless)))) cycle
      end if
      others = word_items(trim(refusals(r)%with))
      do i = 1, size(others)
        if (refusals(r)%feature /= name .and. others(i)%text /= name) cycle
        yes = yes .and. .not. asked(feature_number(others(i)%text))
      end do
    end do
  end function allowed

  !> Reports the others of a refusal that the deck asks for.
  subroutine check_refusal(refusal, asker, cards, errors)
    type(refusal_t), intent(in) :: refusal
    integer, intent(in) :: asker(:)                !! of each feature, 0: none
    type(deck_card_t), intent(in) :: cards(:)
    type(deck_errors_t), intent(inout) :: errors
    type(string_t), allocatable :: others(:)
    integer :: f, i
    f = feature_number(trim(refusal%feature))
    if (asker(f) == 0) return
    if (refusal%unless /= '') then
      if (asker(feature_number(trim(refusal%unless))) > 0) return
    end if
    others = word_items(trim(refusal%with))
    do i = 1, size(others)
      if (asker(feature_number(others(i)%text)) == 0) cycle
      call errors%add(place(cards(asker(f)), features(f)), feature_label(trim(refusal%feature))// &
                      ' does not go with '//feature_label(others(i)%text)//': '// &
                      trim(refusal%reason), trim(refusal%remedy))
    end do
  end subroutine check_refusal

  !> The first card that asks for each feature; 0 where none does.
  pure function askers(cards) result(asker)
    type(deck_card_t), intent(in) :: cards(:)
    integer :: asker(size(features))
    integer :: c, f
    asker = 0
    do c = 1, size(cards)
      do f = 1, size(features)
        if (asker(f) > 0) cycle
        if (asks(cards(c), features(f))) asker(f) = c
      end do
    end do
  end function askers

  !> Number of the feature of a name.
  pure integer function feature_number(name) result(number)
    character(*), intent(in) :: name
    do number = 1, size(features) - 1
      if (features(number)%name == name) return
    end do
  end function feature_number

  !> Whether a card asks for a feature; one that is wrong asks for none.
  pure function asks(card, feature) result(yes)
    type(deck_card_t), intent(in) :: card
    type(feature_t), intent(in) :: feature
    logical :: yes
    integer :: k
    yes = .not. card%failed .and. word_in_list(card%name, trim(feature%cards)) > 0
    if (.not. yes .or. feature%ask == ask_card) return
    if (feature%ask == ask_any) then
      yes = any([(card%values(k)%present .and. card%values(k)%text == feature%word, &
                  k=1, size(card%values))])
      return
    end if
    k = card%at(key_of(card, feature))
    yes = card%values(k)%present
    if (.not. yes) return
    associate (value => card%values(k))
      select case (feature%ask)
      case (ask_given)
        yes = value%given
      case (ask_word)
        yes = value%text == trim(feature%word)
      case (ask_number)
        yes = .not. value%named .and. nint(value%number) == feature%number
      case (ask_above)
        yes = .not. value%named .and. value%number > real(feature%number, dp)
      case (ask_below)
        yes = value%number < real(feature%number, dp)
      case default  ! ask_yes
        yes = value%flag
      end select
    end associate
  end function asks

  !> The word that asks for a feature.
  pure function place(card, feature) result(position)
    type(deck_card_t), intent(in) :: card
    type(feature_t), intent(in) :: feature
    type(position_t) :: position
    position = card%position
    if (feature%ask == ask_card .or. feature%ask == ask_any) return
    position = card%place(key_of(card, feature))
  end function place

  !> The key of a feature, of several the first that a card has.
  pure function key_of(card, feature) result(key)
    type(deck_card_t), intent(in) :: card
    type(feature_t), intent(in) :: feature
    character(:), allocatable :: key
    type(string_t), allocatable :: keys(:)
    integer :: i
    keys = word_items(trim(feature%key))
    key = keys(1)%text
    do i = size(keys), 1, -1
      if (card%values(card%at(keys(i)%text))%given) key = keys(i)%text
    end do
  end function key_of

  !> How messages call the feature of a name.
  pure function feature_label(name) result(label)
    character(*), intent(in) :: name
    character(:), allocatable :: label
    integer :: f
    label = name
    do f = 1, size(features)
      if (features(f)%name /= name .or. features(f)%label == '') cycle
      label = trim(features(f)%label)
    end do
  end function feature_label

  !> Whether the feature of a name is asked for by cards of a kind.
  pure function feature_of_card(name, card) result(yes)
    character(*), intent(in) :: name, card
    logical :: yes
    integer :: f
    yes = .false.
    do f = 1, size(features)
      if (features(f)%name == name) yes = word_in_list(card, trim(features(f)%cards)) > 0
    end do
  end function feature_of_card

end module sgmp_combinations
