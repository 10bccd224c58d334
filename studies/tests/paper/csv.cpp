// SPDX-License-Identifier: GPL-3.0-or-later
#include "csv.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

}  // namespace

std::string read_output(const std::string& file) {
  std::ifstream in(std::string(SPHERECHAIN_PAPER_OUT) + "/" + file);
  REQUIRE_MESSAGE(in, file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<Row> read_csv(const std::string& file) {
  std::istringstream in(read_output(file));
  std::string line;
  REQUIRE(std::getline(in, line));
  const std::vector<std::string> columns = split(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = split(line);
    REQUIRE(cells.size() == columns.size());
    rows.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) rows.back()[columns[c]] = cells[c];
  }
  REQUIRE(!rows.empty());
  return rows;
}

double number(const Row& row, const std::string& column) {
  const auto found = row.find(column);
  REQUIRE_MESSAGE(found != row.end(), column);
  char* end = nullptr;
  const double value = std::strtod(found->second.c_str(), &end);
  REQUIRE_MESSAGE((!found->second.empty() && *end == '\0'), column, ": ", found->second);
  return value;
}

std::vector<double> numbers(const std::vector<Row>& rows, const std::string& column) {
  std::vector<double> out;
  for (const Row& row : rows) out.push_back(number(row, column));
  return out;
}

std::vector<Row> only(const std::vector<Row>& rows, const std::string& column, const std::string& word) {
  std::vector<Row> out;
  for (const Row& row : rows) {
    if (row.at(column) == word) out.push_back(row);
  }
  REQUIRE_MESSAGE(!out.empty(), column, " ", word);
  return out;
}
