# SPDX-License-Identifier: Apache-2.0
# Finds HDF5's C library, the one without MPI (Debian: libhdf5-dev), whose places CMake's own FindHDF5 asks of a C
# compiler: the tests compare with it. Target: HDF5Serial::HDF5Serial.
include(FindPackageHandleStandardArgs)

find_path(HDF5Serial_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial)
find_library(HDF5Serial_LIBRARY NAMES hdf5_serial hdf5 PATH_SUFFIXES hdf5/serial)
mark_as_advanced(HDF5Serial_INCLUDE_DIR HDF5Serial_LIBRARY)
if(HDF5Serial_INCLUDE_DIR AND EXISTS ${HDF5Serial_INCLUDE_DIR}/H5public.h)
  file(STRINGS ${HDF5Serial_INCLUDE_DIR}/H5public.h _hdf5_version REGEX "define H5_VERS_(MAJOR|MINOR|RELEASE)[ \t]+[0-9]+")
  string(REGEX MATCHALL "[ \t][0-9]+" _hdf5_version "${_hdf5_version}")
  list(TRANSFORM _hdf5_version STRIP)
  list(JOIN _hdf5_version "." HDF5Serial_VERSION)
endif()

find_package_handle_standard_args(HDF5Serial REQUIRED_VARS HDF5Serial_LIBRARY HDF5Serial_INCLUDE_DIR
  VERSION_VAR HDF5Serial_VERSION REASON_FAILURE_MESSAGE "On Debian: apt-get install libhdf5-dev")
if(HDF5Serial_FOUND AND NOT TARGET HDF5Serial::HDF5Serial)
  add_library(HDF5Serial::HDF5Serial UNKNOWN IMPORTED)
  set_target_properties(HDF5Serial::HDF5Serial PROPERTIES IMPORTED_LOCATION ${HDF5Serial_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${HDF5Serial_INCLUDE_DIR})
endif()
