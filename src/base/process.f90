!> What the operating system knows about this process.
module sgmp_process
  use, intrinsic :: iso_c_binding, only: c_int64_t
  use sgmp_kinds, only: i8
  implicit none
  private
  public :: memory_available_bytes, peak_memory_bytes

  interface
    function c_memory_available() result(bytes) bind(c, name='sgmp_memory_available')
      import :: c_int64_t
      implicit none
      integer(c_int64_t) :: bytes
    end function c_memory_available
  end interface

contains

  !> Bytes that the processes on this machine can still have by what the machine, the control groups
  !! and the limits of this process leave (posix.c).
  function memory_available_bytes() result(bytes)
    integer(i8) :: bytes
    bytes = int(c_memory_available(), i8)
  end function memory_available_bytes

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
