// SPDX-License-Identifier: MIT
#include "runtime/src/inside/inside_job.h"

#include <algorithm>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/clusters/set_up.h"

namespace spherechain {
namespace {

struct Memory {
  PosedClusters skin, own;
  std::int16_t* windings = nullptr;
  Span<std::uint64_t> asked;

  std::size_t lay_out(const AssetView& body, const AssetView& of_skin, bool are_one, std::uint64_t* words) {
    WordMemory memory(words);
    spherechain::lay_out(of_skin, memory, skin);
    if (!are_one) {
      spherechain::lay_out(body, memory, own);
    }
    memory.take(windings, 3 * body.spheres().size);
    memory.take(asked, words_for(body.spheres().size));
    return memory.used();
  }
};

}  // namespace

std::size_t inside_scratch_words(const AssetView& body, const AssetView& skin) {
  return has_skin(body) && has_skin(skin) ? Memory().lay_out(body, skin, false, nullptr) : 0;
}

void InsideJob::run() const {
  const AssetView &asset = view_of(*body.asset), &skin_asset = view_of(*skin.asset);
  Surface surface, skin_surface;
  read_skin_table(asset, body.skin_table, surface);
  read_skin_table(skin_asset, skin.skin_table, skin_surface);
  Memory memory;
  memory.lay_out(asset, skin_asset, are_one, scratch);
  const bool asks_all = !are_one || !has_all_pairs;
  std::fill(memory.asked.begin(), memory.asked.end(), asks_all ? ~std::uint64_t{0} : std::uint64_t{0});
  for (const Pair& pair : pairs) {
    for (const std::uint32_t s : {pair.a, pair.b}) {
      memory.asked[s / 64] |= std::uint64_t{1} << s % 64;
    }
  }
  for (std::size_t s = 0; body.ignored_parts != nullptr && s < asset.spheres().size; ++s) {
    const std::size_t part = asset.spheres()[s].part;
    if ((body.ignored_parts[part / 64] >> part % 64 & 1) != 0) {
      memory.asked[s / 64] &= ~(std::uint64_t{1} << s % 64);
    }
  }
  set_pose(skin_asset, skin_surface, skin.pose, filter, memory.skin);
  if (!are_one) {
    set_pose(asset, surface, body.pose, nullptr, memory.own);
  }
  find_inside({asset,
               surface,
               centers,
               {memory.asked.data, memory.asked.size},
               memory.skin,
               are_one ? memory.skin : memory.own,
               skin.ignored_parts,
               are_one,
               target,
               memory.windings,
               part});
}

}  // namespace spherechain
