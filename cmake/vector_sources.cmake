# hshfit_vector_sources(FOLDER PROPERTY VALUE): sets a source property for the sources of FOLDER and
# below that are compiled once for each instruction set.
function(hshfit_vector_sources folder property value)
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
                                      PROPERTIES ${property} ${value})
        endif()
      endif()
    endforeach()
  endforeach()
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS subfolders)
    hshfit_vector_sources(${subfolder} ${property} ${value})
  endforeach()
endfunction()

# hshfit_unfused(FILE…): sources in which products and sums are fused only explicitly, so that
# results are bitwise identical in every vector width. GCC 12 forgets the option in functions for
# other instruction sets after a precompiled header.
function(hshfit_unfused)
  set_source_files_properties(${ARGN} PROPERTIES
    COMPILE_OPTIONS -ffp-contract=off SKIP_PRECOMPILE_HEADERS ON)
endfunction()
