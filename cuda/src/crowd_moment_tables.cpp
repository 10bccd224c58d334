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

Span<const std::uint16_t> bones_of(const MomentTables& tables, const Member& member) {
  return {tables.bones.data + member.first_bone, member.bone_count};
}

bool have_same_bones(const MomentTables& tables, const Member& a, const Member& b) {
  const Span<const std::uint16_t> l = bones_of(tables, a), r = bones_of(tables, b);
  return std::equal(l.begin(), l.end(), r.begin(), r.end());
}

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
    const Span<const std::uint16_t> l = bones_of(tables, a), r = bones_of(tables, b);
    return l.size != r.size                ? l.size > r.size
           : have_same_bones(tables, a, b) ? a.sphere < b.sphere
                                           : std::lexicographical_compare(l.begin(), l.end(), r.begin(), r.end());
  });
}

// The bones of a run's one or two spheres, ascending, and the number that each has among a sphere's own bones.
struct Union {
  static constexpr std::uint32_t kBonesMax = kRunSpheres * kMaxMomentBones, kNone = ~0U;
  std::uint32_t count;
  std::uint16_t bones[kBonesMax];
  std::uint32_t numbers[kRunSpheres][kBonesMax];

  Union(const MomentTables& tables, Span<const Member> members) {
    const Span<const std::uint16_t> l = bones_of(tables, members[0]), r = bones_of(tables, members[members.size - 1]);
    count = static_cast<std::uint32_t>(std::set_union(l.begin(), l.end(), r.begin(), r.end(), bones) - bones);
    for (std::uint32_t s = 0; s < members.size; ++s) {
      const Span<const std::uint16_t> own = bones_of(tables, members[s]);
      std::uint32_t next = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        numbers[s][i] = next < own.size && own[next] == bones[i] ? next++ : kNone;
      }
    }
  }
};

// About how many instructions the kernel takes for a pair's Gram matrix, to ask which of two spheres has a pair, and
// for the rest of a run.
constexpr std::int64_t kGramCost = 48, kAskingCost = 4, kRunCost = 64;

// The cost that one run for both members saves over two runs.
std::int64_t saved(const MomentTables& tables, const Member& a, const Member& b) {
  const Member both[] = {a, b};
  const std::int64_t common = pairs_of(a.bone_count + b.bone_count - Union(tables, {both, 2}).count);
  const std::int64_t all = pairs_of(a.bone_count) + pairs_of(b.bone_count) - common;
  return common == 0 ? 0 : kGramCost * common + kRunCost - kAskingCost * all;
}

// Grows into memory that was taken for it.
template <typename T>
struct List {
  T* data = nullptr;
  std::uint32_t size = 0;

  T& add(const T& one) { return data[size++] = one; }
  T& last() { return data[size - 1]; }
};

class RunWriter {
 public:
  RunWriter(const AssetView& asset, Radius radius, const std::uint32_t* bone_indices)
      : tables_(asset.moment_tables()), rest_(asset.spheres()), radius_(radius), bone_indices_(bone_indices) {}

  // Spheres that all have the same two bones, or three.
  void add_few_bones(Span<const Member> members) {
    const std::uint32_t bones = members[0].bone_count, step = bones == 2 ? 1 : 2;
    MomentRun& run = start(members, bones, bones == 2 ? kTwoBones : kThreeBones);
    run.cost = 3 * pairs_of(bones) + run.sphere_count * (bones == 2 ? 5 : 8);
    for (const std::uint16_t bone : bones_of(tables_, members[0])) {
      run_bones.add(matrix_of(bone));
    }
    for (const Member& member : members) {
      for (std::uint32_t k = 0; k < bones; ++k) {
        add_center(member, k);
      }
    }
    for (std::uint32_t first = 0; first < step; ++first) {
      for (const Member& member : members) {
        for (std::uint32_t k = 0; k < bones; ++k) {
          for (std::uint32_t l = k; l < bones; ++l) {
            add_columns(moment_of(member, k, l), k == l, first, step);
          }
        }
        fill_quad();
      }
    }
  }

  // One or two spheres of any bones.
  void add(Span<const Member> members) {
    const Union all(tables_, members);
    MomentRun& run = start(members, all.count, kAnyBones);
    for (std::uint32_t i = 0; i < all.count; ++i) {
      run_bones.add(add_step(all, i, i, members));
      for (std::uint32_t s = 0; s < members.size; ++s) {
        if (all.numbers[s][i] != Union::kNone) {
          add_center(members[s], all.numbers[s][i]);
        }
      }
      for (std::uint32_t j = i + 1; j < all.count; ++j) {
        add_step(all, i, j, members);
      }
      steps.last() |= kLastOfBone;
    }
    steps.last() |= kLastOfRun;
    run.cost = 3 * (steps.size - run.first_step);  // a Gram matrix is worth three times what a sphere makes of it
    for (const Member& member : members) {
      run.cost += pairs_of(member.bone_count);
    }
  }

