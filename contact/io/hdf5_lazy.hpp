// SPDX-License-Identifier: Apache-2.0
#pragma once
/// HDF5's functions and types under their own names, from a library that is loaded with the first use of one: it needs
/// sixty others, which is most of a program's start, and problems in HDF5 files are few. Each throws std::runtime_error
/// where the library cannot be loaded, std::bad_alloc where memory is short. Private to contact/.
#include <hdf5.h>

#include <atomic>

// In H5F_ACC_RDONLY and its like: ends the process where the library is another release with the same interface.
#undef H5CHECK
#define H5CHECK

namespace perp::contact {

void* hdf5_function(const char* name);
/// The address of the variable: of the program's copy where it has one, because it is linked with HDF5 itself.
const hid_t* hdf5_id(const char* name);

/// Stands for the function F, called or as its address.
template <class F>
class Hdf5Function {
 public:
  explicit constexpr Hdf5Function(const char* name) : name_(name) {}
  operator F*() const {  // NOLINT(google-explicit-constructor): a function is its address
    F* found = found_.load(std::memory_order_acquire);
    if (found == nullptr) {
      found = reinterpret_cast<F*>(hdf5_function(name_));
      found_.store(found, std::memory_order_release);
    }
    return found;
  }

 private:
  const char* name_;
  mutable std::atomic<F*> found_{nullptr};
};

/// Stands for the variable of HDF5 that H5open() sets: the macros of hdf5.h call it before.
class Hdf5Id {
 public:
  explicit constexpr Hdf5Id(const char* name) : name_(name) {}
  operator hid_t() const {  // NOLINT(google-explicit-constructor)
    return *hdf5_id(name_);
  }

 private:
  const char* name_;
};

#define PERP_HDF5_FUNCTION(name) inline constinit const Hdf5Function<decltype(::name)> name(#name);
#define PERP_HDF5_ID(name) inline constinit const Hdf5Id name(#name);

PERP_HDF5_FUNCTION(H5Dclose)
PERP_HDF5_FUNCTION(H5Dcreate2)
PERP_HDF5_FUNCTION(H5Dget_create_plist)
PERP_HDF5_FUNCTION(H5Dget_space)
PERP_HDF5_FUNCTION(H5Dget_storage_size)
PERP_HDF5_FUNCTION(H5Dget_type)
PERP_HDF5_FUNCTION(H5Dopen2)
PERP_HDF5_FUNCTION(H5Dread)
PERP_HDF5_FUNCTION(H5Dwrite)
PERP_HDF5_FUNCTION(H5Eauto_is_v2)
PERP_HDF5_FUNCTION(H5Eclear2)
PERP_HDF5_FUNCTION(H5Eget_auto1)
PERP_HDF5_FUNCTION(H5Eget_auto2)
PERP_HDF5_FUNCTION(H5Eset_auto1)
PERP_HDF5_FUNCTION(H5Eset_auto2)
PERP_HDF5_FUNCTION(H5Fclose)
PERP_HDF5_FUNCTION(H5Fcreate)
PERP_HDF5_FUNCTION(H5Fflush)
PERP_HDF5_FUNCTION(H5Fget_file_image)
PERP_HDF5_FUNCTION(H5Fopen)
PERP_HDF5_FUNCTION(H5Gclose)
PERP_HDF5_FUNCTION(H5Gcreate2)
PERP_HDF5_FUNCTION(H5Lexists)
PERP_HDF5_FUNCTION(H5Lget_info)
PERP_HDF5_FUNCTION(H5Pclose)
PERP_HDF5_FUNCTION(H5Pcreate)
PERP_HDF5_FUNCTION(H5Pget_external_count)
PERP_HDF5_FUNCTION(H5Pget_layout)
PERP_HDF5_FUNCTION(H5Pget_nfilters)
PERP_HDF5_FUNCTION(H5Pset_fapl_core)
PERP_HDF5_FUNCTION(H5Pset_fclose_degree)
PERP_HDF5_FUNCTION(H5Pset_file_image)
PERP_HDF5_FUNCTION(H5Pset_obj_track_times)
PERP_HDF5_FUNCTION(H5Sclose)
PERP_HDF5_FUNCTION(H5Screate)
PERP_HDF5_FUNCTION(H5Screate_simple)
PERP_HDF5_FUNCTION(H5Sget_simple_extent_ndims)
PERP_HDF5_FUNCTION(H5Sget_simple_extent_npoints)
PERP_HDF5_FUNCTION(H5Tclose)
PERP_HDF5_FUNCTION(H5Tcopy)
PERP_HDF5_FUNCTION(H5Tequal)
PERP_HDF5_FUNCTION(H5Tget_class)
PERP_HDF5_FUNCTION(H5Tget_size)
PERP_HDF5_FUNCTION(H5Tis_variable_str)
PERP_HDF5_FUNCTION(H5Tset_size)
PERP_HDF5_FUNCTION(H5open)
PERP_HDF5_ID(H5P_CLS_DATASET_CREATE_ID_g)
PERP_HDF5_ID(H5P_CLS_FILE_ACCESS_ID_g)
PERP_HDF5_ID(H5P_CLS_FILE_CREATE_ID_g)
PERP_HDF5_ID(H5P_CLS_GROUP_CREATE_ID_g)
PERP_HDF5_ID(H5T_C_S1_g)
PERP_HDF5_ID(H5T_IEEE_F32BE_g)
PERP_HDF5_ID(H5T_IEEE_F32LE_g)
PERP_HDF5_ID(H5T_IEEE_F64BE_g)
PERP_HDF5_ID(H5T_IEEE_F64LE_g)
PERP_HDF5_ID(H5T_NATIVE_DOUBLE_g)
PERP_HDF5_ID(H5T_NATIVE_LLONG_g)
PERP_HDF5_ID(H5T_STD_I32BE_g)
PERP_HDF5_ID(H5T_STD_I32LE_g)
PERP_HDF5_ID(H5T_STD_I64BE_g)
PERP_HDF5_ID(H5T_STD_I64LE_g)
PERP_HDF5_ID(H5T_STD_U32LE_g)

#undef PERP_HDF5_FUNCTION
#undef PERP_HDF5_ID

}  // namespace perp::contact
