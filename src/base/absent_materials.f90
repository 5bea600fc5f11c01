!> Materials that people ask for and that no law here describes, with the reason and what to do
!! instead.
module sgmp_absent_materials
  implicit none
  private
  public :: absent_reason

contains

  !> Why a material is not there, '' for all others.
  pure function absent_reason(name) result(text)
    character(*), intent(in) :: name  !! a word of the deck, or the path of a file named after it
    character(:), allocatable :: text
    character(:), allocatable :: word
    word = name(index(name, '/', back=.true.) + 1:)
    if (index(word, '.inp', back=.true.) > 0) word = word(:index(word, '.inp', back=.true.) - 1)
    select case (word)
    case ('mortar', 'cement', 'rock', 'granite')
      text = 'no constants of '//word//' with a source are known here; concrete, '// &
             'johnson_holmquist and mohr_coulomb run with constants of your own, but were '// &
             'compared with no shot at it'
    case ('foam', 'honeycomb', 'polystyrene', 'eps')
      text = 'foams differ too much for a library: write material … crushable_foam with the '// &
             'curve of your own (sgmp help material; sgmp new cushion has an example)'
    case ('wood', 'composite', 'cfrp', 'kevlar')
      text = 'no constitutive model here has different strengths along and across fibres'
    case default
      text = ''
    end select
  end function absent_reason

end module sgmp_absent_materials
