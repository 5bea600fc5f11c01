!> The methods, the particle-grid transfers (kernels) that they use, and what the program has to
!! know of a kernel beside its weights: one row of a table each.
module sgmp_kernels
  use sgmp_kinds, only: dp
  implicit none
  private
  public :: kernel_mpm, kernel_gimp, kernel_sgmp, kernel_centred, kernel_folds, kernel_sized
  public :: bin_span, linear_span, stencil_reach, stencil_shift, stencil_width
  public :: method_mpm, method_gimp, method_cpgimp, method_sgmp, method_bspline
  public :: method_band, method_half_size, method_kernel, method_names

  integer, parameter :: kernel_mpm = 1   !! linear hat functions, particle to node
  integer, parameter :: kernel_gimp = 2  !! GIMP functions, particle to node: uGIMP, cpGIMP and
                                         !! the B-spline
  integer, parameter :: kernel_sgmp = 3  !! linear on the auxiliary grid, then a fixed map from
                                         !! centres to nodes

  integer, parameter :: method_mpm = 1, method_gimp = 2, method_cpgimp = 3, method_sgmp = 4, &
                        method_bspline = 5
  character(8), parameter :: method_names(*) = [character(8) :: 'mpm', 'gimp', 'cpgimp', 'sgmp', &
                                                'bspline']
  integer, parameter :: method_kernel(*) = [kernel_mpm, kernel_gimp, kernel_gimp, kernel_sgmp, &
                                            kernel_gimp]
  !> Half-size of a particle (cells) where the method fixes it, 0: from the particles' spacing. The
  !! quadratic B-spline is the GIMP function of particles as wide as a cell, whatever their volume.
  real(dp), parameter :: method_half_size(*) = [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.5_dp]

  !> Width (cells) of the narrowest band in which strain localises, as a crack that is pulled open
  !! shows it (verification/spall): methods that smooth share the opening among two cells.
  real(dp), parameter :: method_band(*) = [1.0_dp, 1.0_dp, 1.0_dp, 2.0_dp, 2.0_dp]

  !> Properties of a kernel.
  type :: kernel_t
    integer :: width           !! points per axis in a particle's stencil
    real(dp) :: shift          !! a particle at X is in cell floor(X - shift) of its stencils
    logical :: centred         !! particles meet the auxiliary grid of cell centres, not the nodes
    logical :: folds           !! stencils reach behind walls: sums are folded, values mirrored
    logical :: sized           !! particles have a size, which the weights depend on
  end type kernel_t

  type(kernel_t), parameter :: kernels(3) = [kernel_t(2, 0.0_dp, .false., .false., .false.), &
                                             kernel_t(3, 0.5_dp, .false., .true., .true.), &
                                             kernel_t(2, 0.5_dp, .true., .true., .false.)]

  !> Cells of a bin, along its row, where stencils are linear, by dimension: as many as hold the
  !! particles of a few chunks.
  integer, parameter :: linear_span(3) = [16, 8, 1]

contains

  !> Cells of a bin along its row: its particles share chunks. Where a cell fills a chunk, or
  !! stencils are wide, a bin is one cell.
  elemental function bin_span(kernel, ndim) result(span)
    integer, intent(in) :: kernel, ndim
    integer :: span
    span = merge(linear_span(ndim), 1, kernels(kernel)%width == 2)
  end function bin_span

  !> Points per axis in a particle's own stencil, nodes or centres: a stencil of two has linear
  !! weights, one of three any product of weights per axis.
  elemental function stencil_width(kernel) result(width)
    integer, intent(in) :: kernel
    integer :: width
    width = kernels(kernel)%width
  end function stencil_width

  !> Shift s of the stencils: that of a particle at X starts at index floor(X - s), its cell.
  elemental function stencil_shift(kernel) result(shift)
    integer, intent(in) :: kernel
    real(dp) :: shift
    shift = kernels(kernel)%shift
  end function stencil_shift

  !> Nodes that particles of a bin give to, beyond the bin's own: with centres one more.
  elemental function stencil_reach(kernel) result(reach)
    integer, intent(in) :: kernel
    integer :: reach
    reach = kernels(kernel)%width - 1 + merge(1, 0, kernels(kernel)%centred)
  end function stencil_reach

  !> Whether particles meet the auxiliary grid of cell centres, joined to the nodes by a fixed map.
  elemental function kernel_centred(kernel) result(yes)
    integer, intent(in) :: kernel
    logical :: yes
    yes = kernels(kernel)%centred
  end function kernel_centred

  !> Whether stencils reach behind walls, so that sums are folded and values mirrored there.
  elemental function kernel_folds(kernel) result(yes)
    integer, intent(in) :: kernel
    logical :: yes
    yes = kernels(kernel)%folds
  end function kernel_folds

  !> Whether weights depend on a size of the particle.
  elemental function kernel_sized(kernel) result(yes)
    integer, intent(in) :: kernel
    logical :: yes
    yes = kernels(kernel)%sized
  end function kernel_sized

end module sgmp_kernels
