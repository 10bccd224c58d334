// SPDX-License-Identifier: GPL-3.0-or-later
#include "table.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace spherechain::paper {

void Table::add(std::vector<Cell> row) {
  if (row.size() != columns.size()) throw std::logic_error(name + ": a row has other columns than the table");
  rows.push_back(std::move(row));
}

std::size_t Table::index(const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) throw std::logic_error(name + ": no column " + column);
  return static_cast<std::size_t>(found - columns.begin());
}

Table Table::where(const std::string& column, const std::string& word) const {
  Table out{name, columns, {}};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (at(r, column).word == word && !at(r, column).number) out.rows.push_back(rows[r]);
  }
  return out;
}

Table Table::where(const std::string& column, double number) const {
  Table out{name, columns, {}};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (at(r, column).number == number) out.rows.push_back(rows[r]);
  }
  return out;
}

const Cell& Table::at(std::size_t row, const std::string& column) const { return rows.at(row)[index(column)]; }

double Table::number(std::size_t row, const std::string& column) const {
  return at(row, column).number.value_or(std::numeric_limits<double>::quiet_NaN());
}

std::vector<double> Table::numbers(const std::string& column) const {
  std::vector<double> out;
  for (std::size_t r = 0; r < rows.size(); ++r) out.push_back(number(r, column));
  return out;
}

std::vector<std::string> Table::words(const std::string& column) const {
  std::vector<std::string> out;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (std::find(out.begin(), out.end(), word(r, column)) == out.end()) out.push_back(word(r, column));
  }
  return out;
}

std::string to_text(const Cell& cell) { return cell.number ? fmt::format("{:.9g}", *cell.number) : cell.word; }

std::string to_csv(const Table& table) {
  std::string out;
  const auto line = [&](const auto& cells, const auto& text) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string value = text(cells[i]);
      const bool quoted = value.find_first_of(",\"\n") != std::string::npos;
      out += i > 0 ? "," : "";
      if (!quoted) out += value;
      if (!quoted) continue;
      out += '"';
      for (const char c : value) out += c == '"' ? std::string("\"\"") : std::string(1, c);
      out += '"';
    }
    out += '\n';
  };
  line(table.columns, [](const std::string& column) { return column; });
  for (const auto& row : table.rows) line(row, to_text);
  return out;
}

}  // namespace spherechain::paper
