# SPDX-License-Identifier: Apache-2.0
# Finds AMPL's solver library (Debian: libamplsolver-dev; not libasl-dev, which is something else). Target: ASL::ASL.
include(FindPackageHandleStandardArgs)

find_path(ASL_INCLUDE_DIR asl.h PATH_SUFFIXES ampl-netlib-solvers)
find_library(ASL_LIBRARY amplsolver)
mark_as_advanced(ASL_INCLUDE_DIR ASL_LIBRARY)

find_package_handle_standard_args(ASL REQUIRED_VARS ASL_LIBRARY ASL_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libamplsolver-dev")
if(ASL_FOUND AND NOT TARGET ASL::ASL)
  add_library(ASL::ASL UNKNOWN IMPORTED)
  set_target_properties(ASL::ASL PROPERTIES IMPORTED_LOCATION ${ASL_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${ASL_INCLUDE_DIR} INTERFACE_LINK_LIBRARIES "${CMAKE_DL_LIBS}")
endif()
