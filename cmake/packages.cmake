# SPDX-License-Identifier: Apache-2.0
# Debian packages, by `cpack` in a build folder whose prefix is /usr: scripts/package does it all.
#   perp         the program, its man pages and completion, small models
#   libperp      libperp.so, for programs in C
#   libperp-dev  perp.h, the headers and static libraries of C++, for CMake and pkg-config
#   libperp-path libperp_path.so, in place of PATH's library
#   python3-perp the package for Python, for any python3 and architecture: Python over libperp.so
if(NOT PROJECT_IS_TOP_LEVEL OR SKBUILD)
  return()
endif()
set(perp_packages program library development path)
if(NOT PERP_BUILD_APP)
  list(REMOVE_ITEM perp_packages program)
endif()
if(NOT PERP_BUILD_C)
  list(REMOVE_ITEM perp_packages library path)
endif()
if(PERP_BUILD_PYTHON)
  list(APPEND perp_packages python)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${perp_packages})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 2)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(PERP_PACKAGE_CONTACT "Perp maintainers <maintainers@perp.invalid>" CACHE STRING "Who made the packages: Name <address>")
set(CPACK_PACKAGE_CONTACT ${PERP_PACKAGE_CONTACT})
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/triggers)
set(CPACK_DEBIAN_PATH_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/triggers)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_PROVIDES libperp1)  # the name after its SONAME
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/python/postinst
  ${CMAKE_CURRENT_LIST_DIR}/debian/python/prerm)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own

set(perp_same_version "(= ${PROJECT_VERSION})")
# What perpConfig.cmake and perp.pc look for.
set(perp_dev_packages "libeigen3-dev, libsuitesparse-dev, libamplsolver-dev, libmpfi-dev")
if(PERP_GPL)
  string(APPEND perp_dev_packages ", libgsl-dev")
endif()

# What the program as linked is under (docs/licence.md).
if(PERP_GPL)
  set(perp_whole "Linked with UMFPACK, CHOLMOD and GSL, this package is as a whole under the
 GNU General Public License, version 3 or later, in
 /usr/share/common-licenses/GPL-3. Perp's own files are under the Apache
 License, Version 2.0.")
else()
  set(perp_whole "Nothing that is linked is under the GNU General Public License
 (built with -DPERP_GPL=OFF).")
endif()
set(perp_copyright ${PROJECT_BINARY_DIR}/debian/copyright)
configure_file(${PROJECT_SOURCE_DIR}/cmake/debian/copyright.in ${perp_copyright} @ONLY)
string(TIMESTAMP perp_date "%a, %d %b %Y %H:%M:%S +0000" UTC)

# perp_package(COMPONENT NAME SECTION DEPENDS SUMMARY TEXT): DEPENDS beside the libraries that dpkg-shlibdeps finds. A macro,
# for CPack's variables are those of the file.
macro(perp_package component name section depends summary text)
  string(TOUPPER ${component} perp_component)
  set(CPACK_DEBIAN_${perp_component}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${perp_component}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${perp_component}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_COMPONENT_${perp_component}_DESCRIPTION "${summary}\n${text}")
  set(perp_documents ${PROJECT_BINARY_DIR}/debian/${name})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/debian/changelog.in ${perp_documents}/changelog @ONLY)
  execute_process(COMMAND gzip -9nf ${perp_documents}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${perp_copyright} ${perp_documents}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endmacro()

perp_package(program perp math "python3:any" "solver for mixed complementarity problems"
"Finds x between bounds l and u such that F_i(x) >= 0 where x_i = l_i,
F_i(x) <= 0 where x_i = u_i, and F_i(x) = 0 between. Reads AMPL's .nl files,
stands in for PATH under the name pathampl, compares methods, and solves
contact problems with Coulomb friction from FCLIB's files.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "python3-matplotlib, python3-jinja2")  # of perp-compare
perp_package(library libperp libs "" "library for complementarity problems, from C"
"Mixed and nonlinear complementarity problems, and contact with friction.
This package has libperp.so, for programs that were built with perp.h.")
perp_package(development libperp-dev libdevel "libperp ${perp_same_version}, libperp-path ${perp_same_version}, ${perp_dev_packages}"
"library for complementarity problems, for development in C and C++"
"Mixed and nonlinear complementarity problems, and contact with friction.
This package has perp.h, the headers and static libraries of C++, and files
for CMake's find_package(perp) and for pkg-config.")
perp_package(path libperp-path libs "" "library for complementarity problems, behind PATH's C interface"
"libperp_path.so has the functions that clients of the PATH solver call, such
as PATHSolver.jl and path-capi-python. They run unchanged with it.")
perp_package(python python3-perp python "libperp ${perp_same_version}, python3 (>= 3.9), python3-numpy, python3-scipy"
"solver for complementarity problems, from Python"
"Mixed and nonlinear complementarity problems, and contact with friction,
on arrays of numpy and matrices of scipy.sparse.")
include(CPack)
