// SPDX-License-Identifier: Apache-2.0
#include "contact/io/fclib.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "contact/io/fclib_parts.hpp"
#include "contact/io/hdf5_check.hpp"
#include "contact/io/hdf5_lazy.hpp"
#include "contact/model/velocities.hpp"
#include "lcp/io/output_file.hpp"
#include "lcp/solve/schur.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using lcp::FileError;

constexpr long long most_entries = std::numeric_limits<int>::max();
/// Files in memory have a name as well, and HDF5 looks whether a file has it: none can.
constexpr const char* no_file = "/dev/null/none";
constexpr std::size_t longest_text = 1 << 16;

/// HDF5 for one thread at a time, silent, and with the caller's way of telling errors afterwards.
class Library {
 public:
  Library() : lock_(mutex()) {
    H5Eauto_is_v2(H5E_DEFAULT, &second_);
    if (second_ != 0) {
      H5Eget_auto2(H5E_DEFAULT, &tell2_, &data_);
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    } else {
      H5Eget_auto1(&tell1_, &data_);
      H5Eset_auto1(nullptr, nullptr);
    }
  }
  ~Library() {
    H5Eclear2(H5E_DEFAULT);
    if (second_ != 0)
      H5Eset_auto2(H5E_DEFAULT, tell2_, data_);
    else
      H5Eset_auto1(tell1_, data_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

 private:
  /// HDF5's state is the process's, and so is what guards it.
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  std::lock_guard<std::mutex> lock_;
  unsigned second_ = 0;
  H5E_auto2_t tell2_ = nullptr;
  H5E_auto1_t tell1_ = nullptr;
  void* data_ = nullptr;
};

/// Closes what it names.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id(hid_t id, Close close) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&&) = delete;
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;

  void reset(hid_t id) {
    if (id_ >= 0) close_(id_);
    id_ = id;
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

/// Files that are bytes in memory.
Id in_memory() {
  constexpr std::size_t growth = 1 << 16;
  Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access, growth, false);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  return access;
}

// --- reading ---------------------------------------------------------------------------------------------------------

class Reader {
 public:
  Reader(std::string_view content, const std::string& name) : name_(name), bytes_(content.size()) {
    const Id access = in_memory();
    std::string image(content);  // H5Pset_file_image does not write to it, but does not say so
    H5Pset_file_image(access, image.data(), image.size());
    file_ = H5Fopen(no_file, H5F_ACC_RDONLY, access);
    if (file_ < 0) throw FileError(name, 0, "HDF5 cannot open it: no HDF5 file, damaged or cut short");
  }
  ~Reader() { H5Fclose(file_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  template <class... Parts>
  [[noreturn]] void refuse(const std::string& path, const Parts&... parts) const {
    throw FileError(name_, 0, text_of(path, ": ", parts...));
  }

  /// Whether there is a group or dataset. Links out of the file are refused.
  bool has(const std::string& path) const {
    for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
      const std::string part = path.substr(0, end);
      if (H5Lexists(file_, part.c_str(), H5P_DEFAULT) <= 0) return false;
      H5L_info_t link;
      if (H5Lget_info(file_, part.c_str(), &link, H5P_DEFAULT) < 0) refuse(part, "cannot be read");
      if (link.type != H5L_TYPE_HARD) refuse(part, "is a symbolic or external link");
      if (end == std::string::npos) return true;
    }
  }

  /// Whether there is a dataset that has been written: some files announce solutions that nobody stored.
  bool has_values(const std::string& path) const {
    if (!has(path)) return false;
    const Id data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    return !data.good() || H5Dget_storage_size(data) > 0;
  }

  long long integer(const std::string& path, long long least, long long greatest) const {
    const std::vector<long long> values = integers(path);
    if (values.size() != 1) refuse(path, "has ", values.size(), " entries, not one");
    if (values[0] < least || values[0] > greatest)
      refuse(path, "is ", values[0], ", not within ", least, " and ", greatest);
    return values[0];
  }

  std::vector<long long> integers(const std::string& path) const {
    const Id data = open(path, {H5T_STD_I32LE, H5T_STD_I64LE, H5T_STD_U32LE, H5T_STD_I32BE, H5T_STD_I64BE},
                         "32- or 64-bit integers");
    std::vector<long long> values(entries(data, path));
    if (!values.empty() && H5Dread(data, H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      refuse(path, "cannot be read: the file is damaged or cut short");
    return values;
  }

  Vec numbers(const std::string& path) const {
    const Id data =
        open(path, {H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_IEEE_F64BE, H5T_IEEE_F32BE}, "32- or 64-bit floating point");
    Vec values(static_cast<Index>(entries(data, path)));
    if (values.size() > 0 && H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      refuse(path, "cannot be read: the file is damaged or cut short");
    return values;
  }

  /// `size` numbers, all finite; any number of them if size < 0.
  Vec vector(const std::string& path, Index size, const char* why) const {
    Vec v = numbers(path);
    if (size >= 0 && v.size() != size) refuse(path, "has ", v.size(), " entries, not ", size, ": ", why);
    for (Index k = 0; k < v.size(); ++k)
      if (!std::isfinite(v[k])) refuse(path, "entry ", k, " is ", v[k]);
    return v;
  }

  /// Empty where there is none, or none of a fixed length.
  std::string text(const std::string& path) const {
    if (!has(path)) return {};
    const Id data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) return {};
    const Id type(H5Dget_type(data), H5Tclose);
    const Id space(H5Dget_space(data), H5Sclose);
    if (!type.good() || !space.good() || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) return {};
    const std::size_t size = H5Tget_size(type);
    if (size == 0 || size > longest_text || H5Sget_simple_extent_npoints(space) != 1 || !plain(data)) return {};
    std::string text(size, '\0');
    if (H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) return {};
    text.resize(std::min(text.size(), text.find('\0')));
    return text;
  }

  SpMat matrix(const std::string& path, Index rows, Index columns) const {
    FclibMatrix stored;
    stored.m = integer(path + "/m", 0, most_entries);
    stored.n = integer(path + "/n", 0, most_entries);
    stored.nzmax = integer(path + "/nzmax", 0, most_entries);
    stored.nz = integer(path + "/nz", -2, most_entries);
    stored.p = integers(path + "/p");
    stored.i = integers(path + "/i");
    stored.x = numbers(path + "/x");
    try {
      return to_sparse(stored, rows, columns);
    } catch (const std::invalid_argument& error) {
      refuse(path, error.what());
    }
  }

 private:
  /// Stored in the file as it is: nothing to unpack, no other file.
  static bool plain(hid_t data) {
    const Id made(H5Dget_create_plist(data), H5Pclose);
    if (!made.good()) return false;
    const H5D_layout_t layout = H5Pget_layout(made);
    return (layout == H5D_CONTIGUOUS || layout == H5D_COMPACT) && H5Pget_nfilters(made) == 0 &&
           H5Pget_external_count(made) == 0;
  }

  Id open(const std::string& path, std::initializer_list<hid_t> types, const char* wanted) const {
    if (!has(path)) refuse(path, "is missing");
    Id data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(path, "is no dataset, or damaged");
    const Id type(H5Dget_type(data), H5Tclose);
    if (!type.good() ||
        std::none_of(types.begin(), types.end(), [&](hid_t known) { return H5Tequal(type, known) > 0; }))
      refuse(path, "is of another type than ", wanted);
    if (!plain(data)) refuse(path, "is chunked, compressed or outside of the file (h5repack -f NONE -l CONTI unpacks)");
    return data;
  }

  /// Not more than the file has bytes for.
  std::size_t entries(hid_t data, const std::string& path) const {
    const Id space(H5Dget_space(data), H5Sclose);
    const Id type(H5Dget_type(data), H5Tclose);
    const int rank = space.good() ? H5Sget_simple_extent_ndims(space) : -1;
    if (rank != 0 && rank != 1) refuse(path, "has ", rank, " dimensions, not one");
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const std::size_t size = H5Tget_size(type);
    if (count < 0 || size == 0 || static_cast<hsize_t>(count) > bytes_ / size ||
        (count > 0 && H5Dget_storage_size(data) < static_cast<hsize_t>(count) * size))
      refuse(path, "has ", count, " entries, more than the file holds");
    return static_cast<std::size_t>(count);
  }

  const std::string& name_;
  std::size_t bytes_;
  hid_t file_ = -1;
};

Vec friction(const Reader& in, const std::string& path) {
  Vec mu = in.vector(path, -1, "");
  for (Index a = 0; a < mu.size(); ++a)
    if (mu[a] < 0) in.refuse(path, "entry ", a, " is ", mu[a], ", a coefficient of friction below 0");
  return mu;
}

/// Eliminates lambda: W - V R^-1 V', q - V R^-1 s.
void eliminate(const Reader& in, Problem& p) {
  const std::string root = "/fclib_local";
  const Vec s = in.vector(root + "/vectors/s", -1, "");
  const SpMat B = in.matrix(root + "/V", p.q.size(), s.size()).transpose();
  const auto R = std::make_shared<const lcp::RefinedLu>(in.matrix(root + "/R", s.size(), s.size()));
  std::optional<lcp::TwoPartVector> x;
  if (R->regular()) x = R->refined(lcp::TwoPartVector(s));
  const auto exact = std::make_shared<const lcp::SchurProduct>(R, B, -1, p.W.matrix());
  std::optional<SpMat> W;
  if (x) W = exact->matrix(0);
  if (!W) in.refuse(root + "/R", "is singular (reciprocal condition number ", R->rcond(), ")");
  p.rounding = rounding_by_lu(*R, B, x->value, p.q, p.W.diagonal());
  p.q = exact->offset(s, p.q);
  W->makeCompressed();
  p.W = Delassus(std::move(*W), exact);
}

Problem read_local(const Reader& in) {
  const std::string root = "/fclib_local";
  Problem p;
  p.dimension = static_cast<int>(in.integer(root + "/spacedim", 2, 3));
  p.mu = friction(in, root + "/vectors/mu");
  p.q = in.vector(root + "/vectors/q", p.dimension * p.contacts(), "spacedim for each entry of mu");
  p.W = in.matrix(root + "/W", p.q.size(), p.q.size());
  if (in.has(root + "/V") || in.has(root + "/R")) eliminate(in, p);
  return p;
}

/// To be condensed: W and q are not filled.
Problem read_global(const Reader& in) {
  const std::string root = "/fclib_global";
  Problem p;
  Global g;
  p.dimension = static_cast<int>(in.integer(root + "/spacedim", 2, 3));
  p.mu = friction(in, root + "/vectors/mu");
  g.w = in.vector(root + "/vectors/w", p.dimension * p.contacts(), "spacedim for each entry of mu");
  g.f = in.vector(root + "/vectors/f", -1, "");
  g.M = in.matrix(root + "/M", g.f.size(), g.f.size());
  g.H = in.matrix(root + "/H", g.f.size(), g.w.size());
  if (in.has(root + "/G")) g.b = in.vector(root + "/vectors/b", -1, "");
  g.G = g.b.size() > 0 ? in.matrix(root + "/G", g.f.size(), g.b.size()) : SpMat(g.f.size(), 0);
  p.global = std::make_shared<const Global>(std::move(g));
  return p;
}

/// Sizes of v and l where they are known, else -1.
struct PointSizes {
  Index v = -1;
  Index contacts = 0;
  Index l = -1;
};

FclibPoint read_point(const Reader& in, const std::string& path, const PointSizes& sizes) {
  const auto part = [&](const char* name, Index size) {
    const std::string at = path + "/" + name;
    return in.has_values(at) ? in.vector(at, size, "as many as the problem has") : Vec();
  };
  return {
      .v = part("v", sizes.v), .u = part("u", sizes.contacts), .r = part("r", sizes.contacts), .l = part("l", sizes.l)};
}

Fclib read_all(std::string_view content, const std::string& name) {
  const Library hdf5;
  const Reader in(content, name);
  const bool local = in.has("/fclib_local");
  if (local && in.has("/fclib_global")) throw FileError(name, 0, "has both /fclib_local and /fclib_global");
  if (!local && !in.has("/fclib_global")) throw FileError(name, 0, "has neither /fclib_local nor /fclib_global");
  Fclib out;
  const Problem& p = out.problem = local ? read_local(in) : read_global(in);
  const std::string info = local ? "/fclib_local/info/" : "/fclib_global/info/";
  out.title = in.text(info + "title");
  out.description = in.text(info + "description");
  out.math_info = in.text(info + "math_info");
  PointSizes sizes{.contacts = p.dimension * p.contacts()};
  if (p.global) {
    sizes.v = p.global->f.size();
    sizes.l = p.global->b.size();
  }
  if (in.has("/solution")) out.solution = read_point(in, "/solution", sizes);
  const long long guesses = in.has("/guesses") ? in.integer("/guesses/number_of_guesses", 0, most_entries) : 0;
  for (long long k = 1; k <= guesses; ++k) {
    const std::string path = "/guesses/" + std::to_string(k);
    if (!in.has(path)) in.refuse(path, "is missing, of ", guesses, " guesses");
    out.guesses.push_back(read_point(in, path, sizes));
  }
  return out;
}

// --- writing ---------------------------------------------------------------------------------------------------------

class Writer {
 public:
  Writer()
      : made_(H5Pcreate(H5P_DATASET_CREATE), H5Pclose),
        group_(H5Pcreate(H5P_GROUP_CREATE), H5Pclose),
        file_(-1, H5Fclose) {
    // No times: the same problem gives the same bytes.
    H5Pset_obj_track_times(made_, false);
    H5Pset_obj_track_times(group_, false);
    const Id access = in_memory();
    const Id create(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(create, false);
    file_.reset(H5Fcreate(no_file, H5F_ACC_TRUNC, create, access));
    demand(file_.good());
  }

  void group(const std::string& path) const {
    const Id id(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, group_, H5P_DEFAULT), H5Gclose);
    demand(id.good());
  }
  void integers(const std::string& path, const std::vector<long long>& values) const {
    write(path, H5T_STD_I32LE, H5T_NATIVE_LLONG, values.size(), values.data());
  }
  void integer(const std::string& path, long long value) const { integers(path, {value}); }
  void vector(const std::string& path, const Vec& v) const {
    write(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, static_cast<std::size_t>(v.size()), v.data());
  }
  void text(const std::string& path, const std::string& text) const {
    const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, text.size() + 1);
    const Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Id data(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, made_, H5P_DEFAULT), H5Dclose);
    demand(data.good() && H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0);
  }
  void matrix(const std::string& path, const SpMat& A) const {
    const FclibMatrix stored = to_fclib(A);
    group(path);
    integer(path + "/m", stored.m);
    integer(path + "/n", stored.n);
    integer(path + "/nzmax", stored.nzmax);
    integer(path + "/nz", stored.nz);
    integers(path + "/p", stored.p);
    integers(path + "/i", stored.i);
    vector(path + "/x", stored.x);
  }

  std::string bytes() const {
    demand(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0);
    const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
    demand(size > 0);
    std::string out(static_cast<std::size_t>(size), '\0');
    demand(H5Fget_file_image(file_, out.data(), out.size()) == size);
    return out;
  }

 private:
  /// In memory only that can be missing.
  static void demand(bool good) {
    if (!good) throw std::bad_alloc();
  }
  void write(const std::string& path, hid_t stored, hid_t native, std::size_t count, const void* values) const {
    const std::array<hsize_t, 1> size{count};
    const Id space(H5Screate_simple(1, size.data(), nullptr), H5Sclose);
    const Id data(H5Dcreate2(file_, path.c_str(), stored, space, H5P_DEFAULT, made_, H5P_DEFAULT), H5Dclose);
    demand(data.good());
    if (count > 0) demand(H5Dwrite(data, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  }

  Id made_;
  Id group_;
  Id file_;
};

void write_problem(const Writer& out, const Fclib& file, bool global) {
  const Problem& p = file.problem;
  const std::string root = global ? "/fclib_global" : "/fclib_local";
  out.group(root);
  out.integer(root + "/spacedim", p.dimension);
  out.group(root + "/vectors");
  out.vector(root + "/vectors/mu", p.mu);
  if (global) {
    const Global& g = *p.global;
    out.matrix(root + "/M", g.M);
    out.matrix(root + "/H", g.H);
    if (g.G.cols() > 0) out.matrix(root + "/G", g.G);
    if (g.G.cols() > 0) out.vector(root + "/vectors/b", g.b);
    out.vector(root + "/vectors/f", g.f);
    out.vector(root + "/vectors/w", g.w);
  } else {
    out.matrix(root + "/W", p.W.matrix());
    out.vector(root + "/vectors/q", p.q);
  }
  out.group(root + "/info");
  out.text(root + "/info/title", file.title);
  out.text(root + "/info/description", file.description);
  out.text(root + "/info/math_info", file.math_info);
}

void write_point(const Writer& out, const std::string& path, const FclibPoint& point) {
  out.group(path);
  const auto part = [&](const char* name, const Vec& v) {
    if (v.size() > 0) out.vector(path + "/" + name, v);
  };
  part("v", point.v);
  part("u", point.u);
  part("r", point.r);
  part("l", point.l);
}

}  // namespace

Fclib parse_fclib(std::string_view content, const std::string& name) {
  try {
    check_hdf5(content);
  } catch (const std::invalid_argument& error) {
    throw FileError(name, 0, std::string("no HDF5 file, damaged or cut short: ") + error.what());
  }
  Fclib out = read_all(content, name);
  Problem& p = out.problem;
  try {
    if (p.global) p = condense(*p.global, p.mu, p.dimension);
    p.name = name;
    check(p);
  } catch (const std::invalid_argument& error) {
    throw FileError(name, 0, (p.global ? "/fclib_global: " : "/fclib_local: ") + std::string(error.what()));
  }
  return out;
}

Fclib read_fclib(const std::string& path) { return parse_fclib(lcp::read_file(path), path); }

void write_fclib(const std::string& path, const Fclib& file, FclibForm form) {
  check(file.problem);
  if (file.solution) check(*file.solution, file.problem);
  for (const FclibPoint& guess : file.guesses) check(guess, file.problem);
  std::string bytes;
  {
    const Library hdf5;
    const Writer out;
    write_problem(out, file, form == FclibForm::Given && file.problem.global);
    if (file.solution) write_point(out, "/solution", *file.solution);
    if (!file.guesses.empty()) {
      out.group("/guesses");
      out.integer("/guesses/number_of_guesses", static_cast<long long>(file.guesses.size()));
      for (std::size_t k = 0; k < file.guesses.size(); ++k)
        write_point(out, "/guesses/" + std::to_string(k + 1), file.guesses[k]);
    }
    bytes = out.bytes();
  }
  lcp::write_file(path, bytes);
}

}  // namespace perp::contact
