// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/write/rest_contacts.h"

#include "baker/mesh/error.h"
#include "spherechain/body.h"

namespace spherechain::baker {

std::vector<Pair> find_rest_contacts(const std::vector<std::uint8_t>& bytes, const std::vector<float>& rest) {
  const Model model(bytes.data(), bytes.size(), nullptr, 0, SC_LAYOUT_UNSET);
  if (!model) return {};  // the next who opens it says what is wrong
  std::vector<std::uint64_t> nothing_ignored(sc_pair_words(&model.asset()), 0);
  Filter filter;
  filter.ignored = nothing_ignored.data();
  filter.ignored_words = nothing_ignored.size();
  Query query;
  query.scope = SC_SCOPE_ALL;
  query.detail = SC_DETAIL_FULL;
  query.filter = &filter;
  Pose pose;
  pose.vertices = rest.data();
  pose.vertex_count = rest.size() / 3;
  BodyDef def;
  for (;;) {
    Body body(model, def);
    if (body) body.set_pose(pose);
    const Contacts found = body.status() == SC_OK ? body.contacts(query) : Contacts{};
    if (body.status() == SC_NOT_IN_ASSET) return {};  // it has no triangles
    if (body.status() != SC_OK) {
      throw Error(ExitCode::kInternal,
                  std::string("rest contacts: ") + field_name(body.status()) + ": " + code_text(body.status()));
    }
    if (found.triangle_count < found.triangle_total) {
      def.max_triangles = found.triangle_total;
      continue;
    }
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < found.triangle_count; ++i) {
      pairs.push_back({found.triangles[i].triangle_a, found.triangles[i].triangle_b});
    }
    return pairs;
  }
}

}  // namespace spherechain::baker
