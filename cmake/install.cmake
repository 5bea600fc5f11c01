# What `make install` puts where: the program and sgmp-view; decks, gallery and materials (sgmp new finds them there),
# job scripts, documents; manual page and completion as the program itself writes them; a CMake package, so that
# find_package(sgmp) knows the program and the decks.

include(CMakePackageConfigHelpers)

set(sgmp_documents "${PROJECT_BINARY_DIR}/generated/sgmp.1" "${PROJECT_BINARY_DIR}/generated/completion")
# A build with the address sanitizer would fail for what gfortran leaves of functions' results when a program ends.
set(sgmp_speak "${CMAKE_COMMAND}" -E env ASAN_OPTIONS=detect_leaks=0 $<TARGET_FILE:sgmp>)
add_custom_command(OUTPUT ${sgmp_documents}
  COMMAND ${sgmp_speak} help --man > sgmp.1
  COMMAND ${sgmp_speak} completion bash > completion
  WORKING_DIRECTORY "${PROJECT_BINARY_DIR}/generated" DEPENDS sgmp COMMENT "" VERBATIM)
add_custom_target(sgmp_manual ALL DEPENDS ${sgmp_documents})

install(TARGETS sgmp EXPORT sgmp RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(DIRECTORY input DESTINATION "${CMAKE_INSTALL_DATADIR}/sgmp" FILES_MATCHING PATTERN "*.inp" PATTERN "*.md")
# sgmp-view looks for its package in ../share/sgmp/python.
install(PROGRAMS scripts/sgmp-view DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(DIRECTORY python DESTINATION "${CMAKE_INSTALL_DATADIR}/sgmp" FILES_MATCHING PATTERN "*.py" PATTERN
  "pyproject.toml"
        PATTERN "README.md" PATTERN "__pycache__" EXCLUDE PATTERN "build" EXCLUDE PATTERN "*.egg-info" EXCLUDE)
install(DIRECTORY scripts/hpc DESTINATION "${CMAKE_INSTALL_DATADIR}/sgmp" USE_SOURCE_PERMISSIONS)
install(PROGRAMS scripts/ballistic_limit.py scripts/largest_cfl.py DESTINATION "${CMAKE_INSTALL_DATADIR}/sgmp/scripts")
install(FILES README.md CHANGELOG.md LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY doc DESTINATION "${CMAKE_INSTALL_DOCDIR}" FILES_MATCHING PATTERN "*.md" PATTERN "*.png")
install(FILES "${PROJECT_BINARY_DIR}/generated/sgmp.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES "${PROJECT_BINARY_DIR}/generated/completion" RENAME sgmp
        DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")

set(sgmp_package "${CMAKE_INSTALL_LIBDIR}/cmake/sgmp")
set(sgmp_input_dir "${CMAKE_INSTALL_DATADIR}/sgmp/input")
install(EXPORT sgmp FILE sgmpTargets.cmake NAMESPACE sgmp:: DESTINATION "${sgmp_package}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sgmpConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/generated/sgmpConfig.cmake"
  INSTALL_DESTINATION "${sgmp_package}" PATH_VARS sgmp_input_dir)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/generated/sgmpConfigVersion.cmake" COMPATIBILITY
  SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/generated/sgmpConfig.cmake"
  "${PROJECT_BINARY_DIR}/generated/sgmpConfigVersion.cmake"
        DESTINATION "${sgmp_package}")
