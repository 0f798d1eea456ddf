// SPDX-License-Identifier: Apache-2.0
#pragma once
/// FCLIB files of any content, also bad, made with HDF5 itself and not with the library's writer.
#include <hdf5.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "contact/io/fclib.hpp"
#include "lcp/io/file_error.hpp"
#include "support/matrices.hpp"

namespace perp::contact {

/// A temporary folder.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("perp_contact_" + std::to_string(getpid()) + "_" + std::to_string(made++))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directory(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::size_t files() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(path_)) ++count;
    return count;
  }

 private:
  static inline std::atomic<int> made = 0;
  std::filesystem::path path_;
};

using Ints = std::vector<int>;
using Longs = std::vector<long long>;
using Doubles = std::vector<double>;
using Floats = std::vector<float>;
/// Datasets by their paths; a text is one of fixed length.
using Datasets = std::map<std::string, std::variant<Ints, Longs, Doubles, Floats, std::string>>;

enum class Storage { Contiguous, Compact, Chunked, Compressed, TwoDimensions, NeverWritten };

class RawFile {
 public:
  explicit RawFile(const std::string& path, hid_t access = H5P_DEFAULT)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)) {
    if (file_ < 0) throw std::runtime_error("HDF5 does not make " + path);
  }
  ~RawFile() { H5Fclose(file_); }
  RawFile(const RawFile&) = delete;
  RawFile& operator=(const RawFile&) = delete;

  hid_t id() const { return file_; }

  void write(const Datasets& datasets) {
    for (const auto& one : datasets) std::visit([&](const auto& v) { write(one.first, v); }, one.second);
  }
  void write(const std::string& path, const Ints& v, Storage as = Storage::Contiguous) {
    write(path, H5T_STD_I32LE, H5T_NATIVE_INT, v.size(), v.data(), as);
  }
  void write(const std::string& path, const Longs& v, Storage as = Storage::Contiguous) {
    write(path, H5T_STD_I64BE, H5T_NATIVE_LLONG, v.size(), v.data(), as);
  }
  void write(const std::string& path, const Doubles& v, Storage as = Storage::Contiguous) {
    write(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, v.size(), v.data(), as);
  }
  void write(const std::string& path, const Floats& v, Storage as = Storage::Contiguous) {
    write(path, H5T_IEEE_F32BE, H5T_NATIVE_FLOAT, v.size(), v.data(), as);
  }
  void write(const std::string& path, const std::string& text) {
    groups(path);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, text.size() + 1);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t data = H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str());
    H5Dclose(data);
    H5Sclose(space);
    H5Tclose(type);
  }
  /// The groups above `path`.
  void groups(const std::string& path) {
    for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1))
      if (made_.insert(path.substr(0, end)).second)
        H5Gclose(H5Gcreate2(file_, path.substr(0, end).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }

 private:
  void write(const std::string& path, hid_t stored, hid_t native, std::size_t n, const void* values, Storage as) {
    groups(path);
    const bool two = as == Storage::TwoDimensions;
    const hsize_t size[] = {n, 1};
    const hid_t space = H5Screate_simple(two ? 2 : 1, size, nullptr);
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    if (as == Storage::Compact) H5Pset_layout(made, H5D_COMPACT);
    if (as == Storage::Chunked || as == Storage::Compressed) H5Pset_chunk(made, 1, size);
    if (as == Storage::Compressed) H5Pset_deflate(made, 9);
    const hid_t data = H5Dcreate2(file_, path.c_str(), stored, space, H5P_DEFAULT, made, H5P_DEFAULT);
    if (n > 0 && as != Storage::NeverWritten) H5Dwrite(data, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(data);
    H5Pclose(made);
    H5Sclose(space);
  }

  hid_t file_;
  std::set<std::string> made_;
};

/// One contact in 2D: W = [2 1; 1 3] with a stored zero, by compressed rows; nzmax and the arrays longer than used.
inline Datasets small_local() {
  return {{"/fclib_local/spacedim", Ints{2}},
          {"/fclib_local/W/m", Ints{2}},
          {"/fclib_local/W/n", Ints{2}},
          {"/fclib_local/W/nzmax", Ints{6}},
          {"/fclib_local/W/nz", Ints{-2}},
          {"/fclib_local/W/p", Ints{0, 2, 4}},
          {"/fclib_local/W/i", Ints{0, 1, 0, 1, 77, -5}},
          {"/fclib_local/W/x", Doubles{2, 1, 1, 3, 0, 0}},
          {"/fclib_local/vectors/q", Doubles{-1, 4}},
          {"/fclib_local/vectors/mu", Doubles{0.5}},
          {"/fclib_local/info/title", std::string("a title")},
          {"/solution/r", Doubles{1, -0.5}},
          {"/solution/u", Doubles{0.5, 3}},
          {"/guesses/number_of_guesses", Ints{1}},
          {"/guesses/1/r", Doubles{0.25, 0}}};
}

/// One contact in 2D on a body of two velocities, M = diag(2, 4), H = [1 3; 2 4] as triplets, p columns and i rows.
inline Datasets small_global() {
  return {{"/fclib_global/spacedim", Ints{2}},
          {"/fclib_global/M/m", Ints{2}},
          {"/fclib_global/M/n", Ints{2}},
          {"/fclib_global/M/nzmax", Ints{2}},
          {"/fclib_global/M/nz", Ints{-1}},
          {"/fclib_global/M/p", Ints{0, 1, 2}},
          {"/fclib_global/M/i", Ints{0, 1}},
          {"/fclib_global/M/x", Doubles{2, 4}},
          {"/fclib_global/H/m", Ints{2}},
          {"/fclib_global/H/n", Ints{2}},
          {"/fclib_global/H/nzmax", Ints{9}},
          {"/fclib_global/H/nz", Ints{5}},
          {"/fclib_global/H/p", Ints{0, 0, 1, 1, 1}},
          {"/fclib_global/H/i", Ints{0, 1, 0, 1, 1}},
          {"/fclib_global/H/x", Doubles{1, 2, 3, 1, 3}},
          {"/fclib_global/vectors/f", Doubles{2, 4}},
          {"/fclib_global/vectors/w", Doubles{10, 20}},
          {"/fclib_global/vectors/mu", Doubles{0.5}}};
}

/// The bytes of a file with these datasets.
inline std::string bytes_of(const Datasets& datasets) {
  const Folder folder;
  const std::string path = folder / "raw.hdf5";
  RawFile(path).write(datasets);
  return lcp::read_file(path);
}

inline Problem parse_small() { return parse_fclib(bytes_of(small_local()), "small").problem; }

}  // namespace perp::contact
