# SPDX-License-Identifier: Apache-2.0
# Finds SuiteSparse's libraries, for which Debian 12 ships no CMake package.
#   find_package(SuiteSparse COMPONENTS UMFPACK KLU CHOLMOD SPQR)
# gives a target SuiteSparse::NAME for each component found.
include(FindPackageHandleStandardArgs)

find_path(SuiteSparse_INCLUDE_DIR SuiteSparse_config.h PATH_SUFFIXES suitesparse)
set(_suitesparse_header_UMFPACK umfpack.h)
set(_suitesparse_header_KLU klu.h)
set(_suitesparse_header_CHOLMOD cholmod.h)
set(_suitesparse_header_SPQR SuiteSparseQR.hpp)
if(SuiteSparse_INCLUDE_DIR AND EXISTS ${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h)
  file(STRINGS ${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h _suitesparse_version
    REGEX "define SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION [0-9]+")
  string(REGEX MATCHALL "[0-9]+" _suitesparse_version "${_suitesparse_version}")
  list(JOIN _suitesparse_version "." SuiteSparse_VERSION)
endif()

foreach(component IN LISTS SuiteSparse_FIND_COMPONENTS)
  string(TOLOWER ${component} _suitesparse_name)
  find_library(SuiteSparse_${component}_LIBRARY ${_suitesparse_name})
  if(SuiteSparse_${component}_LIBRARY AND EXISTS ${SuiteSparse_INCLUDE_DIR}/${_suitesparse_header_${component}})
    set(SuiteSparse_${component}_FOUND TRUE)
    if(NOT TARGET SuiteSparse::${component})
      add_library(SuiteSparse::${component} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${component} PROPERTIES
        IMPORTED_LOCATION ${SuiteSparse_${component}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${SuiteSparse_INCLUDE_DIR})
    endif()
  endif()
  mark_as_advanced(SuiteSparse_${component}_LIBRARY)
endforeach()
mark_as_advanced(SuiteSparse_INCLUDE_DIR)

find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_INCLUDE_DIR
  VERSION_VAR SuiteSparse_VERSION HANDLE_COMPONENTS
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsuitesparse-dev")
