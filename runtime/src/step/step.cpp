// SPDX-License-Identifier: MIT
// A step is cut into pieces, each so short that the vertices' ways are nearly straight in it. In each piece: pairs of
// spheres that may touch on the way, then their triangles. Contacts at the step's ends are found as those of a frame.
#include <algorithm>
#include <cmath>

#include "runtime/src/base/memory.h"
#include "runtime/src/base/status.h"
#include "runtime/src/contacts/collector.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/step/motion.h"
#include "runtime/src/step/step_collector.h"
#include "runtime/src/step/step_job.h"

namespace spherechain {
namespace {

constexpr float kTolerance = 1e-4F;
constexpr double kWidest = 1.0 / 1024;          // what vertices may stray in a piece, in heights
constexpr double kFarthest = 1.0 / 4;           // what they may move against each other in a piece, in heights
constexpr double kTooFar = 16;                  // heights: cut by this, a step would have too many pieces
constexpr int kHalvingsMax = 9;                 // of the step, into pieces
constexpr std::size_t kClusterPairs = 1 << 14;  // listed at a time

// A body, on its way through the pieces.
struct Walker {
  const Motion* motion = nullptr;
  const AssetView* asset = nullptr;
  Surface surface;
  BodyMotion way;
  PosedClusters start, end;
  BoxColumns spheres, clusters;
  std::uint8_t* is_swept = nullptr;
  std::uint16_t* cluster_parts = nullptr;
  float* strays = nullptr;                                          // in a piece
  float *bones[2] = {}, *morph_weights[2] = {}, *vertices[2] = {};  // of `start` and of `end`, between the step's ends

  void take(WordMemory& memory, const Motion& of_motion, bool is_alone) {
    const AssetView& of = view_of(*of_motion.body.asset);
    const bool has_vertices = of_motion.body.pose.vertices != nullptr && !is_alone;
    const SkinSizes& sizes = of.skin().sizes;
    const std::size_t sphere_count = of.spheres().size;
    lay_out(of, memory, start);
    lay_out(of, memory, end);
    way.take(memory, of, of_motion.joint_count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      memory.take(spheres.low[axis], sphere_count);
      memory.take(spheres.high[axis], sphere_count);
      memory.take(clusters.low[axis], sizes.clusters);
      memory.take(clusters.high[axis], sizes.clusters);
    }
    memory.take(is_swept, sphere_count);
    memory.take(strays, sphere_count);
    memory.take(cluster_parts, sizes.clusters);
    for (std::size_t side = 0; side < 2; ++side) {
      memory.take(bones[side], 12 * of.bone_count());
      memory.take(morph_weights[side], of.morph_count());
      memory.take(vertices[side], has_vertices ? 3 * of.vertex_count() : 0);
    }
  }
  // The end of a piece is the start of the next.
  void go_on() {
    std::swap(start, end);
    std::swap(bones[0], bones[1]);
    std::swap(morph_weights[0], morph_weights[1]);
    std::swap(vertices[0], vertices[1]);
  }
  double widest() const {
    const Span<const float> all = way.strays();
    return all.size == 0 ? 0 : double{*std::max_element(all.begin(), all.end())};
  }
  MovingSkin moving() const { return {start, end, strays, spheres, clusters, is_swept}; }
};

struct StepMemory {
  Walker a, b;
  StepTable table;
  PartTable parts;
  Span<Pair> spheres, clusters;  // pairs of them

  void take(WordMemory& memory, const Motion& of_a, const Motion* of_b) {
    const AssetView& asset_a = view_of(*of_a.body.asset);
    const bool is_one = of_b == nullptr;
    a.take(memory, of_a, is_one);
    const std::size_t count = asset_a.spheres().size;
    std::size_t pair_count = count * (count + 1) / 2, parts_b = asset_a.part_count();
    if (!is_one) {
      const AssetView& asset_b = view_of(*of_b->body.asset);
      b.take(memory, *of_b, is_one);
      pair_count = count * asset_b.spheres().size;
      parts_b = asset_b.part_count();
    }
    table.take(memory, asset_a.part_count(), parts_b, is_one);
    parts.take(memory, asset_a.part_count(), parts_b, is_one);
    memory.take(spheres, pair_count);
    memory.take(clusters, kClusterPairs);
  }
};

// The memory that a job reads of a motion.
struct MotionRanges {
  BodyRanges body;
  MemoryRange end_vertices, end_bones, end_weights, start_joints, end_joints, parents, joint_of_bone;

