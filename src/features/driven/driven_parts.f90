!> Parts of bodies whose motion is prescribed: what a step tells the grid of them, and what it finds
!! out (doc/loads.md).
module sgmp_driven_parts
  use sgmp_body, only: body_parts, body_t
  use sgmp_driven_part, only: driven_part_advance, driven_part_book, driven_part_choose
  use sgmp_field, only: field_t
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: driven_any, driven_book, driven_choose, driven_publish, driven_terms

contains

  !> Whether a scene has such parts.
  pure function driven_any(fields) result(yes)
    type(field_t), intent(in) :: fields(:)
    logical :: yes
    yes = any(fields%columns%driven > 0)
  end function driven_any

  !> How many there are.
  pure function driven_terms(fields) result(n)
    type(field_t), intent(in) :: fields(:)
    integer :: n
    n = sum(fields%columns%driven)
  end function driven_terms

  !> Motions of the step at hand, taken in its middle.
  subroutine driven_choose(bodies, fields, middle, dt)
    type(body_t), intent(inout) :: bodies(:)
    type(field_t), intent(inout) :: fields(:)
    real(dp), intent(in) :: middle           !! time
    real(dp), intent(in) :: dt               !! position step
    integer :: b, i
    do b = 1, size(bodies)
      do i = 1, body_parts(bodies(b))
        call driven_part_choose(bodies(b)%driven(i), middle, dt)
      end do
    end do
    call driven_publish(bodies, fields)
  end subroutine driven_choose

  !> Tells the fields how their parts move.
  pure subroutine driven_publish(bodies, fields)
    type(body_t), intent(in) :: bodies(:)
    type(field_t), intent(inout) :: fields(:)
    integer :: b, i
    do b = 1, size(bodies)
      do i = 1, body_parts(bodies(b))
        associate (part => bodies(b)%driven(i))
          fields(bodies(b)%field)%drives(part%number) = part%drive
        end associate
      end do
    end do
  end subroutine driven_publish

  !> Ends a step: parts are where it has taken them, and have received what its sums say.
  pure subroutine driven_book(bodies, fields, dt, dt_kick, sums)
    type(body_t), intent(inout) :: bodies(:)
    type(field_t), intent(in) :: fields(:)
    real(dp), intent(in) :: dt, dt_kick      !! position step, velocity step
    real(dp), intent(in) :: sums(:, :)       !! (drive_sums, drives of all fields)
    integer :: b, i, before
    do b = 1, size(bodies)
      before = sum(fields(:bodies(b)%field - 1)%columns%driven)
      do i = 1, body_parts(bodies(b))
        associate (part => bodies(b)%driven(i))
          call driven_part_book(part, dt_kick, sums(:, before + part%number))
          call driven_part_advance(part, dt)
        end associate
      end do
    end do
  end subroutine driven_book

end module sgmp_driven_parts
