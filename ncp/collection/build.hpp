#pragma once
/// How the collection makes its problems: one generic function F for values and derivatives, names, tables of numbers.
/// Private to the collection.
#include <algorithm>
#include <initializer_list>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "ncp/collection/collection.hpp"
#include "ncp/collection/dual.hpp"

namespace perp::ncp::collection {

using Names = std::vector<std::string>;

/// "letter[place]"
std::string element(std::string letter, const std::string& place);
/// "x[1]", ..., "x[n]"
Names indexed(const std::string& letter, Index n);
/// All names of the parts in their order.
Names joined(std::initializer_list<Names> parts);

Vec vec(std::initializer_list<double> values);
Vec joined(std::initializer_list<Vec> parts);
/// The eight starts of the tiny problems with four unknowns: 0; 1; 100; (1,0,1,0); (1,0,0,0); (0,1,1,0); (0,1,0,1);
/// (1.25,0,0,.5).
std::vector<Vec> eight_starts();

/// Everything of a problem but its function. An empty pattern means a dense one, empty equation names "F[1]", ....
struct Shape {
  std::string name;
  Box box;
  Names variables;
  Names equations{};
  SpMat pattern{};
};

/// The Functions of that shape, F and J still to be set.
Functions functions_of(Shape shape);
/// Are all values finite?
bool all_finite(In values);

/// Throws std::invalid_argument, naming problem, argument and value, if value < least.
void require_at_least(std::string_view problem, std::string_view argument, Index value, Index least);

/// F(x) = M x + q.
std::unique_ptr<Mcp> make_affine(Shape shape, const SpMat& M, const Vec& q);

/// The number type f is called with: double or Dual.
template <class Span>
using Number = std::remove_cvref_t<decltype(std::declval<Span>()[0])>;

/// The problem with F = f, where `bool f(const auto& x, auto& F)` reads x[0..n-1], writes F[0..n-1] (spans of double or
/// Dual) and answers whether F is defined there. J comes by forward differentiation; values that are not finite count
/// as "not defined here" in F and in J.
template <class Fn>
std::unique_ptr<Mcp> make_problem(Shape shape, Fn f) {
  Functions made = functions_of(std::move(shape));
  made.F = [f](In x, Out F) {
    const std::span<const double> from(x.data(), static_cast<std::size_t>(x.size()));
    std::span<double> to(F.data(), static_cast<std::size_t>(F.size()));
    return f(from, to) && all_finite(F);
  };
  made.J = [f](In x, SpMat& J) {
    const auto n = static_cast<std::size_t>(x.size());
    std::vector<Dual> seeded(x.begin(), x.end()), rows(n);
    const std::span<const Dual> from(seeded);
    for (std::size_t first = 0; first < n; first += Dual::width) {
      const std::size_t last = std::min(first + Dual::width, n);
      for (std::size_t j = first; j < last; ++j) seeded[j].d[j - first] = 1;
      std::span<Dual> to(rows);
      if (!f(from, to)) return false;
      for (std::size_t j = first; j < last; ++j) {
        for (SpMat::InnerIterator entry(J, static_cast<Index>(j)); entry; ++entry)
          entry.valueRef() = rows[static_cast<std::size_t>(entry.row())].d[j - first];
        seeded[j].d[j - first] = 0;
      }
    }
    return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
  };
  return make_mcp(std::move(made));
}

}  // namespace perp::ncp::collection
