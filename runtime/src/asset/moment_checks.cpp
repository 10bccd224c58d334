// SPDX-License-Identifier: MIT
#include "asset/moment_checks.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstddef>

#include "asset/moment_tables.h"
#include "asset/sphere_set.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

constexpr std::uint32_t pairs_of_bones(std::uint32_t count) { return count * (count + 1) / 2; }

bool has_size(std::uint32_t size, std::uint64_t wanted, const char* name, const char* of, Message& message) {
  return size == wanted || message.wrong("moments.%s: %" PRIu32 " of them, but %" PRIu64 " %s", name, size, wanted, of);
}

bool check_origin(const schema::Moments& in, std::uint32_t bones, Message& message) {
  const schema::Vec3* origin = in.origin();
  if (origin == nullptr) {
    return message.wrong("moments.origin: missing");
  }
  if (!std::isfinite(origin->x()) || !std::isfinite(origin->y()) || !std::isfinite(origin->z())) {
    return message.wrong("moments.origin: not finite");
  }
  return in.reference() < bones ||
         message.wrong("moments.reference: %" PRIu32 " is past the %" PRIu32 " bones", in.reference(), bones);
}

bool check_batches(const schema::Moments& in, std::uint32_t spheres, Message& message) {
  std::uint64_t pairs_used = 0, spheres_used = 0;
  for (std::uint32_t i = 0; i < in.batches()->size(); ++i) {
    const schema::MomentBatch& batch = *in.batches()->Get(i);
    if (batch.pair_count() == 0 || batch.pair_count() > kMaxMomentPairs) {
      return message.wrong("moments.batches[%" PRIu32 "].pair_count: %" PRIu32 " is not 1 to %zu", i,
                           batch.pair_count(), kMaxMomentPairs);
    }
    if (batch.sphere_count() == 0) {
      return message.wrong("moments.batches[%" PRIu32 "].sphere_count: 0", i);
    }
    pairs_used += batch.pair_count();
    spheres_used += batch.sphere_count();
  }
  return has_size(in.pairs()->size(), pairs_used, "pairs", "in the batches", message) &&
         has_size(in.spheres()->size(), spheres, "spheres", "in the asset", message) &&
         has_size(in.spheres()->size(), spheres_used, "spheres", "in the batches", message);
}

bool check_pairs(const schema::Moments& in, std::uint32_t bones, Message& message) {
  std::uint32_t i = 0;
  for (const schema::MomentBatch* batch : *in.batches()) {
    for (const std::uint32_t first = i; i < first + batch->pair_count(); ++i) {
      const schema::BonePair& pair = *in.pairs()->Get(i);
      if (pair.b() >= bones) {
        return message.wrong("moments.pairs[%" PRIu32 "].b: %u is past the %" PRIu32 " bones", i, unsigned{pair.b()},
                             bones);
      }
      if (pair.a() > pair.b()) {
        return message.wrong("moments.pairs[%" PRIu32 "]: a is above b", i);
      }
      if (i == first) {
        continue;
      }
      const schema::BonePair& before = *in.pairs()->Get(i - 1);
      if (pair.a() < before.a() || (pair.a() == before.a() && pair.b() <= before.b())) {
        return message.wrong("moments.pairs[%" PRIu32 "]: not sorted, or there twice", i);
      }
    }
  }
  return true;
}

bool check_spheres(const schema::Moments& in, Message& message) {
  SphereSet seen;
  const std::uint32_t count = in.spheres()->size();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t sphere = in.spheres()->Get(i);
    if (sphere >= count) {
      return message.wrong("moments.spheres[%" PRIu32 "]: %" PRIu32 " is past the %" PRIu32 " spheres", i, sphere,
                           count);
    }
    if (!seen.insert(sphere)) {
      return message.wrong("moments.spheres[%" PRIu32 "]: %" PRIu32 " is there already", i, sphere);
    }
  }
  return true;
}

