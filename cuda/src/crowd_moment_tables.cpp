// SPDX-License-Identifier: MIT
// Deals an asset's spheres into runs (MomentRun) and lays out what the runs read.
#include <algorithm>

#include "crowd_tables.h"

namespace spherechain::cuda {
namespace {

// A sphere, and where its bones and pairs begin in the asset's tables.
struct alignas(16) Member {
  std::uint32_t sphere, bone_count;
  std::uint32_t first_bone, first_pair;
};

constexpr std::uint32_t pairs_of(std::uint32_t bones) { return static_cast<std::uint32_t>(pairs_of_bones(bones)); }

// Spheres of most bones come first, spheres of the same bones next to each other.
void fill_members(const MomentTables& tables, Member* out) {
  std::uint32_t bone = 0, pair = 0;
  for (std::size_t i = 0; i < tables.spheres.size; ++i) {
    const std::uint32_t count = tables.bone_counts[i];
    out[i] = {tables.spheres[i], count, bone, pair};
    bone += count;
    pair += pairs_of(count);
  }
  std::sort(out, out + tables.spheres.size, [&](const Member& a, const Member& b) {
    const std::uint16_t *l = tables.bones.data + a.first_bone, *r = tables.bones.data + b.first_bone;
    if (a.bone_count != b.bone_count) {
      return a.bone_count > b.bone_count;
    }
    const bool are_equal = std::equal(l, l + a.bone_count, r);
    return are_equal ? a.sphere < b.sphere : std::lexicographical_compare(l, l + a.bone_count, r, r + b.bone_count);
  });
}

// The bones of a run's spheres, ascending, and the number that each has among a sphere's own bones.
struct Union {
  static constexpr std::uint32_t kBonesMax = kRunSpheres * kMaxMomentBones, kNone = ~0U;
  std::uint32_t count = 0;
  std::uint16_t bones[kBonesMax];
  std::uint32_t numbers[kRunSpheres][kBonesMax];

  Union(const MomentTables& tables, const Member* members, std::uint32_t sphere_count) {
    std::uint32_t next[kRunSpheres] = {};
    const auto has_next = [&](std::uint32_t s) { return s < sphere_count && next[s] < members[s].bone_count; };
    const auto next_bone = [&](std::uint32_t s) { return tables.bones[members[s].first_bone + next[s]]; };
    for (;; ++count) {
      bool is_any = false;
      for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
        if (has_next(s)) {
          bones[count] = is_any ? std::min(bones[count], next_bone(s)) : next_bone(s);
          is_any = true;
        }
      }
      if (!is_any) {
        return;
      }
      for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
        numbers[s][count] = has_next(s) && next_bone(s) == bones[count] ? next[s]++ : kNone;
      }
    }
  }
};

// About how many instructions the kernel takes for a pair's Gram matrix, to ask which of two spheres has a pair, and
// for the rest of a run.
constexpr std::int64_t kGramCost = 48, kAskingCost = 4, kRunCost = 64;

// What one run for both saves over two.
std::int64_t saved(const MomentTables& tables, const Member& a, const Member& b) {
  const Member both[] = {a, b};
  const std::int64_t common = pairs_of(a.bone_count + b.bone_count - Union(tables, both, 2).count);
  const std::int64_t all = pairs_of(a.bone_count) + pairs_of(b.bone_count) - common;
  return common == 0 ? 0 : kGramCost * common + kRunCost - kAskingCost * all;
}

class RunWriter {
 public:
  RunWriter(const AssetView& asset, Radius radius, const std::uint32_t* bone_indices)
      : tables_(asset.moment_tables()), rest_(asset.spheres()), radius_(radius), bone_indices_(bone_indices) {}

  // Spheres that all have the same two bones, or three.
  void add_few_bones(const Member* members, std::uint32_t count) {
    const std::uint32_t bones = members[0].bone_count;
    MomentRun& run = start(members, count, bones == 2 ? kTwoBones : kThreeBones);
    run.bone_count = bones;
    for (std::uint32_t k = 0; k < bones; ++k) {
      run_bones[bone_count_++] = matrix_of(tables_.bones[members[0].first_bone + k]);
    }
    for (std::uint32_t s = 0; s < count; ++s) {
      for (std::uint32_t k = 0; k < bones; ++k) {
        add_center(members[s], k);
      }
    }
    const std::uint32_t step = bones == 2 ? 1 : 2;
    for (std::uint32_t first = 0; first < step; ++first) {
      for (std::uint32_t s = 0; s < count; ++s) {
        add_columns(members[s], first, step);
      }
    }
    run.cost = static_cast<std::uint32_t>(3 * pairs_of(bones) + count * (bones == 2 ? 5 : 8));
  }

