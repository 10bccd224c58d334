// SPDX-License-Identifier: GPL-3.0-or-later
#include "write/rest_contacts.h"

#include "mesh/error.h"
#include "spherechain/skin_contacts.h"

namespace spherechain::baker {

std::vector<Pair> find_rest_contacts(const std::vector<std::uint8_t>& bytes, const std::vector<float>& rest) {
  sc_asset asset;
  if (sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), bytes.size(), nullptr, 0) != SC_OK) {
    return {};  // said where it is opened next
  }
  std::vector<std::uint64_t> table(sc_skin_table_words(&asset)), scratch(sc_skin_scratch_words(&asset)),
      nothing_ignored(sc_pair_words(&asset), 0);
  if (table.empty()) return {};
  sc_filter filter;
  filter.ignored = nothing_ignored.data();
  filter.ignored_words = nothing_ignored.size();
  SkinContactJob job;
  job.asset = &asset;
  job.pose.vertices = rest.data();
  job.pose.vertex_count = rest.size() / 3;
  job.filter = &filter;
  job.scope = SC_SCOPE_ALL;
  job.skin_table = table.data();
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  std::vector<TriangleContact> contacts(1024);
  const auto find = [&] {
    job.triangles = contacts.data();
    job.triangle_capacity = contacts.size();
    const Status status = job.run();
    contacts.resize(job.triangle_count);
    return status;
  };
  Status status = sc_prepare_skin(&asset, table.data(), table.size());
  if (status == SC_OK) status = find();
  if (status == SC_OVERFLOW) status = find();  // now all fit
  if (status != SC_OK) {
    throw Error(ExitCode::kInternal,
                std::string("rest contacts: ") + sc_field_name(status.field) + ": " + sc_code_text(status.code));
  }
  std::vector<Pair> pairs;
  for (const TriangleContact& contact : contacts) pairs.push_back({contact.triangle_a, contact.triangle_b});
  return pairs;
}

}  // namespace spherechain::baker
