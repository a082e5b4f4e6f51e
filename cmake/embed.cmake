# hshfit_embed(TARGET NAME FILE): compiles FILE into TARGET as
#   namespace hshfit::embedded { extern const std::string_view NAME; }
# so that templates stay real files and the program needs none at run time.
function(hshfit_embed target name file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DNAME=${name} -DINPUT=${CMAKE_CURRENT_SOURCE_DIR}/${file}
            -DOUTPUT=${source} -P ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file} ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    VERBATIM)
  set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  # Rules belong to a folder: this target carries them to one that was added elsewhere.
  add_custom_target(hshfit_embed_${name} DEPENDS ${source})
  add_dependencies(${target} hshfit_embed_${name})
  target_sources(${target} PRIVATE ${source})
endfunction()