  // One or two spheres of any bones.
  void add(const Member* members, std::uint32_t count) {
    const Union all(tables_, members, count);
    MomentRun& run = start(members, count, kAnyBones);
    run.bone_count = all.count;
    for (std::uint32_t i = 0; i < all.count; ++i) {
      add_bone(all, i, members, count);
      for (std::uint32_t j = i + 1; j < all.count; ++j) {
        add_pair(all, i, j, members, count);
      }
      steps[step_count_ - 1] |= kLastOfBone;
    }
    steps[step_count_ - 1] |= kLastOfRun;
    run.cost = 3 * (step_count_ - run.first_step);  // a Gram matrix is worth three times what a sphere makes of it
    for (std::uint32_t s = 0; s < count; ++s) {
      run.cost += pairs_of(members[s].bone_count);
    }
  }

  std::uint32_t run_count() const { return run_count_; }

  MomentRun* runs = nullptr;
  RunSphere* spheres = nullptr;
  std::uint32_t* steps = nullptr;
  Float4* moments = nullptr;
  std::uint32_t* run_bones = nullptr;
  Float4* center_terms = nullptr;

 private:
  MomentRun& start(const Member* members, std::uint32_t count, std::uint32_t kind) {
    MomentRun& run = runs[run_count_++];
    run.first_step = step_count_;
    run.first_moment = moment_count_;
    run.first_bone = bone_count_;
    run.first_center = center_count_;
    run.first_sphere = sphere_count_;
    run.sphere_count = count;
    run.kind = kind;
    for (std::uint32_t s = 0; s < count; ++s) {
      const RestSphere& rest = rest_[members[s].sphere];
      spheres[sphere_count_++] = {members[s].sphere, radius_ == SC_RADIUS_FIT ? rest.radius : rest.detect_radius};
    }
    return run;
  }

  const Moment& moment_of(const Member& member, std::uint32_t k, std::uint32_t l) const {
    const std::uint32_t before = pairs_of(member.bone_count) - pairs_of(member.bone_count - k);
    return tables_.moments[member.first_pair + before + l - k];
  }

  std::uint32_t matrix_of(std::uint16_t bone) const {
    return static_cast<std::uint32_t>(3 * bone_indices_[bone] * kPitch * sizeof(Float4));
  }

  void add_center(const Member& member, std::uint32_t number) {
    const CenterTerm& term = tables_.centers[member.first_bone + number];
    center_terms[center_count_++] = {term.x, term.y, term.z, term.w};
  }

  // The bone, and its pair with itself.
  void add_bone(const Union& all, std::uint32_t i, const Member* members, std::uint32_t count) {
    std::uint32_t& bone = run_bones[bone_count_++] = matrix_of(all.bones[i]);
    std::uint32_t& step = steps[step_count_++] = bone;
    for (std::uint32_t s = 0; s < count; ++s) {
      const std::uint32_t k = all.numbers[s][i];
      if (k != Union::kNone) {
        bone |= 1U << s;
        step |= 1U << s;
        add_center(members[s], k);
        add_moment(moment_of(members[s], k, k), true);
      }
    }
  }

  void add_pair(const Union& all, std::uint32_t i, std::uint32_t j, const Member* members, std::uint32_t count) {
    std::uint32_t mask = 0;
    for (std::uint32_t s = 0; s < count; ++s) {
      const std::uint32_t k = all.numbers[s][i], l = all.numbers[s][j];
      if (k != Union::kNone && l != Union::kNone) {
        mask |= 1U << s;
        add_moment(moment_of(members[s], k, l), false);
      }
    }
    if (mask != 0) {
      steps[step_count_++] = matrix_of(all.bones[j]) | mask;
    }
  }

  // Columns of a moment, of those that are kept the rows one after another.
  static float* put_columns(const Moment& moment, bool is_self, std::size_t first, std::size_t step, float* to) {
    for (std::size_t column = first; column < 4; column += step) {
      for (std::size_t row = 0; row < rows_of_moment(is_self, column); ++row) {
        *to++ = moment.values[4 * row + column];
      }
    }
    return to;
  }

  // Columns of all moments of a sphere of few bones.
  void add_columns(const Member& member, std::uint32_t first, std::uint32_t step) {
    auto* to = reinterpret_cast<float*>(moments + moment_count_);
    for (std::uint32_t k = 0; k < member.bone_count; ++k) {
      for (std::uint32_t l = k; l < member.bone_count; ++l) {
        to = put_columns(moment_of(member, k, l), k == l, first, step, to);
      }
    }
    moment_count_ += static_cast<std::uint32_t>(few_bone_quads(member.bone_count, first, step));
  }