  explicit MotionRanges(const Motion& motion)
      : body(motion.body),
        end_vertices(range_of_vertices(view_of(*motion.body.asset), motion.end)),
        end_bones(range_of_bones(view_of(*motion.body.asset), motion.end)),
        end_weights(range_of_morph_weights(view_of(*motion.body.asset), motion.end)),
        start_joints(range_of(Span<const sc_transform>{motion.start_joints, motion.joint_count})),
        end_joints(range_of(Span<const sc_transform>{motion.end_joints, motion.joint_count})),
        parents(range_of(Span<const std::uint32_t>{motion.parents, motion.joint_count})),
        joint_of_bone(
            range_of(Span<const std::uint32_t>{motion.joint_of_bone, view_of(*motion.body.asset).bone_count()})) {}

  bool overlaps(const MemoryRange& out) const {
    return any_shared({out}, {body.vertices, body.bones, body.morph_weights, body.skin_table, body.ignored_parts,
                              end_vertices, end_bones, end_weights, start_joints, end_joints, parents, joint_of_bone});
  }
};

bool has_two(const StepJob& job) { return job.b.body.asset != nullptr; }

std::size_t step_scratch_words(const StepJob& job) {
  return step_scratch_words(&job.a, has_two(job) ? &job.b : nullptr);
}

bool is_aliased(const StepJob& job) {
  const MemoryRange contacts = range_of(Span<StepContact>{job.contacts, job.contact_capacity});
  const MemoryRange scratch = range_of(Span<std::uint64_t>{job.scratch, step_scratch_words(job)});
  bool shared = any_shared({contacts, scratch}, {range_of(job.filter)});
  for (const MemoryRange& out : {contacts, scratch}) {
    shared = shared || MotionRanges(job.a).overlaps(out) || (has_two(job) && MotionRanges(job.b).overlaps(out));
  }
  return shared;
}

Status check(const StepJob& job, Target& resolved, StepMemory& room) {
  Status status = check_motion(job.a, room.a.surface);
  if (status == SC_OK && has_two(job)) {
    status = check_motion(job.b, room.b.surface);
  }
  if (status == SC_OK && job.filter != nullptr) {
    status = has_two(job) ? refuse(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS)
                          : check_filter(view_of(*job.a.body.asset), *job.filter);
  }
  if (status != SC_OK) {
    return status;
  }
  const Status lists[] = {check_list(job.a.body.ignored_parts, 0, SC_FIELD_IGNORED_PARTS),
                          check_list(job.b.body.ignored_parts, 0, SC_FIELD_IGNORED_PARTS),
                          check_list(job.scratch, 1, SC_FIELD_SCRATCH),
                          check_list(job.contacts, job.contact_capacity, SC_FIELD_CONTACTS)};
  for (const Status& list : lists) {
    if (list != SC_OK) {
      return list;
    }
  }
  if (!(job.tolerance >= 0) || !(job.tolerance <= 1)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TOLERANCE);
  }
  if (job.scratch_words < step_scratch_words(job)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  return is_aliased(job) ? refuse(SC_ALIASED, SC_FIELD_OUTPUT) : done();
}

// One run of a checked job.
class Step {
 public:
  Step(const StepJob& job, Target resolved, StepMemory& room)
      : job_(job), resolved_(resolved), room_(room), are_one_(!has_two(job)), b_(are_one_ ? room.a : room.b) {}

  // Refuses steps that are too wild for a certain answer; only scratch memory is written.
  Status begin() {
    begin(room_.a, job_.a);
    if (!are_one_) {
      begin(b_, job_.b);
    }
    const double height{room_.a.asset->info().height};
    for (const Walker* walker : {&room_.a, &b_}) {
      if (!(walker->widest() <= kWidest * height * (1 << 2 * kHalvingsMax))) {
        return refuse(SC_BAD_VALUE,
                      walker->motion->blend == SC_BLEND_LINEAR ? SC_FIELD_MORPH_WEIGHTS : SC_FIELD_JOINTS);
      }
    }
    return done();
  }

