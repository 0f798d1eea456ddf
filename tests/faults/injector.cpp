// SPDX-License-Identifier: Apache-2.0
#include "faults/injector.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>
#include <utility>

namespace perp::faults {
namespace {

enum class Kind { Malloc, New };

struct Range {
  std::uintptr_t first = 0, last = 0;
  bool mallocs = false, news = false;
};

/// No containers: this runs inside malloc.
struct Modules {
  std::array<Range, 64> ranges{};
  std::size_t count = 0;
};

Modules modules;
const char* only = "";
bool traced = false;
thread_local bool armed = false;
long counted = 0;
long failing = 0;
bool has_failed = false;

int add_module(dl_phdr_info* info, std::size_t, void*) {
  std::string_view name = info->dlpi_name;
  name.remove_prefix(name.rfind('/') + 1);
  constexpr std::array ours{"libamd.",    "libbtf.", "libcamd.", "libccolamd.",           "libcholmod.",
                            "libcolamd.", "libgsl.", "libklu.",  "libsuitesparseconfig.", "libumfpack."};
  const auto begins = [&](const char* with) { return name.starts_with(with); };
  const bool chosen = *only != '\0';
  const bool library = chosen ? begins(only) : name.empty() || std::any_of(ours.begin(), ours.end(), begins);
  const bool news = chosen ? library : library || begins("libstdc++.");
  for (int i = 0; news && i < info->dlpi_phnum && modules.count < modules.ranges.size(); ++i) {
    const auto& segment = info->dlpi_phdr[i];
    if (segment.p_type != PT_LOAD || (segment.p_flags & PF_X) == 0) continue;
    const std::uintptr_t first = info->dlpi_addr + segment.p_vaddr;
    modules.ranges[modules.count++] = {first, first + segment.p_memsz, library, news};
  }
  return 0;
}

/// Whether this call is the one.
bool fails(Kind kind, const void* caller) {
  if (!armed) return false;
  const auto address = reinterpret_cast<std::uintptr_t>(caller);
  bool counts = false;
  for (std::size_t i = 0; i < modules.count && !counts; ++i) {
    const Range& range = modules.ranges[i];
    counts = address >= range.first && address < range.last && (kind == Kind::New ? range.news : range.mallocs);
  }
  if (!counts || ++counted != failing) return false;
  has_failed = true;
  if (traced) {
    armed = false;
    std::array<void*, 40> frames{};
    backtrace_symbols_fd(frames.data(), backtrace(frames.data(), static_cast<int>(frames.size())), STDERR_FILENO);
    armed = true;
  }
  return true;
}

/// For what is asked for while the real functions are looked up.
alignas(64) std::array<char, 1 << 14> early{};
std::size_t early_used = 0;
bool is_early(const void* p) { return p >= early.data() && p < early.data() + early.size(); }

void* take_early(std::size_t size) {
  const std::size_t begin = (early_used + 63) / 64 * 64;
  if (begin + size > early.size()) return nullptr;
  early_used = begin + size;
  return early.data() + begin;
}

template <class Function>
class Real {
 public:
  constexpr explicit Real(const char* name) : name_(name) {}
  /// nullptr while it is looked up.
  Function* get() {
    static thread_local bool looking = false;
    if (function_ == nullptr && !looking) {
      looking = true;
      function_ = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name_));
      looking = false;
    }
    return function_;
  }

 private:
  const char* name_;
  Function* function_ = nullptr;
};

constinit Real<void*(std::size_t)> real_malloc("malloc");
constinit Real<void*(std::size_t, std::size_t)> real_calloc("calloc");
constinit Real<void*(void*, std::size_t)> real_realloc("realloc");
constinit Real<void(void*)> real_free("free");
constinit Real<int(void**, std::size_t, std::size_t)> real_posix_memalign("posix_memalign");
constinit Real<void*(std::size_t, std::size_t)> real_aligned_alloc("aligned_alloc");
constinit Real<void*(std::size_t)> real_new("_Znwm");
constinit Real<void*(std::size_t)> real_new_array("_Znam");
constinit Real<void*(std::size_t, std::align_val_t)> real_new_aligned("_ZnwmSt11align_val_t");
constinit Real<void*(std::size_t, std::align_val_t)> real_new_array_aligned("_ZnamSt11align_val_t");

void* refused() {
  errno = ENOMEM;
  return nullptr;
}

/// The others that throw nothing ask these.
template <class Function, class... Aligned>
void* make_new(Real<Function>& real, const void* caller, std::size_t size, Aligned... aligned) {
  if (fails(Kind::New, caller)) throw std::bad_alloc();
  const bool was_armed = std::exchange(armed, false);  // what the real one asks of malloc is not counted twice
  try {
    void* p = real.get()(size, aligned...);
    armed = was_armed;
    return p;
  } catch (...) {
    armed = was_armed;
    throw;
  }
}

}  // namespace

Armed::Armed(long k) {
  if (modules.count == 0) dl_iterate_phdr(add_module, nullptr);
  counted = 0;
  failing = k;
  has_failed = false;
  armed = true;
}
Armed::~Armed() { armed = false; }
long Armed::calls() { return counted; }
bool Armed::failed() { return has_failed; }

void trace(bool on) {
  std::array<void*, 1> frame{};
  if (on) backtrace(frame.data(), 1);  // loads what it needs
  traced = on;
}

void count_only(const char* module) {
  only = module;
  modules.count = 0;
}

}  // namespace perp::faults

using namespace perp::faults;

extern "C" {

void* malloc(std::size_t size) {
  if (fails(Kind::Malloc, __builtin_return_address(0))) return refused();
  auto* real = real_malloc.get();
  return real != nullptr ? real(size) : take_early(size);
}

void* calloc(std::size_t n, std::size_t size) {
  if (fails(Kind::Malloc, __builtin_return_address(0))) return refused();
  auto* real = real_calloc.get();
  return real != nullptr ? real(n, size) : take_early(n * size);
}

void* realloc(void* p, std::size_t size) {
  if (fails(Kind::Malloc, __builtin_return_address(0))) return refused();
  auto* real = real_realloc.get();
  return real != nullptr ? real(p, size) : nullptr;
}

void free(void* p) {
  if (p == nullptr || is_early(p)) return;
  if (auto* real = real_free.get()) real(p);
}

int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  if (fails(Kind::Malloc, __builtin_return_address(0))) return ENOMEM;
  return real_posix_memalign.get()(p, alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (fails(Kind::Malloc, __builtin_return_address(0))) return refused();
  return real_aligned_alloc.get()(alignment, size);
}
}

// The nothrow ones of the C++ library call these. Those of a sanitizer do not, and are not counted.
void* operator new(std::size_t size) { return make_new(real_new, __builtin_return_address(0), size); }
void* operator new[](std::size_t size) { return make_new(real_new_array, __builtin_return_address(0), size); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return make_new(real_new_aligned, __builtin_return_address(0), size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return make_new(real_new_array_aligned, __builtin_return_address(0), size, alignment);
}
