!> What a checkpoint keeps of contact: sums of the pairs, states at the nodes.
module sgmp_contact_state
  use sgmp_archive, only: archive_t
  use sgmp_contact, only: contact_t
  use sgmp_contact_memory, only: memory_share
  use sgmp_contact_pairs, only: contact_pair_t
  use sgmp_self_contact, only: self_index, self_t, self_table
  implicit none
  private
  public :: contact_state_pass

contains

  !> Sums of all pairs, what they remember at the nodes, and where bodies come near themselves.
  subroutine contact_state_pass(archive, contact, own)
    type(archive_t), intent(inout) :: archive
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: own(2)          !! planes of this rank
    integer :: p
    if (contact%self%on) call pass_self(archive, contact%self)
    do p = 1, size(contact%pairs)
      call pass_pair(archive, contact%pairs(p))
    end do
    call pass_memory(archive, contact, own)
  end subroutine contact_state_pass

  !> Where patches were when they were looked at last.
  subroutine pass_self(archive, self)
    type(archive_t), intent(inout) :: archive
    type(self_t), intent(inout) :: self
    integer :: rows
    rows = 0
    if (allocated(self%table)) rows = size(self%table, 2)
    call archive%pass(self%next_step)
    call archive%pass(self%next_time)
    call archive%pass(self%crowded)
    call archive%pass(rows)
    if (.not. archive%complete) return
    if (archive%reading) then
      if (allocated(self%table)) deallocate (self%table)
      allocate (self%table(self_table, rows))
    end if
    if (allocated(self%table)) call archive%pass(self%table)
    if (archive%reading) call self_index(self)
  end subroutine pass_self

  subroutine pass_pair(archive, pair)
    type(archive_t), intent(inout) :: archive
    type(contact_pair_t), intent(inout) :: pair
    call archive%pass(pair%impulse)
    call archive%pass(pair%angular_impulse)
    call archive%pass(pair%friction_impulse)
    call archive%pass(pair%dissipation)
    call archive%pass(pair%shared)
    call archive%pass(pair%touching)
  end subroutine pass_pair

  !> States of contact at the nodes of all ranks; a reader's next layout takes them from the memory.
  subroutine pass_memory(archive, contact, own)
    type(archive_t), intent(inout) :: archive
    type(contact_t), intent(inout) :: contact
    integer, intent(in) :: own(2)          !! planes of this rank
    if (.not. archive%reading) call memory_share(contact%memory, contact%shared, own)
    call archive%pass(contact%memory%n)
    if (.not. archive%complete) return
    if (archive%reading) then
      if (allocated(contact%memory%values)) deallocate (contact%memory%values)
      allocate (contact%memory%values(contact%memory%n))
    end if
    call archive%pass(contact%memory%values(:contact%memory%n))
    if (.not. archive%reading) contact%memory%n = 0
  end subroutine pass_memory

end module sgmp_contact_state
