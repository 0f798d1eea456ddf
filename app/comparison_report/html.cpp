// SPDX-License-Identifier: Apache-2.0
#include "app/comparison_report/html.hpp"

#include <fmt/format.h>

#include "app/program/files.hpp"
#include "app/text/svg.hpp"

namespace perp::app::comparison {

namespace {

std::string attribute(std::string_view name, std::string_view value) {
  return value.empty() ? "" : fmt::format(" {}=\"{}\"", name, html_text(value));
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    bool whole = true;
    const std::size_t length = utf8_character(text, whole);
    const char c = text.front();
    if (const std::string_view other = entity(c); !other.empty())
      result += other;
    else if (length == 0 || c == 0x7F || (length == 1 && c < ' ' && c != '\n' && c != '\t'))
      result += "\xEF\xBF\xBD";
    else
      result += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

std::string script_json(std::string json) {
  for (std::size_t k = json.find('<'); k != std::string::npos; k = json.find('<', k)) json.replace(k, 1, "\\u003c");
  return json;
}

std::string HtmlTable::row(const std::vector<HtmlCell>& cells) const {
  std::string html = "<tr>";
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const HtmlCell& cell = cells[k];
    std::string css = columns_[k].number ? "n" : "";
    if (!cell.css.empty()) css = css.empty() ? cell.css : fmt::format("{} {}", css, cell.css);
    const std::string tag = k == 0 ? "th scope=\"row\"" : "td";
    html +=
        fmt::format("<{}{}{}{}>{}</{}>", tag, attribute("class", css), attribute("data-key", cell.key),
                    attribute("title", cell.tip), cell.raw ? cell.text : html_text(cell.text), k == 0 ? "th" : "td");
  }
  return html + "</tr>\n";
}

std::string HtmlTable::html(std::string_view css) const {
  std::string html = fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\">\n"
      "<table class=\"sortable{1}\">\n<caption>{0}</caption>\n<thead><tr>",
      html_text(caption_), css.empty() ? std::string() : fmt::format(" {}", css));
  for (const HtmlColumn& column : columns_)
    html += fmt::format("<th scope=\"col\"{}{}>{}</th>", attribute("class", column.number ? "n" : ""),
                        attribute("title", column.tip), html_text(column.header));
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& cells : rows_) html += row(cells);
  html += "</tbody>\n";
  if (!foot_.empty()) {
    html += "<tfoot>\n";
    for (const auto& cells : foot_) html += row(cells);
    html += "</tfoot>\n";
  }
  return html + "</table>\n</div>\n";
}

}  // namespace perp::app::comparison
