// SPDX-License-Identifier: MIT
#include "fuzz_case.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tiny_moments.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

// Below, at and past a word, a tile and a register of spheres; groups of pivots that are not full, and several; each
// rule of refit; with and without what older bakers left out.
std::vector<std::vector<std::uint8_t>> make_assets() {
  std::vector<std::vector<std::uint8_t>> assets;
  for (const unsigned n : {1U, 2U, 5U, 12U, 16U, 33U, 64U, 75U, 128U, 129U, 200U}) {
    TinyAsset tiny = random_asset(n, n);
    if (n % 3 == 0) {
      give_pivots(tiny, n / 2, 19, n);
      give_pivots(tiny, 0, 9, n);
      tiny.parts.refit = 0;
    }
    TinySkin skin;
    if (n != 12) {
      skin = add_bones(tiny, 1 + n % 6, n);
      if (n % 3 == 2) {
        add_moments(tiny, skin, n % 2 == 0 ? 48 : 3, n % 8 == 0 ? PivotTables::kKept : PivotTables::kLeftOut);
      }
    }
    if (n % 2 == 0 || n % 5 == 0) {  // one without bones, several with
      add_surface(tiny, n == 12 ? nullptr : &skin, 1 + n % 4);
    }
    assets.push_back(build(tiny.parts));
  }
  return assets;
}

const std::vector<std::vector<std::uint8_t>>& assets() {
  static const std::vector<std::vector<std::uint8_t>> made = make_assets();
  return made;
}

}  // namespace

std::size_t asset_count() { return assets().size(); }

bool draw_asset(Case& c) {
  // Small ones more often: they are quick, and their ends are nearer.
  const std::size_t last = c.random.up_to(assets().size() - 1);
  const std::vector<std::uint8_t>& bytes = assets()[std::min(last, c.random.up_to(assets().size() - 1))];
  auto* data = reinterpret_cast<std::uint8_t*>(c.arena.add<std::uint64_t>((bytes.size() + 7) / 8));
  std::copy(bytes.begin(), bytes.end(), data);
  for (std::size_t changes = c.random.one_in(2) ? 1 + c.random.below(3) : 0; changes > 0; --changes) {
    const std::size_t at = c.random.up_to(bytes.size() - 4);
    if (!c.random.one_in(4)) {  // most of these open
      data[at] = static_cast<std::uint8_t>(data[at] ^ (1U << c.random.below(8)));
      continue;
    }
    const std::uint32_t words[] = {0, 1, 0xFFFFFFFFU, 0x7FFFFFFFU, 0x7F7FFFFFU, 0x3F800000U};
    const std::uint32_t word = c.random.pick(words);
    std::memcpy(data + at / 4 * 4, &word, sizeof word);
  }
  auto* memory = c.arena.add<std::uint64_t>(sc_asset_size() / 8 + 1);
  auto* closed = c.arena.add<std::uint64_t>(sc_asset_size() / 8 + 1);
  const sc_asset* none = nullptr;
  (void)sc_asset_open(SC_ABI_VERSION, closed, sc_asset_size(), data, 3, &none, nullptr, 0);
  c.c_closed = reinterpret_cast<const sc_asset*>(closed);
  const Status status = c.asset.open(data, bytes.size());
  const sc_status c_status =
      sc_asset_open(SC_ABI_VERSION, memory, sc_asset_size(), data, bytes.size(), &c.c_asset, nullptr, 0);
  c.expect(none == nullptr && static_cast<Status>(c_status) == status, "open: the two APIs differ");
  c.n = status == Status::kOk ? c.asset.spheres().size : 0;
  return status == Status::kOk;
}

void fill_figures(Case& c, float* figures, std::size_t count) {
  using Limits = std::numeric_limits<float>;
  // The tail: where nothing is infinite yet, but squares are, or nearly.
  const float hostile[] = {Limits::quiet_NaN(),
                           -Limits::quiet_NaN(),
                           Limits::infinity(),
                           -Limits::infinity(),
                           Limits::max(),
                           -Limits::max(),
                           Limits::denorm_min(),
                           Limits::min(),
                           0.0F,
                           -0.0F,
                           1.8e19F,
                           -9e18F,
                           1e15F,
                           1e-20F,
                           1e-38F,
                           4.0F};
  constexpr std::uint32_t kCount = sizeof hostile / sizeof hostile[0], kTail = 6;
  const std::uint32_t first = c.random.one_in(2) ? kTail : 0;
  const std::uint32_t modes[] = {0, 0, 1000, 40, 4, 1};
  const std::uint32_t mode = c.random.pick(modes);
  const float scales[] = {1.0F, 1.0F, 0.5F, 1e-3F, 1e4F, 8e18F};
  const float scale = c.random.pick(scales);
  for (std::size_t i = 0; i < count; ++i) {
    figures[i] =
        mode > 0 && c.random.one_in(mode) ? hostile[first + c.random.below(kCount - first)] : scale * c.random.figure();
  }
}

