// SPDX-License-Identifier: Apache-2.0
/// The problems of perp.h.
#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "capi/guard.hpp"
#include "capi/handles.hpp"
#include "capi/solve.hpp"
#include "collection/sized.hpp"
#include "lcp/io/matrix_market.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::capi {

namespace {

void check_x(const perp_problem* problem, const double* x) {
  require(problem, "problem");
  if (problem->mcp.size() > 0) require(x, "x");
}

Eigen::Map<const Vec> point(const perp_problem* problem, const double* x) { return {x, problem->mcp.size()}; }

void copy_name(const perp_problem* problem, std::int64_t i, char* name, std::int64_t size,
               std::string (ncp::Mcp::*named)(Index) const) {
  require(problem, "problem");
  if (i < 0 || i >= problem->mcp.size())
    refuse("i", std::to_string(i) + " is not within 0 and " + std::to_string(problem->mcp.size() - 1));
  copy_text((problem->mcp.*named)(i), name, size, "name");
}

std::vector<std::string> names_of(const char* const* names, Index n, const char* argument) {
  std::vector<std::string> copy;
  if (names == nullptr) return copy;
  for (Index i = 0; i < n; ++i) {
    if (names[i] == nullptr) refuse(argument, "entry [" + std::to_string(i) + "] is NULL");
    copy.emplace_back(names[i]);
  }
  return copy;
}

/// Of names that are no names: C counts from 0.
constexpr int first_of_C = 0;

/// An affine problem whose matrix stays where the caller has it.
class AffineView final : public ncp::Mcp {
 public:
  AffineView(Vec q, lcp::Box box) : problem_{.M = {}, .q = std::move(q), .box = std::move(box)} {}
  AffineView(const AffineView&) = delete;
  AffineView& operator=(const AffineView&) = delete;
  ~AffineView() override {
    if (borrowed_) problem_.M.swap(lent_);  // Eigen frees its own arrays, and not the caller's
  }
  /// Takes the caller's arrays as M, if they need no conversion.
  bool borrow(const perp_matrix& M) {
    if (!lent_.borrow(M, "M")) return false;
    problem_.M.swap(lent_);
    borrowed_ = true;
    return true;
  }

  const lcp::Box& box() const override { return problem_.box; }
  const SpMat& jacobian_pattern() const override { return problem_.M; }
  bool eval(ncp::In x, ncp::Out F) const override {
    F = problem_.q;
    F.noalias() += problem_.M * x;
    return F.allFinite();
  }
  bool jacobian(ncp::In /*x*/, SpMat& J) const override {
    std::copy_n(problem_.M.valuePtr(), problem_.M.nonZeros(), J.valuePtr());
    return true;
  }
  const lcp::AffineMcp* affine() const override { return &problem_; }
  std::string name() const override { return "affine"; }

 private:
  BorrowedMatrix lent_{};
  bool borrowed_ = false;
  lcp::AffineMcp problem_;
};

std::unique_ptr<ncp::Mcp> affine_mcp(const perp_matrix* M, Vec q, lcp::Box box) {
  if (M->lent != 0 && M->form == PERP_COLUMNS_INT32) {
    auto view = std::make_unique<AffineView>(q, box);
    if (view->borrow(*M)) return view;
  }
  lcp::AffineMcp affine{.M = {}, .q = std::move(q), .box = std::move(box)};
  matrix_of(M, "M", M->columns, M->columns).entries.swap(affine.M);
  affine.M.markAsRValue();  // not copied
  return ncp::make_affine_mcp(std::move(affine), "affine");
}

Vec bound_of(const char* path, const char* argument, double otherwise, Index n) {
  if (path == nullptr) return Vec::Constant(n, otherwise);
  Vec bound = lcp::read_vector(path, true);
  if (bound.size() != n)
    refuse(argument, std::string(path) + " has " + std::to_string(bound.size()) + " numbers for " + std::to_string(n) +
                         " variables");
  return bound;
}

std::unique_ptr<perp_problem> from_matrix(const char* M, const char* q, const char* lower, const char* upper) {
  require(M, "M");
  require(q, "q");
  lcp::AffineMcp affine{.M = lcp::read_matrix(M), .q = lcp::read_vector(q), .box = {}};
  const Index n = affine.q.size();
  if (affine.M.rows() != n || affine.M.cols() != n)
    refuse("M", std::string(M) + " is " + std::to_string(affine.M.rows()) + " x " + std::to_string(affine.M.cols()) +
                    ", and q has " + std::to_string(n) + " numbers");
  affine.box = {.lower = bound_of(lower, "lower", 0, n), .upper = bound_of(upper, "upper", lcp::infinity, n)};
  affine.box = box_of(affine.box.lower.data(), affine.box.upper.data(), n);
  auto made = std::make_unique<perp_problem>(ncp::make_affine_mcp(std::move(affine), M));
  made->source = M;
  return made;
}

namespace collection = ncp::collection;

collection::Problem made_by_name(const std::string& name) {
  if (const collection::Entry* entry = collection::find(name)) return entry->make();
  const std::size_t colon = name.find(':');
  const std::string stem = name.substr(0, colon);
  const collection::Family* family = collection::find_family(stem);
  if (colon != std::string::npos && family != nullptr) try {
      return collection::make(*family, name.substr(colon + 1));
    } catch (const std::invalid_argument& wrong) {
      refuse("name", wrong.what());
    }
  if (colon != std::string::npos && collection::find(stem) != nullptr)
    refuse("name", "'" + stem + "' comes in one size, and '" + name + "' asks for another");
  refuse("name", "there is no problem '" + name + "' in the collection" +
                     settings::did_you_mean(name, collection::similar(name)));
}

std::unique_ptr<perp_problem> from_collection(const std::string& name) {
  collection::Problem made = made_by_name(name);
  auto problem = std::make_unique<perp_problem>(std::move(made.mcp));
  problem->starts = std::move(made.starts);
  if (const collection::Entry* entry = collection::find(name.substr(0, name.find(':'))))
    problem->source = entry->source;
  return problem;
}

}  // namespace

