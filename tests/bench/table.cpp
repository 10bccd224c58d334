// SPDX-License-Identifier: GPL-3.0-or-later
#include "table.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

namespace spherechain::bench {
namespace {

std::string time_text(double nanoseconds) {
  return nanoseconds < 1e4 ? fmt::format("{:.0f} ns", nanoseconds) : fmt::format("{:.1f} us", nanoseconds / 1e3);
}

}  // namespace

void Table::print() const {
  for (const std::string& line : context) {
    fmt::print("{}\n", line);
  }
  fmt::print("\n    {:<48} {:>10} {:>10}\n", "one character", "median", "min");
  for (const TableRow& row : rows) {
    fmt::print("{}  {:<48} {:>10} {:>10}  {}\n", row.section, row.name, time_text(row.times.median),
               time_text(row.times.min), row.note);
  }
  fmt::print("\n");
  for (const Goal& goal : goals) {
    fmt::print("{:<58} {:>8.3g} {:<3} goal: {} {:g}  {}\n", goal.name, goal.reached, goal.unit,
               goal.at_least ? "at least" : "at most", goal.wanted, goal.is_met() ? "met" : "MISSED");
  }
}

void Table::write_json(const std::string& file) const {
  nlohmann::json out;
  out["context"] = context;
  for (const TableRow& row : rows) {
    out["rows"].push_back({{"goal", row.section},
                           {"name", row.name},
                           {"median_ns", row.times.median},
                           {"min_ns", row.times.min},
                           {"note", row.note}});
  }
  for (const Goal& goal : goals) {
    out["goals"].push_back({{"name", goal.name},
                            {"unit", goal.unit},
                            {"reached", goal.reached},
                            {"wanted", goal.wanted},
                            {"at_least", goal.at_least},
                            {"met", goal.is_met()}});
  }
  std::ofstream stream(file);
  stream << out.dump(2) << '\n';
  if (!stream.flush()) {
    throw std::runtime_error(file + ": cannot be written");
  }
}

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(info, line)) {
    if (line.rfind("model name", 0) == 0) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  }
  return fmt::format("{}, {} cores", name, std::thread::hardware_concurrency());
}

}  // namespace spherechain::bench
