// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/bodies.h"

#include <utility>

#include "baker/import/makehuman.h"
#include "baker/os/written_file.h"

namespace spherechain::baker {
namespace {

// MakeHumanBody's gender, age, muscle and weight.
struct NamedBody {
  const char* name;
  double gender, age, muscle, weight;
};

constexpr NamedBody kBodies[]{
    {"baby", 0.5, 0, 0.5, 0.5},      {"child", 0.5, 0.19, 0.5, 0.5}, {"woman", 0, 0.5, 0.5, 0.5},
    {"man", 1, 0.5, 0.5, 0.5},       {"thin_woman", 0, 0.5, 0.3, 0}, {"thin_man", 1, 0.5, 0.3, 0},
    {"heavy_woman", 0, 0.5, 0.4, 1}, {"heavy_man", 1, 0.5, 0.4, 1},  {"muscular_man", 1, 0.5, 1, 0.7},
    {"old_woman", 0, 1, 0.3, 0.5},   {"old_man", 1, 1, 0.3, 0.5},    {"old_heavy_man", 1, 1, 0.3, 1}};

}  // namespace

bool is_makehuman(const std::filesystem::path& folder) {
  return std::filesystem::is_regular_file(folder / "3dobjs/base.obj");
}

std::vector<std::string> write_bodies(const std::filesystem::path& makehuman, const std::filesystem::path& to) {
  std::vector<std::string> out;
  for (const NamedBody& one : kBodies) {
    MakeHumanBody body;
    body.gender = one.gender;
    body.age = one.age;
    body.muscle = one.muscle;
    body.weight = one.weight;
    out.push_back((to / (std::string(one.name) + ".glb")).string());
    write_atomically(out.back(), make_body_as_glb(makehuman, body));
  }
  return out;
}

}  // namespace spherechain::baker
