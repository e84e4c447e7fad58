# Copies Lua's archive to COPY: without its tables, and with other names for what lua_math.cpp and lua_work.cpp replace.
# Called by CMakeLists.txt with ARCHIVE, COPY, AR, OBJCOPY.
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(folder ${COPY}.members)
file(REMOVE_RECURSE ${folder} ${COPY})
file(MAKE_DIRECTORY ${folder})
run(${AR} x ${ARCHIVE})
file(REMOVE ${folder}/ltable-c++.o)

# The C library's functions and streams, wherever they are called.
set(called)
foreach(name acos asin atan atan2 cos cosh exp fmod log log10 memchr memcmp memcpy pow sin sinh strchr strcoll strlen
             stderr stdin stdout strpbrk strtod strtoul tan tanh)
  list(APPEND called --redefine-sym ${name}=verisim_lua_${name})
endforeach()
list(APPEND called --redefine-sym __sprintf_chk=verisim_lua_sprintf_chk)
file(GLOB members ${folder}/*.o)
foreach(member ${members})
  run(${OBJCOPY} ${called} ${member})
endforeach()

# Lua's own functions, where they are defined: the other members then find ours under the former name.
run(${OBJCOPY} --redefine-sym _Z12luaS_newlstrP9lua_StatePKcm=_Z19verisim_lua_newlstrP9lua_StatePKcm lstring-c++.o)
run(${OBJCOPY} --redefine-sym _Z12luaD_precallP9lua_StateP10lua_TValuei=_Z19verisim_lua_precallP9lua_StateP10lua_TValuei
    --redefine-sym _Z12luaD_poscallP9lua_StateP10lua_TValue=_Z19verisim_lua_poscallP9lua_StateP10lua_TValue ldo-c++.o)
run(${OBJCOPY} --redefine-sym lua_lessthan=verisim_lua_plain_lessthan lapi-c++.o)
run(${AR} rcs ${COPY} ${members})
