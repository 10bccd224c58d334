// SPDX-License-Identifier: MIT
#include "jobs.h"

#include <algorithm>
#include <limits>

namespace spherechain::test {

Refitted refit(const Asset& asset, const std::vector<float>& positions, RadiusKind radius, std::size_t stride) {
  Refitted result{Status::kOk, std::vector<Sphere>(asset.spheres().size)};
  RefitJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() * sizeof(float) / stride;
  job.stride = stride;
  job.radius = radius;
  job.spheres = {result.spheres.data(), result.spheres.size()};
  result.status = job.run();
  return result;
}

Refitted refit_bones(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights,
                     RadiusKind radius, Target target) {
  Refitted result{Status::kOk, std::vector<Sphere>(asset.spheres().size)};
  RefitBonesJob job;
  job.target = target;
  job.asset = &asset;
  job.bones = bones;
  job.morph_weights = {morph_weights.data(), morph_weights.size()};
  job.radius = radius;
  job.spheres = {result.spheres.data(), result.spheres.size()};
  result.status = job.run();
  return result;
}

Covered cover(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights, Target target) {
  Covered result{Status::kOk, std::vector<Sphere>(asset.leaf_count()), std::vector<Sphere>(asset.spheres().size)};
  CoverJob job;
  job.asset = &asset;
  job.bones = bones;
  job.morph_weights = {morph_weights.data(), morph_weights.size()};
  job.target = target;
  job.leaves = {result.leaves.data(), result.leaves.size()};
  job.spheres = {result.spheres.data(), result.spheres.size()};
  result.status = job.run();
  return result;
}

SkinnedSurface skin(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights,
                    Target target, std::size_t stride) {
  const std::size_t count = asset.info().source_vertex_count;
  SkinnedSurface result{Status::kOk, std::vector<float>((count - 1) * stride / sizeof(float) + 3,
                                                        std::numeric_limits<float>::quiet_NaN())};
  SkinJob job;
  job.asset = &asset;
  job.bones = bones;
  job.morph_weights = {morph_weights.data(), morph_weights.size()};
  job.target = target;
  job.positions = result.positions.data();
  job.vertex_count = count;
  job.stride = stride;
  result.status = job.run();
  return result;
}

namespace {

// With a table the job finds all that it found without: `job` has run and `expected` is its buffers.
bool is_same_by_table(DetectJob job, const Filter* filter, const Detected& expected) {
  std::vector<std::uint64_t> words(DetectTable::words_needed(*job.asset), ~std::uint64_t{0});  // dirty on purpose
  DetectTable table{{words.data(), words.size()}};
  if (prepare_detect(*job.asset, job.radius, filter, table) != Status::kOk) {
    return false;
  }
  Detected found = expected;
  std::fill(found.pairs.begin(), found.pairs.end(), Pair{77, 77});
  std::fill(found.chain_pairs.begin(), found.chain_pairs.end(), ChainPair{77, {77, 77}});
  std::fill(found.bits.begin(), found.bits.end(), ~std::uint64_t{0});
  job.table = &table;
  job.pairs.data = found.pairs.data();
  job.chain_pairs.data = found.chain_pairs.data();
  job.bits.data = found.bits.data();
  const auto is_same = [&](Status status) {
    return job.run() == status && job.pair_count == expected.pairs.size() && job.test_count == expected.test_count &&
           (job.method == Method::kM2 || job.chain_pair_count == expected.chain_pairs.size()) &&
           same_bits(found.pairs, expected.pairs) && same_bits(found.bits, expected.bits);
  };
  if (!is_same(Status::kOk) || !same_bits(found.chain_pairs, expected.chain_pairs)) {
    return false;
  }
  // A list of chain pairs takes another way than none; and a list one short is as far as it goes the same.
  job.chain_pairs = {};
  if (!is_same(Status::kOk) || job.pairs.size < 2) {
    return job.pairs.size < 2;
  }
  found.pairs.back() = expected.pairs.back();
  --job.pairs.size;
  return is_same(Status::kOverflow);
}

}  // namespace

Detected detect(const Asset& asset, const std::vector<Sphere>& spheres, Method method, RadiusKind radius, Target target,
                const Filter* filter) {
  std::vector<std::uint64_t> words(DetectContext::words_needed(asset), ~std::uint64_t{0});  // dirty on purpose
  DetectContext context{{words.data(), words.size()}};
  DetectJob job;
  job.asset = &asset;
  job.spheres = {spheres.data(), spheres.size()};
  job.radius = radius;
  job.method = method;
  job.target = target;
  job.filter = filter;
  job.context = method == Method::kM1 ? &context : nullptr;
  Detected result{job.run(), {}, {}, {}, 0};
  if (result.status != Status::kOk) {
    return result;
  }
  result.pairs.resize(job.pair_count);
  result.chain_pairs.resize(method == Method::kM1 ? job.chain_pair_count : 0);
  result.bits.assign(DetectJob::bit_words(asset), ~std::uint64_t{0});
  job.bits = {result.bits.data(), result.bits.size()};
  job.pairs = {result.pairs.data(), result.pairs.size()};
  job.chain_pairs = {result.chain_pairs.data(), result.chain_pairs.size()};
  result.status = job.run();
  result.test_count = job.test_count;
  if (result.status == Status::kOk && !is_same_by_table(job, filter, result)) {
    result.status = Status::kCorrupt;
  }
  return result;
}

}  // namespace spherechain::test
