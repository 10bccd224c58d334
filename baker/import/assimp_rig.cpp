// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "baker/import/assimp_scene.h"
#include "baker/import/pivots.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using Influences = std::vector<std::pair<double, Index>>;  // weight, bone

// The bones of a rig as meshes bring them.
class Bones {
 public:
  explicit Bones(std::vector<Bone>& bones) : bones_(bones) {}

  Index add(Index node, const Affine& inverse_bind) {
    constexpr double kSame = 1e-5;  // singles
    std::vector<Index>& known = of_node_[node];
    for (const Index b : known) {
      if (bones_[b].inverse_bind.isApprox(inverse_bind, kSame)) return b;
    }
    known.push_back(static_cast<Index>(bones_.size()));
    bones_.push_back({node, inverse_bind});
    return known.back();
  }

 private:
  std::vector<Bone>& bones_;
  std::map<Index, std::vector<Index>> of_node_;
};

VertexWeights largest(Influences influences) {
  std::sort(influences.begin(), influences.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  influences.resize(std::min(influences.size(), kMaxInfluences));
  double sum = 0;
  for (const auto& [weight, bone] : influences) sum += weight;
  VertexWeights out;
  for (std::size_t k = 0; k < influences.size(); ++k) {
    out.weight[k] = influences[k].first / sum;
    out.joint[k] = influences[k].second;
  }
  return out;
}

// Vertices without bones move with the mesh's node.
void read_weights(const MeshInstance& instance, const AssimpScene& flat, const std::string& file, Bones& bones,
                  SourceRig& rig) {
  const aiMesh& mesh = *instance.mesh;
  const Affine to_mesh = instance.placement.inverse();
  std::vector<Influences> influences(mesh.mNumVertices);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const auto refuse = [&](const std::string& what) {
      throw Error(ExitCode::kFile, file + ": bone '" + bone.mName.C_Str() + "' " + what);
    };
    const auto node = flat.by_name.find(bone.mName.C_Str());
    if (node == flat.by_name.end() || bone.mNumWeights == 0) continue;
    const Affine inverse_bind = offset_of(bone, instance) * to_mesh;
    if (!inverse_bind.matrix().allFinite()) refuse("has a bind pose that is not finite");
    const Index index = bones.add(node->second, inverse_bind);
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      const aiVertexWeight& weight = bone.mWeights[w];
      if (weight.mVertexId >= mesh.mNumVertices)
        refuse("moves vertex " + std::to_string(weight.mVertexId) + " of " + std::to_string(mesh.mNumVertices));
      if (!std::isfinite(weight.mWeight)) refuse("has a weight that is not finite");
      if (weight.mWeight > 0) influences[weight.mVertexId].emplace_back(weight.mWeight, index);
    }
  }
  const bool held = std::none_of(influences.begin(), influences.end(), [](const auto& i) { return i.empty(); });
  if (!held && to_mesh.matrix().allFinite()) {
    const Index rigid = bones.add(instance.node, flat.world[instance.node].inverse());
    for (Influences& own : influences) {
      if (own.empty()) own.emplace_back(1.0, rigid);
    }
  }
  for (Influences& own : influences) rig.weights.push_back(largest(std::move(own)));
}

void read_morphs(const MeshInstance& instance, const std::string& file, std::vector<Morph>& morphs) {
  const aiMesh& mesh = *instance.mesh;
  for (unsigned a = 0; a < mesh.mNumAnimMeshes; ++a) {
    const aiAnimMesh& target = *mesh.mAnimMeshes[a];
    Morph morph;
    morph.name = target.mName.C_Str();
    for (unsigned v = 0; target.HasPositions() && v < std::min(target.mNumVertices, mesh.mNumVertices); ++v) {
      const Vec3 delta = instance.placement.linear() * (to_vec3(target.mVertices[v]) - to_vec3(mesh.mVertices[v]));
      if (!delta.allFinite()) {
        throw Error(ExitCode::kFile, file + ": morph target '" + morph.name + "' has a position that is not finite");
      }
      if (delta.isZero(0)) continue;
      morph.vertices.push_back(instance.first_vertex + v);
      morph.deltas.push_back(delta);
    }
    morphs.push_back(std::move(morph));
  }
}

