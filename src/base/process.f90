!> What the operating system knows about this process.
module sgmp_process
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: peak_memory_bytes

contains

  !> Peak resident memory in bytes, 0 where the system does not tell (read from /proc/self/status).
  function peak_memory_bytes() result(bytes)
    integer(i8) :: bytes
    character(128) :: line
    integer :: unit, status
    bytes = 0_i8
    open (newunit=unit, file='/proc/self/status', action='read', status='old', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line(:6) /= 'VmHWM:') cycle
      read (line(7:index(line, 'kB') - 1), *, iostat=status) bytes
      if (status /= 0) bytes = 0_i8
      bytes = 1024_i8*bytes
      exit
    end do
    close (unit)
  end function peak_memory_bytes

end module sgmp_process
