// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/play/asset_file.h"

namespace spherechain::baker {

// Pieces of an asset's skin that have one name, and what lies over them at rest.
struct PieceRow {
  struct Cover {
    std::string name;
    double area = 0;         // share of the row's
    double distance_mm = 0;  // the mean by area
    bool crosses = false;    // triangles of the two intersect at rest
  };
  std::string name;
  std::size_t count = 0;
  double area = 0;                     // share of the skin's
  double border_mm = 0;                // length of edges that one triangle has
  double inside_out = 0, doubled = 0;  // shares of its area: faces inwards; lies on other triangles of the same corners
  std::vector<Cover> covers;           // the largest first
};

// The largest first.
std::vector<PieceRow> piece_rows(const OpenAsset& asset);

nlohmann::ordered_json pieces_json(const std::vector<PieceRow>& rows);
std::string pieces_text(const std::vector<PieceRow>& rows);

}  // namespace spherechain::baker