// Marks the nodes that carry a rigid mesh and hang on a bone of another mesh.
void mark_attachments(const AssimpScene& flat, std::vector<Node>& nodes) {
  std::vector<bool> is_joint(nodes.size(), false);
  for (const MeshInstance& instance : flat.instances) {
    for (unsigned b = 0; b < instance.mesh->mNumBones; ++b) {
      const auto node = flat.by_name.find(instance.mesh->mBones[b]->mName.C_Str());
      if (node != flat.by_name.end()) is_joint[node->second] = true;
    }
  }
  for (const MeshInstance& instance : flat.instances) {
    if (instance.mesh->mNumBones > 0 || is_joint[instance.node]) continue;
    int above = nodes[instance.node].parent;
    while (above >= 0 && !is_joint[static_cast<std::size_t>(above)])
      above = nodes[static_cast<std::size_t>(above)].parent;
    nodes[instance.node].is_attachment = above >= 0;
  }
}

// Whether a skeleton or a clip can move a mesh of the scene.
bool anything_moves(const AssimpScene& flat, const std::vector<Clip>& clips) {
  std::vector<bool> moves(flat.nodes.size(), false);
  for (const Clip& clip : clips) {
    for (const Channel& channel : clip.channels) {
      if (channel.path != ChannelPath::kMorphWeight) moves[channel.target] = true;
    }
  }
  for (std::size_t n = 0; n < moves.size(); ++n) {
    const int parent = flat.nodes[n].parent;
    moves[n] = moves[n] || (parent >= 0 && moves[static_cast<std::size_t>(parent)]);
  }
  return std::any_of(flat.instances.begin(), flat.instances.end(), [&](const MeshInstance& instance) {
    return instance.mesh->mNumBones > 0 || moves[instance.node];
  });
}

// The point that an FBX node turns about, in its own space: the origin, but for a RotationPivot and what scales.
Vec3 turning_point(const std::vector<const aiNode*>& chain) {
  Affine turned = Affine::Identity();  // the node's own space into that of its rotation
  bool before = chain.size() > 1;
  for (const aiNode* link : chain) {
    const std::string_view name = link->mName.C_Str();
    before = before && (name.ends_with("$_Translation") || name.ends_with("$_RotationOffset") ||
                        name.ends_with("$_RotationPivot"));
    if (!before) turned = turned * to_affine(link->mTransformation);
  }
  if (chain.size() < 2 || !(std::abs(turned.linear().determinant()) > 0)) return Vec3::Zero();
  return turned.inverse().translation();
}

// Whether a clip turns a node: rounded keys of one rotation do not.
bool turns_node(const Channel& channel, const Node& node) {
  constexpr double kTurned = 1e-3;  // radians
  if (channel.path != ChannelPath::kRotation) return false;
  for (std::size_t i = 0; i + 4 <= channel.values.size(); i += 4) {
    const double* const q = channel.values.data() + i;
    if (Eigen::Quaterniond(q[3], q[0], q[1], q[2]).angularDistance(node.rotation) > kTurned) return true;
  }
  return false;
}

// Where the nodes turn, if one turns elsewhere than where it is. A pivot that no clip of the file uses says nothing.
std::vector<Vec3> read_pivots(const AssimpScene& flat, const SourceRig& rig) {
  std::vector<bool> turns(flat.nodes.size(), rig.clips.empty());
  for (const Clip& clip : rig.clips) {
    for (const Channel& channel : clip.channels) {
      if (turns_node(channel, rig.nodes[channel.target])) turns[channel.target] = true;
    }
  }
  std::vector<Vec3> pivots;
  bool elsewhere = false;
  const std::vector<Affine> places = places_at_rest(rig);
  for (std::size_t n = 0; n < places.size(); ++n) {
    const Vec3 own = turns[n] ? turning_point(flat.chains[n]) : Vec3(Vec3::Zero());
    pivots.emplace_back(places[n] * own);
    elsewhere = elsewhere || !own.isZero();
  }
  return elsewhere ? pivots : std::vector<Vec3>{};
}

}  // namespace

SourceRig read_rig(const aiScene& scene, const AssimpScene& flat, const std::string& file) {
  SourceRig rig;
  rig.clips = read_clips(scene, flat, file);
  for (std::size_t c = 0; c < rig.clips.size(); ++c) rig.clips[c].in_file = static_cast<int>(c);
  for (const MeshInstance& instance : flat.instances) read_morphs(instance, file, rig.morphs);
  if (anything_moves(flat, rig.clips)) {
    Bones bones(rig.bones);
    for (const MeshInstance& instance : flat.instances) read_weights(instance, flat, file, bones, rig);
  }
  if (!flat.instances.empty() && rig.bones.empty() && rig.morphs.empty()) return {};
  rig.nodes = flat.nodes;
  int number = 0;
  for (Node& node : rig.nodes) node.in_file = number++;
  mark_attachments(flat, rig.nodes);
  rig.pivots = read_pivots(flat, rig);
  return rig;
}

}  // namespace spherechain::baker
