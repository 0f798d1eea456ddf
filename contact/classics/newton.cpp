// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/newton.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "contact/classics/trial.hpp"

namespace perp::contact {
namespace {

/// Tries W + alpha I, one alpha after another until there is a direction.
constexpr std::array newton_alphas{1e-10, 1e-8, 1e-6, 1e-4, 1e-2};

/// A direction with a larger residual, relative to its right side, is none: the matrix is singular, or (A + alpha B)^-1
/// has taken its digits.
constexpr double direction_tol = 1e-6;

template <int Size>
class NewtonRun {
 public:
  NewtonRun(Trial& trial, const Scaled& problem, const NewtonOptions& options, const RowsOfContacts<Size>& rows_of)
      : trial_(trial),
        problem_(problem),
        options_(options),
        rows_of_(rows_of),
        matrix_(problem, lcp::LuBackend::General) {}

  void run(Vec r) {
    Vec u = problem_.W * r + problem_.q;
    for (int k = 0; k < options_.max_iterations; ++k) {
      const NewtonSystemOf<Size> system = newton_system<Size>(problem_, rows_of_, r, u);
      if (!std::isfinite(system.merit()) || system.merit() == 0 || !direction(system)) return;
      const Vec Wd = problem_.W * d_;
      const double t = length(system, r, u, Wd);
      r += t * d_;
      u = problem_.W * r + problem_.q;
      if (trial_.step(r, {.step = t, .alpha = alpha_})) return;
    }
  }

 private:
  bool direction(const NewtonSystemOf<Size>& system) {
    for (const double alpha : newton_alphas) {
      ++trial_.stats.factorizations;
      alpha_ = alpha;
      if (trial_.over()) return false;
      if (newton_direction(problem_, matrix_, system, alpha, d_)) return true;
    }
    return false;
  }

  double merit_at(In r, In u) const { return newton_system<Size>(problem_, rows_of_, r, u).merit(); }

  /// The slope of psi along a Newton step is -2 psi.
  double length(const NewtonSystemOf<Size>& system, const Vec& r, const Vec& u, const Vec& Wd) const {
    if (options_.line_search == ContactLineSearch::None) return 1;
    const double psi = system.merit();
    const bool both = options_.line_search == ContactLineSearch::GoldsteinPrice;
    double low = 0;
    double high = std::numeric_limits<double>::infinity();
    double t = 1;
    for (int k = 0; k <= options_.max_halvings; ++k) {
      const double decrease = psi - merit_at(r + t * d_, u + t * Wd);
      if (!(decrease >= 2 * options_.sigma * t * psi))
        high = t;
      else if (both && decrease > 2 * (1 - options_.sigma) * t * psi)
        low = t;
      else
        return t;
      t = std::isinf(high) ? 2 * t : (low + high) / 2;
    }
    return low > 0 ? low : 1;
  }

  Trial& trial_;
  const Scaled& problem_;
  const NewtonOptions& options_;
  const RowsOfContacts<Size>& rows_of_;
  ContactSystemOf<Size> matrix_;
  Vec d_;
  double alpha_ = 0;
};

}  // namespace

void describe(NewtonOptions& o, Fields& f) {
  using enum ContactLineSearch;
  f.choice("line_search", &o.line_search, {{"none", None}, {"armijo", Armijo}, {"goldstein-price", GoldsteinPrice}},
           "on |Phi|^2 / 2");
  f.add("sigma", &o.sigma, {.low = 0, .high = 0.5, .open_low = true, .open_high = true}, "of the line search");
  f.add("max_halvings", &o.max_halvings, at_least(0), "of a step");
  f.add("max_iterations", &o.max_iterations, at_least(1), "Newton steps");
  f.add("scaling", &o.scaling, "in the units of the contacts");
}

NewtonWeights::NewtonWeights(const Scaled& problem)
    : N(static_cast<Index>(problem.blocks.size())),
      T(static_cast<Index>(problem.blocks.size())),
      R(problem.rolls ? static_cast<Index>(problem.blocks.size()) : 0) {
  const Vec diagonal = problem.W.diagonal();
  const auto inverse = [](double w) { return w > 1e-12 ? 1 / w : 1.0; };
  for (std::size_t a = 0; a < problem.blocks.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    const auto i = static_cast<Index>(a);
    N[i] = inverse(diagonal[block.first]);
    const auto of_disk = [&](int j) {
      if (j >= block.disk_count()) return 1.0;
      return inverse(diagonal.segment(block.first + block.first_of(j), block.entries()).mean());
    };
    T[i] = of_disk(0);
    if (problem.rolls) R[i] = of_disk(1);
  }
}

template <int Size>
NewtonSystemOf<Size> newton_system(const Scaled& problem, const std::type_identity_t<RowsOfContacts<Size>>& rows_of,
                                   In r, In u) {
  NewtonSystemOf<Size> system{.rows = std::vector<RowsOfSize<Size>>(problem.blocks.size()), .c = Vec(r.size())};
  for (std::size_t a = 0; a < system.rows.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    const NewtonRowsOfSize<Size> rows = rows_of(a, block.of<Size>(r), block.of<Size>(u));
    system.rows[a] = rows;
    system.c.segment(block.first, block.size) = rows.c.head(block.size);
  }
  return system;
}

template NewtonSystemOf<3> newton_system<3>(const Scaled&, const RowsOfContacts<3>&, In, In);
template NewtonSystemOf<5> newton_system<5>(const Scaled&, const RowsOfContacts<5>&, In, In);

template <int Size>
bool newton_direction(const Scaled& problem, ContactSystemOf<Size>& matrix, const NewtonSystemOf<Size>& system,
                      double alpha, Vec& d) {
  std::vector<RowsOfSize<Size>> rows = system.rows;
  for (RowsOfSize<Size>& of : rows) of.A += alpha * of.B;
  if (!matrix.factor(rows)) return false;
  matrix.solve(system.c, d);
  return (system.c - product(problem, rows, d)).norm() <= direction_tol * system.c.norm();
}

template bool newton_direction<3>(const Scaled&, ContactSystemOf<3>&, const NewtonSystemOf<3>&, double, Vec&);
template bool newton_direction<5>(const Scaled&, ContactSystemOf<5>&, const NewtonSystemOf<5>&, double, Vec&);

template <int Size>
void newton(Trial& trial, const Scaled& problem, const NewtonOptions& options, const RowsOfContacts<Size>& rows_of,
            Vec r) {
  NewtonRun<Size>(trial, problem, options, rows_of).run(std::move(r));
}

template void newton<3>(Trial&, const Scaled&, const NewtonOptions&, const RowsOfContacts<3>&, Vec);
template void newton<5>(Trial&, const Scaled&, const NewtonOptions&, const RowsOfContacts<5>&, Vec);

}  // namespace perp::contact
