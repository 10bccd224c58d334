// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_motion.h"

#include <nlohmann/json.hpp>

#include "baker/page/base64.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

void add(std::vector<float>& out, const Vec3& v) {
  for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(v[k]));
}

void add(std::vector<float>& out, const std::vector<Affine>& bones) {
  for (const Affine& bone : bones) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) out.push_back(static_cast<float>(bone.matrix()(row, column)));
    }
  }
}

}  // namespace

void PageMotion::add(const Deformation& deformation, const std::vector<Vec3>& positions) {
  baker::add(bones_, deformation.bones);
  for (const double weight : deformation.morphs) morphs_.push_back(static_cast<float>(weight));
  morph_count_ = deformation.morphs.size();
  if (!deformation.positions.empty()) {
    const std::vector<float> packed = pack(positions);
    vertices_.insert(vertices_.end(), packed.begin(), packed.end());
  }
  Eigen::AlignedBox3d box;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : positions) {
    const Vec3 from = (p - axes_.origin) / axes_.height;
    const Vec3 at(from.dot(axes_.left), from.dot(axes_.up), from.dot(axes_.forward));
    box.extend(at);
    sum += at;
  }
  baker::add(boxes_, box.min());
  baker::add(boxes_, box.max());
  baker::add(centers_, sum / static_cast<double>(positions.size()));
}

void PageMotion::add_animated(const Deformation& deformation) { baker::add(animated_, deformation.bones); }

std::size_t PageMotion::bytes() const {
  return sizeof(float) * (bones_.size() + animated_.size() + vertices_.size() + boxes_.size() + centers_.size());
}

bool PageMotion::moves(std::size_t morph) const {
  for (std::size_t i = morph; i < morphs_.size(); i += morph_count_) {
    if (morphs_[i] != morphs_[morph]) return true;
  }
  return false;
}

std::vector<Vec3> PageMotion::rest() const {
  std::vector<double> still;
  for (std::size_t m = 0; m < morph_count_; ++m) still.push_back(moves(m) ? 0.0 : static_cast<double>(morphs_[m]));
  return morph(character_.source_positions, character_.rig.morphs, still);
}

ordered_json PageMotion::json(Still still) const {
  ordered_json out{{"boxes", base64(boxes_)}, {"centers", base64(centers_)}};
  if (!vertices_.empty()) {
    out["vertices"] = base64(vertices_);
    return out;
  }
  out["bones"] = base64(bones_);
  if (!animated_.empty()) out["animated"] = base64(animated_);
  out["morph_weights"] = base64(morphs_);
  ordered_json& targets = out["morphs"] = ordered_json::array();
  for (std::size_t m = 0; m < morph_count_; ++m) {
    if (!moves(m) && (still == Still::kInRest || morphs_[m] == 0)) continue;
    const Morph& target = character_.rig.morphs[m];
    std::vector<float> weights;
    for (std::size_t i = m; i < morphs_.size(); i += morph_count_) weights.push_back(morphs_[i]);
    targets.push_back({{"name", target.name},
                       {"vertices", base64(target.vertices)},
                       {"deltas", base64(pack(target.deltas))},
                       {"weights", base64(weights)}});
  }
  return out;
}

}  // namespace spherechain::baker
