// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "character.h"
#include "spherechain/crowd.h"

namespace spherechain::bench {

// Goal P4: a crowd of one character in its poses in turn. Each instance has matrices of its own: bones in, pairs out.
class CrowdRun {
 public:
  CrowdRun(const PosedCharacter& character, std::size_t instance_count, std::size_t thread_count);
  CrowdRun(const CrowdRun&) = delete;  // the job points into this

  void run();
  // True if the last run found for each instance the pairs that a DetectJob finds.
  bool has_the_pairs_of(const PosedCharacter& character) const;

 private:
  static void on_threads(void* self_pointer, std::size_t count, void (*task)(void*, std::size_t), void* data);

  std::size_t thread_count_;
  std::vector<float> matrices_;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> counts_;
  std::vector<CrowdPair> pairs_;
  CrowdJob job_;
};

}  // namespace spherechain::bench
