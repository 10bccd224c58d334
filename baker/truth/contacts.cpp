// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/contacts.h"

#include <algorithm>

#include "baker/play/skin_player.h"
#include "runtime/src/skin/skin_inputs.h"

namespace spherechain::baker {
namespace {

std::vector<Pair> run(SkinPlayer& player, Scope scope) {
  std::vector<Pair> pairs;
  for (const TriangleContact& contact : player.triangles(scope)) {
    pairs.push_back({contact.triangle_a, contact.triangle_b});
  }
  return pairs;
}

// Skinning writes one of the source vertices that move alike: the others follow it.
void follow(const Surface& surface, std::vector<float>& positions, const std::vector<Triangle>& source_triangles) {
  for (const spherechain::Cluster& cluster : surface.clusters) {
    for (std::size_t k = cluster.first_triangle; k < cluster.first_triangle + cluster.triangle_count; ++k) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t slot = cluster.first_vertex + surface.corners[3 * k + corner];
        const Index from = surface.source_vertices[surface.cluster_vertices[slot]],
                    to = source_triangles[surface.triangles[k]][corner];
        if (from != to) std::copy_n(&positions[3 * std::size_t{from}], 3, &positions[3 * std::size_t{to}]);
      }
    }
  }
}

}  // namespace

std::vector<Pair> find_contacts(const OpenAsset& asset, const std::vector<float>& positions, Scope scope,
                                Target target) {
  SkinPlayer player(asset, target);
  player.set_pose(pose_of(positions));
  return run(player, scope);
}

ContactsFromBones find_contacts_from_bones(const OpenAsset& asset, const Character& character,
                                           const Deformation& deformation, Target target) {
  const BonePose bones(asset, deformation);
  const sc_pose pose = bones.pose();
  ContactsFromBones out{pack(character.source_positions), {}, {}};
  skin_surface(asset.surface(), pose, target, out.positions.data(), 3);
  follow(asset.surface(), out.positions, character.source_triangles);
  SkinPlayer player(asset, target);
  player.set_pose(pose);
  out.pairs = run(player, SC_SCOPE_LAYERS);
  out.neighbours = run(player, SC_SCOPE_NEIGHBOURS);
  return out;
}

ContactErrors compare(const std::vector<Pair>& found, const std::vector<Pair>& truth) {
  std::size_t common = 0;
  for (auto f = found.begin(), t = truth.begin(); f != found.end() && t != truth.end();) {
    if (*f == *t) {
      ++common;
      ++f;
      ++t;
    } else if (*f < *t) {
      ++f;
    } else {
      ++t;
    }
  }
  return {truth.size() - common, found.size() - common};
}

}  // namespace spherechain::baker
