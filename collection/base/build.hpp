// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How the collection makes its problems: one generic function F for values and derivatives, names, tables of numbers.
/// Private to the collection.
#include <algorithm>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "collection/base/dual.hpp"
#include "collection/base/entry.hpp"

namespace perp::ncp::collection {

using Names = std::vector<std::string>;

/// "letter[place]"
std::string element(std::string letter, const std::string& place);
/// "x[1]", ..., "x[n]"
Names indexed(const std::string& letter, Index n);
Box free_box(Index n);  ///< of n free variables
/// All names of the parts in their order.
Names joined(std::initializer_list<Names> parts);

Vec vec(std::initializer_list<double> values);
Vec joined(std::initializer_list<Vec> parts);
/// x_i (1 + fraction), x_i (1 - fraction) in turn: a start near another one that nobody has chosen.
Vec shaken(const Vec& x, double fraction);
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
/// The same if value < least or value > most.
void require_between(std::string_view problem, std::string_view argument, Index value, Index least, Index most);

/// F(x) = M x + q.
std::unique_ptr<Mcp> make_affine(Shape shape, const SpMat& M, const Vec& q);

/// n numbers side by side, indexed by Index as Eigen's vectors are, with their head, segment and tail.
template <class T>
class Row {
 public:
  Row(T* data, Index size) : data_(data), size_(size) {}
  Index size() const { return size_; }
  T& operator[](Index i) const { return data_[i]; }
  T* begin() const { return data_; }
  T* end() const { return data_ + size_; }
  Row head(Index n) const { return {data_, n}; }
  Row segment(Index first, Index n) const { return {data_ + first, n}; }
  Row tail(Index n) const { return {data_ + size_ - n, n}; }

 private:
  T* data_;
  Index size_;
};

/// The number type of a Row: double, Dual or Expression.
template <class R>
using Number = std::remove_cvref_t<decltype(std::declval<R>()[0])>;

/// f on expressions, as Functions::expression; `void f(const auto& x, auto& F)` is handed vectors as Eigen's.
template <class Fn>
std::function<bool(std::span<const Expression>, std::span<Expression>)> on_vectors(Index n, Fn f) {
  return [n, f](std::span<const Expression> x, std::span<Expression> F) {
    using Vector = Eigen::Matrix<Expression, Eigen::Dynamic, 1>;
    const Vector from = Eigen::Map<const Vector>(x.data(), n);
    Vector to = Vector::Constant(n, Expression(0));
    f(from, to);
    std::copy(to.data(), to.data() + n, F.begin());
    return true;
  };
}
/// A x, for x of any numbers.
template <class V>
Eigen::Matrix<typename V::Scalar, Eigen::Dynamic, 1> product(const SpMat& A, const V& x) {
  using T = typename V::Scalar;
  Eigen::Matrix<T, Eigen::Dynamic, 1> y = Eigen::Matrix<T, Eigen::Dynamic, 1>::Constant(A.rows(), T(0));
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator entry(A, j); entry; ++entry) y[entry.row()] += entry.value() * x[j];
  return y;
}

/// The problem with F = f, where `bool f(const auto& x, const auto& F)` reads x[0..n-1], writes F[0..n-1] (Rows of
/// double, Dual or Expression) and answers whether F is defined there; a void f says that it is. J comes by forward
/// differentiation; values that are not finite count as "not defined here" in F and in J.
template <class Fn>
std::unique_ptr<Mcp> make_problem(Shape shape, Fn fn) {
  const auto f = [fn](const auto& x, const auto& F) {
    if constexpr (std::is_void_v<decltype(fn(x, F))>)
      return fn(x, F), true;
    else
      return fn(x, F);
  };
  Functions made = functions_of(std::move(shape));
  made.expression = [f](std::span<const Expression> x, std::span<Expression> F) {
    const auto n = static_cast<Index>(x.size());
    return f(Row<const Expression>(x.data(), n), Row<Expression>(F.data(), n));
  };
  made.F = [f](In x, Out F) {
    return f(Row<const double>(x.data(), x.size()), Row<double>(F.data(), F.size())) && all_finite(F);
  };
  made.J = [f](In x, SpMat& J) {
    const Index n = x.size();
    std::vector<Dual> seeded(x.begin(), x.end()), F(x.begin(), x.end());
    const Row<const Dual> from(seeded.data(), n);
    const Row<Dual> to(F.data(), n);
    const Row<Dual> seeds(seeded.data(), n);
    for (Index first = 0; first < n; first += Dual::width) {
      const Index last = std::min(first + Dual::width, n);
      for (Index j = first; j < last; ++j) seeds[j].d[j - first] = 1;
      if (!f(from, to)) return false;
      for (Index j = first; j < last; ++j) {
        for (SpMat::InnerIterator entry(J, j); entry; ++entry) entry.valueRef() = to[entry.row()].d[j - first];
        seeds[j].d[j - first] = 0;
      }
    }
    return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
  };
  return make_mcp(std::move(made));
}

}  // namespace perp::ncp::collection
