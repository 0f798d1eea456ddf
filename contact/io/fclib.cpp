// SPDX-License-Identifier: Apache-2.0
#include "contact/io/fclib.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "contact/io/hdf5.hpp"
#include "contact/model/checks.hpp"
#include "contact/model/velocities.hpp"
#include "lcp/io/output_file.hpp"
#include "lcp/solve/schur.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

constexpr long long most_entries = std::numeric_limits<int>::max();

template <class... Parts>
[[noreturn]] void refuse(const std::string& path, const Parts&... parts) {
  refuse_input(path, ": ", parts...);
}

struct FclibMatrix {
  long long m = 0;
  long long n = 0;
  long long nzmax = 0;
  long long nz = -1;
  std::vector<long long> p{};
  std::vector<long long> i{};
  Vec x{};
};

void check_length(const char* name, std::size_t length, long long needed, const char* why) {
  if (static_cast<long long>(length) < needed) refuse_input(name, " has ", length, " entries, not ", needed, ": ", why);
}

void check_index(const char* name, long long k, long long value, long long below) {
  if (value < 0 || value >= below) refuse_input(name, "[", k, "] is ", value, ", not within 0 and ", below - 1);
}

class Entries {
 public:
  explicit Entries(const FclibMatrix& stored) : stored_(stored) {}

  SpMat matrix() {
    if (stored_.nz < -2) refuse_input("nz is ", stored_.nz, ", neither -1, -2 nor a number of triplets");
    if (stored_.nz >= 0)
      triplets();
    else
      compressed();
    SpMat A(stored_.m, stored_.n);
    A.setFromTriplets(entries_.begin(), entries_.end());
    return A;
  }

 private:
  void check_entries(long long count) {
    check_length("i", stored_.i.size(), count, "one an entry");
    check_length("x", static_cast<std::size_t>(stored_.x.size()), count, "one an entry");
    if (stored_.nzmax < count) refuse_input("nzmax is ", stored_.nzmax, ", below the number of entries, ", count);
    entries_.reserve(static_cast<std::size_t>(count));
  }

  void add(long long k, long long row, long long column) {
    const double x = stored_.x[static_cast<Index>(k)];
    if (!std::isfinite(x)) refuse_input("x[", k, "] is ", x);
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), x);
  }

  void triplets() {
    check_length("p", stored_.p.size(), stored_.nz, "one a triplet");
    check_entries(stored_.nz);
    for (long long k = 0; k < stored_.nz; ++k) {
      const auto at = static_cast<std::size_t>(k);
      check_index("i", k, stored_.i[at], stored_.m);
      check_index("p", k, stored_.p[at], stored_.n);
      add(k, stored_.i[at], stored_.p[at]);
    }
  }

  void compressed() {
    const bool columns = stored_.nz == -1;
    const long long count = columns ? stored_.n : stored_.m;
    const std::vector<long long>& p = stored_.p;
    check_length("p", p.size(), count + 1, columns ? "one a column and one more" : "one a row and one more");
    if (p[0] != 0) refuse_input("p[0] is ", p[0], ", not 0");
    for (std::size_t j = 1; j <= static_cast<std::size_t>(count); ++j)
      if (p[j] < p[j - 1]) refuse_input("p[", j, "] is ", p[j], ", below p[", j - 1, "] = ", p[j - 1]);
    check_entries(p[static_cast<std::size_t>(count)]);
    for (long long j = 0; j < count; ++j)
      for (long long k = p[static_cast<std::size_t>(j)]; k < p[static_cast<std::size_t>(j) + 1]; ++k) {
        const long long other = stored_.i[static_cast<std::size_t>(k)];
        check_index("i", k, other, columns ? stored_.m : stored_.n);
        add(k, columns ? other : j, columns ? j : other);
      }
  }

  const FclibMatrix& stored_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// The arrays are looked at before anything is allocated.
SpMat to_sparse(const FclibMatrix& stored, Index rows, Index columns) {
  if (stored.m != rows || stored.n != columns)
    refuse_input("m x n is ", stored.m, " x ", stored.n, ", but the vectors make it ", rows, " x ", columns);
  return Entries(stored).matrix();
}

void check(const FclibPoint& point, const Problem& problem) {
  const auto part = [](const char* name, const Vec& v, Index size) {
    if (v.size() > 0 && size >= 0 && v.size() != size)
      refuse_input("FCLIB file: ", name, " of a solution or guess has ", v.size(), " entries, not ", size);
    for (Index k = 0; k < v.size(); ++k)
      if (!std::isfinite(v[k])) refuse_input("FCLIB file: ", name, "[", k, "] of a solution or guess is ", v[k]);
  };
  const Global* g = problem.global.get();
  part("v", point.v, g != nullptr ? g->f.size() : -1);
  part("u", point.u, problem.q.size());
  part("r", point.r, problem.q.size());
  part("l", point.l, g != nullptr ? g->b.size() : -1);
}

