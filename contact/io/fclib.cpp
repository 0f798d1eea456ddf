// SPDX-License-Identifier: Apache-2.0
#include "contact/io/fclib.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "contact/io/fclib_parts.hpp"
#include "contact/io/hdf5.hpp"
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
void eliminate(Reader& in, Problem& p) {
  const std::string root = "/fclib_local";
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

Problem read_local(Reader& in) {
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
Problem read_global(Reader& in) {
  const std::string root = "/fclib_global";
  Problem p;
  Global g;
  p.dimension = static_cast<int>(in.integer(root + "/spacedim", 2, 3));
  p.mu = friction(in, root + "/vectors/mu");
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
  const bool local = in.has("/fclib_local");
  if (local && in.has("/fclib_global")) throw std::invalid_argument("has both /fclib_local and /fclib_global");
  if (!local && !in.has("/fclib_global")) throw std::invalid_argument("has neither /fclib_local nor /fclib_global");
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
    if (!in.has(path)) refuse(path, "is missing, of ", guesses, " guesses");
    out.guesses.push_back(read_point(in, path, sizes));
  }
  return out;
}

// --- writing ---------------------------------------------------------------------------------------------------------

void write_matrix(Hdf5Writer& out, const std::string& path, const SpMat& A) {
  const FclibMatrix stored = to_fclib(A);
  out.integers(path + "/m", {stored.m});
  out.integers(path + "/n", {stored.n});
  out.integers(path + "/nzmax", {stored.nzmax});
  out.integers(path + "/nz", {stored.nz});
  out.integers(path + "/p", stored.p);
  out.integers(path + "/i", stored.i);
  out.numbers(path + "/x", stored.x);
}

void write_problem(Hdf5Writer& out, const Fclib& file, bool global) {
  const Problem& p = file.problem;
  const std::string root = global ? "/fclib_global" : "/fclib_local";
  out.integers(root + "/spacedim", {p.dimension});
  out.numbers(root + "/vectors/mu", p.mu);
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
    at_path(p.global ? "/fclib_global" : "/fclib_local", [&] {
      if (p.global) p = condense(*p.global, p.mu, p.dimension);
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
