// SPDX-License-Identifier: MIT
#include "arena.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#endif

namespace spherechain::test {
namespace {

constexpr std::size_t kCapacity = std::size_t{16} << 20;
constexpr std::size_t kGuard = 128;  // bytes, at least

}  // namespace

Arena::Arena() : memory_(kCapacity), picture_(kCapacity) {}

Arena::~Arena() { set_guards(false); }

void Arena::begin(Random& random) {
  set_guards(false);
  random_ = &random;
  blocks_.clear();
  used_ = 0;
}

void* Arena::add_bytes(std::size_t size, std::size_t alignment) {
  const auto base = reinterpret_cast<std::uintptr_t>(memory_.data());
  const std::size_t aligned = (base + used_ + kGuard + 63) / 64 * 64 - base;
  const std::size_t begin = aligned + alignment * random_->below(static_cast<std::uint32_t>(64 / alignment));
  const std::size_t end = begin + size + kGuard;
  if (end > kCapacity) {
    std::fprintf(stderr, "fuzz_jobs: a case needs more than %zu bytes\n", kCapacity);
    std::abort();
  }
  // Dirt that differs from place to place, so that a copy from the wrong one shows.
  const auto dirt = static_cast<std::uint8_t>(random_->below(256));
  for (std::size_t i = used_; i < end; ++i) {
    memory_[i] = static_cast<std::uint8_t>(dirt + 7 * i + (i >> 8));
  }
  blocks_.push_back({begin, begin + size});
  used_ = end;
  return memory_.data() + begin;
}

void Arena::set_guards([[maybe_unused]] bool poisoned) {
#if defined(__SANITIZE_ADDRESS__)
  if (!poisoned) {
    ASAN_UNPOISON_MEMORY_REGION(memory_.data(), used_);
    return;
  }
  std::size_t at = 0;
  for (const Block& block : blocks_) {
    ASAN_POISON_MEMORY_REGION(memory_.data() + at, block.begin - at);
    at = block.end;
  }
  ASAN_POISON_MEMORY_REGION(memory_.data() + at, used_ - at);
#endif
}

void Arena::seal() {
  std::memcpy(picture_.data(), memory_.data(), used_);
  set_guards(true);
}

bool Arena::kept_but(const std::vector<Bytes>& writable) {
  set_guards(false);
  // Outputs that may have changed are restored for this check.
  std::vector<std::vector<std::uint8_t>> found;
  const auto place_of = [&](const Bytes& bytes) {
    return static_cast<std::size_t>(static_cast<const std::uint8_t*>(bytes.data) - memory_.data());
  };
  for (const Bytes& bytes : writable) {
    const auto* data = static_cast<const std::uint8_t*>(bytes.data);
    found.emplace_back(data, data + bytes.size);
    if (bytes.size > 0) {
      std::memcpy(memory_.data() + place_of(bytes), picture_.data() + place_of(bytes), bytes.size);
    }
  }
  const bool kept = std::memcmp(memory_.data(), picture_.data(), used_) == 0;
  for (std::size_t i = 0; i < writable.size(); ++i) {
    if (writable[i].size > 0) {
      std::memcpy(memory_.data() + place_of(writable[i]), found[i].data(), found[i].size());
    }
  }
  set_guards(true);
  return kept;
}

void Arena::invert(const std::vector<Bytes>& ranges) {
  for (const Bytes& range : ranges) {
    const auto at = static_cast<std::size_t>(static_cast<const std::uint8_t*>(range.data) - memory_.data());
    for (std::size_t i = 0; i < range.size; ++i) {
      memory_[at + i] = static_cast<std::uint8_t>(~picture_[at + i]);
    }
  }
}

void Arena::restore() {
  set_guards(false);
  std::memcpy(memory_.data(), picture_.data(), used_);
  set_guards(true);
}

}  // namespace spherechain::test