bool check_bones(const schema::Moments& in, std::uint32_t bones, Message& message) {
  if (!has_size(in.bone_counts()->size(), in.spheres()->size(), "bone_counts", "spheres", message)) {
    return false;
  }
  std::uint64_t bones_used = 0, pairs_used = 0;
  for (std::uint32_t i = 0; i < in.bone_counts()->size(); ++i) {
    const std::uint32_t count = in.bone_counts()->Get(i);
    if (count == 0 || count > kMaxMomentBones) {
      return message.wrong("moments.bone_counts[%" PRIu32 "]: %" PRIu32 " is not 1 to %zu", i, count, kMaxMomentBones);
    }
    bones_used += count;
    pairs_used += pairs_of_bones(count);
  }
  if (!has_size(in.bones()->size(), bones_used, "bones", "in bone_counts", message) ||
      !has_size(in.centers()->size(), bones_used, "centers", "in bone_counts", message) ||
      !has_size(in.pair_places()->size(), pairs_used, "pair_places", "pairs of the spheres' bones", message) ||
      !has_size(in.moments()->size(), pairs_used, "moments", "pairs of the spheres' bones", message)) {
    return false;
  }
  std::uint32_t i = 0;
  for (const std::uint32_t count : *in.bone_counts()) {
    for (const std::uint32_t first = i; i < first + count; ++i) {
      if (in.bones()->Get(i) >= bones) {
        return message.wrong("moments.bones[%" PRIu32 "]: %u is past the %" PRIu32 " bones", i,
                             unsigned{in.bones()->Get(i)}, bones);
      }
      if (i > first && in.bones()->Get(i) <= in.bones()->Get(i - 1)) {
        return message.wrong("moments.bones[%" PRIu32 "]: not above the one before it", i);
      }
    }
  }
  return true;
}

// Every pair of a sphere's bones is where its place says.
bool check_places(const schema::Moments& in, Message& message) {
  std::uint32_t first_pair = 0, sphere = 0, first_bone = 0, i = 0;
  for (const schema::MomentBatch* batch : *in.batches()) {
    for (std::uint32_t left = batch->sphere_count(); left > 0; --left, ++sphere) {
      const std::uint32_t end = first_bone + in.bone_counts()->Get(sphere);
      for (std::uint32_t k = first_bone; k < end; ++k) {
        for (std::uint32_t l = k; l < end; ++l, ++i) {
          const std::uint32_t place = in.pair_places()->Get(i);
          if (place >= batch->pair_count()) {
            return message.wrong("moments.pair_places[%" PRIu32 "]: %" PRIu32 " is past its batch's %" PRIu32 " pairs",
                                 i, place, batch->pair_count());
          }
          const schema::BonePair& pair = *in.pairs()->Get(first_pair + place);
          if (pair.a() != in.bones()->Get(k) || pair.b() != in.bones()->Get(l)) {
            return message.wrong("moments.pair_places[%" PRIu32 "]: not the place of bones %u and %u", i,
                                 unsigned{in.bones()->Get(k)}, unsigned{in.bones()->Get(l)});
          }
        }
      }
      first_bone = end;
    }
    first_pair += batch->pair_count();
  }
  return true;
}

// A bone's own moment is symmetric, and stored upper triangular.
bool is_upper(const float* m) { return m[4] == 0 && m[8] == 0 && m[9] == 0 && m[12] == 0 && m[13] == 0 && m[14] == 0; }

bool check_own_moments(const schema::Moments& in, Message& message) {
  std::uint32_t i = 0;
  for (const std::uint32_t count : *in.bone_counts()) {
    for (std::uint32_t left = count; left > 0; i += left, --left) {
      if (!is_upper(in.moments()->Get(i)->values()->data())) {
        return message.wrong("moments.moments[%" PRIu32 "]: a bone's own, but not 0 below the diagonal", i);
      }
    }
  }
  return true;
}

bool check_figures(const schema::Moments& in, Message& message) {
  for (std::uint32_t i = 0; i < in.centers()->size(); ++i) {
    const schema::CenterTerm& term = *in.centers()->Get(i);
    if (!std::isfinite(term.x()) || !std::isfinite(term.y()) || !std::isfinite(term.z()) || !std::isfinite(term.w())) {
      return message.wrong("moments.centers[%" PRIu32 "]: not finite", i);
    }
  }
  for (std::uint32_t i = 0; i < in.moments()->size(); ++i) {
    const float* values = in.moments()->Get(i)->values()->data();
    if (!std::all_of(values, values + kMomentSize, [](float value) { return std::isfinite(value); })) {
      return message.wrong("moments.moments[%" PRIu32 "]: not finite", i);
    }
  }
  return true;
}

}  // namespace

bool moment_values_are_valid(const schema::Asset& root, Message& message) {
  const schema::Moments* moments = root.moments();
  const bool are_wanted = root.refit() == schema::Refit::moments && root.bones()->size() > 0;
  if (moments == nullptr || !are_wanted) {
    return (moments != nullptr) == are_wanted ||
           message.wrong("moments: %s", are_wanted ? "missing, but refit is moments" : "refit is another, or no bones");
  }
  const std::uint32_t bones = root.bones()->size();
  return check_origin(*moments, bones, message) && check_batches(*moments, root.spheres()->size(), message) &&
         check_pairs(*moments, bones, message) && check_spheres(*moments, message) &&
         check_bones(*moments, bones, message) && check_places(*moments, message) && check_figures(*moments, message) &&
         check_own_moments(*moments, message);
}

}  // namespace spherechain
