!> What speaks against a run, and what makes its numbers inexact: the reasons of a verdict, and its
!! word (doc/verdict.md).
module sgmp_opinion
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: opinion_t, reason_length, sound_error

  integer, parameter :: reason_length = 240
  real(dp), parameter :: sound_error = 0.05_dp  !! of numbers of sound runs (make truth)

  !> Doubts, each with its number; and errors to be expected, each with what makes them.
  type :: opinion_t
    character(reason_length), allocatable :: doubts(:)
    character(reason_length), allocatable :: causes(:)  !! of the errors
    real(dp), allocatable :: errors(:)                  !! parts of the number
  contains
    procedure :: open => opinion_open
    procedure :: object => opinion_object
    procedure :: expect => opinion_expect
    procedure :: word => opinion_word
    procedure :: error => opinion_error
    procedure :: reasons => opinion_reasons
  end type opinion_t

contains

  !> Nothing speaks against it.
  pure subroutine opinion_open(self)
    class(opinion_t), intent(inout) :: self
    if (allocated(self%doubts)) deallocate (self%doubts, self%causes, self%errors)
    allocate (self%doubts(0), self%causes(0), self%errors(0))
  end subroutine opinion_open

  !> Adds a doubt.
  pure subroutine opinion_object(self, reason)
    class(opinion_t), intent(inout) :: self
    character(*), intent(in) :: reason
    self%doubts = [character(reason_length) :: self%doubts, reason]
  end subroutine opinion_object

  !> Adds an error to be expected, and why.
  pure subroutine opinion_expect(self, error, cause)
    class(opinion_t), intent(inout) :: self
    real(dp), intent(in) :: error              !! part of the number
    character(*), intent(in) :: cause
    self%errors = [self%errors, error]
    self%causes = [character(reason_length) :: self%causes, cause]
  end subroutine opinion_expect

  !> sound, coarse or doubtful.
  pure function opinion_word(self) result(word)
    class(opinion_t), intent(in) :: self
    character(:), allocatable :: word
    word = 'sound'
    if (size(self%causes) > 0) word = 'coarse'
    if (size(self%doubts) > 0) word = 'doubtful'
  end function opinion_word

  !> The error that numbers of the run should stay within; of a doubtful one, none: huge.
  pure function opinion_error(self) result(error)
    class(opinion_t), intent(in) :: self
    real(dp) :: error
    error = maxval([sound_error, self%errors])
    if (size(self%doubts) > 0) error = huge(1.0_dp)
  end function opinion_error

  !> Why the word is what it is: doubts, or else what makes errors.
  pure function opinion_reasons(self) result(reasons)
    class(opinion_t), intent(in) :: self
    character(reason_length), allocatable :: reasons(:)
    reasons = self%doubts
    if (size(self%doubts) == 0) reasons = self%causes
  end function opinion_reasons

end module sgmp_opinion
