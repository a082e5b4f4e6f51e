# hshfit_room(NAME SOURCES… [NEEDS ROOM…] [LINKS LIBRARY…]): a folder of lib/hshfit as a static
# library, hshfit_room_NAME. NEEDS lists the rooms whose headers it includes, all of them lower;
# tests/house_rules.sh holds that to the includes. LINKS are libraries that no header shows.
function(hshfit_room name)
  cmake_parse_arguments(ARG "" "" "NEEDS;LINKS" ${ARGN})
  set(target hshfit_room_${name})
  add_library(${target} STATIC ${ARG_UNPARSED_ARGUMENTS})
  list(TRANSFORM ARG_NEEDS PREPEND hshfit_room_)
  target_link_libraries(${target} PUBLIC hshfit_front_door fmt::fmt ${ARG_NEEDS}
                        PRIVATE hshfit_flags ${ARG_LINKS})
endfunction()

# hshfit_part(NAME ROOM…): several rooms under one public name, hshfit::NAME.
function(hshfit_part name)
  list(TRANSFORM ARGN PREPEND hshfit_room_)
  add_library(hshfit_${name} INTERFACE)
  add_library(hshfit::${name} ALIAS hshfit_${name})
  target_link_libraries(hshfit_${name} INTERFACE ${ARGN})
endfunction()
