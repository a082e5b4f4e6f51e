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

# hshfit_own_instructions(FOLDER): compiles the vector sources of FOLDER and below once, for AVX2 if
# this machine has it. The program then ends with a message on a processor without AVX2.
function(hshfit_own_instructions folder)
  include(CheckCXXSourceRuns)
  check_cxx_source_runs("int main() {
    return !(__builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") &&
             __builtin_cpu_supports(\"bmi2\") && __builtin_cpu_supports(\"pclmul\") &&
             __builtin_cpu_supports(\"aes\"));
  }" HSHFIT_HAS_AVX2)
  hshfit_vector_sources(${folder} COMPILE_DEFINITIONS HSHFIT_OWN_SET)
  if(HSHFIT_HAS_AVX2)
    # All that Highway asks for before it takes AVX2; beside the options of hshfit_unfused.
    hshfit_vector_sources(${folder} COMPILE_FLAGS
                          "-mavx2 -mfma -mbmi -mbmi2 -mf16c -mpclmul -maes")
    hshfit_vector_sources(${folder} SKIP_PRECOMPILE_HEADERS ON)
    if(TARGET hshfit)
      target_compile_definitions(hshfit PRIVATE HSHFIT_NEEDS_AVX2)
    endif()
  endif()
endfunction()

# hshfit_unfused(FILE…): sources in which products and sums are fused only explicitly, so that
# results are bitwise identical in every vector width. GCC 12 forgets the option in functions for
# other instruction sets after a precompiled header.
function(hshfit_unfused)
  set_source_files_properties(${ARGN} PROPERTIES
    COMPILE_OPTIONS -ffp-contract=off SKIP_PRECOMPILE_HEADERS ON)
endfunction()
