# Writes OUT, a source file with the commit that SOURCE is at, if it says something else already. Run at every build:
# cmake -DSOURCE=... -DOUT=... -P commit.cmake
cmake_minimum_required(VERSION 3.25)
set(commit "unknown")
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top ERROR_QUIET
                OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
if(NOT failed AND top STREQUAL SOURCE)
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=* OUTPUT_VARIABLE commit
                  ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT
     "#include \"engine/session/origin.hpp\"\nstd::string verisim::commit() { return \"@commit@\"; }\n")
