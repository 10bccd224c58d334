// SPDX-License-Identifier: GPL-3.0-or-later
#include "write/rest_contacts.h"

#include "mesh/error.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::baker {

std::vector<TrianglePair> find_rest_contacts(const std::vector<std::uint8_t>& bytes, const std::vector<float>& rest) {
  Asset asset;
  if (asset.open(bytes.data(), bytes.size()) != Status::kOk) return {};  // said where it is opened next
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset)),
      nothing_ignored(Filter::ignored_words(asset), 0);
  TriangleContactContext context{{words.data(), words.size()}};
  const Filter filter{{nothing_ignored.data(), nothing_ignored.size()}, {}, {}};
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = rest.data();
  job.vertex_count = rest.size() / 3;
  job.filter = &filter;
  job.scope = ContactScope::kAll;
  job.context = &context;
  std::vector<TrianglePair> pairs;
  Status status = job.run();  // to count
  if (status == Status::kOk) {
    pairs.resize(job.pair_count);
    job.pairs = {pairs.data(), pairs.size()};
    status = job.run();
  }
  if (status != Status::kOk) throw Error(ExitCode::kInternal, std::string("rest contacts: ") + to_string(status));
  return pairs;
}

}  // namespace spherechain::baker
