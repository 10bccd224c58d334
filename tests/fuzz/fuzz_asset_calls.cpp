// SPDX-License-Identifier: MIT
// Opening in the caller's memory, what an asset is asked, and edits of filters, through both APIs.
#include <algorithm>
#include <cstring>

#include "fuzz_case.h"

namespace spherechain::test {
namespace {

std::size_t draw_index(Case& c, std::size_t count) {
  const std::size_t indices[] = {c.random.up_to(count), count, 0, ~std::size_t{0}, std::size_t{1} << 32};
  return c.random.pick(indices);
}

template <typename Out>
void ask(Case& c, std::size_t count, sc_status (*get)(const sc_asset*, std::size_t, Out*)) {
  auto* out = c.arena.add<Out>(1);
  const std::size_t index = draw_index(c, count);
  c.arena.seal();
  const std::uint32_t way = c.random.below(8);
  const sc_status status = get(way == 0 ? nullptr : way == 1 ? c.c_closed : c.c_asset, index, way == 2 ? nullptr : out);
  const sc_status wanted = way == 0 || way == 2 ? SC_NULL_ARGUMENT
                           : way == 1           ? SC_NOT_OPEN
                           : index < count      ? SC_OK
                                                : SC_BAD_ARGUMENT;
  c.expect(status == wanted, "an accessor's status");
  c.expect(c.arena.kept_but({bytes_of(out, wanted == SC_OK ? 1 : 0)}), "an accessor writes what it must not");
  (status == SC_OK ? c.tally.ran : c.tally.refused) += 1;
}

void ask_info(Case& c) {
  auto* info = c.arena.add<sc_asset_info>(1);
  const std::uint32_t way = c.random.below(6);
  const std::size_t wrong[] = {0, sizeof *info - 1, sizeof *info + 8, ~std::size_t{0}};
  info->struct_size = way == 0 ? c.random.pick(wrong) : sizeof *info;
  c.arena.seal();
  const sc_status status = sc_asset_get_info(way == 1 ? nullptr : way == 2 ? c.c_closed : c.c_asset, info);
  const sc_status wanted[] = {SC_WRONG_ABI, SC_NULL_ARGUMENT, SC_NOT_OPEN, SC_OK, SC_OK, SC_OK};
  c.expect(status == wanted[way], "the status of sc_asset_get_info");
  c.expect(c.arena.kept_but({bytes_of(info, status == SC_OK ? 1 : 0)}), "sc_asset_get_info writes what it must not");
}

void ask_source(Case& c) {
  const std::size_t vertices = c.asset.info().source_vertex_count;
  if (vertices > 5000) {
    return;
  }
  const std::size_t stride = 12 + 4 * c.random.below(3);
  const std::size_t floats = vertices == 0 ? 0 : (vertices - 1) * stride / sizeof(float) + 3;
  auto* positions = c.arena.add<float>(floats);
  fill_figures(c, positions, floats);
  c.arena.seal();
  const sc_status status = sc_check_source(c.c_asset, positions, vertices, stride);
  c.expect(status == SC_WRONG_SOURCE || status == SC_OK, "the status of sc_check_source");
  c.expect(vertices == 0 || sc_check_source(c.c_asset, positions, vertices - 1, stride) == SC_TOO_FEW_VERTICES,
           "too few positions");
  c.expect(sc_check_source(c.c_asset, positions, vertices, 4 * c.random.below(3) + 2) == SC_BAD_STRIDE, "a stride");
  c.expect(sc_check_source(c.c_closed, positions, vertices, stride) == SC_NOT_OPEN, "a closed asset's source");
  const std::size_t parts = c.asset.source_parts().size;
  const std::size_t part = draw_index(c, parts);
  const sc_status wanted = part >= parts                                          ? SC_BAD_ARGUMENT
                           : vertices < c.asset.source_parts()[part].vertex_count ? SC_TOO_FEW_VERTICES
                                                                                  : SC_WRONG_SOURCE;
  const sc_status part_status = sc_check_source_part(c.c_asset, part, positions, vertices, stride);
  c.expect(part_status == wanted || part_status == SC_OK, "the status of sc_check_source_part");
  (void)sc_hash_positions(positions, vertices, stride);
  c.expect(c.arena.kept_but({}), "a check writes");
}

void ask_targets(Case& c) {
  const std::size_t capacity = c.random.below(9);
  auto* targets = c.arena.add<sc_target>(capacity);
  auto* found = c.arena.add<sc_target>(1);
  auto* name = c.arena.add<char>(6);
  for (std::size_t i = 0; i < 5; ++i) name[i] = static_cast<char>(c.random.below(256));
  name[5] = '\0';
  c.arena.seal();
  const std::size_t count = sc_supported_targets(c.random.one_in(4) ? nullptr : targets, capacity);
  c.expect(count == supported_targets().size, "the count of targets");
  const sc_status status = sc_find_target(name, found);
  c.expect(sc_target_name(draw_c_none(c, 7)) != nullptr && sc_target_lanes(draw_c_none(c, 7)) == 0, "no target");
  c.expect(c.arena.kept_but({bytes_of(targets, std::min(capacity, count)), bytes_of(found, status == SC_OK ? 1 : 0)}),
           "the list of targets writes what it must not");
}

// One edit by each API, on filters of the same contents, must leave the same.
sc_status edit_both(Case& c, Filter& filter, sc_filter& c_filter) {
  const auto sphere = [&] { return static_cast<std::uint32_t>(draw_index(c, c.n)); };
  const std::uint32_t a = sphere(), b = sphere();
  const std::size_t region = draw_index(c, c.asset.region_count()), other = draw_index(c, c.asset.region_count());
  const std::size_t hops = draw_index(c, 3);
  const bool on = c.random.one_in(2);
  float padding = 0;
  fill_figures(c, &padding, 1);
  const Asset& asset = c.asset;
  Status status{};
  sc_status c_status{};
  switch (c.random.below(6)) {
    case 0:
      status = ignore_pair(asset, filter, a, b, on);
      c_status = sc_ignore_pair(c.c_asset, &c_filter, a, b, on ? -3 : 0);
      break;
    case 1:
      status = ignore_regions(asset, filter, region, other, on);
      c_status = sc_ignore_regions(c.c_asset, &c_filter, region, other, on ? 1 : 0);
      break;
    case 2:
      status = ignore_hops(asset, filter, hops, on);
      c_status = sc_ignore_hops(c.c_asset, &c_filter, hops, on ? 1 : 0);
      break;
    case 3:
      status = disable_sphere(asset, filter, a, on);
      c_status = sc_disable_sphere(c.c_asset, &c_filter, a, on ? 1 : 0);
      break;
    case 4:
      status = pad_sphere(asset, filter, a, padding);
      c_status = sc_pad_sphere(c.c_asset, &c_filter, a, padding);
      break;
    default:
      status = c.random.one_in(4) ? reset_filter(asset, filter) : check_filter(asset, filter);
      c_status = status == Status::kOk ? sc_check_filter(c.c_asset, &c_filter) : SC_NULL_ARGUMENT;
      if (status == Status::kOk) std::memcpy(c_filter.ignored, filter.ignored.data, 8 * filter.ignored.size);
      if (status == Status::kOk && filter.disabled.size > 0)
        std::memcpy(c_filter.disabled, filter.disabled.data, 8 * filter.disabled.size);
      if (status == Status::kOk && filter.padding.size > 0)
        std::memcpy(c_filter.padding, filter.padding.data, 4 * filter.padding.size);
      return status == Status::kOk ? c_status : static_cast<sc_status>(status);
  }
  c.expect(static_cast<sc_status>(status) == c_status, "an edit's status");
  return c_status;
}

template <typename T>
bool same(const Span<T>& l, const T* r) {
  return l.size == 0 || std::memcmp(l.data, r, l.size * sizeof(T)) == 0;
}

}  // namespace

void fuzz_open(Case& c) {
  if (!draw_asset(c)) {
    ++c.tally.refused;
  }
  // Once more, with what else may be wrong.
  auto* data = c.arena.add<std::uint64_t>(8);
  const std::size_t size = c.random.below(65), message_size = c.random.below(200), memory_size = sc_asset_size();
  auto* memory = c.arena.add<std::uint64_t>(memory_size / 8 + 1);
  auto* message = c.arena.add<char>(message_size);
  const sc_asset* asset = c.c_asset;
  const std::uint32_t way = c.random.below(6);
  c.arena.seal();
  const sc_status status =
      sc_asset_open(way == 0 ? SC_ABI_VERSION + c.random.below(9) + 1 : SC_ABI_VERSION,
                    way == 1   ? nullptr
                    : way == 2 ? static_cast<void*>(reinterpret_cast<char*>(memory) + 1)
                               : memory,
                    way == 3 ? c.random.up_to(memory_size - 1) : memory_size, way == 4 ? nullptr : data, size,
                    way == 5 ? nullptr : &asset, message, message_size);
  c.expect(status != SC_OK && (way == 5 || asset == nullptr), "hostile bytes opened");
  c.expect(c.arena.kept_but({bytes_of(message, message_size), {memory, memory_size}}),
           "sc_asset_open writes what it must not");
  c.expect(message_size == 0 || std::memchr(message, 0, message_size) != nullptr, "a message without its end");
  ++c.tally.ran;
}

void fuzz_accessors(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  switch (c.random.below(8)) {
    case 0:
      return ask(c, c.asset.region_count(), sc_asset_region);
    case 1:
      return ask(c, c.asset.chain_count(), sc_asset_chain);
    case 2:
      return ask(c, c.asset.joint_count(), sc_asset_joint);
    case 3:
      return ask(c, c.asset.bone_count(), sc_asset_bone);
    case 4:
      return ask_info(c);
    case 5:
      return ask_source(c);
    case 6:
      return ask_targets(c);
    default: {
      const std::size_t index = draw_index(c, c.asset.morph_count());
      c.expect((sc_asset_morph_name(c.c_asset, index) != nullptr) == (index < c.asset.morph_count()), "a morph's name");
      c.expect(sc_asset_morph_name(c.c_closed, 0) == nullptr, "a closed asset's morph");
      c.expect(sc_status_string(draw_c_none(c, 22)) != nullptr, "no status");
      std::size_t count = 1;
      c.expect(sc_asset_near_pairs(c.c_asset, draw_c_none(c, 2), &count) == nullptr && count == 0, "no such radius");
    }
  }
}

void fuzz_filter(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  Filter filter = draw_filter(c);
  Filter second = filter;
  const auto copy = [&](auto& span) {
    auto* data = c.arena.add<std::remove_pointer_t<decltype(span.data)>>(span.size);
    std::copy(span.begin(), span.end(), data);
    span.data = data;
  };
  copy(second.ignored);
  copy(second.disabled);
  copy(second.padding);
  Spoiled spoiled;
  if (c.random.one_in(3)) {
    spoil_filter(c, filter, spoiled);
    second = spoiled.count > 0 ? filter : second;
  }
  sc_filter c_filter = to_c(second);
  c.arena.seal();
  for (int edit = 0; edit < 8; ++edit) {
    const sc_status status = edit_both(c, filter, c_filter);
    c.expect(spoiled.count == 0 || status == static_cast<sc_status>(spoiled.status), "a spoiled filter is edited");
    (status == SC_OK ? c.tally.ran : c.tally.refused) += 1;
  }
  if (spoiled.count > 0) {
    c.expect(c.arena.kept_but({}), "a spoiled filter is written");
    return;
  }
  c.expect(same(filter.ignored, second.ignored.data) && same(filter.disabled, second.disabled.data) &&
               same(filter.padding, second.padding.data),
           "the C API edits something else");
  c.expect(
      c.arena.kept_but(
          {bytes_of(filter.ignored.data, filter.ignored.size), bytes_of(filter.disabled.data, filter.disabled.size),
           bytes_of(filter.padding.data, filter.padding.size), bytes_of(second.ignored.data, filter.ignored.size),
           bytes_of(second.disabled.data, filter.disabled.size), bytes_of(second.padding.data, filter.padding.size)}),
      "an edit writes past the filter");
}

}  // namespace spherechain::test
