!> What a checkpoint says of itself to readers other than a restart: time, grid, bodies, and what
!! the columns of their particles and of the grid's sums are, as JSON.
module sgmp_contents
  use sgmp_body, only: body_t
  use sgmp_columns, only: column_name, columns_t
  use sgmp_material_history, only: slots_t
  use sgmp_mesh, only: mesh_t
  use sgmp_model, only: model_t
  use sgmp_particle_fields, only: particle_field_components, particle_field_find
  use sgmp_space, only: axes_in_output
  use sgmp_text, only: integer_text, real_text_short
  implicit none
  private
  public :: contents_text

  integer, parameter :: name_length = 16

contains

  !> Places are origin + cell*(the first columns), along the axes of output that `axes` counts.
  function contents_text(model) result(text)
    type(model_t), intent(in) :: model
    character(:), allocatable :: text
    integer :: b, d, f
    associate (mesh => model%mesh)
      text = '{"time": '//real_text_short(model%clock%time)//', "step": '// &
             integer_text(model%clock%step)//', "cell": '//real_text_short(mesh%h)//', "origin": ['
      do d = 1, mesh%ndim
        text = text//real_text_short(mesh%origin(d))//trim(merge(', ', '  ', d < mesh%ndim))
      end do
      text = text//'], "axes": ['
      do d = 1, mesh%ndim
        text = text//integer_text(axes_in_output(d, mesh%space))// &
               trim(merge(', ', '  ', d < mesh%ndim))
      end do
      text = text//'], "bodies": ['
      do b = 1, size(model%bodies)
        text = text//body_text(model%bodies(b), mesh)
        if (b < size(model%bodies)) text = text//', '
      end do
      text = text//'], "fields": ['
      do f = 1, size(model%fields)
        text = text//field_text(model%fields(f)%columns)
        if (f < size(model%fields)) text = text//', '
      end do
      text = text//']}'
    end associate
  end function contents_text

  !> Columns of a field's moments.
  function field_text(columns) result(text)
    type(columns_t), intent(in) :: columns
    character(:), allocatable :: text
    integer :: q
    text = '{"columns": "'//column_name(columns, 1)
    do q = 2, columns%total
      text = text//' '//column_name(columns, q)
    end do
    text = text//'"}'
  end function field_text

  !> Name and first id of a body, and the columns of its particles.
  function body_text(body, mesh) result(text)
    type(body_t), intent(in) :: body
    type(mesh_t), intent(in) :: mesh
    character(:), allocatable :: text
    character(name_length), allocatable :: names(:)
    integer :: q
    names = column_names(body%law%slots, mesh)
    text = '{"name": "'//trim(body%name)//'", "first_id": '//integer_text(body%first_id)// &
           ', "columns": "position velocity mass'
    do q = 1, size(names)
      text = text//' '//trim(names(q))
    end do
    text = text//'"}'
  end function body_text

  !> Names of the history columns as output has them; the mean stress where it is the only one, and
  !! `spin+2` for the third component of the spin; of the loads of a body, by number, shares in a
  !! force and area vectors.
  function column_names(slots, mesh) result(names)
    type(slots_t), intent(in) :: slots
    type(mesh_t), intent(in) :: mesh
    character(name_length) :: names(slots%total)
    integer :: i, q
    names(slots%volume) = 'volume'
    do i = 1, size(slots%list)
      associate (slot => slots%list(i))
        names(slot%first) = slot%name
        do q = 1, size(slot%start) - 1
          names(slot%first + q) = trim(slot%name)//'+'//integer_text(q)
        end do
      end associate
    end do
    if (slots%stresses > 1) then
      names(slots%stress:slots%stress + slots%stresses - 1) = &
        particle_field_components(particle_field_find('stress'), mesh%space, slots%stresses)
    else
      names(slots%stress) = 'mean_stress'
    end if
  end function column_names

end module sgmp_contents