std::unique_ptr<perp_problem> affine_problem(std::int32_t interface, const perp_matrix* M, const double* q,
                                             const double* lower, const double* upper) {
  require_interface(interface);
  require(M, "M");
  const Index n = M->columns;
  check_size(n, "M");
  if (M->rows != n) refuse("M", "is " + std::to_string(M->rows) + " x " + std::to_string(n) + ", not square");
  return std::make_unique<perp_problem>(affine_mcp(M, vector_of(q, n, "q"), box_of(lower, upper, n)), first_of_C);
}

ncp::Vec own_start(const perp_problem& problem, std::size_t k) {
  if (problem.starts.empty()) return lcp::project(problem.mcp.box(), ncp::Vec(ncp::Vec::Zero(problem.mcp.size())));
  return lcp::project(problem.mcp.box(), problem.starts[k]);
}

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_problem_create(int32_t interface_, int64_t n, const double* lower, const double* upper,
                            const perp_matrix* pattern, perp_F F, perp_J J, void* user, perp_problem** problem,
                            perp_error* error) {
  return guarded_make(problem, "problem", error, [&] {
    require_interface(interface_);
    check_size(n, "n");
    if (F == nullptr) refuse("F", "is NULL");
    perp::lcp::Box box = box_of(lower, upper, n);  // asks for the memory before the pattern is read
    auto callbacks = std::make_unique<CallbackMcp>(std::move(box), pattern_of(pattern, "pattern", n), F, J, user);
    CallbackMcp* known = callbacks.get();
    auto made = std::make_unique<perp_problem>(std::move(callbacks), first_of_C);
    made->callbacks = known;
    return made;
  });
}

int32_t perp_problem_affine(int32_t interface_, const perp_matrix* M, const double* q, const double* lower,
                            const double* upper, perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error, [&] { return affine_problem(interface_, M, q, lower, upper); });
}

int32_t perp_problem_read_nl(int32_t interface_, const char* path, perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error, [&] {
    require_interface(interface_);
    require(path, "path");
    std::unique_ptr<perp::ncp::ampl::Model> model = perp::ncp::ampl::read_model(path);
    const perp::ncp::ampl::Model* known = model.get();
    auto made = std::make_unique<perp_problem>(std::move(model));
    made->model = known;
    made->own_names = true;
    made->source = path;
    made->starts = {known->start()};
    return made;
  });
}

int32_t perp_problem_read_matrix(int32_t interface_, const char* M, const char* q, const char* lower, const char* upper,
                                 perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error, [&] {
    require_interface(interface_);
    return from_matrix(M, q, lower, upper);
  });
}

int32_t perp_problem_collection(int32_t interface_, const char* name, perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error, [&] {
    require_interface(interface_);
    require(name, "name");
    return from_collection(name);
  });
}

void perp_problem_free(perp_problem* problem) { delete problem; }

int64_t perp_problem_size(const perp_problem* problem) { return problem == nullptr ? 0 : problem->mcp.size(); }

