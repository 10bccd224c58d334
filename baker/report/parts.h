// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/bind/body_parts.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {

// A body part as it is shown.
struct PartRow {
  std::string name;
  Side side;
  std::string bone;  // the bone that it follows; empty: none
  std::size_t triangles;
};

// The body parts of an asset.
std::vector<PartRow> part_rows(const OpenAsset& asset);

nlohmann::ordered_json parts_json(const std::vector<PartRow>& parts);
std::string parts_text(const std::vector<PartRow>& parts);

}  // namespace spherechain::baker
