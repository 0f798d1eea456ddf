// SPDX-License-Identifier: Apache-2.0
#include "capi/callback_mcp.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "capi/forced_unwind.hpp"
#include "capi/guard.hpp"
#include "ncp/problem/words.hpp"

namespace perp::capi {

namespace {

/// A NaN that no arithmetic makes: what a callback has not set is still this.
constexpr std::uint64_t unset = 0x7FF8'5065'7270'0001;

/// Relative difference of F or J from what a promise makes it: far beyond rounding, far below a term that matters.
constexpr double broken = 1e-6;

bool is_unset(double value) { return std::bit_cast<std::uint64_t>(value) == unset; }

/// What the exception that is being handled says.
std::string exception_text() {
  try {
    throw;
  } catch (const std::exception& error) {
    return std::string(": ") + error.what();
  } catch (...) {
    return "";
  }
}

}  // namespace

CallbackMcp::CallbackMcp(lcp::Box box, Matrix pattern, perp_F F, perp_J J, void* user)
    : box_(std::move(box)), pattern_(std::move(pattern)), F_(F), J_(J), user_(user) {
  x_.resize(box_.size());
  values_F_.resize(lcp::at(box_.size()));
  if (J_ == nullptr)
    differences_.emplace(pattern_.entries);
  else
    values_J_.resize(lcp::at(pattern_.entries.nonZeros()));
}

ncp::JacobianWork CallbackMcp::jacobian_work() const {
  if (!differences_) return {};
  return {ncp::JacobianWork::By::Differences, differences_->colours(), differences_->F_evals()};
}

void CallbackMcp::set_linear(const std::int8_t* linear) {
  if (linear != nullptr && differences_)
    refuse("linear", "J of the problem is NULL, and differences cannot keep the promise that entries are constant");
  linear_.clear();
  affine_ = false;
  first_x_.resize(0);
  knows_J_ = probed_ = false;
  if (linear == nullptr) return;
  const auto count = static_cast<std::size_t>(pattern_.entries.nonZeros());
  linear_.resize(count);
  for (std::size_t k = 0; k < count; ++k)
    linear_[pattern_.place.empty() ? k : lcp::at(pattern_.place[k])] = linear[k] != 0;
  affine_ = std::ranges::find(linear_, false) == linear_.end();
}

void CallbackMcp::begin(std::atomic<bool>* stop) const {
  stop_ = stop;
  F_evals_ = 0;
  J_evals_ = 0;
  stopped_.clear();
  failure_.clear();
}

void CallbackMcp::end(std::string& why, const std::string& text) const {
  why = text;
  if (stop_ != nullptr) *stop_ = true;
}

/// Of the callback's own k-th value.
std::string CallbackMcp::place(const char* name, Index k) const {
  if (*name == 'F') return "F[" + std::to_string(k) + "]";
  Index there = k;
  if (!pattern_.place.empty()) there = pattern_.place[lcp::at(k)];
  Index column = 0;
  while (pattern_.entries.outerIndexPtr()[column + 1] <= there) ++column;
  return "value[" + std::to_string(k) + "] (row " + std::to_string(pattern_.entries.innerIndexPtr()[there]) +
         ", column " + std::to_string(column) + ")";
}

template <class Call>
bool CallbackMcp::called(const char* name, int evaluation, std::vector<double>& values, Call call) const {
  if (values.empty()) return true;
  const auto who = [&] { return std::string(name) + ", in its evaluation " + std::to_string(evaluation); };
  std::fill(values.begin(), values.end(), std::bit_cast<double>(unset));
  std::int32_t answer = 0;
  try {
    answer = call(values.data());
  } catch (const ForcedUnwind&) {
    throw;
  } catch (...) {
    end(failure_, who() + ", threw an exception" + exception_text());
    return false;
  }
  if (answer == PERP_UNDEFINED) {
    std::replace_if(values.begin(), values.end(), is_unset, std::numeric_limits<double>::quiet_NaN());
    return false;
  }
  if (answer == PERP_STOP) {
    end(stopped_, who());
    return false;
  }
  const bool stop = stop_ != nullptr && *stop_;  // meanwhile: what was to be computed may not have been
  if (answer != PERP_DEFINED) {
    if (stop) return false;
    end(failure_,
        who() + ", returned " + std::to_string(answer) + "; it must return 0 (defined), 1 (undefined) or 2 (stop)");
    return false;
  }
  const auto missing = std::find_if(values.begin(), values.end(), is_unset);
  if (missing == values.end()) return true;
  if (stop) return false;
  end(failure_,
      who() + ", left " + place(name, missing - values.begin()) + " of " + std::to_string(values.size()) + " unset");
  return false;
}

bool CallbackMcp::call_F(ncp::In x, double* F) const {
  if (ended()) return false;
  x_ = x;
  const bool defined =
      called("F", ++F_evals_, values_F_, [&](double* values) { return F_(x_.size(), x_.data(), values, user_); });
  std::copy(values_F_.begin(), values_F_.end(), F);
  return defined;
}

bool CallbackMcp::eval(ncp::In x, ncp::Out F) const {
  const bool defined = call_F(x, F.data());
  if (defined && differences_) differences_->keep(x, F);
  if (defined && affine_) check_promise_of_F(x, F);
  return defined && failure_.empty();
}

void CallbackMcp::check_promise_of_F(ncp::In x, ncp::In F) const {
  if (first_x_.size() == 0) {
    first_x_ = x;
    first_F_ = F;
    return probe();
  }
  if (!knows_J_) return;
  const Vec dx = x - first_x_;
  const Vec made = first_F_ + first_J_ * dx;
  const Vec size = first_F_.cwiseAbs().cwiseMax(1) + first_J_.cwiseAbs() * dx.cwiseAbs();
  for (Index i = 0; i < F.size(); ++i)
    if (std::isfinite(made[i]) && std::abs(F[i] - made[i]) > broken * size[i])
      return end(failure_, place("F", i) + " is not as linear as the problem declares: it is " + ncp::number(F[i]) +
                               " where its value at another point and J make it " + ncp::number(made[i]));
}

void CallbackMcp::check_promise_of_J() const {
  if (!std::exchange(knows_J_, true)) {
    first_J_ = pattern_.entries;
    put_values(first_J_);
    return probe();
  }
  for (std::size_t k = 0; k < values_J_.size(); ++k)
    if (const double first = first_J_.valuePtr()[pattern_.place.empty() ? static_cast<Index>(k) : pattern_.place[k]];
        std::abs(values_J_[k] - first) > broken * std::abs(first))
      return end(failure_, "J, " + place("J", static_cast<Index>(k)) +
                               " is not as constant as the problem declares: it is " + ncp::number(values_J_[k]) +
                               ", and was " + ncp::number(first));
}

void CallbackMcp::put_values(SpMat& J) const {
  if (pattern_.place.empty())
    std::copy(values_J_.begin(), values_J_.end(), J.valuePtr());
  else
    for (std::size_t k = 0; k < values_J_.size(); ++k) J.valuePtr()[pattern_.place[k]] = values_J_[k];
}

void CallbackMcp::probe() const {
  if (first_x_.size() == 0 || !knows_J_ || std::exchange(probed_, true)) return;
  Vec x = first_x_, F(x.size());
  for (Index j = 0; j < x.size(); ++j) {
    const double step = std::max(1.0, std::abs(x[j])) * (0.6 + 0.3 * std::sin(static_cast<double>(j)));
    x[j] = lcp::project(box_, j, x[j] + step > box_.upper[j] ? x[j] - step : x[j] + step);
  }
  if (call_F(x, F.data())) check_promise_of_F(x, F);
}

bool CallbackMcp::jacobian(ncp::In x, SpMat& J) const {
  if (ended()) return false;
  if (differences_)
    return differences_->jacobian([this](ncp::In y, ncp::Out F) { return call_F(y, F.data()); }, box_, x, J.valuePtr());
  x_ = x;
  const Index count = pattern_.entries.nonZeros();
  const bool defined = called("J", ++J_evals_, values_J_,
                              [&](double* values) { return J_(x_.size(), count, x_.data(), values, user_); });
  if (defined && affine_) check_promise_of_J();
  put_values(J);
  return defined && failure_.empty();
}

void Watch::check() const {
  if (callbacks_ != nullptr && !callbacks_->failure().empty()) throw Refusal(PERP_BAD_CALLBACK, callbacks_->failure());
}

}  // namespace perp::capi