  List<MomentRun> runs;
  List<RunSphere> spheres;
  List<std::uint32_t> steps, run_bones;
  List<float> moments;  // each sphere's or pair's at a multiple of four
  List<Float4> center_terms;

 private:
  MomentRun& start(Span<const Member> members, std::uint32_t bone_count, std::uint32_t kind) {
    const auto count = static_cast<std::uint32_t>(members.size);
    MomentRun& run = runs.add(
        {steps.size, moments.size / 4, run_bones.size, center_terms.size, spheres.size, count, bone_count, kind, 0});
    for (const Member& member : members) {
      const RestSphere& rest = rest_[member.sphere];
      spheres.add({member.sphere, radius_ == SC_RADIUS_FIT ? rest.radius : rest.detect_radius});
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
    center_terms.add({term.x, term.y, term.z, term.w});
  }

  // The step of bones i and j, if a sphere has both, and the moments of those that do. Returns the step, or 0.
  std::uint32_t add_step(const Union& all, std::uint32_t i, std::uint32_t j, Span<const Member> members) {
    std::uint32_t mask = 0;
    for (std::uint32_t s = 0; s < members.size; ++s) {
      const std::uint32_t k = all.numbers[s][i], l = all.numbers[s][j];
      if (k != Union::kNone && l != Union::kNone) {
        mask |= 1U << s;
        add_columns(moment_of(members[s], k, l), i == j, 0, 1);
        fill_quad();
      }
    }
    return mask == 0 ? 0 : steps.add(matrix_of(all.bones[j]) | mask);
  }

  // Columns of a moment, of those that are kept the rows one after another.
  void add_columns(const Moment& moment, bool is_self, std::size_t first, std::size_t step) {
    for (std::size_t column = first; column < 4; column += step) {
      for (std::size_t row = 0; row < rows_of_moment(is_self, column); ++row) {
        moments.add(moment.values[4 * row + column]);
      }
    }
  }
  void fill_quad() { moments.size = (moments.size + 3) / 4 * 4; }

  const MomentTables& tables_;
  Span<const RestSphere> rest_;
  Radius radius_;
  const std::uint32_t* bone_indices_;
};

// The spheres of two or three bones, many of the same ones at a time; the others by twos where that is less work. Of
// those only spheres near each other in the order are compared.
void add_runs(const MomentTables& tables, Member* members, RunWriter& writer) {
  constexpr std::ptrdiff_t kNear = 64;
  Member* const end = members + tables.spheres.size;
  Member* few = std::find_if(members, end, [](const Member& member) { return member.bone_count <= 3; });
  few = std::rotate(few, std::find_if(few, end, [](const Member& member) { return member.bone_count < 2; }), end);
  for (Member *one = few, *next = one; one < end; one = next) {
    next = std::find_if_not(one, one + std::min<std::ptrdiff_t>(kRunSpheresMax, end - one),
                            [&](const Member& other) { return have_same_bones(tables, *one, other); });
    writer.add_few_bones({one, static_cast<std::size_t>(next - one)});
  }
  for (Member* one = members; one < few; ++one) {
    if (one->bone_count == 0) {
      continue;  // taken already
    }
    Member* best = nullptr;
    std::int64_t best_saving = 0;
    for (Member* other = one + 1; other < one + std::min(kNear, few - one); ++other) {
      const std::int64_t saving = other->bone_count == 0 ? 0 : saved(tables, *one, *other);
      best = saving > best_saving ? other : best;
      best_saving = std::max(best_saving, saving);
    }
    const Member run[kRunSpheres] = {*one, best != nullptr ? *best : *one};
    writer.add({run, best != nullptr ? std::size_t{2} : 1});
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
  writer.runs.data = memory.take<MomentRun>(n, header.runs);
  writer.spheres.data = memory.take<RunSphere>(n, header.run_spheres);
  writer.steps.data = memory.take<std::uint32_t>(2 * tables.moments.size, header.moment_steps);
  writer.moments.data = memory.take<float>(kMomentSize * tables.moments.size, header.moments);
  writer.run_bones.data = memory.take<std::uint32_t>(tables.bones.size, header.run_bones);
  writer.center_terms.data = memory.take<Float4>(tables.bones.size, header.center_terms);
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
  add_runs(tables, members, writer);
  header.run_count = writer.runs.size;
  std::sort(writer.runs.data, writer.runs.data + header.run_count, [](const MomentRun& l, const MomentRun& r) {
    return l.cost != r.cost ? l.cost > r.cost : l.first_sphere < r.first_sphere;
  });
}

}  // namespace spherechain::cuda
