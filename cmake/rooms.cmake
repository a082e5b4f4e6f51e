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

# Libraries of headers alone, which a program that links a static library of ours does not need.
set(HSHFIT_HEADER_LIBRARIES Eigen3::Eigen nlohmann_json::nlohmann_json nanoflann::nanoflann)

# hshfit_link(TARGET LIBRARY…): libraries that no header of TARGET shows. The installed target names
# those that programs have to link: no flag of ours, no library of headers, and no path.
function(hshfit_link target)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hshfit_flags>)
  foreach(library IN LISTS ARGN)
    if(library IN_LIST HSHFIT_HEADER_LIBRARIES)
      target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${library}>)
    elseif(IS_ABSOLUTE "${library}")
      cmake_path(GET library STEM name)
      string(REGEX REPLACE "^lib" "" name ${name})
      target_link_libraries(${target} PRIVATE
        $<BUILD_INTERFACE:${library}> $<INSTALL_INTERFACE:${name}>)
    else()
      target_link_libraries(${target} PRIVATE ${library})
    endif()
  endforeach()
endfunction()

# hshfit_room(NAME SOURCES… [APART] [TEXT] [NEEDS ROOM…] [LINKS LIBRARY…] [PRIVATE_HEADERS
# HEADER…]): a folder of lib/hshfit as a static library, hshfit_room_NAME. With HSHFIT_UNITY eight
# sources are compiled at a time; APART is for rooms whose sources have local functions of one name,
# as the members of a table do. TEXT is for rooms that write pages and shaders: -O1 loses nothing
# there and compiles in two thirds of the time. NEEDS lists the rooms whose headers it includes, all
# of them lower; tests/house_rules.sh holds that to the includes. LINKS are libraries that no header
# shows, and PRIVATE_HEADERS are headers for the rooms above that are not installed: they show a
# library.
function(hshfit_room name)
  cmake_parse_arguments(ARG "APART;TEXT" "" "NEEDS;LINKS;PRIVATE_HEADERS" ${ARGN})
  set(target hshfit_room_${name})
  add_library(${target} STATIC ${ARG_UNPARSED_ARGUMENTS})
  list(TRANSFORM ARG_NEEDS PREPEND hshfit_room_)
  target_link_libraries(${target} PUBLIC hshfit_front_door fmt::fmt ${ARG_NEEDS})
  hshfit_link(${target} ${ARG_LINKS})
  hshfit_precompiled(${target} ${HSHFIT_ROOM_HEADERS})
  if(ARG_TEXT)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  hshfit_install_target(${target} room_${name})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR}/lib ${CMAKE_CURRENT_SOURCE_DIR})
  hshfit_install_headers(${folder} ${ARG_PRIVATE_HEADERS})
  if(HSHFIT_UNITY AND NOT ARG_APART)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    # GCC takes an unnamed namespace of an included source for one of a header.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# hshfit_part(NAME ROOM… [REQUIRES MODULE…] [LIBS FLAG…]): several rooms under one public name,
# hshfit::NAME; for programs without CMake, hshfit-NAME.pc with what pkg-config has to add.
function(hshfit_part name)
  cmake_parse_arguments(ARG "" "" "REQUIRES;LIBS" ${ARGN})
  list(TRANSFORM ARG_UNPARSED_ARGUMENTS PREPEND hshfit_room_)
  add_library(hshfit_${name} INTERFACE)
  add_library(hshfit::${name} ALIAS hshfit_${name})
  target_link_libraries(hshfit_${name} INTERFACE ${ARG_UNPARSED_ARGUMENTS})
  hshfit_install_target(hshfit_${name} ${name})
  hshfit_pkgconfig(hshfit-${name} ${ARG_UNPARSED_ARGUMENTS}
                   REQUIRES ${ARG_REQUIRES} LIBS ${ARG_LIBS})
  set_property(GLOBAL APPEND PROPERTY hshfit_components ${name})
endfunction()

# hshfit_joint_sources(TARGET NAME SOURCES…): sources of TARGET that are compiled as one with
# HSHFIT_UNITY: what the headers that they share cost is paid once. Names in their anonymous
# namespaces meet.
function(hshfit_joint_sources target name)
  target_sources(${target} PRIVATE ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${name})
endfunction()
