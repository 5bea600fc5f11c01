# The build types of CMakePresets.json and their flags; any other compiler keeps CMake's own.

set(SGMP_ARCH "native" CACHE STRING "Value of -march in a release build (native: the machine that compiles)")
set(sgmp_build_types Release Debug Repro Sanitize Coverage)
get_property(is_multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT CMAKE_BUILD_TYPE AND NOT is_multi_config)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "One of: ${sgmp_build_types}" FORCE)
endif()
set_property(CACHE CMAKE_BUILD_TYPE PROPERTY STRINGS ${sgmp_build_types})

if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  # No -flto and no -ffast-math: the first was measured slower, the second changes the bits.
  # Functions start on a cache line: what others were linked before a kernel then changes its speed less.
  set(CMAKE_Fortran_FLAGS_RELEASE "-O3 -march=${SGMP_ARCH} -falign-functions=64 -fno-trapping-math -fno-math-errno")
  set(CMAKE_Fortran_FLAGS_DEBUG "-O0 -g -std=f2008 -Wall -Wextra -fcheck=all,no-array-temps -finit-real=snan")
  string(APPEND CMAKE_Fortran_FLAGS_DEBUG " -ffpe-trap=invalid,zero,overflow -fbacktrace")
  set(CMAKE_Fortran_FLAGS_REPRO "-O2 -g -ffp-contract=off")
  set(CMAKE_Fortran_FLAGS_SANITIZE "-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fbacktrace")
  set(CMAKE_EXE_LINKER_FLAGS_SANITIZE "-fsanitize=address,undefined")
  set(CMAKE_Fortran_FLAGS_COVERAGE "-O0 -g --coverage")
  set(CMAKE_EXE_LINKER_FLAGS_COVERAGE "--coverage")
endif()
