// SPDX-License-Identifier: MIT
#include "fuzz_case.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "runtime/src/pose/pose.h"
#include "runtime/src/simd/simd.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

// Below, at and past a word, a tile and a register of spheres; groups of pivots that are not full, and several; both
// rules of refit; with and without bones, moments and a skin.
std::vector<std::vector<std::uint8_t>> make_assets() {
  std::vector<std::vector<std::uint8_t>> assets;
  for (const unsigned n : {1U, 2U, 5U, 12U, 16U, 33U, 64U, 75U, 128U, 129U, 200U}) {
    TinyAsset tiny = n % 2 == 0 ? random_asset(n, n) : random_band(n, n);
    if (n % 3 == 0) {
      give_pivots(tiny, n / 2, 19, n);
      give_pivots(tiny, 0, 9, n);
      tiny.parts.refit = 0;
    }
    TinySkin skin;
    if (n != 12) {
      skin = add_bones(tiny, 1 + n % 6, n);
    }
    if (n != 64) {
      add_skin(tiny, n == 12 ? nullptr : &skin, 1 + n % 4);
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
  c.asset_bytes = {data, bytes.size()};
  const Status status = sc_asset_open(&c.asset, SC_ABI_VERSION, data, bytes.size(), nullptr, 0);
  c.expect(status == SC_OK || status.field == SC_FIELD_DATA, "open: a refusal without its field");
  c.n = status == SC_OK ? c.view().spheres().size : 0;
  return status == SC_OK;
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
  std::size_t count = 0;
  const Target* const targets = sc_supported_targets(&count);
  return c.random.one_in(3) ? SC_TARGET_BEST : targets[c.random.up_to(count - 1)];
}

void draw_bones(Case& c, Pose& pose) {
  pose.bone_layout = static_cast<MatrixLayout>(1 + c.random.below(4));
  pose.bone_stride = c.random.one_in(2) ? 0 : size_of(pose.bone_layout) + 4 * c.random.below(6);
  pose.bone_count = c.view().bone_count() + (c.random.one_in(2) ? 0 : c.random.below(3));
  const std::size_t bytes =
      pose.bone_count == 0 ? 0 : (pose.bone_count - 1) * bone_stride(pose) + size_of(pose.bone_layout);
  float* const bones = c.arena.add<float>(bytes / sizeof(float));
  fill_figures(c, bones, bytes / sizeof(float));
  pose.bones = bones;
  if (c.random.one_in(2)) {
    pose.morph_weight_count = c.view().morph_count() + c.random.below(2);
    float* const weights = c.arena.add<float>(pose.morph_weight_count);
    fill_figures(c, weights, pose.morph_weight_count);
    pose.morph_weights = weights;
  }
}

bool draw_vertices(Case& c, Pose& pose) {
  if (c.view().vertex_count() > kMaxVertices) {
    return false;
  }
  pose.vertex_count = c.view().vertex_count() + c.random.below(2);
  pose.vertex_stride = c.random.one_in(2) ? 0 : 12 + 4 * c.random.below(8);
  const std::size_t floats =
      pose.vertex_count == 0 ? 0 : (pose.vertex_count - 1) * vertex_stride(pose) / sizeof(float) + 3;
  float* const vertices = c.arena.add<float>(floats);
  fill_figures(c, vertices, floats);
  pose.vertices = vertices;
  return true;
}

void add_asset_ways(Case& c, const Asset*& asset, Ways& ways) {
  ways.insert(ways.end(), {[&] { asset = nullptr, c.spoil(SC_NULL, SC_FIELD_ASSET); },
                           [&] { asset = &c.closed, c.spoil(SC_NOT_OPEN, SC_FIELD_ASSET); }});
}

void add_bone_ways(Case& c, Pose& pose, Ways& ways) {
  ways.insert(
      ways.end(),
      {[&] { pose.bone_count = c.random.up_to(c.view().bone_count() - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_BONE_COUNT); },
       [&] {
         const std::size_t size = size_of(pose.bone_layout);
         const std::size_t strides[] = {4, 44, size - 4, size + 2, 999, ~std::size_t{0}};
         pose.bone_stride = c.random.pick(strides);
         c.spoil(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE);
       },
       [&] {
         pose.bone_layout = c.random.one_in(2) ? SC_LAYOUT_UNSET : draw_none<MatrixLayout>(c, 5);
         c.spoil(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT);
       },
       [&] { put_askew(c, pose.bones), c.spoil(SC_MISALIGNED, SC_FIELD_BONES); },
       [&] {
         pose.morph_weights = nullptr;
         pose.morph_weight_count = c.view().morph_count() + 1;
         c.spoil(SC_NULL, SC_FIELD_MORPH_WEIGHTS);
       },
       [&] {
         if (c.view().morph_count() > 1) {
           pose.morph_weights = c.arena.add<float>(3);
           pose.morph_weight_count = c.view().morph_count() - 1;
           c.spoil(SC_TOO_SMALL, SC_FIELD_MORPH_WEIGHTS);
         }
       }});
}

void add_vertex_ways(Case& c, Pose& pose, Ways& ways) {
  ways.insert(ways.end(), {[&] {
                             if (c.view().vertex_count() > 0) {
                               pose.vertex_count = c.random.one_in(2) ? c.view().vertex_count() - 1 : 0;
                               c.spoil(SC_TOO_SMALL, SC_FIELD_VERTEX_COUNT);
                             }
                           },
                           [&] {
                             const std::size_t strides[] = {4, 8, 11, 13, 14, 18, ~std::size_t{0}, ~std::size_t{0} - 1};
                             pose.vertex_stride = c.random.pick(strides);
                             c.spoil(SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE);
                           },
                           [&] { put_askew(c, pose.vertices), c.spoil(SC_MISALIGNED, SC_FIELD_VERTICES); }});
}

std::vector<Bone> draw_engine_joints(Case& c) {
  std::vector<Bone> joints;
  for (std::size_t i = 0; i < c.view().bone_count(); ++i) {
    joints.push_back(sc_asset_bone(&c.asset, i));
    if (c.random.one_in(4)) joints.back().inverse_bind = nullptr;
  }
  if (!joints.empty() && c.random.one_in(3)) joints[c.random.up_to(joints.size() - 1)].name = nullptr;
  return joints;
}

Filter draw_filter(Case& c) {
  Filter filter;
  filter.ignored_words = sc_pair_words(&c.asset);
  auto* const words = c.arena.add<std::uint64_t>(filter.ignored_words);
  filter.ignored = words;
  for (std::size_t i = 0; i < filter.ignored_words; ++i) {
    words[i] = c.random.one_in(3) ? c.random.bits() & c.random.bits() & c.random.bits() : 0;
  }
  return filter;
}

void spoil_filter(Case& c, Filter& filter) {
  switch (c.random.below(4)) {
    case 0:
      filter.ignored_words += 1;
      return c.spoil(SC_TOO_SMALL, SC_FIELD_IGNORED_PAIRS);
    case 1:  // as of another asset
      if (filter.ignored_words > 0) {
        filter.ignored_words /= 2;
        c.spoil(SC_TOO_SMALL, SC_FIELD_IGNORED_PAIRS);
      }
      return;
    case 2:
      filter.ignored = nullptr;
      filter.ignored_words += 1;
      return c.spoil(SC_NULL, SC_FIELD_IGNORED_PAIRS);
    default:
      put_askew(c, filter.ignored);
      return c.spoil(SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS);
  }
}

void spoil_some(Case& c, const Ways& ways) {
  const auto count = static_cast<std::uint32_t>(ways.size());
  const std::uint32_t times = c.random.one_in(2) ? 0 : c.random.one_in(5) ? 2 : 1;
  const std::uint32_t first = c.random.below(count);
  for (std::uint32_t i = 0; i < times; ++i) {
    ways[i == 0 ? first : (first + 1 + c.random.below(count - 1)) % count]();
  }
}

Status run_twice(Case& c, const Call& call) {
  const auto copy = [&](const std::vector<Bytes>& ranges) {
    std::vector<std::uint8_t> bytes;
    for (const Bytes& range : ranges) {
      const auto* data = static_cast<const std::uint8_t*>(range.data);
      bytes.insert(bytes.end(), data, data + range.size);
    }
    return bytes;
  };
  c.arena.seal();
  const Status status = call.run();
  const bool ran = status == SC_OK || status == SC_OVERFLOW;
  c.expect(c.spoiled == 0 ? ran : c.spoiled == 1 ? status == c.wanted : !ran, "another status");
  c.expect(status == SC_OK || status.field != SC_FIELD_NONE, "a status without its field");
  const std::vector<Bytes> changed = ran ? call.outputs() : std::vector<Bytes>();
  c.expect(c.arena.kept_but(changed), "memory was written that must not be");
  if (ran) call.tidy();
  const std::vector<std::uint8_t> outputs = copy(changed);
  c.arena.restore();
  if (call.writes_all) c.arena.invert(changed);
  c.expect(call.run() == status, "another status on another target");
  c.expect(c.arena.kept_but(changed), "memory was written that must not be, on another target");
  if (ran) call.tidy();
  c.expect(copy(changed) == outputs, "another target gives something else");
  (ran ? status == SC_OK ? c.tally.ran : c.tally.overflowed : c.tally.refused) += 1;
  return status;
}

void make_one_nan(float* figures, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    figures[i] = std::isnan(figures[i]) ? std::numeric_limits<float>::quiet_NaN() : figures[i];
  }
}

}  // namespace spherechain::test
