// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrestlers.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_inputs.h"

namespace spherechain::bench {

void require(Status status, const char* what) {
  if (status != SC_OK) throw std::runtime_error(fmt::format("{}: {}", what, sc_code_text(status.code)));
}

baker::Affine affine_at(const float* bone) {
  baker::Affine out = baker::Affine::Identity();
  for (Eigen::Index k = 0; k < 12; ++k) out.matrix()(k / 4, k % 4) = double{bone[k]};
  return out;
}
void put(const baker::Affine& bone, float* out) {
  for (Eigen::Index k = 0; k < 12; ++k) out[k] = static_cast<float>(bone.matrix()(k / 4, k % 4));
}

Wrestlers::Wrestlers(int frames) {
  load(human_, "human", "{}", 33);
  table_ = memory_for(skin_table_words(&human_.asset));
  require(prepare_skin(&human_.asset, table_.data()->words, skin_table_words(&human_.asset)), "skin table");
  require(read_skin_table(human_.view(), table_.data()->words, surface_), "skin table");
  make_truth();
  const auto motions = motions_of(human_.bake);
  const auto motion = [&](const std::string& name) -> const baker::Motion& {
    return *std::find_if(motions.begin(), motions.end(), [&](const auto& m) { return m.name == name; })->motion;
  };
  for (const auto& [a, b] :
       {std::pair{"Boxing_Toes", "Boxing_Toes"}, std::pair{"01_01", "01_03"}, std::pair{"01_03", "Boxing_Toes"}}) {
    for (int i = 0; i < frames; ++i) {
      const double t = (i + 0.5) / frames;
      add(motion(a).at(t), motion(b).at(t < 0.5 ? t + 0.5 : t - 0.5));
    }
  }
}

Frame Wrestlers::random_placement(std::mt19937& random) const {
  Frame frame;
  frame.bones[0] = frames_[random() % frames_.size()].bones[0];
  const std::vector<float> bones = frames_[random() % frames_.size()].bones[0];
  const double reach = 0.25 * double{human_.view().info().height};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> off(-reach, reach);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
  skin(frame, 0);
  const baker::Vec3 middle = middle_of(frame.positions[0]);
  const baker::Affine place = Eigen::Translation3d(middle + baker::Vec3(off(random), off(random), off(random))) *
                              baker::Affine(turn) * Eigen::Translation3d(-middle);
  for (std::size_t b = 0; b < bones.size(); b += 12) {
    frame.bones[1].resize(b + 12);
    put(place * affine_at(bones.data() + b), frame.bones[1].data() + b);
  }
  skin(frame, 1);
  frame.expected = baker::find_intersections(truth_, frame.positions[0], truth_, frame.positions[1]);
  return frame;
}

void Wrestlers::add(const baker::Deformation& a, const baker::Deformation& b) {
  Frame frame;
  const AssetInfo info = human_.view().info();
  baker::Vec3 middles[2];
  for (int body = 0; body < 2; ++body) {
    for (const baker::Affine& bone : (body == 0 ? a : b).bones) {
      frame.bones[body].resize(frame.bones[body].size() + 12);
      put(bone, frame.bones[body].data() + frame.bones[body].size() - 12);
    }
    skin(frame, body);
    middles[body] = middle_of(frame.positions[body]);
  }
  const baker::Vec3 up(double{info.up.x}, double{info.up.y}, double{info.up.z});
  const baker::Vec3 forward(double{info.forward.x}, double{info.forward.y}, double{info.forward.z});
  baker::Affine place = baker::Affine::Identity();
  place.linear() = 2 * up * up.transpose() - Eigen::Matrix3d::Identity();  // half a turn
  place.translation() = middles[0] + 0.2 * double{info.height} * forward - place.linear() * middles[1];
  for (std::size_t i = 0; i < b.bones.size(); ++i) put(place * b.bones[i], frame.bones[1].data() + 12 * i);
  skin(frame, 1);
  frame.expected = baker::find_intersections(truth_, frame.positions[0], truth_, frame.positions[1]);
  frames_.push_back(std::move(frame));
}
void Wrestlers::skin(Frame& frame, int body) const {
  frame.positions[body].assign(3 * human_.bake.character.source_positions.size(), 0);
  Pose pose = human_.pose(0);
  pose.bones = frame.bones[body].data();
  skin_surface(surface_, pose, supported_targets()[0], frame.positions[body].data(), 3);
}
// By the source vertices that the runtime skins.
void Wrestlers::make_truth() {
  for (std::uint32_t t = 0; t < surface_.place_of_source.size; ++t) {
    const std::uint32_t place = surface_.place_of_source[t];
    if (place == kNoPlace) continue;
    const std::uint32_t* const v = surface_.triangle_vertices.data + 3 * std::size_t{place};
    truth_.source_triangle.push_back(t);
    truth_.corners.push_back(
        {surface_.source_vertices[v[0]], surface_.source_vertices[v[1]], surface_.source_vertices[v[2]]});
  }
}
baker::Vec3 Wrestlers::middle_of(const std::vector<float>& positions) const {
  baker::Vec3 sum(0, 0, 0);
  for (const std::uint32_t v : surface_.source_vertices) {
    const float* const p = positions.data() + 3 * std::size_t{v};
    sum += baker::Vec3(double{p[0]}, double{p[1]}, double{p[2]});
  }
  return sum / static_cast<double>(surface_.source_vertices.size);
}

}  // namespace spherechain::bench
