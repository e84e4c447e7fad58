#!/bin/sh
# A compiler launcher that puts another compiler in the place of CMake's: compile_with.sh CLANG++ C++ ARGUMENTS... runs
# CLANG++ ARGUMENTS..., through ccache where there is one. Both understand g++'s command line.
compiler=$1
shift 2
if command -v ccache >/dev/null; then exec ccache "$compiler" "$@"; fi
exec "$compiler" "$@"
