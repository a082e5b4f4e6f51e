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
