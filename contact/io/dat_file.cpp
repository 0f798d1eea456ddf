// SPDX-License-Identifier: Apache-2.0
#include "contact/io/dat_file.hpp"

#include <limits>
#include <utility>

#include "lcp/io/siconos_matrix.hpp"

namespace perp::contact {
namespace {

using lcp::Numbers;
using lcp::SiconosMatrix;

constexpr Index most_rows = std::numeric_limits<int>::max();

Vec friction(Numbers& in, const char* name, const char* what, Index n) {
  in.expect(name, n, 1);
  Vec mu(n);
  for (Index a = 0; a < n; ++a) {
    mu[a] = in.number(name);
    if (mu[a] < 0) in.refuse("the coefficient of ", what, " of contact ", a, " is ", mu[a]);
  }
  return mu;
}
Vec sliding_friction(Numbers& in, Index n) { return friction(in, "mu", "friction", n); }

/// Reads mu_r of contacts of 5 entries, and of 3 where it is there, and the contacts roll in 2D. A single 0 or 1 is the
/// flag.
Vec rolling_friction(Numbers& in, int d, Index n) {
  const bool flag = in.left() == 1 && (in.next_is("0") || in.next_is("1"));
  if (d == 5 || (d == 3 && n > 0 && in.left() >= n && !flag)) return friction(in, "mu_r", "rolling friction", n);
  return {};
}

void end(Numbers& in) {
  if (in.left() > 0) in.integer("the flag at the end", 0, 1);
  if (in.left() > 0) in.refuse(in.left(), " numbers too many");
}

Problem read_global(Numbers& in, Global g, Index n, int d, const std::string& name) {
  const Index m = g.M.rows();
  if (g.M.cols() != m) in.refuse("M is ", m, " x ", g.M.cols(), ", not square");
  SiconosMatrix H(in, "H");
  if (H.rows() != m || H.columns() != d * n)
    in.refuse("H is ", H.rows(), " x ", H.columns(), ", not ", m, " x ", d * n);
  g.H = H.entries();
  g.f = in.vector("f", m);
  g.w = in.vector("w", d * n);
  const Vec mu = sliding_friction(in, n);
  const Vec mu_r = rolling_friction(in, d, n);
  end(in);
  g.G = SpMat(m, 0);
  g.b = Vec(0);
  try {
    return condense(std::move(g), mu, d, name, mu_r);
  } catch (const std::invalid_argument& error) {
    in.refuse(error.what());
  }
}

}  // namespace

Problem parse_dat(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const auto d = static_cast<int>(in.integer("the dimension", 2, 5));
  if (d == 4) in.refuse("the dimension is 4; contacts have 2 or 3 entries, with rolling friction 3 or 5");
  const Index n = in.integer("the number of contacts", 0, most_rows / d);
  in.expect("mu", n, 1);
  SiconosMatrix first(in, "the first matrix, W or M,");
  SpMat A = first.entries();
  // A global problem has more to come: at least the head of H, f and w.
  if (in.left() > d * n + 2 * n + 1 || first.rows() != d * n) {
    Global g;
    g.M.swap(A);
    return read_global(in, std::move(g), n, d, name);
  }
  if (first.columns() != d * n) in.refuse("W is ", first.rows(), " x ", first.columns(), ", not ", d * n, " x ", d * n);
  Problem p{.dimension = d, .name = name};
  p.W = std::move(A);
  p.q = in.vector("q", d * n);
  p.mu = sliding_friction(in, n);
  p.mu_r = rolling_friction(in, d, n);
  end(in);
  return p;
}

Problem read_dat(const std::string& path) { return parse_dat(lcp::read_file(path), path); }

}  // namespace perp::contact
