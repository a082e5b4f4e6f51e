# The flags of the presets `sanitize` and `threads`, which set HSHFIT_SANITIZE.
function(hshfit_sanitize flags)
  target_compile_options(${flags} INTERFACE
    -fsanitize=${HSHFIT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(${flags} INTERFACE -fsanitize=${HSHFIT_SANITIZE})
  # Of the instruction sets those that every machine here runs: AVX2 and the baseline.
  target_compile_definitions(${flags} INTERFACE
    "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4|HWY_AVX3|HWY_AVX3_DL)")
  if(HSHFIT_SANITIZE STREQUAL "thread")
    target_include_directories(${flags} BEFORE INTERFACE tests/threads)
  endif()
endfunction()

# hshfit_vectors_unoptimised(FOLDER): -O0 for the sources of FOLDER and below that are compiled for
# each instruction set. Clang 14 takes more than three minutes for one of them with -O1 and the
# address sanitizer, and ten seconds with -O0.
function(hshfit_vectors_unoptimised folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(sources ${target} SOURCES)
    get_target_property(place ${target} SOURCE_DIR)
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${place} OUTPUT_VARIABLE path)
      if(path MATCHES "\\.cpp$" AND EXISTS ${path})
        file(STRINGS ${path} vectors REGEX "^#define HWY_TARGET_INCLUDE" LIMIT_COUNT 1)
        if(vectors)
          set_source_files_properties(${path} TARGET_DIRECTORY ${target}
                                      PROPERTIES COMPILE_OPTIONS -O0)
        endif()
      endif()
    endforeach()
  endforeach()
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS subfolders)
    hshfit_vectors_unoptimised(${subfolder})
  endforeach()
endfunction()
