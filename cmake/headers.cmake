# hshfit_need_header(HEADER PACKAGE) and hshfit_need_library(NAME PACKAGE): configuration ends here,
# and names the Debian package, where a library without a CMake package of its own is missing.
# Without them the compiler or the linker would be the first to notice.
function(hshfit_need_header header package)
  string(MAKE_C_IDENTIFIER "HSHFIT_FOUND_${header}" found)
  find_path(${found} ${header})
  mark_as_advanced(${found})
  if(NOT ${found})
    message(FATAL_ERROR "${header} is missing (Debian package ${package})")
  endif()
endfunction()

function(hshfit_need_library name package)
  string(MAKE_C_IDENTIFIER "HSHFIT_FOUND_lib${name}" found)
  find_library(${found} ${name})
  mark_as_advanced(${found})
  if(NOT ${found})
    message(FATAL_ERROR "lib${name} is missing (Debian package ${package})")
  endif()
endfunction()
