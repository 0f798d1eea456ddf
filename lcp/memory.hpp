// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How much memory there is, and the refusal to take more: asked before anything large is built, because Linux gives
/// address space it does not have and ends the program later.
#include <cstddef>
#include <memory>
#include <new>
#include <string>

namespace perp::lcp {

/// Bytes that this process may still take: the least of what the machine has available, what its control groups
/// (containers) and the limit of its address space (ulimit -v) leave. The largest double-exact number where nothing is
/// known.
double available_memory();

/// "3.1 GB".
std::string memory_text(double bytes);

/// std::bad_alloc that says how much was asked for, of what is left.
class NotEnoughMemory : public std::bad_alloc {
 public:
  /// "the factors need 24 GB, 3.1 GB are available".
  NotEnoughMemory(const std::string& what_needs, double bytes, double available);
  const char* what() const noexcept override;

 private:
  std::shared_ptr<const std::string> text_;  // copies of exceptions must not throw
};

/// Throws NotEnoughMemory if `bytes` are more than available_memory(). `what_needs`: a plural, "the factors".
void require_memory(double bytes, const std::string& what_needs);
/// The same for the factors of a matrix.
void require_factors(std::ptrdiff_t rows, double bytes);

}  // namespace perp::lcp
