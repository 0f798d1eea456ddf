// SPDX-License-Identifier: Apache-2.0
#include "contact/io/hdf5_lazy.hpp"

#include <dlfcn.h>

#include <cerrno>
#include <new>
#include <stdexcept>
#include <string>

namespace perp::contact {
namespace {

[[noreturn]] void refuse_library() {
  if (errno == ENOMEM) throw std::bad_alloc();
  const char* why = dlerror();
  throw std::runtime_error("HDF5 files need HDF5's library " PERP_HDF5 " (Debian: libhdf5-103-1): " +
                           std::string(why != nullptr ? why : "it cannot be loaded"));
}

/// Stays loaded: its own clean-up runs when the process ends.
void* library() {
  static void* const loaded = [] {
    errno = 0;
    void* handle = dlopen(PERP_HDF5, RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) handle = dlopen(PERP_HDF5_PATH, RTLD_NOW | RTLD_LOCAL);  // as it was found for the build
    if (handle == nullptr) refuse_library();
    return handle;
  }();
  return loaded;
}

}  // namespace

void* hdf5_function(const char* name) {
  errno = 0;
  void* const found = dlsym(library(), name);
  if (found == nullptr) refuse_library();
  return found;
}

const hid_t* hdf5_id(const char* name) {
  const void* const found = dlsym(RTLD_DEFAULT, name);
  return static_cast<const hid_t*>(found != nullptr ? found : hdf5_function(name));
}

}  // namespace perp::contact
