// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Text files of numbers, and some words, separated by blanks and line ends, read one after the other; what does not
/// fit is refused by FileError with line and reason. Private to the readers of the project.
#include <string>
#include <string_view>
#include <vector>

#include "lcp/io/file_error.hpp"
#include "lcp/types.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

class Numbers {
 public:
  /// Both must outlive this; `name` is for the errors.
  Numbers(std::string_view text, const std::string& name) : rest_(without_mark(text, name)), name_(name) {}

  template <class... Parts>
  [[noreturn]] void refuse(const Parts&... parts) const {
    throw FileError(name_, line_, text_of(parts...));
  }

  Index integer(const char* what, Index least, Index most);
  /// Finite.
  double number(const char* what);
  Vec vector(const char* what, Index n);
  /// Refuses any other word.
  void word(const std::string& expected);
  void skip_line();  ///< its rest
  Eigen::MatrixXd by_rows(const char* what, Index rows, Index columns);

  /// Refuses counts above what a file of so many more bytes can hold, before anything is allocated.
  void expect(const char* what, Index rows, Index columns) const;
  /// Numbers and words left.
  Index left() const;
  /// Returns whether this word comes next.
  bool next_is(std::string_view word) {
    skip_blanks();
    return token() == word;
  }
  /// The numbers of a known solution, or text on a line of its own; nothing else may be left.
  std::vector<double> end();

 private:
  void skip_blanks();
  std::string_view token() const;
  std::string_view next(const char* what);

  std::string_view rest_;
  const std::string& name_;
  long line_ = 1;
};

}  // namespace perp::lcp
