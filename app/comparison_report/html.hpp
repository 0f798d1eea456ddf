// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The few pieces of HTML a report needs: escaped text, tables that the page's script can sort.
#include <string>
#include <string_view>
#include <vector>

namespace perp::app::comparison {

/// Escaped for text and attributes; bytes that are no UTF-8 and control characters become U+FFFD.
std::string html_text(std::string_view text);

/// JSON that may stand in a script element: '<' is written as \u003c, which nothing ends early.
std::string script_json(std::string json);

struct HtmlColumn {
  std::string header{};
  std::string tip{};
  bool number = true;  ///< right-aligned; sorts by value
};

struct HtmlCell {
  std::string text{};
  std::string key{};  ///< to sort by, if not the text: a number
  std::string css{};
  bool raw = false;  ///< the text is HTML already
  std::string tip{};
};

class HtmlTable {
 public:
  HtmlTable(std::string caption, std::vector<HtmlColumn> columns)
      : caption_(std::move(caption)), columns_(std::move(columns)) {}
  void add(std::vector<HtmlCell> row) { rows_.push_back(std::move(row)); }
  /// A last row that stays where it is.
  void foot(std::vector<HtmlCell> row) { foot_.push_back(std::move(row)); }
  /// First column as row headers; in a frame of its own that scrolls where the page is too narrow.
  /// `css`: classes of the table beside "sortable".
  std::string html(std::string_view css = {}) const;

 private:
  std::string row(const std::vector<HtmlCell>& cells) const;
  std::string caption_;
  std::vector<HtmlColumn> columns_;
  std::vector<std::vector<HtmlCell>> rows_{};
  std::vector<std::vector<HtmlCell>> foot_{};
};

}  // namespace perp::app::comparison
