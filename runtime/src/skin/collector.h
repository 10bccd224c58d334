// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>

#include "asset/span.h"
#include "skin/scene_setup.h"
#include "spherechain/skin_contacts.h"

namespace spherechain {

// The least entries of a sorted list that fit a buffer, and how many there were. Sorted only by finish().
template <typename T>
class LeastEntries {
 public:
  explicit LeastEntries(Span<T> out) : out_(out) {}

  void add(const T& entry) {
    if (count_ < out_.size) {
      out_[count_] = entry;
    } else if (out_.size > 0) {
      if (count_ == out_.size) {
        std::make_heap(out_.begin(), out_.end(), is_before);
      }
      if (is_before(entry, out_[0])) {
        std::pop_heap(out_.begin(), out_.end(), is_before);
        out_[out_.size - 1] = entry;
        std::push_heap(out_.begin(), out_.end(), is_before);
      }
    }
    ++count_;
  }
  void finish() { std::sort(out_.begin(), out_.begin() + std::min(count_, out_.size), is_before); }

  bool is_wanted() const { return out_.size > 0; }
  bool overflowed() const { return out_.size > 0 && count_ > out_.size; }
  std::size_t count() const { return count_; }

 private:
  static bool is_before(const T& l, const T& r) { return key_of(l) < key_of(r); }
  static Pair key_of(const Pair& pair) { return pair; }
  static Pair key_of(const TriangleContact& contact) { return {contact.triangle_a, contact.triangle_b}; }

  Span<T> out_;
  std::size_t count_ = 0;
};

// Kernels call its functions, none of them inline: they must not call templates of the standard library.
class ContactCollector {
 public:
  ContactCollector(const Surface& surface, const PartTable& parts, SkinContactJob& job)
      : surface_(surface),
        part_table_(parts),
        parts_{job.parts, job.part_capacity},
        triangles_({job.triangles, job.triangle_capacity}),
        spheres_({job.spheres, job.sphere_capacity}),
        spheres_only_(job.spheres_only != 0) {}

  void begin_spheres(Pair spheres);
  bool decide(const Candidate& candidate);  // is it a contact?
  // Brings the lists in order and sets the job's counts. SC_OK, or SC_OVERFLOW.
  Status finish(SkinContactJob& job);

 private:
  void end_spheres();
  bool share_a_position(const Candidate& candidate) const;
  void add_parts(std::uint32_t a, std::uint32_t b, const Candidate& candidate);
  std::size_t list_parts() const;

  const Surface& surface_;
  PartTable part_table_;
  Span<sc_part_contact> parts_;
  LeastEntries<TriangleContact> triangles_;
  LeastEntries<Pair> spheres_;
  bool spheres_only_, touch_ = false;
  Pair current_{};
};

}  // namespace spherechain
