# verisim_link_engine_first(TARGET): of an inline function that several objects have a linker takes the first it meets. What
# is compiled for the loop stands before what is not (verisim_off_the_loop): libraries of commands and words, and the
# program's or test's own objects. So the engine runs as it is compiled, whoever links it.

# The project's libraries that a target links, and what they link. $1: list that they are added to   $2: the target
function(verisim_libraries_of out target)
  set(found ${${out}})
  get_target_property(links ${target} LINK_LIBRARIES)
  foreach(library IN LISTS links)
    if(library MATCHES "^verisim_" AND NOT library IN_LIST found)
      get_target_property(type ${library} TYPE)
      if(type STREQUAL STATIC_LIBRARY)
        list(APPEND found ${library})
        verisim_libraries_of(found ${library})
      endif()
    endif()
  endforeach()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

function(verisim_order_links target)
  set(libraries)
  verisim_libraries_of(libraries ${target})
  set(loop)
  set(others)
  foreach(library IN LISTS libraries)
    get_target_property(links ${library} LINK_LIBRARIES)
    if(verisim_off_the_loop IN_LIST links)
      list(APPEND others $<TARGET_FILE:${library}>)
    else()
      list(APPEND loop $<TARGET_FILE:${library}>)
    endif()
  endforeach()
  list(APPEND loop ${others})
  list(JOIN loop "," files)
  target_link_options(${target} PRIVATE "LINKER:--whole-archive,${files},--no-whole-archive")
endfunction()

function(verisim_link_engine_first target)
  # Later, when all that it links is known.
  cmake_language(EVAL CODE "cmake_language(DEFER CALL verisim_order_links ${target})")
endfunction()
