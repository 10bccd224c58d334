// SPDX-License-Identifier: GPL-3.0-or-later
#include <assimp/commonMetaData.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include "baker/import/assimp_scene.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr double kTicksPerSecond = 25;  // where a file does not say, by assimp's convention
// Where an X file does not say, Direct3D counts 3ds Max's ticks. Some exporters number frames instead.
constexpr double kDirectTicks = 4800, kDirectTicksApart = 40;

using Channels = std::map<std::string, const aiNodeAnim*>;

// Keys in seconds, sorted; of several at one time the first.
class Keys {
 public:
  Keys(const std::string& file, const std::string& node, double ticks) : file_(file), node_(node), ticks_(ticks) {}

  template <typename Key, typename Values>
  Channel read(ChannelPath path, Index target, const Key* keys, unsigned count, const Values& values) const {
    std::vector<const Key*> order;
    for (unsigned k = 0; k < count; ++k) {
      order.push_back(&keys[k]);
      bool finite = std::isfinite(keys[k].mTime);
      for (const double v : values(keys[k])) finite = finite && std::isfinite(v);
      if (!finite) throw Error(ExitCode::kFile, file_ + ": a key of '" + node_ + "' is not finite");
    }
    std::stable_sort(order.begin(), order.end(), [](const Key* a, const Key* b) { return a->mTime < b->mTime; });
    Channel channel{path, target, Interpolation::kLinear, {}, {}};
    for (const Key* key : order) {
      const double seconds = key->mTime / ticks_;
      if (!channel.times.empty() && seconds <= channel.times.back()) continue;
      channel.times.push_back(seconds);
      for (const double v : values(*key)) channel.values.push_back(v);
    }
    return channel;
  }

 private:
  const std::string& file_;
  const std::string& node_;
  double ticks_;
};

std::vector<Channel> read_node(const aiNodeAnim& animation, Index target, double ticks, const std::string& file) {
  const std::string name = animation.mNodeName.C_Str();
  const Keys keys(file, name, ticks);
  const auto vector = [](const aiVectorKey& key) {
    return std::array<double, 3>{key.mValue.x, key.mValue.y, key.mValue.z};
  };
  const auto turn = [](const aiQuatKey& key) {
    return std::array<double, 4>{key.mValue.x, key.mValue.y, key.mValue.z, key.mValue.w};
  };
  std::vector<Channel> channels{
      keys.read(ChannelPath::kTranslation, target, animation.mPositionKeys, animation.mNumPositionKeys, vector),
      keys.read(ChannelPath::kRotation, target, animation.mRotationKeys, animation.mNumRotationKeys, turn),
      keys.read(ChannelPath::kScale, target, animation.mScalingKeys, animation.mNumScalingKeys, vector)};
  channels.erase(std::remove_if(channels.begin(), channels.end(), [](const Channel& c) { return c.times.empty(); }),
                 channels.end());
  return channels;
}

Affine local_at(const aiNode& link, const std::vector<Channel>& channels, double seconds) {
  Node node;
  node.local = to_affine(link.mTransformation);
  if (channels.empty()) return node.local;
  decompose(node);
  for (const Channel& channel : channels) {
    const Eigen::Vector4d v = sample(channel, seconds);
    if (channel.path == ChannelPath::kTranslation) node.translation = v.head<3>();
    if (channel.path == ChannelPath::kRotation) node.rotation = Eigen::Quaterniond(v);
    if (channel.path == ChannelPath::kScale) node.scale = v.head<3>();
  }
  return Affine(Eigen::Translation3d(node.translation) * node.rotation * Eigen::Scaling(node.scale));
}

// Between the keys of a turn about a pivot the node itself moves on an arc: keys on it, 30 a second.
std::vector<double> on_arcs(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<double> out;
  for (std::size_t k = 0; k < times.size(); ++k) {
    out.push_back(times[k]);
    const double gap = k + 1 < times.size() ? times[k + 1] - times[k] : 0;
    constexpr double kStepsMax = 256;
    const double steps = std::min(std::ceil(gap * 30), kStepsMax);
    for (double step = 1; step < steps; ++step) out.push_back(times[k] + gap * step / steps);
  }
  return out;
}

