# verisim_test(NAME [ALONE] [LINKS targets...] [SOURCES files...]): tests/<folder>/NAME.cpp becomes part of the folder's test
# program, build/tests/<folder>_tests, and ctest knows each of its cases as NAME.Suite.Case (list_tests.py). One program per
# folder, because linking and reading the same headers for every file cost more than compiling the tests. Each file has a
# namespace of its own name, so that files do not see each other. ALONE: a program of its own, for what replaces malloc or
# kills itself.
find_package(GTest REQUIRED)
# Looked for once, here: each takes a second.
set(Python_EXECUTABLE /usr/bin/python3)  # Debian's, whose headers, NumPy and h5py are Debian's too
find_package(Python REQUIRED COMPONENTS Interpreter OPTIONAL_COMPONENTS Development.Module)
find_package(HDF5 REQUIRED COMPONENTS C)
set(VERISIM_SHARED_DATA "${PROJECT_SOURCE_DIR}/../shared/data" CACHE PATH "Recordings and models of other people; tests that need them say when they are absent")
set(VERISIM_SHARED_REFERENCE "${PROJECT_SOURCE_DIR}/../shared/reference" CACHE PATH "Recorded facts of published pieces")
configure_file(${PROJECT_SOURCE_DIR}/tests/support/paths.cpp.in ${CMAKE_BINARY_DIR}/generated/paths.cpp @ONLY)
add_library(verisim_paths STATIC ${CMAKE_BINARY_DIR}/generated/paths.cpp)
target_link_libraries(verisim_paths PRIVATE verisim_flags verisim_off_the_loop)

function(verisim_test_program target)
  add_executable(${target})
  verisim_link_engine_first(${target})
  target_link_libraries(${target} PRIVATE verisim_flags verisim_off_the_loop verisim_paths GTest::gtest_main)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}.cmake)
  set(left_out)
  if(VERISIM_SANITIZE)
    set(left_out ${PROJECT_SOURCE_DIR}/tests/sweeps.txt)
  endif()
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM
    COMMAND ${Python_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/list_tests.py $<TARGET_FILE:${target}> ${list} ${left_out})
  file(WRITE ${list}.include "if(EXISTS \"${list}\")\n  include(\"${list}\")\nelse()\n"
                             "  add_test(${target}_NOT_BUILT ${target}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${list}.include)
endfunction()

function(verisim_test name)
  cmake_parse_arguments(ARG "ALONE" "" "LINKS;SOURCES" ${ARGN})
  get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(target ${folder}_tests)
  if(ARG_ALONE)
    set(target ${name})
  endif()
  if(NOT TARGET ${target})
    verisim_test_program(${target})
  endif()
  target_sources(${target} PRIVATE ${name}.cpp ${ARG_SOURCES})  # CMake compiles a file once that is named twice
  if(ARG_SOURCES)  # allocations.cpp and its like replace operator new, whose users must not see it
    set_source_files_properties(${ARG_SOURCES} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  target_link_libraries(${target} PRIVATE ${ARG_LINKS})
endfunction()