  void add_moment(const Moment& moment, bool is_self) {
    put_columns(moment, is_self, 0, 1, reinterpret_cast<float*>(moments + moment_count_));
    moment_count_ += static_cast<std::uint32_t>(is_self ? few_bone_quads(1, 0, 1) : kPairQuads);
  }

  const MomentTables& tables_;
  Span<const RestSphere> rest_;
  Radius radius_;
  const std::uint32_t* bone_indices_;
  std::uint32_t run_count_ = 0, step_count_ = 0, moment_count_ = 0, bone_count_ = 0, center_count_ = 0,
                sphere_count_ = 0;
};

bool has_few_bones(const Member& member) { return member.bone_count == 2 || member.bone_count == 3; }

bool have_same_bones(const MomentTables& tables, const Member& a, const Member& b) {
  const std::uint16_t *l = tables.bones.data + a.first_bone, *r = tables.bones.data + b.first_bone;
  return std::equal(l, l + a.bone_count, r, r + b.bone_count);
}

// Takes out the spheres of two or three bones, many of the same ones at a time. Returns how many spheres are left.
std::size_t add_few_bone_runs(const MomentTables& tables, Member* members, RunWriter& writer) {
  const std::size_t n = tables.spheres.size;
  std::size_t left = 0;
  for (std::size_t i = 0; i < n;) {
    if (!has_few_bones(members[i])) {
      members[left++] = members[i++];
      continue;
    }
    std::uint32_t count = 1;
    while (count < kRunSpheresMax && i + count < n && have_same_bones(tables, members[i], members[i + count])) {
      ++count;
    }
    writer.add_few_bones(members + i, count);
    i += count;
  }
  return left;
}

// The others, by twos where that is less work; only spheres near each other in the order are compared.
void add_other_runs(const MomentTables& tables, Member* members, std::size_t count, RunWriter& writer) {
  constexpr std::size_t kNear = 64;
  for (Member* one = members; one < members + count; ++one) {
    if (one->bone_count == 0) {
      continue;  // taken already
    }
    Member* best = nullptr;
    std::int64_t best_saving = 0;
    for (Member* other = one + 1; other < members + count && other < one + kNear; ++other) {
      const std::int64_t saving = other->bone_count == 0 ? 0 : saved(tables, *one, *other);
      best = saving > best_saving ? other : best;
      best_saving = std::max(best_saving, saving);
    }
    Member run[kRunSpheres] = {*one, best != nullptr ? *best : *one};
    writer.add(run, best != nullptr ? 2 : 1);
    if (best != nullptr) {
      best->bone_count = 0;
    }
  }
}

}  // namespace

void add_moments(const AssetView& asset, Radius radius, TableMemory& memory, TableHeader& header) {
  const MomentTables& tables = asset.moment_tables();
  const std::size_t n = tables.spheres.size;
  if (n == 0) {
    return;
  }
  std::uint32_t unread = 0;  // where arrays lie that the kernels do not read
  header.bone_count = static_cast<std::uint32_t>(asset.bone_count());
  auto* used_bones = memory.take<std::uint32_t>(header.bone_count, header.used_bones);
  auto* bone_indices = memory.take<std::uint32_t>(header.bone_count, unread);
  auto* members = memory.take<Member>(n, unread);
  RunWriter writer(asset, radius, bone_indices);
  writer.runs = memory.take<MomentRun>(n, header.runs);
  writer.spheres = memory.take<RunSphere>(n, header.run_spheres);
  writer.steps = memory.take<std::uint32_t>(2 * tables.moments.size, header.moment_steps);
  writer.moments = memory.take<Float4>(kPairQuads * tables.moments.size, header.moments);
  writer.run_bones = memory.take<std::uint32_t>(tables.bones.size, header.run_bones);
  writer.center_terms = memory.take<Float4>(tables.bones.size, header.center_terms);
  if (memory.is_null()) {
    return;
  }
  bone_indices[tables.reference] = 1;
  for (const std::uint16_t bone : tables.bones) {
    bone_indices[bone] = 1;
  }
  for (std::uint32_t bone = 0; bone < header.bone_count; ++bone) {
    if (bone_indices[bone] != 0) {
      bone_indices[bone] = header.used_bone_count;
      used_bones[header.used_bone_count++] = bone;
    }
  }
  header.reference = bone_indices[tables.reference];
  header.origin = tables.origin;
  fill_members(tables, members);
  add_other_runs(tables, members, add_few_bone_runs(tables, members, writer), writer);
  header.run_count = writer.run_count();
  std::sort(writer.runs, writer.runs + header.run_count, [](const MomentRun& l, const MomentRun& r) {
    return l.cost != r.cost ? l.cost > r.cost : l.first_sphere < r.first_sphere;
  });
}

}  // namespace spherechain::cuda
