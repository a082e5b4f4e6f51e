# hshfit_precompiled(TARGET [JSON]): the headers that most files of lib/ include, parsed once for
# all of them; with JSON also those of nlohmann-json, which the rooms of the part math do without.
# A file still includes what it uses: CMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without this.
function(hshfit_precompiled target)
  cmake_parse_arguments(ARG "JSON" "" "" ${ARGN})
  set(headers hshfit_headers)
  if(ARG_JSON)
    set(headers hshfit_json_headers)
  endif()
  if(NOT TARGET ${headers})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${headers}.cpp CONTENT "")
    add_library(${headers} OBJECT ${PROJECT_BINARY_DIR}/${headers}.cpp)
    target_link_libraries(${headers} PRIVATE hshfit_flags fmt::fmt)
    if(ARG_JSON)
      target_link_libraries(${headers} PRIVATE nlohmann_json::nlohmann_json)
      target_precompile_headers(${headers} PRIVATE <nlohmann/json.hpp>)
    endif()
    target_precompile_headers(${headers} PRIVATE
      <fmt/format.h> <algorithm> <array> <cmath> <filesystem> <fstream>
      <functional> <memory> <optional> <span> <string> <vector>)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

# hshfit_room(NAME SOURCES… [APART] [NEEDS ROOM…] [LINKS LIBRARY…]): a folder of lib/hshfit as a
# static library, hshfit_room_NAME. With HSHFIT_UNITY eight sources are compiled at a time; APART is
# for rooms whose sources have local functions of one name, as the members of a table do. NEEDS
# lists the rooms whose headers it includes, all of them lower; tests/house_rules.sh holds that to
# the includes. LINKS are libraries that no header shows.
function(hshfit_room name)
  cmake_parse_arguments(ARG "APART" "" "NEEDS;LINKS" ${ARGN})
  set(target hshfit_room_${name})
  add_library(${target} STATIC ${ARG_UNPARSED_ARGUMENTS})
  list(TRANSFORM ARG_NEEDS PREPEND hshfit_room_)
  target_link_libraries(${target} PUBLIC hshfit_front_door fmt::fmt ${ARG_NEEDS}
                        PRIVATE hshfit_flags ${ARG_LINKS})
  hshfit_precompiled(${target} ${HSHFIT_ROOM_HEADERS})
  if(HSHFIT_UNITY AND NOT ARG_APART)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    # GCC takes an unnamed namespace of an included source for one of a header.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# hshfit_part(NAME ROOM…): several rooms under one public name, hshfit::NAME.
function(hshfit_part name)
  list(TRANSFORM ARGN PREPEND hshfit_room_)
  add_library(hshfit_${name} INTERFACE)
  add_library(hshfit::${name} ALIAS hshfit_${name})
  target_link_libraries(hshfit_${name} INTERFACE ${ARGN})
endfunction()
