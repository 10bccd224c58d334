// SPDX-License-Identifier: MIT
// The runtime's jobs as one call each, their buffers on the heap and sized exactly, so that sanitizers see any overrun.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "runtime/src/inside/inside_job.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/penetrations/penetration_jobs.h"
#include "runtime/src/refit/refit_job.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_table.h"
#include "runtime/src/step/step_job.h"
#include "spherechain/spherechain.h"

namespace spherechain::test {

struct Refitted {
  Status status;
  std::vector<Sphere> spheres;
};

// From deformed vertices: as many as `vertices` has whole strides.
Refitted refit(const Asset& asset, const std::vector<float>& vertices, Radius radius, std::size_t stride = 12);
Refitted refit(const Asset& asset, const Pose& pose, Radius radius, Target target = SC_TARGET_BEST);

struct Detected {
  Status status;
  std::vector<Pair> pairs;
  std::vector<std::uint64_t> bits;
};

// Runs to count, then with buffers of exactly that many, then with a table. SC_CORRUPT where that finds something else.
Detected detect(const Asset& asset, const std::vector<Sphere>& spheres, Radius radius, Target target = SC_TARGET_BEST,
                const Filter* filter = nullptr);

// An asset's skin table. `status` is that of prepare_skin(), or of reading the table.
struct PreparedSkin {
  explicit PreparedSkin(const Asset& asset);
  PreparedSkin(const PreparedSkin&) = delete;  // the surface points into this

  Status status;
  std::vector<std::uint64_t> words;
  Surface surface;
};

// All source vertices, three floats each; NaN where nothing was written.
std::vector<float> skin(const Asset& asset, const Pose& pose, Target target = SC_TARGET_BEST);

struct SkinContacts {
  Status status;
  std::vector<PartContact> parts;
  std::vector<Pair> spheres;
  std::vector<TriangleContact> triangles;
};

// Runs `job`, which needs no outputs or scratch memory, to count and then with exactly sized lists. Skin tables that it
// lacks are prepared.
// SC_CORRUPT where the runs find different things.
SkinContacts find_contacts(SkinContactJob job);
SkinContacts find_contacts(BodyContactJob job);

// Contacts of a step job: listed in full, and counted first.
struct StepContacts {
  Status status{};
  std::vector<StepContact> contacts;

  const StepContact* of(std::uint32_t part_a, std::uint32_t part_b) const;  // null: none
};
StepContacts find_contacts(StepJob job);

// The part of the same body that holds each sphere's centre, or kOutside.
std::vector<std::uint16_t> find_inside(const Asset& asset, const Pose& pose, Target target);

// The same for the measure of contacts; nothing where it fails.
std::vector<Penetration> measure(PenetrationJob job, Target target);
std::vector<Penetration> measure(BodyPenetrationJob job, Target target);

// Bit for bit, so that a NaN equals itself.
template <typename T>
bool same_bits(const std::vector<T>& l, const std::vector<T>& r) {
  return l.size() == r.size() && (l.empty() || std::memcmp(l.data(), r.data(), l.size() * sizeof(T)) == 0);
}

}  // namespace spherechain::test
