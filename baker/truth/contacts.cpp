// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/contacts.h"

#include <algorithm>

#include "mesh/error.h"
#include "play/play.h"
#include "spherechain/skin.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::baker {
namespace {

void check(Status status) {
  if (status != Status::kOk) throw Error(ExitCode::kInternal, std::string("contacts: ") + to_string(status));
}

// `job` has the pose.
std::vector<TrianglePair> run(TriangleContactJob job) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(*job.asset));
  TriangleContactContext context{{words.data(), words.size()}};
  job.context = &context;
  check(job.run());  // to count
  std::vector<TrianglePair> pairs(job.pair_count);
  job.pairs = {pairs.data(), pairs.size()};
  check(job.run());
  return pairs;
}

// SkinJob writes one of the source vertices that move alike: the others follow it.
void follow(const Asset& asset, std::vector<float>& positions, const std::vector<Triangle>& source_triangles) {
  const Surface& surface = asset.surface();
  for (const Leaf& leaf : surface.leaves) {
    for (std::size_t k = leaf.first_triangle; k < leaf.first_triangle + leaf.triangle_count; ++k) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Index
            from = surface.source_vertices[surface.leaf_vertices[leaf.first_vertex + surface.corners[3 * k + corner]]],
            to = source_triangles[asset.triangles()[k]][corner];
        if (from != to) std::copy_n(&positions[3 * std::size_t{from}], 3, &positions[3 * std::size_t{to}]);
      }
    }
  }
}

}  // namespace

std::vector<TrianglePair> find_contacts(const Asset& asset, const std::vector<float>& positions, ContactScope scope,
                                        Target target) {
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.scope = scope;
  job.target = target;
  return run(job);
}

ContactsFromBones find_contacts_from_bones(const Asset& asset, const Character& character,
                                           const Deformation& deformation, Target target) {
  const std::vector<float> matrices = bone_palette(asset, deformation);
  std::vector<float> weights(deformation.morphs.begin(), deformation.morphs.end());
  weights.resize(asset.morph_count());
  ContactsFromBones out{pack(character.source_positions), {}, {}};
  SkinJob skin;
  skin.asset = &asset;
  skin.bones = {matrices.data(), asset.bone_count()};
  skin.morph_weights = {weights.data(), weights.size()};
  skin.target = target;
  skin.positions = out.positions.data();
  skin.vertex_count = out.positions.size() / 3;
  check(skin.run());
  follow(asset, out.positions, character.source_triangles);
  TriangleContactJob job;
  job.asset = &asset;
  job.bones = skin.bones;
  job.morph_weights = skin.morph_weights;
  job.target = target;
  out.pairs = run(job);
  job.scope = ContactScope::kNeighbours;
  out.neighbours = run(job);
  return out;
}

ContactErrors compare(const std::vector<TrianglePair>& found, const std::vector<TrianglePair>& truth) {
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
