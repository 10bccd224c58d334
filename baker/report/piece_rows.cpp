// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/piece_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "baker/layers/pieces.h"
#include "baker/report/json_text.h"
#include "runtime/src/base/double3.h"
#include "runtime/src/base/stream.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr double kShown = 0.01;  // share of the area; the text has no smaller rows or covers

double area_at_rest(const Surface& surface, std::uint32_t triangle) {
  Double3 p[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = surface.triangle_vertices[3 * std::size_t{triangle} + k];
    const float* const at = surface.rest_positions.data + 3 * std::size_t{vertex};
    p[k] = {double{at[0]}, double{at[1]}, double{at[2]}};
  }
  return 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
}

// The rows while they are summed up.
class Rows {
 public:
  explicit Rows(const OpenAsset& asset)
      : surface_(asset.surface()), number_(number_pieces(surface_)), mm_(1000 * asset.metres_per_unit()) {
    for (std::size_t p = 0; p < asset->piece_count(); ++p) {
      const PieceView piece = asset->piece(p);
      const auto [known, is_new] = by_name_.emplace(piece.name, rows_.size());
      if (is_new) rows_.emplace_back().name = piece.name;
      row_of_.push_back(known->second);
      ++rows_[known->second].count;
      rows_[known->second].border_mm += mm_ * double{piece.border};
    }
    covers_.resize(rows_.size());
    if (!rows_.empty()) sum_up(asset->skin());
  }

  // Files come from strangers: they may have no pieces, contacts of triangles that are in none, or empty ones.
  std::vector<PieceRow> finish() {
    if (rows_.empty()) return {};
    for (const Pair& pair : surface_.rest_contacts) {
      if (surface_.place_of_source[pair.a] == kNoPlace || surface_.place_of_source[pair.b] == kNoPlace) continue;
      const std::size_t a = row_of_triangle(surface_.place_of_source[pair.a]);
      const std::size_t b = row_of_triangle(surface_.place_of_source[pair.b]);
      crossing_.insert(std::minmax(a, b));
    }
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      PieceRow& row = rows_[r];
      for (const auto& [over, sum] : covers_[r]) {
        row.covers.push_back(
            {rows_[over].name, sum.first / row.area, sum.second / sum.first, crossing_.contains(std::minmax(r, over))});
      }
      std::ranges::stable_sort(row.covers, [](const auto& a, const auto& b) { return a.area > b.area; });
    }
    std::erase_if(rows_, [](const PieceRow& row) { return !(row.area > 0); });
    double whole = 0;
    for (const PieceRow& row : rows_) whole += row.area;
    for (PieceRow& row : rows_) {
      row.inside_out /= row.area;
      row.doubled /= row.area;
      row.area /= whole;
    }
    std::ranges::stable_sort(rows_, [](const PieceRow& a, const PieceRow& b) { return a.area > b.area; });
    return std::move(rows_);
  }

 private:
  // Pieces without a name count as the last.
  std::size_t row_of_triangle(std::uint32_t triangle) const {
    const std::uint32_t piece = number_[surface_.triangle_vertices[3 * std::size_t{triangle}]];
    return row_of_[std::min<std::size_t>(piece, row_of_.size() - 1)];
  }

  void sum_up(const SkinData& skin) {
    Stream pieces_over(skin.covers);
    for (std::size_t c = 0; c < surface_.clusters.size; ++c) {
      const spherechain::Cluster& cluster = surface_.clusters[c];
      std::uint32_t over = 0;
      pieces_over.read(over);
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        PieceRow& row = rows_[row_of_triangle(t)];
        const double area = area_at_rest(surface_, t);
        row.area += area;
        if ((surface_.layers[t] & kIsInsideOut) != 0) row.inside_out += area;
        if ((surface_.layers[t] & kIsDouble) != 0) row.doubled += area;
        if (over == 0) continue;
        auto& [covered, weighted] = covers_[row_of_triangle(t)][row_of_[over - 1]];
        covered += area;
        weighted += area * mm_ * double{skin.cover_distances[c]};
      }
    }
  }

  const Surface& surface_;
  std::vector<std::uint32_t> number_;  // of each vertex: its piece
  double mm_;                          // in a unit of the source
  std::map<std::string, std::size_t> by_name_;
  std::vector<std::size_t> row_of_;  // of each piece
  std::vector<PieceRow> rows_;
  std::vector<std::map<std::size_t, std::pair<double, double>>>
      covers_;  // by the row over a row: area, and times the distance
  std::set<std::pair<std::size_t, std::size_t>> crossing_;
};

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

}  // namespace

std::vector<PieceRow> piece_rows(const OpenAsset& asset) { return Rows(asset).finish(); }

ordered_json pieces_json(const std::vector<PieceRow>& rows) {
  ordered_json out = ordered_json::array();
  for (const PieceRow& row : rows) {
    ordered_json covers = ordered_json::array();
    for (const PieceRow::Cover& cover : row.covers) {
      covers.push_back({{"name", cover.name},
                        {"area_percent", 100 * cover.area},
                        {"distance_mm", cover.distance_mm},
                        {"crosses", cover.crosses}});
    }
    out.push_back({{"name", row.name},
                   {"count", row.count},
                   {"area_percent", 100 * row.area},
                   {"border_mm", row.border_mm},
                   {"inside_out_percent", 100 * row.inside_out},
                   {"doubled_percent", 100 * row.doubled},
                   {"covers", std::move(covers)}});
  }
  return out;
}

std::string pieces_text(const std::vector<PieceRow>& rows) {
  std::size_t widest = 5;
  for (const PieceRow& row : rows) {
    if (row.area >= kShown) widest = std::max(widest, row.name.size());
  }
  std::string out =
      fmt::format("\n{:<{}} {:>6} {:>6}  {}\n", "piece", widest, "count", "area", "what lies over it at rest");
  for (const PieceRow& row : rows) {
    if (row.area < kShown) continue;
    std::string over;
    for (const PieceRow::Cover& cover : row.covers) {
      if (cover.area < kShown) continue;
      over += fmt::format("{}{} ({}, {:.1f} mm away{})", over.empty() ? "" : ", ", cover.name, percent(cover.area),
                          cover.distance_mm, cover.crosses ? ", crosses it" : "");
    }
    if (row.inside_out >= 0.5) over += over.empty() ? "faces inwards" : "; faces inwards";
    out += fmt::format("{:<{}} {:>6} {:>6}  {}\n", row.name, widest, row.count, percent(row.area),
                       over.empty() ? "-" : over);
  }
  return out;
}

}  // namespace spherechain::baker
