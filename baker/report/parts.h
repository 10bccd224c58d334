// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bind/body_parts.h"
#include "spherechain/asset.h"

namespace spherechain::baker {

// A body part as it is shown.
struct PartRow {
  std::string name;
  Side side;
  std::string bone;  // that it follows; empty where there is none
  std::size_t triangles;
};

// `bones` are the names of the asset's.
std::vector<PartRow> part_rows(const BodyParts& parts, const std::vector<std::string>& bones);

// Those of an asset: its regions, until it stores its body parts.
std::vector<PartRow> part_rows(const Asset& asset);

nlohmann::ordered_json parts_json(const std::vector<PartRow>& parts);
std::string parts_text(const std::vector<PartRow>& parts);

}  // namespace spherechain::baker
