# Dimension-generic sources: written once, compiled for one, two and three dimensions, and some for axisymmetric scenes.
#
# A file X.F90 below src with a line that starts with "! dimension-generic" among its first
# lines is replaced in the list of sources by generated/…/X_1d.f90, X_2d.f90 and X_3d.f90. Each is X.F90 after the
# preprocessor with NDIM = 1, 2 or 3; X.F90 itself chooses the name of its module (#if NDIM == 1 …). Preprocessing in a
# step of its own, and not inside the compilation, is what lets every generator see the right module in the right
# file: the scanner of the Makefile generators does not evaluate #if. Line markers keep messages and debuggers in X.F90.
# "! dimension-generic, axisymmetric" adds X_rz.f90, with NDIM = 2 and AXISYMMETRIC.

function(sgmp_expand_dimensions sources_variable)
  if(CMAKE_Fortran_COMPILER_ID MATCHES "^Intel")
    set(preprocess -fpp -E)
  elseif(CMAKE_Fortran_COMPILER_ID MATCHES "NVHPC|PGI")
    set(preprocess -Mpreprocess -E)
  else()
    set(preprocess -cpp -E)
  endif()
  set(include_flags "-I${PROJECT_SOURCE_DIR}/src/base" "-I${PROJECT_SOURCE_DIR}/src/transfer")
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.inc")

  set(expanded)
  foreach(source IN LISTS ${sources_variable})
    set(is_generic FALSE)
    if(source MATCHES "/src/.*\\.F90$")
      file(STRINGS "${source}" marker REGEX "^! dimension-generic" LIMIT_COUNT 1)
      if(marker)
        set(is_generic TRUE)
      endif()
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}") # the marker may come or go
    endif()
    if(NOT is_generic)
      list(APPEND expanded "${source}")
      continue()
    endif()
    file(RELATIVE_PATH relative "${PROJECT_SOURCE_DIR}/src" "${source}")
    get_filename_component(folder "${relative}" DIRECTORY)
    get_filename_component(name "${relative}" NAME_WE)
    file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/generated/${folder}")
    set(variants 1d 2d 3d)
    if(marker MATCHES "axisymmetric")
      list(APPEND variants rz)
    endif()
    foreach(variant IN LISTS variants)
      set(output "${PROJECT_BINARY_DIR}/generated/${folder}/${name}_${variant}.f90")
      string(REGEX MATCH "^[123]" dimension "${variant}")
      set(definitions "-DNDIM=${dimension}")
      if(variant STREQUAL "rz")
        set(definitions -DNDIM=2 -DAXISYMMETRIC)
      endif()
      add_custom_command(
        OUTPUT "${output}"
        COMMAND "${CMAKE_Fortran_COMPILER}" ${preprocess} ${definitions} ${include_flags} "${source}" -o "${output}"
        DEPENDS "${source}" ${headers}
        COMMENT "Specialising ${relative} (${variant})" VERBATIM)
      list(APPEND expanded "${output}")
    endforeach()
  endforeach()
  set(${sources_variable} "${expanded}" PARENT_SCOPE)
endfunction()
