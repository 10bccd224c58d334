// SPDX-License-Identifier: MIT
#include "jobs.h"

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
  return result;
}

}  // namespace spherechain::test
