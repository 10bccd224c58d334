// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/page/base64.h"
#include "baker/page/shrink_picture.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr int kPictureSize = 512;  // pixels a side
constexpr std::size_t kPicturesMax = 64;
constexpr float kUvMax = 1000;  // a picture that is repeated more often is not seen

std::string hex(const std::array<float, 3>& colour) {
  const auto byte = [](float x) { return static_cast<int>(std::lround(255 * (x >= 0 && x <= 1 ? x : 1))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(colour[0]), byte(colour[1]), byte(colour[2]));
}

// In 16 bits between the lowest and the highest.
ordered_json uvs_json(const SourceLook& look) {
  std::array<float, 2> low{0, 0}, high{1, 1};
  const auto finite = [](float x) { return x >= -kUvMax && x <= kUvMax ? x : 0; };
  for (const auto& uv : look.uvs) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], finite(uv[k]));
      high[k] = std::max(high[k], finite(uv[k]));
    }
  }
  std::vector<std::uint16_t> shares;
  for (const auto& uv : look.uvs) {
    for (std::size_t k = 0; k < 2; ++k) {
      shares.push_back(static_cast<std::uint16_t>(std::lround(65535 * (finite(uv[k]) - low[k]) / (high[k] - low[k]))));
    }
  }
  return {{"low", low}, {"high", high}, {"shares", base64(shares)}};
}

}  // namespace

ordered_json page_look(const SourceLook& look) {
  std::vector<std::uint8_t> keeps_alpha(look.pictures.size(), 0);
  for (const SkinMaterial& material : look.materials) {
    if (material.picture >= 0 && material.cut > 0) keeps_alpha[static_cast<std::size_t>(material.picture)] = 1;
  }
  std::vector<int> numbers;  // in the page; -1: not there
  ordered_json pictures = ordered_json::array(), materials = ordered_json::array();
  for (std::size_t i = 0; i < look.pictures.size(); ++i) {
    std::string picture = shrink_picture(look.pictures[i], kPictureSize, keeps_alpha[i] != 0);
    const bool is_shown = !picture.empty() && pictures.size() < kPicturesMax;
    numbers.push_back(is_shown ? static_cast<int>(pictures.size()) : -1);
    if (is_shown) pictures.push_back(std::move(picture));
  }
  for (const SkinMaterial& material : look.materials) {
    const int picture = material.picture < 0 ? -1 : numbers[static_cast<std::size_t>(material.picture)];
    ordered_json& made =
        materials.emplace_back(ordered_json{{"colour", hex(picture < 0 ? material.colour : material.tint)}});
    if (picture >= 0) made["picture"] = picture;
    if (picture >= 0 && material.cut > 0) made["cut"] = material.cut;
  }
  const bool is_plain = std::all_of(look.material_of.begin(), look.material_of.end(), [&](std::uint16_t m) {
    const std::uint16_t first = look.material_of.front();
    return m == first || (m != kNoMaterial && first != kNoMaterial && materials[m] == materials[first]);
  });
  if (pictures.empty() && is_plain) return {};
  ordered_json out{{"of", base64(look.material_of)}, {"materials", materials}, {"pictures", pictures}};
  if (!pictures.empty()) out["uvs"] = uvs_json(look);
  return out;
}

}  // namespace spherechain::baker
