!> First places and deformation gradients of particles (sgmp_reference).
module sgmp_reference_places
  use sgmp_body, only: body_t
  use sgmp_kinds, only: dp, lanes
  use sgmp_material_history, only: slots_ask
  implicit none
  private
  public :: reference_columns, reference_fill

contains

  !> Columns of the particles of a body.
  pure subroutine reference_columns(ndim, body)
    integer, intent(in) :: ndim
    type(body_t), intent(inout) :: body
    integer :: d
    if (body%rigid) return
    call slots_ask(body%law%slots, 'reference', &
                   [(0.0_dp, d=1, ndim), unit(ndim)])
  end subroutine reference_columns

  !> The unit tensor, row by row.
  pure function unit(ndim) result(one)
    integer, intent(in) :: ndim
    real(dp) :: one(ndim**2)
    integer :: d
    one = [(merge(1.0_dp, 0.0_dp, mod(d, ndim + 1) == 0), d=0, ndim**2 - 1)]
  end function unit

  !> Notes where the particles are.
  pure subroutine reference_fill(body)
    type(body_t), intent(inout) :: body
    integer :: c, l
    body%particles%reference = body%law%slots%reference
    if (body%law%slots%reference == 0) return
    associate (particles => body%particles, n => body%particles%ndim, &
               first => body%law%slots%reference)
      do c = 1, particles%chunks
        do l = 1, lanes
          if (particles%id(l, c) == 0) cycle
          particles%state(l, first:first + n - 1, c) = particles%motion(l, :n, c)
        end do
      end do
    end associate
  end subroutine reference_fill

end module sgmp_reference_places
