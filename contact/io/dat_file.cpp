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

Vec friction(Numbers& in, Index n) {
  in.expect("mu", n, 1);
  Vec mu(n);
  for (Index a = 0; a < n; ++a) {
    mu[a] = in.number("mu");
    if (mu[a] < 0) in.refuse("the coefficient of friction of contact ", a, " is ", mu[a]);
  }
  return mu;
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
  const Vec mu = friction(in, n);
  end(in);
  g.G = SpMat(m, 0);
  g.b = Vec(0);
  try {
    return condense(std::move(g), mu, d, name);
  } catch (const std::invalid_argument& error) {
    in.refuse(error.what());
  }
}

}  // namespace

Problem parse_dat(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const auto d = static_cast<int>(in.integer("the dimension", 2, 3));
  const Index n = in.integer("the number of contacts", 0, most_rows / 3);
  in.expect("mu", n, 1);
  SiconosMatrix first(in, "the first matrix, W or M,");
  SpMat A = first.entries();
  // A global problem has more to come: at least the head of H, f and w.
  if (in.left() > d * n + n + 1 || first.rows() != d * n) {
    Global g;
    g.M.swap(A);
    return read_global(in, std::move(g), n, d, name);
  }
  if (first.columns() != d * n) in.refuse("W is ", first.rows(), " x ", first.columns(), ", not ", d * n, " x ", d * n);
  Problem p{.dimension = d, .name = name};
  p.W = std::move(A);
  p.q = in.vector("q", d * n);
  p.mu = friction(in, n);
  end(in);
  return p;
}

Problem read_dat(const std::string& path) { return parse_dat(lcp::read_file(path), path); }

}  // namespace perp::contact
