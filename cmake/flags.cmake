# Every flag that any target is compiled with. Determinism lives here: no fused multiply-add, no fast-math, no
# -march=native, so that g++ and clang++ at any optimisation level give the same bits.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2")  # asserts stay on: a broken promise must not go unseen in a result

# Reading headers costs most of a compile (Eigen alone 1 s), so several files of a library are compiled as one unit.
# Each must still compile alone (-DVERISIM_UNITY=OFF), and names in its anonymous namespace are unique within its library:
# clang-tidy (tests/lint) reads each library as one unit and finds those that are not.
option(VERISIM_UNITY "Compile several source files as one" ON)
set(CMAKE_UNITY_BUILD ${VERISIM_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)

find_program(VERISIM_CCACHE ccache)
if(VERISIM_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${VERISIM_CCACHE})
endif()

add_library(verisim_flags INTERFACE)
# What assertions say of their place begins at the project's folder, so that the compiler cache serves a clone elsewhere.
target_compile_options(verisim_flags INTERFACE -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
target_compile_options(verisim_flags INTERFACE -ffp-contract=off -fno-fast-math -Wall -Wextra -Wshadow -Wnon-virtual-dtor)
# g++ collects garbage only above 600 MB: 4 % of its time (start.sh counts with 1.8 GB a compiler).
target_compile_options(verisim_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=600000>)
target_include_directories(verisim_flags INTERFACE ${PROJECT_SOURCE_DIR})
# Small functions on small arrays (engine/exact): -O3 inlines them.
add_library(verisim_small_arrays INTERFACE)
target_compile_options(verisim_small_arrays INTERFACE -O3)
# Code whose compile time is all that it costs: commands, words, tests. At -O1 g++ takes a fifth less for it, and warns
# where it inlined half of a pair: an assignment and not its use, a delete and not its new. Under the sanitizers -O0 takes
# half of the time of -O1 (link_order.cmake keeps the engine fast).
set(VERISIM_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined")
add_library(verisim_off_the_loop INTERFACE)
if(VERISIM_SANITIZE)
  target_compile_options(verisim_off_the_loop INTERFACE -O0)
else()
  target_compile_options(verisim_off_the_loop INTERFACE
                         -O1 $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-mismatched-new-delete>)
endif()
# Among -Wall: -Wswitch. A switch over an enum class has no default, so that one that forgets a kind does not compile.
option(VERISIM_WERROR "Treat warnings as errors" OFF)
if(VERISIM_WERROR)
  target_compile_options(verisim_flags INTERFACE -Werror)
endif()
if(VERISIM_SANITIZE)
  add_compile_definitions(VERISIM_SANITIZED)  # g++ and clang++ say it each in its own way
  add_compile_options(-fsanitize=${VERISIM_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${VERISIM_SANITIZE})
endif()
find_package(Threads REQUIRED)