// The channels of a node's pivots, folded into one translation, rotation and scale of the node.
std::vector<Channel> fold(const std::vector<const aiNode*>& chain, const Channels& by_name, Index target, double ticks,
                          const std::string& file) {
  std::vector<std::vector<Channel>> links;
  std::vector<double> times;
  for (const aiNode* link : chain) {
    const auto found = by_name.find(link->mName.C_Str());
    links.push_back(found == by_name.end() ? std::vector<Channel>() : read_node(*found->second, target, ticks, file));
  }
  // One key says no more than that nothing moves, and assimp puts some of its own at the file's time 0.
  for (const bool is_moving : {true, false}) {
    for (const std::vector<Channel>& link : links) {
      for (const Channel& channel : link) {
        if (channel.times.size() > 1 || !is_moving)
          times.insert(times.end(), channel.times.begin(), channel.times.end());
      }
    }
    if (!times.empty()) break;
  }
  if (times.empty()) return {};
  times = on_arcs(std::move(times));
  Channel move{ChannelPath::kTranslation, target, Interpolation::kLinear, times, {}},
      turn{ChannelPath::kRotation, target, Interpolation::kLinear, times, {}},
      scale{ChannelPath::kScale, target, Interpolation::kLinear, times, {}};
  for (const double seconds : times) {
    Node node;
    for (std::size_t l = 0; l < chain.size(); ++l) node.local = node.local * local_at(*chain[l], links[l], seconds);
    decompose(node);
    const Eigen::Vector4d q = node.rotation.coeffs();
    move.values.insert(move.values.end(), node.translation.begin(), node.translation.end());
    turn.values.insert(turn.values.end(), q.begin(), q.end());
    scale.values.insert(scale.values.end(), node.scale.begin(), node.scale.end());
  }
  return {move, turn, scale};
}

// "Mesh" or "Mesh*3": the mesh's name, or its node's.
bool is_for(const aiMeshMorphAnim& animation, const MeshInstance& instance, const AssimpScene& flat) {
  std::string name = animation.mName.C_Str();
  const char* const node = flat.chains[instance.node].back()->mName.C_Str();
  if (name == instance.mesh->mName.C_Str() || name == node) return true;
  name = name.substr(0, name.rfind('*'));
  return name == instance.mesh->mName.C_Str() || name == node;
}

void read_morph_weights(const aiMeshMorphAnim& animation, const MeshInstance& instance, double ticks,
                        const std::string& file, Clip& clip) {
  const std::string name = animation.mName.C_Str();
  for (unsigned a = 0; a < instance.mesh->mNumAnimMeshes; ++a) {
    const auto weight = [&](const aiMeshMorphKey& key) {
      double sum = 0;
      for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i) sum += key.mValues[i] == a ? key.mWeights[i] : 0.0;
      return std::array<double, 1>{sum};
    };
    Channel channel =
        Keys(file, name, ticks)
            .read(ChannelPath::kMorphWeight, instance.first_morph + a, animation.mKeys, animation.mNumKeys, weight);
    if (!channel.times.empty()) clip.channels.push_back(std::move(channel));
  }
}

// The scale of an FBX node, as its chain has it.
Vec3 scaling_of(const std::vector<const aiNode*>& chain) {
  for (const aiNode* link : chain) {
    if (std::string_view(link->mName.C_Str()).ends_with("_$AssimpFbx$_Scaling"))
      return to_affine(link->mTransformation).linear().diagonal();
  }
  return Vec3::Ones();
}

// In the rotations of a node without pivots assimp applies a PostRotation that FBX takes back. The chain's links have
// it right. Assimp takes a scale out of the keys after that, with other signs than the file's where it mirrors.
void take_back(const aiNode& post, const std::vector<const aiNode*>& chain, std::vector<Channel>& channels) {
  const Eigen::Quaterniond back(Eigen::Matrix3d(to_affine(post.mTransformation).linear()));
  Vec3 signs = scaling_of(chain);
  for (const Channel& channel : channels) {
    if (channel.path == ChannelPath::kScale) signs = signs.cwiseProduct(Vec3(channel.values.data()));
  }
  // Half a turn or none, as the signs that are not the file's own.
  const auto flips = [&](Eigen::Index axis) { return signs[axis] < 0; };
  Eigen::Quaterniond half = Eigen::Quaterniond::Identity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!flips(axis) && flips((axis + 1) % 3) && flips((axis + 2) % 3)) half.coeffs() = Eigen::Vector4d::Unit(axis);
  }
  for (Channel& channel : channels) {
    if (channel.path != ChannelPath::kRotation) continue;
    for (std::size_t v = 0; v < channel.values.size(); v += 4) {
      Eigen::Map<Eigen::Quaterniond> key(&channel.values[v]);
      key = (key * half * back * back * half.conjugate()).normalized();
    }
  }
}