/// Names the place in the file of what a part of it is refused for.
template <class Part>
auto at_path(const std::string& path, const Part& part) {
  try {
    return part();
  } catch (const std::invalid_argument& error) {
    refuse(path, error.what());
  }
}

class Reader : public Hdf5Reader {
 public:
  using Hdf5Reader::Hdf5Reader;

  long long integer(const std::string& path, long long least, long long greatest) {
    const std::vector<long long> values = integers(path);
    if (values.size() != 1) refuse(path, "has ", values.size(), " entries, not one");
    if (values[0] < least || values[0] > greatest)
      refuse(path, "is ", values[0], ", not within ", least, " and ", greatest);
    return values[0];
  }

  /// `size` numbers, all finite; any number of them if size < 0.
  Vec vector(const std::string& path, Index size = -1, const char* why = "") {
    Vec v = numbers(path);
    if (size >= 0 && v.size() != size) refuse(path, "has ", v.size(), " entries, not ", size, ": ", why);
    for (Index k = 0; k < v.size(); ++k)
      if (!std::isfinite(v[k])) refuse(path, "entry ", k, " is ", v[k]);
    return v;
  }

  SpMat matrix(const std::string& path, Index rows, Index columns) {
    FclibMatrix stored;
    stored.m = integer(path + "/m", 0, most_entries);
    stored.n = integer(path + "/n", 0, most_entries);
    stored.nzmax = integer(path + "/nzmax", 0, most_entries);
    stored.nz = integer(path + "/nz", -2, most_entries);
    stored.p = integers(path + "/p");
    stored.i = integers(path + "/i");
    stored.x = numbers(path + "/x");
    return at_path(path, [&] { return to_sparse(stored, rows, columns); });
  }
};

Vec friction(Reader& in, const std::string& path) {
  Vec mu = in.vector(path);
  for (Index a = 0; a < mu.size(); ++a)
    if (mu[a] < 0) refuse(path, "entry ", a, " is ", mu[a], ", a coefficient of friction below 0");
  return mu;
}

/// Eliminates lambda: W - V R^-1 V', q - V R^-1 s.
void eliminate(Reader& in, const std::string& root, Problem& p) {
  const Vec s = in.vector(root + "/vectors/s");
  const SpMat B = in.matrix(root + "/V", p.q.size(), s.size()).transpose();
  const auto R = std::make_shared<const lcp::RefinedLu>(in.matrix(root + "/R", s.size(), s.size()));
  std::optional<lcp::TwoPartVector> x;
  if (R->regular()) x = R->refined(lcp::TwoPartVector(s));
  const auto exact = std::make_shared<const lcp::SchurProduct>(R, B, -1, p.W.matrix());
  std::optional<SpMat> W;
  if (x) W = exact->matrix(0);
  if (!W) refuse(root + "/R", "is singular (reciprocal condition number ", R->rcond(), ")");
  p.rounding = rounding_by_lu(*R, B, x->value, p.q, p.W.diagonal());
  p.q = exact->offset(s, p.q);
  W->makeCompressed();
  p.W = Delassus(std::move(*W), exact);
}

constexpr const char* rolling = "_rolling";

void read_law(Reader& in, const std::string& root, Problem& p) {
  const bool rolls = root.ends_with(rolling);
  p.dimension = static_cast<int>(in.integer(root + "/spacedim", rolls ? 3 : 2, rolls ? 5 : 3));
  p.mu = friction(in, root + "/vectors/mu");
  if (rolls) p.mu_r = friction(in, root + "/vectors/mu_r");
  at_path(root + "/spacedim", [&] { check_rolling(p.dimension, p.mu, p.mu_r); });
}

Problem read_local(Reader& in, const std::string& root) {
  Problem p;
  read_law(in, root, p);
  p.q = in.vector(root + "/vectors/q", p.dimension * p.contacts(), "spacedim for each entry of mu");
  p.W = in.matrix(root + "/W", p.q.size(), p.q.size());
  if (in.has(root + "/V") || in.has(root + "/R")) eliminate(in, root, p);
  return p;
}

