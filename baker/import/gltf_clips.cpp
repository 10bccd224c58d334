// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/gltf_clips.h"

#include <algorithm>

#include "baker/import/notes.h"

namespace spherechain::baker {
namespace {

constexpr int kFloatType = TINYGLTF_COMPONENT_TYPE_FLOAT;

class ClipReader {
 public:
  ClipReader(const GltfFile& file, const GltfNodes& nodes, const std::vector<GltfMorphs>& morphs)
      : file_(file), nodes_(nodes), morphs_(morphs) {}

  Clip read(std::size_t index) {
    const tinygltf::Animation& animation = file_.model.animations[index];
    where_ = "animations[" + std::to_string(index) + "]";
    Clip clip;
    clip.name = animation.name.empty() ? "animation_" + std::to_string(index) : animation.name;
    for (const tinygltf::AnimationChannel& channel : animation.channels) {
      if (channel.target_node >= 0) {
        add(channel, animation.samplers[static_cast<std::size_t>(channel.sampler)], clip);
      }
    }
    for (const Channel& channel : clip.channels) clip.duration = std::max(clip.duration, channel.times.back());
    return clip;
  }

 private:
  void add(const tinygltf::AnimationChannel& in, const tinygltf::AnimationSampler& sampler, Clip& clip) {
    const auto node = static_cast<std::size_t>(in.target_node);
    Channel channel{ChannelPath::kTranslation, nodes_.of_file[node], interpolation(sampler), {}, {}};
    if (in.target_path == "translation" || in.target_path == "scale") {
      if (in.target_path == "scale") channel.path = ChannelPath::kScale;
      if (keys(sampler, TINYGLTF_TYPE_VEC3, {kFloatType}, 1, channel)) clip.channels.push_back(std::move(channel));
    } else if (in.target_path == "rotation") {
      channel.path = ChannelPath::kRotation;
      if (keys(sampler, TINYGLTF_TYPE_VEC4, kUnit, 1, channel)) clip.channels.push_back(std::move(channel));
    } else if (in.target_path == "weights" && morphs_[node].count > 0) {
      channel.path = ChannelPath::kMorphWeight;
      if (keys(sampler, TINYGLTF_TYPE_SCALAR, kUnit, morphs_[node].count, channel)) split(channel, morphs_[node], clip);
    }
  }

  Interpolation interpolation(const tinygltf::AnimationSampler& sampler) const {
    if (sampler.interpolation == "STEP") return Interpolation::kStep;
    if (sampler.interpolation == "CUBICSPLINE") return Interpolation::kCubicSpline;
    if (!sampler.interpolation.empty() && sampler.interpolation != "LINEAR") {
      file_.fail(where_ + " has an interpolation '" + sampler.interpolation + "', which glTF does not know");
    }
    return Interpolation::kLinear;
  }

  // False where there are none. `elements` of the output belong to a key, or three times as many with cubic splines.
  bool keys(const tinygltf::AnimationSampler& sampler, int type, const std::vector<int>& components,
            std::size_t elements, Channel& channel) {
    channel.times = file_.numbers(sampler.input, TINYGLTF_TYPE_SCALAR, {kFloatType});
    channel.values = file_.numbers(sampler.output, type, components);
    const auto width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
    const std::size_t a_key = width * elements * (channel.interpolation == Interpolation::kCubicSpline ? 3 : 1);
    if (channel.values.size() != channel.times.size() * a_key) {
      file_.fail(where_ + " has " + std::to_string(channel.values.size()) + " numbers in accessors[" +
                 std::to_string(sampler.output) + "] for " + std::to_string(channel.times.size()) + " keys of " +
                 std::to_string(a_key));
    }
    total_ += channel.times.size() + channel.values.size();
    if (total_ > 8 * kGltfElementsMax) file_.fail(where_ + " and those before it have too many keys for a character");
    drop_repeats(channel, a_key, sampler.input);
    return !channel.times.empty();
  }

  // Some exporters give a time twice; the last of them holds.
  void drop_repeats(Channel& channel, std::size_t a_key, int accessor) const {
    if (!channel.times.empty() && channel.times.front() < 0) {
      file_.fail(where_ + ": accessors[" + std::to_string(accessor) + "] has a key at " +
                 std::to_string(channel.times.front()) + " s (times begin at 0: move the keys, and export it again)");
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < channel.times.size(); ++k) {
      if (kept > 0 && channel.times[k] < channel.times[kept - 1]) {
        file_.fail(where_ + ": the times in accessors[" + std::to_string(accessor) + "] do not ascend");
      }
      if (kept == 0 || channel.times[k] > channel.times[kept - 1]) ++kept;
      channel.times[kept - 1] = channel.times[k];
      if (kept - 1 < k) std::copy_n(&channel.values[k * a_key], a_key, &channel.values[(kept - 1) * a_key]);
    }
    channel.times.resize(kept);
    channel.values.resize(kept * a_key);
  }

  // All targets' weights of a key lie side by side, and so do the tangents of a spline.
  void split(const Channel& all, const GltfMorphs& morphs, Clip& clip) const {
    for (Index m = 0; m < morphs.count; ++m) {
      Channel one{all.path, morphs.first + m, all.interpolation, all.times, {}};
      for (std::size_t i = m; i < all.values.size(); i += morphs.count) one.values.push_back(all.values[i]);
      clip.channels.push_back(std::move(one));
    }
  }

  // Rotations and weights may be stored as integer fractions.
  const std::vector<int> kUnit{kFloatType, TINYGLTF_COMPONENT_TYPE_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                               TINYGLTF_COMPONENT_TYPE_SHORT, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
  const GltfFile& file_;
  const GltfNodes& nodes_;
  const std::vector<GltfMorphs>& morphs_;
  std::string where_;
  std::size_t total_ = 0;
};

}  // namespace

std::vector<Clip> read_clips(const GltfFile& file, const GltfNodes& nodes, const std::vector<GltfMorphs>& morphs) {
  ClipReader reader(file, nodes, morphs);
  std::vector<Clip> clips;
  for (std::size_t a = 0; a < file.model.animations.size(); ++a) {
    Clip clip = reader.read(a);
    clip.in_file = static_cast<int>(a);
    if (clip.channels.empty()) {
      add_note(file.name + ": the clip '" + clip.name + "' has no keys that move a node: it is left out");
    } else {
      clips.push_back(std::move(clip));
    }
  }
  return clips;
}

}  // namespace spherechain::baker