bool is_x_file(const aiScene& scene) {
  aiString format;
  return scene.mMetaData != nullptr && scene.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, format) &&
         std::string_view(format.C_Str()).find("XFile") != std::string_view::npos;
}

// Assimp takes lengths and a rotation out of an X file's matrices, which have neither where they mirror.
void check_mirrors(const Node& node, const std::vector<Channel>& channels, const std::string& file) {
  if (!(node.local.linear().determinant() < 0)) return;
  for (const Channel& channel : channels) {
    if (channel.path == ChannelPath::kScale && sample(channel, 0).head<3>().prod() > 0) {
      throw Error(ExitCode::kFile, file + ": the joint '" + node.name +
                                       "' mirrors, which its keys lose where they are matrices (export keys of "
                                       "rotation, position and scale)");
    }
  }
}

double ticks_per_second(const aiScene& scene, const aiAnimation& animation) {
  if (animation.mTicksPerSecond > 0 && std::isfinite(animation.mTicksPerSecond)) return animation.mTicksPerSecond;
  if (!is_x_file(scene)) return kTicksPerSecond;
  double apart = std::numeric_limits<double>::max();  // of two keys, at the least on average
  const auto look = [&](const auto* keys, unsigned count) {
    if (count > 1) apart = std::min(apart, (keys[count - 1].mTime - keys[0].mTime) / (count - 1));
  };
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    const aiNodeAnim& channel = *animation.mChannels[c];
    look(channel.mPositionKeys, channel.mNumPositionKeys);
    look(channel.mRotationKeys, channel.mNumRotationKeys);
    look(channel.mScalingKeys, channel.mNumScalingKeys);
  }
  return apart >= kDirectTicksApart && apart < std::numeric_limits<double>::max() ? kDirectTicks : kTicksPerSecond;
}

// A clip begins with its first key, wherever on the file's time line that is.
void start_at_zero(Clip& clip) {
  double first = std::numeric_limits<double>::max();
  for (const Channel& channel : clip.channels) first = std::min(first, channel.times.front());
  for (Channel& channel : clip.channels) {
    for (double& time : channel.times) time -= first;
    clip.duration = std::max(clip.duration, channel.times.back());
  }
}

}  // namespace

std::vector<Clip> read_clips(const aiScene& scene, const AssimpScene& flat, const std::string& file) {
  std::vector<Clip> clips;
  for (unsigned a = 0; a < scene.mNumAnimations; ++a) {
    const aiAnimation& animation = *scene.mAnimations[a];
    const double ticks = ticks_per_second(scene, animation);
    Clip clip;
    clip.name = animation.mName.length > 0 ? animation.mName.C_Str() : std::to_string(a);
    Channels by_name;
    for (unsigned c = 0; c < animation.mNumChannels; ++c)
      by_name.emplace(animation.mChannels[c]->mNodeName.C_Str(), animation.mChannels[c]);
    for (Index n = 0; n < flat.nodes.size(); ++n) {
      const std::string name = flat.chains[n].back()->mName.C_Str();
      if (flat.by_name.at(name) != n) continue;
      const auto own = by_name.find(name);
      // A channel of the node's own name is all of the node, its pivots included.
      std::vector<Channel> channels = own != by_name.end() ? read_node(*own->second, n, ticks, file)
                                                           : fold(flat.chains[n], by_name, n, ticks, file);
      const aiNode* post = post_rotation(flat.chains[n]);
      if (post != nullptr && own != by_name.end()) take_back(*post, flat.chains[n], channels);
      if (is_x_file(scene)) check_mirrors(flat.nodes[n], channels, file);
      clip.channels.insert(clip.channels.end(), channels.begin(), channels.end());
    }
    for (unsigned m = 0; m < animation.mNumMorphMeshChannels; ++m) {
      for (const MeshInstance& instance : flat.instances) {
        const aiMeshMorphAnim& morph = *animation.mMorphMeshChannels[m];
        if (is_for(morph, instance, flat)) read_morph_weights(morph, instance, ticks, file, clip);
      }
    }
    if (clip.channels.empty()) continue;
    start_at_zero(clip);
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace spherechain::baker
