// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <new>

namespace spherechain::baker {

// Memory whose addresses depend only on the order of the calls: one block that is handed out from its start. Freed
// pieces are reused by size, last in, first out. ArenaAllocator uses the arena that exists; there may be one in each
// thread.
class SkeletonArena {
 public:
  // A human of 26,756 triangles took 550 bytes a triangle. Pages that are never touched cost nothing.
  explicit SkeletonArena(std::size_t triangles)
      : capacity_((std::size_t{1} << 24) + 16384 * triangles), block_(new std::byte[capacity_]) {
    current_ = this;
  }
  ~SkeletonArena() { current_ = nullptr; }
  SkeletonArena(const SkeletonArena&) = delete;
  SkeletonArena& operator=(const SkeletonArena&) = delete;

  static SkeletonArena& current() { return *current_; }

  void* allocate(std::size_t size) {
    size = round_up(size);
    if (size < kSizeMax && free_[size / kGrain] != nullptr) {
      Free* piece = free_[size / kGrain];
      free_[size / kGrain] = piece->next;
      return piece;
    }
    if (size > capacity_ - used_) throw std::bad_alloc();
    used_ += size;
    return block_.get() + used_ - size;
  }

  void deallocate(void* p, std::size_t size) {
    size = round_up(size);
    if (size >= kSizeMax) return;
    free_[size / kGrain] = new (p) Free{free_[size / kGrain]};
  }

 private:
  struct Free {
    Free* next;
  };
  static constexpr std::size_t kGrain = 16, kSizeMax = 4096;
  static std::size_t round_up(std::size_t size) { return (size + kGrain - 1) / kGrain * kGrain; }

  static inline thread_local SkeletonArena* current_ = nullptr;
  std::size_t capacity_, used_ = 0;
  std::unique_ptr<std::byte[]> block_;
  std::array<Free*, kSizeMax / kGrain> free_{};
};

template <typename T>
struct ArenaAllocator {
  using value_type = T;
  ArenaAllocator() = default;
  template <typename U>
  ArenaAllocator(const ArenaAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(SkeletonArena::current().allocate(n * sizeof(T))); }
  void deallocate(T* p, std::size_t n) { SkeletonArena::current().deallocate(p, n * sizeof(T)); }
  template <typename U>
  friend bool operator==(const ArenaAllocator&, const ArenaAllocator<U>&) {
    return true;
  }
  template <typename U>
  friend bool operator!=(const ArenaAllocator&, const ArenaAllocator<U>&) {
    return false;
  }
};

}  // namespace spherechain::baker
