// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "statistics.h"

namespace spherechain::paper {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 3> kTimes{"kernel_us", "launch_us", "frame_us"};

void add_series(const Json& series, const std::map<double, double>& parts, Table& out) {
  const double spheres = series.at("spheres");
  const auto frames = series.at("frame").get<std::vector<double>>();
  const auto overlaps = series.at("overlaps").get<std::vector<double>>();
  std::array<std::vector<double>, kTimes.size()> times;
  for (std::size_t i = 0; i < kTimes.size(); ++i) {
    if (i == 0 || series.contains(kTimes[i])) times[i] = series.at(kTimes[i]).get<std::vector<double>>();
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::vector<Cell> row{
        spheres,   parts.at(spheres), series.at("animation").get<std::string>(), series.at("method").get<std::string>(),
        frames[f], overlaps.at(f)};
    for (const std::vector<double>& time : times) row.push_back(time.empty() ? Cell() : Cell(time.at(f)));
    out.add(std::move(row));
  }
}

}  // namespace

GpuTime read_gpu_time(const std::filesystem::path& file) {
  GpuTime out;
  if (!std::filesystem::exists(file)) return out;
  std::ifstream in(file);
  try {
    const Json json = Json::parse(in);
    out.machine = fmt::format("{}, {} (driver: {}), {}, {}", json.at("chip").get<std::string>(),
                              json.at("runtime").get<std::string>(), json.at("driver").get<std::string>(),
                              json.at("processor").get<std::string>(), json.at("date").get<std::string>());
    out.command = json.at("command").get<std::string>();
    std::map<double, double> parts;
    for (const Json& character : json.at("characters")) parts[character.at("spheres")] = character.at("parts");
    for (const Json& series : json.at("series")) add_series(series, parts, out.frames);
  } catch (const std::exception& error) {  // nlohmann's, and at()'s of a list that is too short
    throw baker::Error(baker::ExitCode::kFile,
                       file.string() + ": is not what spherechain_figure16 writes (" + error.what() + ")");
  }
  return out;
}

Table gpu_medians(const GpuTime& time) {
  Table out{"figure16_medians",
            {"spheres", "parts", "method", "frames", "overlaps", "kernel_us", "launch_us", "frame_us"},
            {}};
  std::vector<double> counts = time.frames.numbers("spheres");
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  for (const double count : counts) {
    const Table spheres = time.frames.where("spheres", count);
    for (const std::string& method : spheres.words("method")) {
      const Table t = spheres.where("method", method);
      std::vector<Cell> row{count, t.number(0, "parts"), method, t.rows.size(), mean(t.numbers("overlaps"))};
      for (const char* column : kTimes) {
        const double value = median(t.numbers(column));
        row.push_back(std::isnan(value) ? Cell() : Cell(value));
      }
      out.add(std::move(row));
    }
  }
  return out;
}

}  // namespace spherechain::paper
