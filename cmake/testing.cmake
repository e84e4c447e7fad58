# verisim_test(NAME [LINKS targets...]): builds tests/<folder>/NAME.cpp and registers each of its cases with ctest.
find_package(GTest REQUIRED)
include(GoogleTest)
set(VERISIM_SHARED_DATA "${PROJECT_SOURCE_DIR}/../shared/data" CACHE PATH "Recordings and models of other people; tests that need them say when they are absent")
set(VERISIM_SHARED_REFERENCE "${PROJECT_SOURCE_DIR}/../shared/reference" CACHE PATH "Recorded facts of published pieces")
function(verisim_test name)
  cmake_parse_arguments(ARG "" "" "LINKS;SOURCES" ${ARGN})
  add_executable(${name} ${name}.cpp ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} verisim_flags GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE VERISIM_SHARED_DATA="${VERISIM_SHARED_DATA}"
                             VERISIM_SHARED_REFERENCE="${VERISIM_SHARED_REFERENCE}" VERISIM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             VERISIM_BINARY_DIR="${CMAKE_BINARY_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(ARG_SOURCES)  # allocations.cpp and its like replace operator new, whose users must not see it
    set_source_files_properties(${ARG_SOURCES} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_MODE PRE_TEST NO_PRETTY_VALUES
                       PROPERTIES TIMEOUT 600)
endfunction()
