# The flags of the presets `sanitize` and `threads`, which set HSHFIT_SANITIZE. They are clang's.
function(hshfit_sanitize flags)
  set(options -fsanitize=${HSHFIT_SANITIZE})
  # Clang finds its run-time library and the linker only when it links.
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_QUIET ON)
  set(CMAKE_REQUIRED_LINK_OPTIONS -fuse-ld=lld)
  check_cxx_source_compiles("int main() {}" HSHFIT_HAS_LLD)
  if(NOT HSHFIT_HAS_LLD)
    unset(HSHFIT_HAS_LLD CACHE)
    message(FATAL_ERROR "${CMAKE_CXX_COMPILER} -fuse-ld=lld links nothing: the presets of "
                        "sanitizers need clang and its linker (Debian packages clang, lld)")
  endif()
  set(CMAKE_REQUIRED_FLAGS ${options})
  string(MAKE_C_IDENTIFIER "HSHFIT_HAS_${HSHFIT_SANITIZE}" found)
  check_cxx_source_compiles("int main() {}" ${found})
  if(NOT ${found})
    unset(${found} CACHE)
    message(FATAL_ERROR "${CMAKE_CXX_COMPILER} ${options} links nothing: the sanitizers' "
                        "run-time library is missing (Debian package libclang-rt-14-dev)")
  endif()

  target_compile_options(${flags} INTERFACE
    ${options} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(HSHFIT_SANITIZE MATCHES "undefined")
    target_compile_options(${flags} INTERFACE
      -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/sanitizer_ignores.txt)
  endif()
  # GNU ld takes several times as long for a test program, and its memory.
  target_link_options(${flags} INTERFACE ${options} -fuse-ld=lld)
  # The tests' own vector code too; lib/hshfit/vector_targets.h.
  string(TOUPPER "HSHFIT_${HSHFIT_INSTRUCTION_SETS}_SETS" sets)
  target_compile_definitions(${flags} INTERFACE ${sets})
  if(HSHFIT_SANITIZE STREQUAL "thread")
    target_include_directories(${flags} BEFORE INTERFACE tests/threads)
  endif()
endfunction()
