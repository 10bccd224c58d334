// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/layers.h"

#include <string>

#include "baker/layers/covered.h"
#include "baker/layers/pieces.h"
#include "baker/layers/stack.h"
#include "baker/layers/windings.h"
#include "baker/mesh/error.h"
#include "runtime/src/bodies/model.h"
#include "spherechain/body.h"

namespace spherechain {
namespace {

// The triangles, of whatever spheres, that intersect in the rest pose and share no corner there; sorted.
baker::Layers::Pairs find_rest_contacts(const Model& model, const std::vector<float>& rest) {
  std::vector<std::uint64_t> nothing_ignored(sc_pair_words(&model.asset()), 0);
  Query query;
  query.scope = SC_SCOPE_ALL;
  query.full = 1;
  query.ignored_pairs = nothing_ignored.data();
  Pose pose;
  pose.vertices = rest.data();
  pose.vertex_count = rest.size() / 3;
  BodyDef def;
  for (;;) {
    Body body(model, def);
    if (body) body.set_pose(pose);
    const Contacts found = body.status() == SC_OK ? body.contacts(query) : Contacts{};
    if (body.status() != SC_OK) {
      throw baker::Error(baker::ExitCode::kInternal,
                         std::string("rest contacts: ") + field_name(body.status()) + ": " + code_text(body.status()));
    }
    if (found.triangle_count < found.triangle_total) {
      def.max_triangles = found.triangle_total;
      continue;
    }
    baker::Layers::Pairs pairs;
    for (std::size_t i = 0; i < found.triangle_count; ++i) {
      pairs.emplace_back(found.triangles[i].triangle_a, found.triangles[i].triangle_b);
    }
    return pairs;
  }
}

}  // namespace

baker::Layers baker::find_layers(const std::vector<std::uint8_t>& draft, const Character& character) {
  Layers out;
  const Model model(draft.data(), draft.size(), nullptr, 0, SC_LAYOUT_UNSET);
  if (!model) return out;  // the next who opens it says what is wrong
  const AssetView& asset = view_of(model.asset());
  if (asset.skin().sizes.triangles == 0) return out;
  Surface surface;
  read_skin_table(asset, model.handle()->skin_table, surface);
  out.rest_contacts = find_rest_contacts(model, pack(character.source_positions));
  out.of_triangle.assign(surface.triangles.size, 0);
  surface.layers = {out.of_triangle.data(), out.of_triangle.size()};
  find_facings(surface);
  const std::vector<char> covered = find_covered(surface);
  for (std::size_t t = 0; t < covered.size(); ++t) {
    if (covered[t] != 0) out.of_triangle[t] |= kIsCovered;
  }
  Layers::Pairs crossing = out.rest_contacts;
  for (auto& [a, b] : crossing) {
    a = surface.place_of_source[a];
    b = surface.place_of_source[b];
  }
  Stack stack = find_stack(asset, surface, crossing);
  out.pieces = find_pieces(surface, character);
  out.covers = std::move(stack.covers);
  out.is_buried = std::move(stack.is_buried);
  out.pairs = std::move(stack.pairs);
  Windings windings = find_windings(asset, surface);
  out.windings = std::move(windings.of_spheres);
  out.core_triangles = std::move(windings.core_triangles);
  out.core_windings = std::move(windings.of_cores);
  return out;
}

}  // namespace spherechain