  std::size_t run() {
    Walker &a = room_.a, &b = b_;
    const double height{a.asset->info().height};
    const double tolerance = height * double{job_.tolerance > 0 ? job_.tolerance : kTolerance};
    room_.table.clear();
    StepCollector collector({{&a.surface, are_one_ ? nullptr : job_.a.body.ignored_parts}, &a.way, a.cluster_parts},
                            {{&b.surface, are_one_ ? nullptr : job_.b.body.ignored_parts}, &b.way, b.cluster_parts},
                            are_one_, room_.table, tolerance);
    pose_at(0, false);
    pose_at(1, true);
    double share = 1;
    const double widest = std::max(a.widest(), b.widest()), reach = greatest_move();
    for (int k = 0; k < kHalvingsMax; ++k) {
      if (widest * share * share > kWidest * height || reach * share > kFarthest * height) {
        share /= 2;
      }
    }
    if (share < 1) {
      note_ends({}, true, collector);
      note_ends({}, false, collector);
    }
    for (double from = 0; from < 1; from += share) {
      if (share < 1) {
        pose_at(from + share, true);
      }
      walk(from, share, collector);
      a.go_on();
      if (!are_one_) {
        b.go_on();
      }
    }
    return collector.list({job_.contacts, job_.contact_capacity});
  }

 private:
  static void begin(Walker& walker, const Motion& motion) {
    walker.motion = &motion;
    walker.asset = &view_of(*motion.body.asset);
    walker.way.start(motion, *walker.asset, walker.surface);
    std::fill(walker.cluster_parts, walker.cluster_parts + walker.surface.clusters.size, StepBody::kUnknown);
  }

  // About how far bones' skins move against each other: a guess, for there are fewer pairs of what moves less. 0 of
  // what no bones move.
  double greatest_move() const {
    Double3 sum{0, 0, 0};
    double count = 0, most = 0;
    const auto over_all = [&](const auto& take) {
      for (const Walker* walker : {&room_.a, &b_}) {
        for (std::size_t bone = 0;
             walker->start.has_balls && walker->end.has_balls && bone < walker->surface.bone_boxes.size; ++bone) {
          const BoneBox& box = walker->surface.bone_boxes[bone];
          if (box.half.x >= 0) {
            take(moved(walker->end.skin.bones, bone, box.center) - moved(walker->start.skin.bones, bone, box.center));
          }
        }
      }
    };
    over_all([&](const Double3& move) {
      sum = sum + move;
      count += 1;
    });
    if (count == 0) {
      return 0;
    }
    const Double3 mean = (1 / count) * sum;
    over_all([&](const Double3& move) { most = std::max(most, length(move - mean)); });
    return most < kTooFar * double{room_.a.asset->info().height} ? 2 * most : 0;
  }

  static Double3 moved(const BoneMatrices& bones, std::size_t bone, const Vec3& p) {
    const float* const m = bones.data + bone * bones.stride;
    const auto along = [&](std::size_t row) {
      const float* const r = m + row * bones.row;
      return double{r[0]} * double{p.x} + double{r[bones.column]} * double{p.y} +
             double{r[2 * bones.column]} * double{p.z} + double{r[3 * bones.column]};
    };
    return {along(0), along(1), along(2)};
  }

  void pose_at(double time, bool at_end) {
    const auto pose = [&](Walker& walker) {
      PosedClusters& posed = at_end ? walker.end : walker.start;
      const std::size_t side = at_end ? 1 : 0;
      posed.has_balls = posed.has_hulls = false;
      set_pose(*walker.asset, walker.surface,
               walker.way.pose_at(time, walker.bones[side], walker.morph_weights[side], walker.vertices[side]),
               job_.filter, posed);
    };
    pose(room_.a);
    if (!are_one_) {
      pose(room_.b);
    }
  }

  // Contacts in the pose of one end: of listed pairs of clusters, a few at a time, for of parts that are known to touch
  // no more is asked; of a null list, of all spheres.
  void note_ends(Span<const Pair> clusters, bool at_start, StepCollector& collector) {
    constexpr std::size_t kAtATime = 16;
    PosedClusters &a = at_start ? room_.a.start : room_.a.end, &b = at_start ? b_.start : b_.end;
    if (clusters.data == nullptr) {
      find_ends(a, b, at_start, collector);
      return;
    }
    Pair some[kAtATime];
    for (std::size_t i = 0; i < clusters.size;) {
      std::size_t count = 0;
      for (; i < clusters.size && count < kAtATime; ++i) {
        if (!collector.touch_at_end(clusters[i], at_start)) {
          some[count++] = clusters[i];
        }
      }
      if (count > 0) {
        a.candidate_clusters = {some, count};
        find_ends(a, b, at_start, collector);
      }
    }
    a.candidate_clusters = {};
  }

