# verisim_core_variants(NAME MAIN file.cpp CORE targets...): the same program with g++ and clang++ at -O0, -O2 and -O3,
# and a test that all print the same lines. VERISIM_COMPILERS=ON builds two of the six (g++ -O2, which is the build's own
# libraries, and clang++ -O3; the sanitized tests are a third: clang++ -O1 and the same goldens); ALL builds six, which takes
# minutes more. The sources of the CORE libraries are compiled anew for each variant.
# What those libraries need besides (files, CAD, HDF5: no part of a simulated frame) is linked as the build made it, and
# so are their archives; but a linker takes from an archive only what no object has defined, so nothing of the core.
set(VERISIM_COMPILERS OFF CACHE STRING "Compile the simulation core with two compilers at several levels and compare the bits")
set_property(CACHE VERISIM_COMPILERS PROPERTY STRINGS OFF ON ALL)

function(verisim_core_variants name)
  cmake_parse_arguments(ARG "" "MAIN" "CORE" ${ARGN})
  if(NOT VERISIM_COMPILERS)
    return()
  endif()
  find_program(VERISIM_GCC g++ REQUIRED)
  find_program(VERISIM_CLANG clang++ REQUIRED)

  set(sources ${ARG_MAIN})
  foreach(library IN LISTS ARG_CORE)
    get_target_property(folder ${library} SOURCE_DIR)
    get_target_property(files ${library} SOURCES)
    foreach(file IN LISTS files)
      get_source_file_property(alone ${folder}/${file} TARGET_DIRECTORY ${library} SKIP_UNITY_BUILD_INCLUSION)
      set_source_files_properties(${folder}/${file} PROPERTIES UNITY_GROUP ${library} SKIP_UNITY_BUILD_INCLUSION ${alone})
      list(APPEND sources ${folder}/${file})
    endforeach()
  endforeach()

  set(cache)
  if(VERISIM_CCACHE)
    set(cache "${VERISIM_CCACHE} ")
  endif()
  set(programs)
  foreach(compiler ${VERISIM_GCC} ${VERISIM_CLANG})
    get_filename_component(compiler_name ${compiler} NAME)
    foreach(level 0 2 3)
      if(NOT VERISIM_COMPILERS STREQUAL "ALL" AND NOT "${compiler_name}${level}" MATCHES "^(g\\+\\+2|clang\\+\\+3)$")
        continue()
      endif()
      set(variant ${name}_${compiler_name}_O${level})
      if(variant STREQUAL "${name}_g++_O2" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release")
        add_executable(${variant} ${ARG_MAIN})  # the build's own libraries are this variant
      else()
        add_executable(${variant} ${sources})
      endif()
      target_link_libraries(${variant} PRIVATE ${ARG_CORE})
      target_compile_options(${variant} PRIVATE -O${level} -g0 -w)  # warnings are the default build's business
      set_target_properties(${variant} PROPERTIES
        UNITY_BUILD_MODE GROUP  # a library is one unit
        CXX_COMPILER_LAUNCHER "${PROJECT_SOURCE_DIR}/cmake/compile_with.sh;${cache}${compiler}"
        EXPORT_COMPILE_COMMANDS OFF  # the default build's are the ones to lint
        RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/variants)
      if(level EQUAL 0)  # g++ refuses Highway's AVX-512 gathers unless it optimises
        target_compile_definitions(${variant} PRIVATE "HWY_DISABLED_TARGETS=(HWY_AVX3|HWY_AVX3_DL)")
      endif()
      list(APPEND programs $<TARGET_FILE:${variant}>)
    endforeach()
  endforeach()
  add_test(NAME compilers.${name} COMMAND ${PROJECT_SOURCE_DIR}/cmake/same_output.sh ${programs})
  set_tests_properties(compilers.${name} PROPERTIES LABELS compilers TIMEOUT 600)
endfunction()

# The alarm itself: two programs that print different lines must not pass.
add_test(NAME compilers.SeesADifference COMMAND ${PROJECT_SOURCE_DIR}/cmake/same_output.sh /bin/pwd /bin/uname)
add_test(NAME compilers.SeesSilence COMMAND ${PROJECT_SOURCE_DIR}/cmake/same_output.sh /bin/true /bin/true)
set_tests_properties(compilers.SeesADifference compilers.SeesSilence PROPERTIES LABELS compilers WILL_FAIL TRUE)
