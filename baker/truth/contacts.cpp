// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/contacts.h"

#include <algorithm>

#include "mesh/error.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::baker {

std::vector<TrianglePair> find_contacts(const Asset& asset, const std::vector<float>& positions, Target target) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
  TriangleContactContext context{{words.data(), words.size()}};
  std::vector<TrianglePair> pairs;
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.target = target;
  job.context = &context;
  Status status = job.run();  // to count
  if (status == Status::kOk) {
    pairs.resize(job.pair_count);
    job.pairs = {pairs.data(), pairs.size()};
    status = job.run();
  }
  if (status != Status::kOk) throw Error(ExitCode::kInternal, std::string("contacts: ") + to_string(status));
  return pairs;
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
