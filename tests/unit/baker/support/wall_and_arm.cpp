// SPDX-License-Identifier: GPL-3.0-or-later
#include "wall_and_arm.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace {

constexpr double kMargin = 0.0015;  // metres: the tool's

}  // namespace

int mesh_of(Glb& glb, const Shape& shape, double x, double y) {
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  for (const auto& p : shape.positions) {
    positions.insert(positions.end(),
                     {static_cast<float>(p[0] + x), static_cast<float>(p[1] + y), static_cast<float>(p[2])});
  }
  for (const auto& triangle : shape.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  const int at = glb.accessor(positions, "VEC3");
  glb.json["meshes"].push_back(
      {{"primitives", {{{"attributes", {{"POSITION", at}}}, {"indices", glb.accessor(corners, "SCALAR")}}}}});
  return static_cast<int>(glb.json["meshes"].size()) - 1;
}

std::string wall_and_arm(const std::vector<double>& degrees, int clips) {
  Glb glb;
  const int wall = mesh_of(glb, box(0.5, 1, 1), 0, 0), arm = mesh_of(glb, box(0.1, 0.4, 0.1), 0, -0.4);
  const int far = mesh_of(glb, box(0.1, 0.1, 0.1), 2, 0);  // between the two: neighbours would fold
  glb.json["nodes"] = {{{"name", "wall"}, {"mesh", wall}, {"children", {1}}},
                       {{"name", "block"}, {"mesh", far}, {"translation", {3, 0.5, 0}}, {"children", {2}}},
                       {{"name", "paddle"},
                        {"mesh", arm},
                        {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}},
                        {"extras", {{"mine", 7}}}}};
  for (int c = 0; c < clips; ++c) {
    std::vector<float> times, rotations, places;
    for (std::size_t f = 0; f < degrees.size(); ++f) {
      const double half = -(degrees[f] + c) * std::numbers::pi / 360;
      times.push_back(static_cast<float>(f) / 30);
      rotations.insert(rotations.end(), {0, 0, static_cast<float>(std::sin(half)), static_cast<float>(std::cos(half))});
      places.insert(places.end(), {static_cast<float>(0.6 + kMargin), 0.5F, 0});
    }
    const int input = glb.accessor(times, "SCALAR");
    glb.json["animations"].push_back({{"name", "swing"},
                                      {"samplers",
                                       {{{"input", input}, {"output", glb.accessor(rotations, "VEC4")}},
                                        {{"input", input}, {"output", glb.accessor(places, "VEC3")}}}},
                                      {"channels",
                                       {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                                        {{"sampler", 1}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
  }
  return glb.bytes();
}

std::string recording_of_arm(const std::vector<double>& degrees, bool is_hinge) {
  const std::string moves = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n",
                    turns = is_hinge ? "CHANNELS 1 Zrotation\n" : "CHANNELS 3 Zrotation Xrotation Yrotation\n";
  std::string out = "HIERARCHY\nROOT wall\n{\nOFFSET 0 0 0\n" + moves + "JOINT block\n{\nOFFSET 3 0.5 0\n" + moves +
                    "JOINT paddle\n{\nOFFSET 0 0 0\n" + turns + "End Site\n{\nOFFSET 0 -0.8 0\n}\n}\n}\n}\n";
  out += fmt::format("MOTION\nFrames: {}\nFrame Time: 0.0333333\n", degrees.size());
  for (const double degree : degrees) {
    out += fmt::format("0 0 0 0 0 0  {:.4f} 0.5 0 0 0 0  {:.3f}{}\n", 0.6 + kMargin, -degree, is_hinge ? "" : " 0 0");
  }
  return out;
}

nlohmann::json json_of(const std::string& glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, 4);
  return nlohmann::json::parse(glb.substr(20, size));
}
