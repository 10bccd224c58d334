// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "runtime/src/base/least_entries.h"
#include "runtime/src/contacts/candidates.h"
#include "runtime/src/contacts/contact_jobs.h"
#include "runtime/src/contacts/part_table.h"
#include "runtime/src/skin/left_out.h"

namespace spherechain {

// Where a job's contacts go, and how many there were.
struct ContactLists {
  Span<PartContact> parts;
  Span<Pair> spheres;
  Span<TriangleContact> triangles;
  bool spheres_only;
  const std::uint64_t* part_pairs = nullptr;  // a bit for each place of PartTable that counts; null: all count

  static ContactLists of(const ContactJob& job) {
    return {{job.parts, job.part_capacity},
            {job.spheres, job.sphere_capacity},
            {job.triangles, job.triangle_capacity},
            job.spheres_only != 0,
            job.part_pairs};
  }
};
struct ContactCounts {
  std::size_t parts, spheres, triangles;

  void copy_to(ContactJob& job) const {
    job.part_count = parts;
    job.sphere_count = spheres;
    job.triangle_count = triangles;
  }
};

// Kernels call its functions, none of them inline: they must not call templates of the standard library.
class ContactCollector {
 public:
  // One body's contacts with itself: neighbours and what touches at rest are none.
  ContactCollector(const Surface& surface, const PartTable& parts, const ContactLists& lists)
      : ContactCollector({&surface, nullptr}, {&surface, nullptr}, true, parts, lists) {}
  // Two bodies'.
  ContactCollector(const FilteredSkin& a, const FilteredSkin& b, const PartTable& parts, const ContactLists& lists)
      : ContactCollector(a, b, false, parts, lists) {}

  void begin_spheres(Pair spheres);
  bool decide(const Candidate& candidate);  // is it a contact?
  // Brings the lists in order. SC_OK, or SC_OVERFLOW.
  Status finish(ContactCounts& counts);

 private:
  ContactCollector(const FilteredSkin& a, const FilteredSkin& b, bool are_one, const PartTable& parts,
                   const ContactLists& lists)
      : a_(a),
        b_(b),
        are_one_(are_one),
        part_table_(parts),
        parts_(lists.parts),
        triangles_(lists.triangles),
        spheres_(lists.spheres),
        spheres_only_(lists.spheres_only),
        part_pairs_(lists.part_pairs) {}

  void end_spheres();
  bool is_left_out(const Candidate& candidate) const;
  bool is_asked(const Candidate& candidate) const;
  void add_parts(const TriangleContact& contact, const Candidate& candidate);
  std::size_t list_parts() const;

  FilteredSkin a_, b_;
  bool are_one_;
  PartTable part_table_;
  Span<PartContact> parts_;
  LeastEntries<TriangleContact> triangles_;
  LeastEntries<Pair> spheres_;
  bool spheres_only_, touch_ = false;
  const std::uint64_t* part_pairs_;
  Pair current_{};
};

}  // namespace spherechain
