// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/play/play.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

const char* side_name(Side side) {
  switch (side) {
    case Side::kLeft:
      return "left";
    case Side::kRight:
      return "right";
    default:
      return "none";
  }
}

}  // namespace

std::vector<PartRow> part_rows(const OpenAsset& asset) {
  const BodyParts parts = body_parts_of(asset);
  std::vector<PartRow> out;
  for (const BodyPart& part : parts.parts) {
    const bool has_bone = part.bone >= 0;
    out.push_back(
        {part.name, part.side, has_bone ? asset->bone(static_cast<std::size_t>(part.bone)).name : std::string(), 0});
  }
  for (const std::uint8_t part : parts.of_triangle) {
    if (part < out.size()) ++out[part].triangles;
  }
  return out;
}

ordered_json parts_json(const std::vector<PartRow>& parts) {
  ordered_json out = ordered_json::array();
  for (const PartRow& part : parts) {
    out.push_back({{"name", part.name},
                   {"side", side_name(part.side)},
                   {"bone", part.bone.empty() ? ordered_json() : ordered_json(part.bone)},
                   {"triangles", part.triangles}});
  }
  return out;
}

std::string parts_text(const std::vector<PartRow>& parts) {
  std::size_t widest = 4;
  for (const PartRow& part : parts) widest = std::max(widest, part.name.size());
  std::string out = fmt::format("\n{:<{}} {:>9}  {}\n", "part", widest, "triangles", "bone");
  for (const PartRow& part : parts) {
    out += fmt::format("{:<{}} {:>9}  {}\n", part.name, widest, part.triangles, part.bone.empty() ? "none" : part.bone);
  }
  return out;
}

}  // namespace spherechain::baker
