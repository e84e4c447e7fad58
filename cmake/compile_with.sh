#!/bin/sh
# A compiler launcher that puts another compiler in the place of CMake's: compile_with.sh "CCACHE CLANG++" C++ ARGUMENTS...
# runs CCACHE CLANG++ ARGUMENTS... Both compilers understand g++'s command line.
compiler=$1
shift 2
# shellcheck disable=SC2086  # the words of one argument are meant
exec $compiler "$@"
