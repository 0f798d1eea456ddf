// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the fuzz targets share. A target is LLVMFuzzerTestOneInput(): it gives the input to a reader, uses what was
/// read a little, and dies where a promise does not hold. tests/fuzz/README.md says how they are run.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace perp::fuzz {

inline std::string_view view(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A promise that does not hold ends the process: that is how a fuzzer knows a finding.
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: does not hold: %s\n", promise);
  std::abort();
}

/// Does the work; false if a Refusal ends it. Other exceptions are findings.
template <class Refusal, class... Others, class Work>
bool accepted(Work work) {
  try {
    if constexpr (sizeof...(Others) == 0)
      work();
    else
      return accepted<Others...>(work);
    return true;
  } catch (const Refusal&) {
    return false;
  }
}

/// What is too slow for every input is done for one in `many`, always the same ones.
inline bool one_in(std::size_t many, std::string_view text) {
  std::size_t hash = 14695981039346656037U;  // FNV-1a
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return (hash >> 8U) % many == 0;
}

/// A folder for readers that take files alone: in PERP_FUZZ_SCRATCH, which scripts/fuzz puts into memory.
class Scratch {
 public:
  Scratch() {
    const char* folder = std::getenv("PERP_FUZZ_SCRATCH");  // NOLINT(concurrency-mt-unsafe)
    std::string name =
        (folder != nullptr ? std::filesystem::path(folder) : std::filesystem::temp_directory_path()) / "perp-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  std::string path(const std::string& name) const { return path_ + "/" + name; }
  std::string write(const std::string& name, std::string_view content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

 private:
  std::string path_;
};

}  // namespace perp::fuzz
