// SPDX-License-Identifier: GPL-3.0-or-later
#include "planted_library.h"

#include "glb_writer.h"
#include "two_shapes.h"

namespace {

int mesh(Glb& glb, const Shape& shape) {
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  for (const auto& p : shape.positions) {
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
  }
  for (const auto& triangle : shape.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  const int at = glb.accessor(positions, "VEC3");
  glb.json["meshes"].push_back(
      {{"primitives", {{{"attributes", {{"POSITION", at}}}, {"indices", glb.accessor(corners, "SCALAR")}}}}});
  return static_cast<int>(glb.json["meshes"].size()) - 1;
}

}  // namespace

std::string planted_character(const std::vector<PlantedClip>& clips) {
  constexpr double kTouching = 0.5 + 0.3;  // the ball's place, from the wall's middle
  Glb glb;
  const int wall = mesh(glb, box(0.5, 1, 1)), sphere = mesh(glb, ball(0.3, 12));
  glb.json["nodes"] = {{{"name", "character"}, {"children", {1, 2}}},
                       {{"name", "wall"}, {"mesh", wall}},
                       {{"name", "ball"}, {"mesh", sphere}, {"translation", {2, 0, 0}}}};
  for (const PlantedClip& clip : clips) {
    std::vector<float> times, places, still, sizes;
    for (std::size_t i = 0; i < clip.depths_mm.size(); ++i) {
      times.push_back(static_cast<float>(i) / 30 * clip.time_scale);
      const double height = clip.heights_mm.empty() ? 0 : clip.heights_mm[i];
      places.insert(places.end(),
                    {static_cast<float>(kTouching - clip.depths_mm[i] / 1000), static_cast<float>(height / 1000), 0});
      still.insert(still.end(), {0, 0, 0});
      const auto size = static_cast<float>(clip.sizes.empty() ? 1 : clip.sizes[i]);
      sizes.insert(sizes.end(), {size, size, size});
    }
    const int input = glb.accessor(times, "SCALAR");
    const auto sampler = [&](const std::vector<float>& values) {
      return nlohmann::json{{"input", input},
                            {"output", glb.accessor(values, "VEC3")},
                            {"interpolation", clip.is_linear ? "LINEAR" : "STEP"}};
    };
    const auto channel = [](int number, int node, const char* path = "translation") {
      return nlohmann::json{{"sampler", number}, {"target", {{"node", node}, {"path", path}}}};
    };
    glb.json["animations"].push_back({{"name", clip.name},
                                      {"samplers", {sampler(still), sampler(places)}},
                                      {"channels", {channel(0, 1), channel(1, 2)}}});
    if (clip.sizes.empty()) continue;
    nlohmann::json& animation = glb.json["animations"].back();
    animation["samplers"].push_back(sampler(sizes));
    animation["channels"].push_back(channel(2, 2, "scale"));
  }
  return glb.bytes();
}
