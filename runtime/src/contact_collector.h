// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>

#include "contact_scene.h"
#include "spherechain/triangle_contacts.h"

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
        std::make_heap(out_.begin(), out_.end());
      }
      if (entry < out_[0]) {
        std::pop_heap(out_.begin(), out_.end());
        out_[out_.size - 1] = entry;
        std::push_heap(out_.begin(), out_.end());
      }
    }
    ++count_;
  }
  void finish() { std::sort(out_.begin(), out_.begin() + std::min(count_, out_.size)); }

  bool overflowed() const { return out_.size > 0 && count_ > out_.size; }
  std::size_t count() const { return count_; }

 private:
  Span<T> out_;
  std::size_t count_ = 0;
};

class ContactCollector {
 public:
  ContactCollector(const Asset& asset, Span<TrianglePair> pairs, Span<TriangleContact> contacts,
                   Span<SphereContact> sphere_contacts, Span<Pair> spheres)
      : asset_(asset),
        pairs_(pairs),
        contacts_(contacts),
        sphere_contacts_(sphere_contacts),
        spheres_(spheres),
        measures_(contacts.size > 0 || sphere_contacts.size > 0) {}

  void begin_spheres(Pair spheres);
  bool decide(const Candidate& candidate);
  void finish();

  bool overflowed() const {
    return pairs_.overflowed() || contacts_.overflowed() || sphere_contacts_.overflowed() || spheres_.overflowed();
  }
  std::size_t pair_count() const { return pairs_.count(); }
  std::size_t sphere_contact_count() const { return sphere_contacts_.count(); }

 private:
  void end_spheres();
  bool share_a_position(const Candidate& candidate) const;

  const Asset& asset_;
  LeastEntries<TrianglePair> pairs_;
  LeastEntries<TriangleContact> contacts_;
  LeastEntries<SphereContact> sphere_contacts_;
  LeastEntries<Pair> spheres_;
  bool measures_;
  SphereContact current_{};
};

}  // namespace spherechain
