!> Means over the particles of a gauge.
module sgmp_gauge_means
  use sgmp_kinds, only: dp
  use sgmp_snapshot, only: snapshot_t
  implicit none
  private
  public :: gauge_means

contains

  !> Means over the members: position, velocity, fields.
  pure subroutine gauge_means(fields, snapshot, members, values)
    character(*), intent(in) :: fields(:)       !! names; mass and volume are behind these
    type(snapshot_t), intent(in) :: snapshot
    integer, intent(in) :: members(:)
    real(dp), allocatable, intent(out) :: values(:)
    real(dp) :: motion(2*3), total_mass, total_volume
    integer :: f, m, n, p
    motion = 0.0_dp
    n = size(fields)
    associate (mass => snapshot%fields(n + 1)%values(1, :), &
               volume => snapshot%fields(n + 2)%values(1, :))
      total_mass = 0.0_dp
      total_volume = 0.0_dp
      do m = 1, size(members)
        p = members(m)
        total_mass = total_mass + mass(p)
        total_volume = total_volume + volume(p)
        motion = motion + mass(p)*[snapshot%position(:, p), snapshot%velocity(:, p)]
      end do
      values = motion/total_mass
      do f = 1, n
        if (fields(f) == 'density') then
          values = [values, total_mass/total_volume]
        else
          values = [values, mean_of(snapshot%fields(f)%values, volume, members)/total_volume]
        end if
      end do
    end associate
  end subroutine gauge_means

  !> Sum of the members' values, each times its volume, in the order of the particles.
  pure function mean_of(values, volume, members) result(total)
    real(dp), intent(in) :: values(:, :), volume(:)
    integer, intent(in) :: members(:)
    real(dp) :: total(size(values, 1))
    integer :: m
    total = 0.0_dp
    do m = 1, size(members)
      total = total + volume(members(m))*values(:, members(m))
    end do
  end function mean_of

end module sgmp_gauge_means
