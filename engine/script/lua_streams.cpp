// The C library's streams for Lua's archive (CMakeLists.txt), which was compiled to be part of a program: named
// directly, they could not be found from a shared library.
#include <cstdio>

extern "C" {

FILE* verisim_lua_stdin = stdin;
FILE* verisim_lua_stdout = stdout;
FILE* verisim_lua_stderr = stderr;

}  // extern "C"
