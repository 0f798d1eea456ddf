// SPDX-License-Identifier: Apache-2.0
/// A fuzz target without a fuzzer: runs it over every file of the folders given (seeds, old findings). A finding ends
/// the process.
#include <iterator>

#include "fuzz/support.hpp"

int main(int count, char** arguments) {
  std::size_t inputs = 0;
  for (int k = 1; k < count; ++k) {
    std::error_code absent;
    for (const auto& entry : std::filesystem::directory_iterator(arguments[k], absent)) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string content{std::istreambuf_iterator<char>(file), {}};
      std::printf("%s\n", entry.path().c_str());
      std::fflush(stdout);
      LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
      ++inputs;
    }
  }
  std::printf("%zu inputs\n", inputs);
  return inputs > 0 ? 0 : 1;
}
