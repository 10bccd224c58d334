// SPDX-License-Identifier: MIT
// A body as jobs take it, and the table that its skin is read from.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/pose.h"

namespace spherechain {

// Two bodies of a job stand in one space, and may be of one asset.
struct JobBody {
  const Asset* asset = nullptr;  // open, with triangles; a character, or what `bake --prop` wrote
  Pose pose;                     // as of a SkinContactJob; a prop has one bone
  const std::uint64_t* skin_table = nullptr;
  const std::uint64_t* ignored_parts = nullptr;  // bit p: body part p meets nothing; null: all parts meet
};

// Expands the asset's packed skin into `words`, skin_table_words() of them, once. Any number of jobs may share the
// table; it must not change. 64-byte alignment is fastest.
std::size_t skin_table_words(const Asset* asset) noexcept;
Status prepare_skin(const Asset* asset, std::uint64_t* words, std::size_t word_count) noexcept;

}  // namespace spherechain
