#!/bin/sh
# A compiler launcher that puts another compiler in the place of CMake's: compile_with.sh CLANG++ C++ ARGUMENTS... runs
# CLANG++ ARGUMENTS... Both understand g++'s command line. Not through ccache: a header compiled before is only good with
# the very files it was made from, and a cached one has older ones.
compiler=$1
shift 2
# clang++ would build a new precompiled header on top of the old one that it replaces.
for argument; do
  case $argument in *.gch) rm -f "$argument" ;; esac
done
exec "$compiler" "$@"
