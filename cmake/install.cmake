# Installation: components `program`, `pictures` (its module), `mpi` (hshfit-mpi), `development`,
# `documentation`, and `python` (python/CMakeLists.txt).
# Headers are those outside internal/ without the PRIVATE_HEADERS of their room;
# docs/reference/library.md lists them.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(HSHFIT_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/hshfit)
# The headers of brdfs/ have a folder of their own, because other projects may have one named brdfs.
set(HSHFIT_BRDFS_HEADERS ${CMAKE_INSTALL_INCLUDEDIR}/hshfit-brdfs)

# hshfit_install_target(TARGET NAME): installs a library, which an outside project then links as
# hshfit::NAME.
function(hshfit_install_target target name)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  if(HSHFIT_DEVELOPMENT)
    install(TARGETS ${target} EXPORT hshfit_targets
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  endif()
endfunction()

# hshfit_install_headers(FOLDER PRIVATE…): the headers of this folder without PRIVATE and without
# those of its subfolders, into FOLDER of the headers.
function(hshfit_install_headers folder)
  if(NOT HSHFIT_DEVELOPMENT)
    return()
  endif()
  set(private)
  foreach(header IN LISTS ARGN)
    list(APPEND private PATTERN ${header} EXCLUDE)
  endforeach()
  # The names of subfolders have no dot.
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT development
          FILES_MATCHING PATTERN "*.h" REGEX "/${folder}/[^/.]+$" EXCLUDE ${private})
endfunction()

# hshfit_pkgconfig(MODULE LIBRARY… [REQUIRES MODULE…] [LIBS FLAG…] [CFLAGS FLAG…]): MODULE.pc. Each
# LIBRARY needs only those before it.
function(hshfit_pkgconfig module)
  cmake_parse_arguments(ARG "" "" "REQUIRES;LIBS;CFLAGS" ${ARGN})
  if(NOT HSHFIT_DEVELOPMENT)
    return()
  endif()
  set(libs)
  foreach(library IN LISTS ARG_UNPARSED_ARGUMENTS)
    list(PREPEND libs -l${library})
  endforeach()
  set(HSHFIT_MODULE ${module})
  list(JOIN ARG_REQUIRES " " HSHFIT_REQUIRES)
  list(APPEND libs ${ARG_LIBS})
  list(JOIN libs " " HSHFIT_LIBS)
  list(JOIN ARG_CFLAGS " " HSHFIT_CFLAGS)
  file(RELATIVE_PATH HSHFIT_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" HSHFIT_PREFIX "${HSHFIT_PREFIX}")
  set(file ${PROJECT_BINARY_DIR}/package/${module}.pc)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/hshfit.pc.in ${file} @ONLY)
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# hshfit_install_package(): the files for find_package, after all targets are known.
function(hshfit_install_package)
  if(NOT HSHFIT_DEVELOPMENT)
    return()
  endif()
  get_property(HSHFIT_COMPONENTS GLOBAL PROPERTY hshfit_components)
  get_property(HSHFIT_TIMES_SHADERS GLOBAL PROPERTY hshfit_times_shaders SET)
  install(EXPORT hshfit_targets NAMESPACE hshfit:: FILE hshfitTargets.cmake
          DESTINATION ${HSHFIT_CMAKE_FOLDER} COMPONENT development)
  set(HSHFIT_MODULE_FOLDER lib/hshfit)
  configure_package_config_file(
    cmake/hshfitConfig.cmake.in ${PROJECT_BINARY_DIR}/package/hshfitConfig.cmake
    INSTALL_DESTINATION ${HSHFIT_CMAKE_FOLDER} PATH_VARS HSHFIT_MODULE_FOLDER
    NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  list(TRANSFORM HSHFIT_COMPONENTS PREPEND hshfit- OUTPUT_VARIABLE modules)
  list(REMOVE_ITEM modules hshfit-lib hshfit-brdfs)
  list(REVERSE modules)
  hshfit_pkgconfig(hshfit REQUIRES ${modules})
  write_basic_package_version_file(
    ${PROJECT_BINARY_DIR}/package/hshfitConfigVersion.cmake COMPATIBILITY SameMajorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/package/hshfitConfig.cmake
                ${PROJECT_BINARY_DIR}/package/hshfitConfigVersion.cmake
          DESTINATION ${HSHFIT_CMAKE_FOLDER} COMPONENT development)
endfunction()

# hshfit_install_documents(): pages, schemas and examples.
function(hshfit_install_documents)
  if(NOT HSHFIT_INSTALL)
    return()
  endif()
  install(FILES README.md CHANGELOG.md LICENSE
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
  install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation
          FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN schemas EXCLUDE
          PATTERN site EXCLUDE PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation
          PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY docs/schemas
          DESTINATION ${CMAKE_INSTALL_DATADIR}/hshfit COMPONENT program)
endfunction()
