// SPDX-License-Identifier: Apache-2.0
#include "capi/callback_mcp.hpp"

#include <cxxabi.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "capi/guard.hpp"

namespace perp::capi {

namespace {

/// A NaN that no arithmetic makes: what a callback has not set is still this.
constexpr std::uint64_t unset = 0x7FF8'5065'7270'0001;

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

void CallbackMcp::set_linear(const std::int8_t* linear) {
  linear_.clear();
  affine_ = false;
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
  std::string entry = "entry " + std::to_string(k + 1);
  if (*name == 'F') return entry;
  Index column = 0;
  while (pattern_.entries.outerIndexPtr()[column + 1] <= k) ++column;
  const Index there = pattern_.place.empty() ? k : pattern_.place[lcp::at(k)];
  return entry + " (row " + std::to_string(pattern_.entries.innerIndexPtr()[there] + 1) + ", column " +
         std::to_string(column + 1) + ")";
}

template <class Call>
bool CallbackMcp::called(const char* name, int evaluation, double* values, Index count, Call call) const {
  if (count == 0) return true;
  const std::string who = std::string(name) + ", in its evaluation ";
  std::fill_n(values, count, std::bit_cast<double>(unset));
  std::int32_t answer = 0;
  try {
    answer = call(values);
  } catch (const abi::__forced_unwind&) {
    throw;
  } catch (...) {
    end(failure_, who + std::to_string(evaluation) + ", threw an exception" + exception_text());
    return false;
  }
  if (answer == PERP_UNDEFINED) {
    std::replace_if(values, values + count, is_unset, std::numeric_limits<double>::quiet_NaN());
    return false;
  }
  if (answer == PERP_STOP) {
    end(stopped_, who + std::to_string(evaluation));
    return false;
  }
  if (answer != PERP_DEFINED) {
    end(failure_, who + std::to_string(evaluation) + ", returned " + std::to_string(answer) +
                      "; it must return 0 (defined), 1 (undefined) or 2 (stop)");
    return false;
  }
  const double* missing = std::find_if(values, values + count, is_unset);
  if (missing == values + count) return true;
  end(failure_, who + std::to_string(evaluation) + ", left " + place(name, missing - values) + " of " +
                    std::to_string(count) + " unset");
  return false;
}

bool CallbackMcp::eval(ncp::In x, ncp::Out F) const {
  if (ended()) return false;
  return called("F", ++F_evals_, F.data(), F.size(),
                [&](double* values) { return F_(x.size(), x.data(), values, user_); });
}

bool CallbackMcp::jacobian(ncp::In x, SpMat& J) const {
  if (ended()) return false;
  const Index count = pattern_.entries.nonZeros();
  const auto call = [&](double* values) { return J_(x.size(), count, x.data(), values, user_); };
  ++J_evals_;
  if (pattern_.place.empty()) return called("J", J_evals_, J.valuePtr(), count, call);
  values_.resize(lcp::at(count));
  const bool defined = called("J", J_evals_, values_.data(), count, call);
  for (Index k = 0; k < count; ++k) J.valuePtr()[pattern_.place[lcp::at(k)]] = values_[lcp::at(k)];
  return defined;
}

void Watch::check() const {
  if (callbacks_ != nullptr && !callbacks_->failure().empty()) throw Refusal(PERP_BAD_CALLBACK, callbacks_->failure());
}

}  // namespace perp::capi
