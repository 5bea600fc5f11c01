!> What a checkpoint says of itself to readers other than a restart: time, grid, bodies, and what
!! the columns of their particles and of the grid's sums are, as JSON.
module sgmp_contents
  use sgmp_body, only: body_t
  use sgmp_columns, only: column_name, columns_t
  use sgmp_mesh, only: mesh_t
  use sgmp_model, only: model_t
  use sgmp_space, only: axes_in_output
  use sgmp_state_columns, only: state_column_names, state_name_length
  use sgmp_text, only: integer_text, real_text_short
  implicit none
  private
  public :: contents_text

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
    character(state_name_length), allocatable :: names(:)
    integer :: q
    names = state_column_names(body%law%slots, mesh%space)
    text = '{"name": "'//trim(body%name)//'", "first_id": '//integer_text(body%first_id)// &
           ', "density": '//real_text_short(body%law%density)// &
           ', "columns": "position velocity mass'
    do q = 1, size(names)
      text = text//' '//trim(names(q))
    end do
    text = text//'"}'
  end function body_text

end module sgmp_contents
