# The stand-in's add_pfunit_ctest, with the arguments of pFUnit's:
#   add_pfunit_ctest(name TEST_SOURCES a.pf … [OTHER_SOURCES …] [LINK_LIBRARIES …] [LABELS …] [MAX_PES n]
#                    [WORKING_DIRECTORY dir])

set(funit_dir "${CMAKE_CURRENT_LIST_DIR}")
set(funit_build_dir "${CMAKE_CURRENT_BINARY_DIR}/standin")
file(MAKE_DIRECTORY "${funit_build_dir}")

add_custom_command(
  OUTPUT "${funit_build_dir}/funit_asserts.f90"
  COMMAND "${Python3_EXECUTABLE}" "${funit_dir}/generate_asserts.py" "${funit_build_dir}/funit_asserts.f90"
  DEPENDS "${funit_dir}/generate_asserts.py" COMMENT "Generating the assertions" VERBATIM)
add_library(funit STATIC
  "${funit_dir}/funit_core.f90" "${funit_dir}/funit_runner.f90" "${funit_dir}/funit.f90"
  "${funit_dir}/pfunit_runner.f90" "${funit_dir}/pfunit.f90" "${funit_build_dir}/funit_asserts.f90")
set_target_properties(funit PROPERTIES Fortran_MODULE_DIRECTORY "${funit_build_dir}/modules")
target_include_directories(funit PUBLIC "${funit_build_dir}/modules")
target_compile_options(funit PRIVATE $<$<Fortran_COMPILER_ID:GNU>:-Wno-compare-reals>) # exact comparison is its trade
target_compile_options(funit PRIVATE $<$<AND:$<Fortran_COMPILER_ID:GNU>,$<CONFIG:Release>>:-O0>) # twelve seconds less
target_link_libraries(funit PUBLIC MPI::MPI_Fortran)

function(add_pfunit_ctest name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "MAX_PES;WORKING_DIRECTORY"
    "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_TEST_SOURCES)
    message(FATAL_ERROR "add_pfunit_ctest(${name}): no TEST_SOURCES, or unknown arguments: ${arg_UNPARSED_ARGUMENTS}")
  endif()

  set(sources)
  set(suites "")
  foreach(source IN LISTS arg_TEST_SOURCES)
    get_filename_component(source "${source}" ABSOLUTE)
    get_filename_component(base "${source}" NAME_WE)
    set(output "${CMAKE_CURRENT_BINARY_DIR}/generated/${name}/${base}.F90")
    file(MAKE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/generated/${name}")
    add_custom_command(
      OUTPUT "${output}"
      COMMAND "${Python3_EXECUTABLE}" "${funit_dir}/pf_preprocess.py" "${source}" "${output}"
      DEPENDS "${source}" "${funit_dir}/pf_preprocess.py" COMMENT "Preprocessing ${base}.pf" VERBATIM)
    list(APPEND sources "${output}")
    string(APPEND suites "  call ${base}_suite()\n")
  endforeach()

  set(mpi_start "")
  set(mpi_end "")
  if(arg_MAX_PES)
    set(mpi_use "  use mpi\n")
    set(mpi_start "  call MPI_Init(ierror)\n  call MPI_Comm_rank(MPI_COMM_WORLD, rank, ierror)\n")
    set(mpi_end "  call MPI_Bcast(has_failed, 1, MPI_LOGICAL, 0, MPI_COMM_WORLD, ierror)\n")
    string(APPEND mpi_end "  call MPI_Finalize(ierror)\n")
    set(declare "  integer :: rank, ierror\n")
    # Only one process speaks; the others end with the same code.
    set(stop "  if (has_failed) then\n    if (rank == 0) error stop 2\n    stop\n  end if\n")
  else()
    set(mpi_use "")
    set(declare "  integer, parameter :: rank = 0\n")
    set(stop "  if (has_failed) error stop 2\n")
  endif()
  set(driver "${CMAKE_CURRENT_BINARY_DIR}/generated/${name}/${name}_driver.f90")
  file(CONFIGURE OUTPUT "${driver}" @ONLY CONTENT
"program ${name}_driver
  use funit_runner, only: run_summary
${mpi_use}  implicit none
${declare}  logical :: has_failed

${mpi_start}${suites}  has_failed = .false.
  if (rank == 0) has_failed = run_summary()
${mpi_end}${stop}end program ${name}_driver
")

  add_executable(${name} ${sources} ${arg_OTHER_SOURCES} "${driver}")
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/modules/${name}")
  target_link_libraries(${name} PRIVATE ${arg_LINK_LIBRARIES} funit)

  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  set(launch)
  if(arg_MAX_PES)
    set(launch "${MPIEXEC_EXECUTABLE}" ${MPIEXEC_PREFLAGS} ${MPIEXEC_NUMPROC_FLAG} ${arg_MAX_PES})
  endif()
  add_test(NAME ${name} WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}" COMMAND ${launch} "$<TARGET_FILE:${name}>")
  if(arg_LABELS)
    set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}")
  endif()
endfunction()
