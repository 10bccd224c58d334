// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/hidden_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "baker/import/named_file.h"

namespace spherechain::baker {

void HiddenJoints::add(const Deformation& deformation) {
  constexpr double kNothing = 1e-3;  // of the size at rest
  ++frames_;
  std::set<std::size_t> hidden;
  for (std::size_t b = 0; b < deformation.bones.size(); ++b) {
    if (deformation.bones[b].linear().colwise().norm().maxCoeff() < kNothing) hidden.insert(b);
  }
  if (hidden.empty()) return;
  // A joint below a hidden one is hidden by that.
  const SourceRig& rig = animated_.character().rig;
  if (rig.bones.size() != deformation.bones.size()) return;
  std::set<Index> nodes;
  for (const std::size_t b : hidden) nodes.insert(rig.bones[b].node);
  for (const std::size_t b : hidden) {
    int above = rig.nodes[rig.bones[b].node].parent;
    while (above >= 0 && !nodes.contains(static_cast<Index>(above))) {
      above = rig.nodes[static_cast<std::size_t>(above)].parent;
    }
    if (above < 0) ++hidden_[b];
  }
}

std::string HiddenJoints::text() const {
  std::map<int, std::vector<std::string>> names;  // by the number of frames
  for (const auto& [bone, frames] : hidden_) names[frames].push_back(animated_.bone_names()[bone]);
  std::string out;
  constexpr std::size_t kNamed = 4;
  for (const auto& [frames, all] : names) {
    out += out.empty() ? "" : "; ";
    for (std::size_t i = 0; i < std::min(all.size(), kNamed); ++i) out += (i > 0 ? ", " : "") + in_quotes(all[i]);
    if (all.size() > kNamed) out += fmt::format(" and {} more", all.size() - kNamed);
    out += fmt::format(" {} a scale of 0 in {} of {} frame{}, so nothing there meets anything",
                       all.size() == 1 ? "has" : "have", frames, frames_, frames_ == 1 ? "" : "s");
  }
  return out;
}

std::string unseen_text(const HiddenJoints& hidden, const ClipFrames& clip) {
  const std::string out = hidden.text();
  if (clip.clip == nullptr || clip.own_count > 1) return out;
  std::size_t keys = 0;
  for (const Channel& channel : clip.clip->channels) keys = std::max(keys, channel.times.size());
  if (keys < 3) return out;
  return out + (out.empty() ? "" : "; ") +
         fmt::format("lasts {:.2g} s, so one of its {} keys is looked at (are its times in seconds?)",
                     clip.clip->duration, keys);
}

}  // namespace spherechain::baker
