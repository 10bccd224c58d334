// SPDX-License-Identifier: MIT
// Collects for each two body parts when they first touch in a step, and when last.
#pragma once

#include "runtime/src/clusters/set_up.h"
#include "runtime/src/contacts/part_table.h"
#include "runtime/src/skin/left_out.h"
#include "runtime/src/step/approach.h"
#include "runtime/src/step/motion.h"
#include "runtime/src/step/moving_skin.h"

namespace spherechain {

struct StepEntry {
  StepContact contact;
  double first, last;  // times of the step; 2 and -1: none found
};
using StepTable = TableOfParts<StepEntry>;

// One body during the step.
struct StepBody {
  FilteredSkin skin;
  BodyMotion* motion;
  // Scratch memory: for each cluster the part of all its triangles, or kSeveral; kUnknown at first.
  std::uint16_t* parts;

  static constexpr std::uint16_t kSeveral = 0xFFFE, kUnknown = 0xFFFF;
  std::uint16_t part_of(std::size_t cluster);
};

// Kernels call decide() and is_settled(), which are not inline: they must not call templates of the standard library.
class StepCollector {
 public:
  StepCollector(const StepBody& a, const StepBody& b, bool are_one, const StepTable& table, double tolerance)
      : a_(a), b_(b), are_one_(are_one), table_(table), tolerance_(tolerance) {}

  // Notes a part contact at the start of the step, or at its end.
  void note_end(const PartContact& contact, bool at_start);
  // Is that known of all parts of two clusters?
  bool touch_at_end(const Pair& clusters, bool at_start);
  // Begins a piece of the step: contacts that are added next belong to it.
  void begin_piece(double begin, double end) {
    begin_ = begin;
    end_ = end;
  }
  // Is all known of the parts of two clusters, in this piece?
  bool is_settled(std::size_t cluster_a, std::size_t cluster_b);
  void decide(const MovingCandidate& candidate);
  // Writes the least entries that fit; gives how many there are.
  std::size_t list(Span<StepContact> out) const;

 private:
  StepEntry& entry(std::uint32_t part_a, std::uint32_t part_b);
  const StepEntry* known(std::uint32_t part_a, std::uint32_t part_b) const;  // null: nothing
  const StepEntry* known_of_clusters(std::size_t cluster_a, std::size_t cluster_b);
  double search(const MovingCandidate& candidate, const CornerPaths& way, double from, double to, double until,
                SixCorners& then);
  SixCorners corners_at(const MovingCandidate& candidate, double time);

  StepBody a_, b_;
  bool are_one_;
  StepTable table_;
  double tolerance_, begin_ = 0, end_ = 1;
};

}  // namespace spherechain