std::size_t draw_capacity(Case& c, std::size_t there_are) {
  const std::size_t capacities[] = {0, c.random.up_to(there_are), there_are, there_are, there_are + c.random.below(9)};
  return c.random.pick(capacities);
}

Target draw_target(Case& c) {
  const Span<const Target> targets = supported_targets();
  return c.random.one_in(3) ? Target::kBest : targets[c.random.up_to(targets.size - 1)];
}

BoneMatrices draw_bones(Case& c) {
  BoneMatrices bones;
  bones.layout = static_cast<MatrixLayout>(c.random.below(4));
  bones.stride = size_of(bones.layout) + 4 * (c.random.one_in(2) ? 0 : c.random.below(6));
  const std::size_t least = c.asset.bone_count();
  bones.count = least + (c.random.one_in(2) ? 0 : c.random.below(3));
  const std::size_t floats =
      bones.count == 0 ? 0 : ((bones.count - 1) * bones.stride + size_of(bones.layout)) / sizeof(float);
  float* data = c.arena.add<float>(floats);
  fill_figures(c, data, floats);
  bones.data = data;
  return bones;
}

Filter draw_filter(Case& c) {
  const std::size_t words = Filter::ignored_words(c.asset);
  Filter filter;
  filter.ignored = {c.arena.add<std::uint64_t>(words), words};
  for (std::uint64_t& word : filter.ignored) {
    word = c.random.one_in(3) ? c.random.bits() & c.random.bits() : 0;
  }
  if (c.random.one_in(2)) {
    filter.disabled.size = Filter::disabled_words(c.asset);
    filter.disabled.data = c.arena.add<std::uint64_t>(filter.disabled.size);
    for (std::uint64_t& word : filter.disabled) {
      word = c.random.one_in(2) ? c.random.bits() & c.random.bits() & c.random.bits() : 0;
    }
  }
  if (c.random.one_in(2)) {
    filter.padding = {c.arena.add<float>(c.n), c.n};
    fill_figures(c, filter.padding.data, c.n);
  }
  return filter;
}

void spoil_filter(Case& c, Filter& filter, Spoiled& spoiled) {
  switch (c.random.below(kFilterWays)) {
    case 0:
      filter.ignored.size += 1;
      return spoiled.with(Status::kBadFilter);
    case 1:  // as of another asset
      if (filter.ignored.size > 0) {
        filter.ignored.size /= 2;
        spoiled.with(Status::kBadFilter);
      }
      return;
    case 2:
      filter.ignored = {nullptr, filter.ignored.size + 1};
      return spoiled.with(Status::kNullArgument);
    case 3:
      filter.disabled = {c.arena.add<std::uint64_t>(9), Filter::disabled_words(c.asset) + 1};
      return spoiled.with(Status::kBadFilter);
    case 4:
      filter.disabled = {nullptr, Filter::disabled_words(c.asset)};
      return spoiled.with(Status::kNullArgument);
    case 5:
      filter.padding = {c.arena.add<float>(c.n + 1), c.n + 1};
      return spoiled.with(Status::kBadFilter);
    case 6:
      if (c.n > 1) {
        filter.padding = {c.arena.add<float>(c.n), c.n - 1};
        spoiled.with(Status::kBadFilter);
      }
      return;
    default:
      put_askew(c, filter.ignored.data);
      return spoiled.with(Status::kMisaligned);
  }
}

sc_filter to_c(const Filter& filter) {
  return {filter.ignored.data,  filter.ignored.size, filter.disabled.data,
          filter.disabled.size, filter.padding.data, filter.padding.size};
}

void make_one_nan(float* figures, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    figures[i] = std::isnan(figures[i]) ? std::numeric_limits<float>::quiet_NaN() : figures[i];
  }
}

}  // namespace spherechain::test
