#include "graspd/formats/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace graspd {
namespace {

/// Columns a terminal shows, for UTF-8 text without combining characters.
std::size_t columns(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

/// "12.3", "-4", "95 %" and "–" line up at the right.
bool is_number(const std::string& text) {
  if (text.empty() || text == "–" || text == "-") return true;
  const std::size_t first = text[0] == '-' || text[0] == '+' ? 1 : 0;
  return first < text.size() && std::isdigit(static_cast<unsigned char>(text[first])) != 0;
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, columns(text)), ' ');
  return right ? space + text : text + space;
}

struct Layout {
  std::vector<std::size_t> width;
  std::vector<bool> right;
};

Layout lay_out(const std::vector<std::string>& header,
               const std::vector<std::vector<std::string>>& rows) {
  Layout layout;
  for (std::size_t column = 0; column < header.size(); ++column) {
    layout.width.push_back(columns(header[column]));
    layout.right.push_back(!rows.empty());
    for (const auto& row : rows) {
      layout.width[column] = std::max(layout.width[column], columns(row.at(column)));
      if (!is_number(row[column])) layout.right[column] = false;
    }
  }
  return layout;
}

std::string line(const std::vector<std::string>& cells, const Layout& layout,
                 std::string_view separator) {
  std::string text;
  for (std::size_t column = 0; column < cells.size(); ++column) {
    if (column > 0) text += separator;
    text += padded(cells[column], layout.width[column], layout.right[column]);
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

std::string Table::to_text() const {
  const Layout layout = lay_out(header_, rows_);
  std::string text = line(header_, layout, "  ") + "\n";
  std::size_t total = 0;
  for (const std::size_t width : layout.width) total += width + 2;
  for (std::size_t i = 2; i < total; ++i) text += "─";
  text += "\n";
  for (const auto& row : rows_) text += line(row, layout, "  ") + "\n";
  return text;
}

std::string Table::to_markdown() const {
  const Layout layout = lay_out(header_, rows_);
  std::string text = "| " + fmt::format("{}", fmt::join(header_, " | ")) + " |\n|";
  for (const bool right : layout.right) text += right ? "---:|" : "---|";
  text += "\n";
  for (const auto& row : rows_) text += "| " + fmt::format("{}", fmt::join(row, " | ")) + " |\n";
  return text;
}

std::string Table::to_csv() const {
  const auto quoted = [](const std::string& cell) {
    if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
    std::string text = "\"";
    for (const char c : cell) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + "\"";
  };
  std::string text;
  const auto add_line = [&](const std::vector<std::string>& cells) {
    for (std::size_t column = 0; column < cells.size(); ++column) {
      text += (column > 0 ? "," : "") + quoted(cells[column]);
    }
    text += "\n";
  };
  add_line(header_);
  for (const auto& row : rows_) add_line(row);
  return text;
}

}  // namespace graspd
