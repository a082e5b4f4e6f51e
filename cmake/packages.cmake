# Debian packages by CPack, with HSHFIT_PACKAGES: `./run package` makes and checks them
# (docs/install.md). One package for each component of the installation.
set(HSHFIT_MAINTAINER "hshfit authors <hshfit@users.noreply.github.com>" CACHE STRING
    "Maintainer of the Debian packages, with an address")
set(HSHFIT_DEBIAN_REVISION 1)

# The changelog of Debian has one entry, dated by the last commit, so that the packages of one
# commit are the same.
if(DEFINED ENV{SOURCE_DATE_EPOCH})
  string(TIMESTAMP HSHFIT_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
else()
  execute_process(COMMAND git log -1 --format=%cD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                  OUTPUT_VARIABLE HSHFIT_DATE OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT HSHFIT_DATE)
    string(TIMESTAMP HSHFIT_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
  endif()
endif()
set(changelog ${PROJECT_BINARY_DIR}/package/changelog.Debian)
configure_file(packaging/debian/changelog.in ${changelog} @ONLY)
find_program(HSHFIT_GZIP gzip REQUIRED)
mark_as_advanced(HSHFIT_GZIP)
execute_process(COMMAND ${HSHFIT_GZIP} -9nfk ${changelog} COMMAND_ERROR_IS_FATAL ANY)
file(READ LICENSE license)
string(REGEX REPLACE "^[^\n]*\n\nCopyright [^\n]*\n\n" "" license "${license}")
string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
string(REGEX REPLACE "\n([^\n])" "\n \\1" HSHFIT_LICENSE "${license}")
configure_file(packaging/debian/copyright.in ${PROJECT_BINARY_DIR}/package/copyright @ONLY)

# hshfit_package(COMPONENT NAME SECTION SUMMARY DEPENDS RECOMMENDS SUGGESTS TEXT): a component as a
# package, with the files that every Debian package has. They belong to packages alone.
function(hshfit_package component name section summary depends recommends suggests text)
  install(FILES ${PROJECT_BINARY_DIR}/package/copyright
                ${PROJECT_BINARY_DIR}/package/changelog.Debian.gz
          DESTINATION share/doc/${name} COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/debian/${name}.lintian-overrides
          DESTINATION share/lintian/overrides RENAME ${name} COMPONENT ${component}
          EXCLUDE_FROM_ALL OPTIONAL)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_RECOMMENDS "${recommends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SUGGESTS "${suggests}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
endfunction()

set(same "(= ${PROJECT_VERSION}-${HSHFIT_DEBIAN_REVISION})")
set(about "hshfit turns a BRDF, analytic or measured, into coefficients of
hemispherical harmonics and of competing bases, with an error estimate,
and reports the share of the energy that each basis captures.")
hshfit_package(program hshfit science
  "BRDFs as coefficients of hemispherical harmonics" "" "gnuplot-nox, hshfit-pictures ${same}"
  "hshfit-doc, libvulkan1" "${about}\n.\nThis package has the program and the schemas of its JSON.")
hshfit_package(pictures hshfit-pictures science
  "Pictures of light for hshfit" "" "" ""
  "${about}\n.\nThis package has the module that reads lights in the formats of OpenImageIO.")
hshfit_package(development libhshfit-dev libdevel
  "BRDFs as coefficients of hemispherical harmonics, library"
  "libfmt-dev, libtbb-dev, libhwy-dev, libimath-dev, libzstd-dev, libopenexr-dev, libpng-dev, \
zlib1g-dev, nettle-dev, glslang-dev, glslang-tools, libpugixml-dev, libembree-dev, \
libtinygltf-dev, libceres-dev"
  "" "hshfit-doc, hshfit-pictures ${same}"
  "${about}\n.\nThis package has the static libraries, their headers, and files for
CMake and pkg-config.")
hshfit_package(documentation hshfit-doc doc
  "BRDFs as coefficients of hemispherical harmonics, documentation" "" "" ""
  "${about}\n.\nThis package has the pages of documentation and the examples.")

if(HSHFIT_PYTHON)
  # The extension module is for one minor version of Python.
  find_package(Python REQUIRED COMPONENTS Interpreter)
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  hshfit_package(python python3-hshfit python
    "BRDFs as coefficients of hemispherical harmonics, Python package"
    "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next}~), python3-numpy"
    "gnuplot-nox" "hshfit-doc, hshfit-pictures ${same}"
    "${about}\n.\nThis package has the module hshfit for Python, which works on arrays of NumPy.")
endif()

if(HSHFIT_MPI AND HSHFIT_PARTS STREQUAL "all")
  # Open MPI starts its processes by a program, which the library alone does not bring.
  hshfit_package(mpi hshfit-mpi science
    "BRDFs as coefficients of hemispherical harmonics, over MPI"
    "openmpi-bin" "hshfit-pictures ${same}" "hshfit, hshfit-doc"
    "${about}\n.\nThis package has hshfit-mpi, whose processes share the work on a map.")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program pictures development documentation)
if(HSHFIT_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(HSHFIT_MPI AND HSHFIT_PARTS STREQUAL "all")
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_NAME hshfit)
set(CPACK_PACKAGE_CONTACT "${HSHFIT_MAINTAINER}")
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS
    ${PROJECT_SOURCE_DIR}/packaging/debian/compress_manual.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${HSHFIT_DEBIAN_REVISION})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PICTURES_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
