// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherechain::paper {

// A number, a word, or nothing.
struct Cell {
  std::optional<double> number;
  std::string word;

  Cell() = default;
  template <typename T>
  requires std::integral<T> || std::floating_point<T> Cell(T value) : number(static_cast<double>(value)) {}
  Cell(std::string value) : word(std::move(value)) {}
  Cell(const char* value) : word(value) {}
};

// The result of an experiment, as in a CSV file. All figures and verdicts are made from tables. Units are in the
// columns' names.
struct Table {
  std::string name;  // of the file, without .csv
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;

  void add(std::vector<Cell> row);
  bool empty() const { return rows.empty(); }

  // The rows with this word, or this number, in a column.
  Table where(const std::string& column, const std::string& word) const;
  Table where(const std::string& column, double number) const;

  const Cell& at(std::size_t row, const std::string& column) const;
  double number(std::size_t row, const std::string& column) const;
  const std::string& word(std::size_t row, const std::string& column) const { return at(row, column).word; }
  // A column's numbers; NaN where a cell has none.
  std::vector<double> numbers(const std::string& column) const;
  // A column's different words, in the order they first appear.
  std::vector<std::string> words(const std::string& column) const;

 private:
  std::size_t index(const std::string& column) const;
};

std::string to_text(const Cell& cell);
std::string to_csv(const Table& table);

}  // namespace spherechain::paper
