// SPDX-License-Identifier: MIT
#include <bitset>

#include "runtime/src/asset/asset_checks.h"

namespace spherechain {
namespace {

// A bone's own moment is symmetric, and stored upper triangular.
bool is_upper(const float* m) { return m[4] == 0 && m[8] == 0 && m[9] == 0 && m[12] == 0 && m[13] == 0 && m[14] == 0; }

class MomentChecker {
 public:
  MomentChecker(const AssetView& asset, Message& message)
      : tables_(asset.moment_tables()), asset_(asset), message_(message) {}

  bool run() {
    return check_reference() && check_batches() && check_pairs() && check_spheres() && check_sizes() &&
           check_sets_of_bones();
  }

 private:
  bool check_reference() {
    return tables_.reference < asset_.bone_count() ||
           message_.wrong("moments.reference: %" PRIu32 " is past the %zu bones", tables_.reference,
                          asset_.bone_count());
  }

  bool check_batches() {
    std::uint64_t pairs_used = 0, spheres_used = 0;
    for (std::size_t i = 0; i < tables_.batches.size; ++i) {
      const MomentBatch& batch = tables_.batches[i];
      if (batch.pair_count == 0 || batch.pair_count > kMaxMomentPairs) {
        return message_.wrong("moments.batches[%zu].pair_count: %" PRIu32 " is not 1 to %zu", i, batch.pair_count,
                              kMaxMomentPairs);
      }
      if (batch.sphere_count == 0) {
        return message_.wrong_at("moments.batches", i, ".sphere_count", "0");
      }
      pairs_used += batch.pair_count;
      spheres_used += batch.sphere_count;
    }
    return message_.has_size("moments.pairs", tables_.pairs.size, pairs_used, "in the batches") &&
           message_.has_size("moments.spheres", tables_.spheres.size, asset_.spheres().size, "in the asset") &&
           message_.has_size("moments.spheres", tables_.spheres.size, spheres_used, "in the batches");
  }

  bool check_pairs() {
    std::size_t i = 0;
    for (const MomentBatch& batch : tables_.batches) {
      Pair before{};
      for (const std::size_t first = i; i < first + batch.pair_count; ++i) {
        const Pair pair{tables_.pairs[i].a, tables_.pairs[i].b};
        if (pair.b >= asset_.bone_count()) {
          return message_.past_end("moments.pairs", i, ".b", pair.b, asset_.bone_count(), "bones");
        }
        if (pair.a > pair.b) {
          return message_.wrong_at("moments.pairs", i, "a is above b");
        }
        if (i > first && !(before < pair)) {
          return message_.wrong_at("moments.pairs", i, "not sorted, or there twice");
        }
        before = pair;
      }
    }
    return true;
  }

  bool check_spheres() {
    std::bitset<kMaxSphereCount> seen;
    for (std::size_t i = 0; i < asset_.spheres().size; ++i) {
      const std::uint32_t sphere = tables_.spheres[i];
      if (sphere >= asset_.spheres().size) {
        return message_.past_end("moments.spheres", i, "", sphere, asset_.spheres().size, "spheres");
      }
      if (seen[sphere]) {
        return message_.wrong("moments.spheres[%zu]: %" PRIu32 " is there already", i, sphere);
      }
      seen[sphere] = true;
    }
    return true;
  }

  bool check_sizes() {
    if (!message_.has_size("moments.bone_counts", tables_.bone_counts.size, asset_.spheres().size, "spheres")) {
      return false;
    }
    std::uint64_t bones_used = 0, pairs_used = 0;
    for (std::size_t i = 0; i < asset_.spheres().size; ++i) {
      const std::uint32_t count = tables_.bone_counts[i];
      if (count == 0 || count > kMaxMomentBones) {
        return message_.wrong("moments.bone_counts[%zu]: %" PRIu32 " is not 1 to %zu", i, count, kMaxMomentBones);
      }
      bones_used += count;
      pairs_used += count * (count + 1) / 2;
    }
    const char* const of_pairs = "pairs of the spheres' bones";
    return message_.has_size("moments.bones", tables_.bones.size, bones_used, "in bone_counts") &&
           message_.has_size("moments.centers", tables_.centers.size, bones_used, "in bone_counts") &&
           message_.has_size("moments.pair_places", tables_.pair_places.size, pairs_used, of_pairs) &&
           message_.has_size("moments.moments", tables_.moments.size, pairs_used, of_pairs);
  }

  bool check_sets_of_bones() {
    std::size_t sphere = 0, first_bone = 0, first_pair = 0, i = 0;
    for (const MomentBatch& batch : tables_.batches) {
      for (const std::size_t end = sphere + batch.sphere_count; sphere < end; ++sphere) {
        const std::size_t end_bone = first_bone + tables_.bone_counts[sphere];
        for (std::size_t k = first_bone; k < end_bone; ++k) {
          if (!check_bone(k, k == first_bone)) {
            return false;
          }
        }
        for (std::size_t k = first_bone; k < end_bone; ++k) {
          for (std::size_t l = k; l < end_bone; ++l, ++i) {
            if (!check_moment(i, k, l, {tables_.pairs.data + first_pair, batch.pair_count})) {
              return false;
            }
          }
        }
        first_bone = end_bone;
      }
      first_pair += batch.pair_count;
    }
    return true;
  }

  bool check_bone(std::size_t k, bool is_first) {
    const std::uint32_t bone = tables_.bones[k];
    if (bone >= asset_.bone_count()) {
      return message_.past_end("moments.bones", k, "", bone, asset_.bone_count(), "bones");
    }
    if (!is_first && bone <= tables_.bones[k - 1]) {
      return message_.wrong_at("moments.bones", k, "not above the one before it");
    }
    return is_finite(tables_.centers[k]) || message_.wrong_at("moments.centers", k, "not finite");
  }

  // Moment i stands for the pair of bones k and l, and its place finds that pair in the batch.
  bool check_moment(std::size_t i, std::size_t k, std::size_t l, Span<const BonePair> pairs) {
    const std::uint32_t place = tables_.pair_places[i], a = tables_.bones[k], b = tables_.bones[l];
    if (place >= pairs.size) {
      return message_.past_end("moments.pair_places", i, "", place, pairs.size, "pairs of its batch");
    }
    if (pairs[place].a != a || pairs[place].b != b) {
      return message_.wrong("moments.pair_places[%zu]: not the place of bones %" PRIu32 " and %" PRIu32, i, a, b);
    }
    if (!is_finite(tables_.moments[i])) {
      return message_.wrong_at("moments.moments", i, "not finite");
    }
    return k != l || is_upper(tables_.moments[i].values) ||
           message_.wrong_at("moments.moments", i, "a bone's own, but not 0 below the diagonal");
  }

  const MomentTables& tables_;
  const AssetView& asset_;
  Message& message_;
};

}  // namespace

bool moment_values_are_valid(const AssetView& asset, Message& message) { return MomentChecker(asset, message).run(); }

}  // namespace spherechain
