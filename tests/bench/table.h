// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "timing.h"

namespace spherechain::bench {

struct TableRow {
  std::string section;  // "P1" ...
  std::string name;
  Times times;
  std::string note;
};

// A figure that a goal of docs/performance.md asks for.
struct Goal {
  std::string name, unit;
  double reached, wanted;
  bool at_least;  // else at most
  bool is_met() const { return at_least ? reached >= wanted : reached <= wanted; }
};

struct Table {
  std::vector<std::string> context;  // what was run, where
  std::vector<TableRow> rows;
  std::vector<Goal> goals;

  void print() const;
  // Throws std::runtime_error that names the file.
  void write_json(const std::string& file) const;
};

// "AMD EPYC ..., 2 cores".
std::string machine();

}  // namespace spherechain::bench