int64_t perp_problem_nonzeros(const perp_problem* problem) {
  return problem == nullptr ? 0 : problem->mcp.jacobian_pattern().nonZeros();
}

int32_t perp_problem_bounds(const perp_problem* problem, double* lower, double* upper, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    const perp::lcp::Box& box = problem->mcp.box();
    if (lower != nullptr) std::copy_n(box.lower.data(), box.size(), lower);
    if (upper != nullptr) std::copy_n(box.upper.data(), box.size(), upper);
  });
}

int32_t perp_problem_is_affine(const perp_problem* problem) {
  return problem != nullptr && problem->mcp.is_affine() ? 1 : 0;
}

int64_t perp_problem_starts(const perp_problem* problem) {
  return problem == nullptr ? 0 : std::max<int64_t>(1, static_cast<int64_t>(problem->starts.size()));
}

int32_t perp_problem_start(const perp_problem* problem, int64_t k, double* x, perp_error* error) {
  return guarded(error, [&] {
    check_x(problem, x);
    if (k < 0 || k >= perp_problem_starts(problem))
      refuse("k", std::to_string(k) + " is not within 0 and " + std::to_string(perp_problem_starts(problem) - 1));
    const Vec start = own_start(*problem, static_cast<std::size_t>(k));
    std::copy_n(start.data(), start.size(), x);
  });
}

int32_t perp_problem_pattern(const perp_problem* problem, perp_matrix* pattern, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    require(pattern, "pattern");
    *pattern = matrix_view(problem->mcp.jacobian_pattern());
    pattern->value = nullptr;
  });
}

int32_t perp_problem_evaluate(const perp_problem* problem, const double* x, double* F, double* J, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const Index n = problem->mcp.size();
    const Vec at = vector_of(x, n, "x");
    const Watch watch(problem->callbacks, nullptr);
    if (F != nullptr) {
      Vec value = Vec::Constant(n, nan);
      const bool defined = problem->mcp.eval(at, value);
      if (!defined && value.allFinite()) value.setConstant(nan);
      std::copy_n(value.data(), n, F);
    }
    if (J != nullptr) {
      SpMat value = problem->mcp.jacobian_pattern();
      if (!problem->mcp.jacobian(at, value)) value.coeffs().setConstant(nan);
      std::copy_n(value.valuePtr(), value.nonZeros(), J);
    }
    watch.check();
  });
}

const char* perp_problem_name(const perp_problem* problem) {
  return problem == nullptr ? "" : problem->mcp.kept_name().c_str();
}
const char* perp_problem_source(const perp_problem* problem) {
  return problem == nullptr ? "" : problem->source.c_str();
}

int32_t perp_problem_count_from(perp_problem* problem, int32_t first, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    if (first != 0 && first != 1) refuse("first", std::to_string(first) + " is neither 0 nor 1");
    if (!problem->own_names) problem->mcp.count_from(first);
  });
}

int32_t perp_problem_set_name(perp_problem* problem, const char* name, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    require(name, "name");
    problem->mcp.set_name(name);
  });
}

int32_t perp_problem_set_names(perp_problem* problem, const char* const* variables, const char* const* equations,
                               perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    if (problem->own_names) refuse("problem", "comes from a file, which has names of its own");
    const Index n = problem->mcp.size();
    problem->mcp.set_names(names_of(variables, n, "variables"), names_of(equations, n, "equations"));
  });
}

int32_t perp_problem_variable_name(const perp_problem* problem, int64_t i, char* name, int64_t size,
                                   perp_error* error) {
  return guarded(error, [&] { copy_name(problem, i, name, size, &perp::ncp::Mcp::variable_name); });
}

int32_t perp_problem_equation_name(const perp_problem* problem, int64_t i, char* name, int64_t size,
                                   perp_error* error) {
  return guarded(error, [&] { copy_name(problem, i, name, size, &perp::ncp::Mcp::equation_name); });
}

int32_t perp_problem_set_linear(perp_problem* problem, const int8_t* linear, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    if (problem->callbacks == nullptr) refuse("problem", "knows by itself which entries are linear");
    problem->callbacks->set_linear(linear);
  });
}

int32_t perp_problem_residual(const perp_problem* problem, const double* x, double* natural, int64_t* worst,
                              perp_error* error) {
  return guarded(error, [&] {
    check_x(problem, x);
    const Watch watch(problem->callbacks, nullptr);
    const perp::ncp::Residual residual = perp::ncp::residual(problem->mcp, point(problem, x));
    watch.check();
    if (natural != nullptr) *natural = residual.natural;
    if (worst != nullptr) *worst = residual.worst;
  });
}