  void find_ends(const PosedClusters& a, const PosedClusters& b, bool at_start, StepCollector& collector) {
    room_.parts.clear();
    const ContactLists lists{{}, {}, {}, false};
    ContactCollector found = are_one_ ? ContactCollector(room_.a.surface, room_.parts, lists)
                                      : ContactCollector({&room_.a.surface, job_.a.body.ignored_parts},
                                                         {&b_.surface, job_.b.body.ignored_parts}, room_.parts, lists);
    find_candidates(resolved_, {a, b, are_one_}, found);
    for (std::size_t w = 0; w < room_.parts.word_count; ++w) {
      for (std::uint64_t word = room_.parts.seen[w]; word != 0; word &= word - 1) {
        collector.note_end(room_.parts.contacts[64 * w + lowest_bit(word)], at_start);
      }
    }
  }

  void walk(double from, double share, StepCollector& collector) {
    prepare(room_.a, share);
    if (!are_one_) {
      prepare(b_, share);
    }
    const MovingSkin a = room_.a.moving(), b = b_.moving();
    const MovingBodies bodies{a, are_one_ ? a : b, are_one_};
    Span<Pair> listed{room_.spheres.data, 0};
    find_moving_spheres(resolved_, bodies, listed);
    for (PosedClusters* posed : {&room_.a.start, &room_.a.end, &b_.start, &b_.end}) {
      posed->has_sphere_boxes = true;
    }
    const Span<const Pair> spheres{listed.data, listed.size};
    if (spheres.size == 0) {
      return;
    }
    collector.begin_piece(from, from + share);
    MovingClusters found{room_.clusters.data, room_.clusters.size, nullptr, nullptr};
    const bool has_all = find_moving_clusters(resolved_, bodies, spheres, found);
    const Span<const Pair> clusters{found.pairs, found.count};
    if (share == 1) {
      for (const bool at_start : {true, false}) {
        note_ends(has_all ? clusters : Span<const Pair>{}, at_start, collector);
      }
    }
    if (has_all) {
      find_moving_candidates(resolved_, bodies, clusters, collector);
      return;
    }
    Batch batch{resolved_, bodies, collector};
    found = {room_.clusters.data, room_.clusters.size, &Batch::take, &batch};
    find_moving_clusters(resolved_, bodies, spheres, found);
    Batch::take(&batch, {found.pairs, found.count});
  }

  // A batch of cluster pairs, where there are too many for one list.
  struct Batch {
    Target resolved;
    const MovingBodies& bodies;
    StepCollector& collector;

    static void take(void* batch, Span<const Pair> clusters) {
      const Batch& of = *static_cast<const Batch*>(batch);
      find_moving_candidates(of.resolved, of.bodies, clusters, of.collector);
    }
  };

  static void prepare(Walker& walker, double share) {
    const std::size_t count = walker.asset->spheres().size;
    std::fill(walker.is_swept, walker.is_swept + count, std::uint8_t{0});
    const Span<const float> strays = walker.way.strays();
    for (std::size_t s = 0; s < count; ++s) {
      walker.strays[s] = static_cast<float>(share * share) * strays[s];
    }
  }

  const StepJob& job_;
  Target resolved_;
  StepMemory& room_;
  bool are_one_;
  Walker& b_;
};

}  // namespace

bool MovingClusters::put(std::size_t a, std::size_t b) {
  if (count == room) {
    if (take == nullptr) {
      return false;
    }
    take(user, {pairs, count});
    count = 0;
  }
  pairs[count++] = {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)};
  return true;
}

std::size_t step_scratch_words(const Motion* a, const Motion* b) noexcept {
  const auto is_one = [](const Motion& motion) {
    return check_asset(motion.body.asset) == SC_OK && motion.joint_count <= kJointsMax;
  };
  if (a == nullptr || !is_one(*a) || (b != nullptr && !is_one(*b))) {
    return 0;
  }
  WordMemory memory(nullptr);
  StepMemory room;
  room.take(memory, *a, b);
  return memory.used();
}

Status StepJob::run() noexcept {
  Target resolved{};
  StepMemory room;
  const Status status = check(*this, resolved, room);
  if (status != SC_OK) {
    return status;
  }
  WordMemory memory(scratch);
  const bool two = has_two(*this);
  room.take(memory, a, two ? &b : nullptr);
  Step step(*this, resolved, room);
  if (const Status wild = step.begin(); wild != SC_OK) {
    return wild;
  }
  contact_count = step.run();
  return contact_count > contact_capacity && contacts != nullptr ? refuse(SC_OVERFLOW, SC_FIELD_CONTACTS) : done();
}

}  // namespace spherechain