/// To be condensed: W and q are not filled.
Problem read_global(Reader& in, const std::string& root) {
  Problem p;
  Global g;
  read_law(in, root, p);
  g.w = in.vector(root + "/vectors/w", p.dimension * p.contacts(), "spacedim for each entry of mu");
  g.f = in.vector(root + "/vectors/f");
  g.M = in.matrix(root + "/M", g.f.size(), g.f.size());
  g.H = in.matrix(root + "/H", g.f.size(), g.w.size());
  if (in.has(root + "/G")) g.b = in.vector(root + "/vectors/b");
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

FclibPoint read_point(Reader& in, const std::string& path, const PointSizes& sizes) {
  const auto part = [&](const char* name, Index size) {
    const std::string at = path + "/" + name;
    return in.has_values(at) ? in.vector(at, size, "as many as the problem has") : Vec();
  };
  return {
      .v = part("v", sizes.v), .u = part("u", sizes.contacts), .r = part("r", sizes.contacts), .l = part("l", sizes.l)};
}

Fclib read_all(std::string_view content) {
  Reader in(content);
  std::string root;
  for (const char* name : {"/fclib_local", "/fclib_global", "/fclib_local_rolling", "/fclib_global_rolling"}) {
    if (!in.has(name)) continue;
    if (!root.empty()) refuse_input("has both ", root, " and ", name);
    root = name;
  }
  if (root.empty()) throw std::invalid_argument("has neither /fclib_local nor /fclib_global");
  Fclib out;
  const Problem& p = out.problem = root.starts_with("/fclib_local") ? read_local(in, root) : read_global(in, root);
  const std::string info = root + "/info/";
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
    if (!in.has(path)) refuse(path, "is missing, of ", guesses, " guesses");
    out.guesses.push_back(read_point(in, path, sizes));
  }
  return out;
}

// --- writing ---------------------------------------------------------------------------------------------------------

/// Writes a matrix by its columns, which are compressed.
void write_matrix(Hdf5Writer& out, const std::string& path, const SpMat& A) {
  out.integers(path + "/m", {A.rows()});
  out.integers(path + "/n", {A.cols()});
  out.integers(path + "/nzmax", {A.nonZeros()});
  out.integers(path + "/nz", {-1});
  out.integers(path + "/p", {A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1});
  out.integers(path + "/i", {A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros()});
  out.numbers(path + "/x", Eigen::Map<const Vec>(A.valuePtr(), A.nonZeros()));
}

void write_problem(Hdf5Writer& out, const Fclib& file, bool global) {
  const Problem& p = file.problem;
  const std::string root = std::string(global ? "/fclib_global" : "/fclib_local") + (p.rolls() ? rolling : "");
  out.integers(root + "/spacedim", {p.dimension});
  out.numbers(root + "/vectors/mu", p.mu);
  if (p.rolls()) out.numbers(root + "/vectors/mu_r", p.mu_r);
  if (global) {
    const Global& g = *p.global;
    write_matrix(out, root + "/M", g.M);
    write_matrix(out, root + "/H", g.H);
    if (g.G.cols() > 0) write_matrix(out, root + "/G", g.G);
    if (g.G.cols() > 0) out.numbers(root + "/vectors/b", g.b);
    out.numbers(root + "/vectors/f", g.f);
    out.numbers(root + "/vectors/w", g.w);
  } else {
    write_matrix(out, root + "/W", p.W.matrix());
    out.numbers(root + "/vectors/q", p.q);
  }
  out.text(root + "/info/title", file.title);
  out.text(root + "/info/description", file.description);
  out.text(root + "/info/math_info", file.math_info);
}

void write_point(Hdf5Writer& out, const std::string& path, const FclibPoint& point) {
  out.group(path);
  const auto part = [&](const char* name, const Vec& v) {
    if (v.size() > 0) out.numbers(path + "/" + name, v);
  };
  part("v", point.v);
  part("u", point.u);
  part("r", point.r);
  part("l", point.l);
}

}  // namespace

Fclib parse_fclib(std::string_view content, const std::string& name) {
  try {
    Fclib out = read_all(content);
    Problem& p = out.problem;
    const std::string group = p.global ? "/fclib_global" : "/fclib_local";
    at_path(group + (p.mu_r.size() > 0 ? "_rolling" : ""), [&] {
      if (p.global) p = condense(*p.global, p.mu, p.dimension, {}, p.mu_r);
      check(p);
    });
    p.name = name;
    return out;
  } catch (const std::invalid_argument& error) {
    throw lcp::FileError(name, 0, error.what());
  }
}

Fclib read_fclib(const std::string& path) { return parse_fclib(lcp::read_file(path), path); }

void write_fclib(const std::string& path, const Fclib& file, FclibForm form) {
  check(file.problem);
  if (file.solution) check(*file.solution, file.problem);
  for (const FclibPoint& guess : file.guesses) check(guess, file.problem);
  Hdf5Writer out;
  write_problem(out, file, form == FclibForm::Given && file.problem.global);
  if (file.solution) write_point(out, "/solution", *file.solution);
  if (!file.guesses.empty()) out.integers("/guesses/number_of_guesses", {static_cast<long long>(file.guesses.size())});
  for (std::size_t k = 0; k < file.guesses.size(); ++k)
    write_point(out, "/guesses/" + std::to_string(k + 1), file.guesses[k]);
  lcp::write_file(path, out.bytes());
}

}  // namespace perp::contact
