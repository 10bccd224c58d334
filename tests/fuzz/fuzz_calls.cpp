// SPDX-License-Identifier: MIT
// Opening, what an asset is asked, edits of filters, tables, and binding.
#include <algorithm>
#include <cstring>

#include "fuzz_case.h"

namespace spherechain::test {
namespace {

std::size_t draw_index(Case& c, std::size_t count) {
  const std::size_t indices[] = {c.random.up_to(count), count, 0, ~std::size_t{0}, power_of_two(32)};
  return c.random.pick(indices);
}

void ask_source(Case& c) {
  const std::size_t vertices = c.view().vertex_count(), buffers = c.view().source_buffers().size;
  if (vertices > kMaxVertices) {
    return;
  }
  const std::size_t stride = 12 + 4 * c.random.below(3);
  const std::size_t floats = vertices == 0 ? 0 : (vertices - 1) * stride / sizeof(float) + 3;
  float* const positions = c.arena.add<float>(floats);
  fill_figures(c, positions, floats);
  c.arena.seal();
  const auto is = [&](std::size_t buffer, std::size_t count, sc_code wanted) {
    const Status status = sc_check_source(&c.asset, buffer, positions, count, stride);
    c.expect(status == wanted || (wanted == SC_WRONG_SOURCE && status == SC_OK), "the status of sc_check_source");
  };
  const std::size_t buffer = draw_index(c, buffers);
  is(SC_WHOLE_SOURCE, vertices, SC_WRONG_SOURCE);
  if (vertices > 0) is(SC_WHOLE_SOURCE, vertices - 1, SC_TOO_SMALL);
  if (buffer != SC_WHOLE_SOURCE) {
    const bool fits = buffer < buffers && c.view().source_buffers()[buffer].vertex_count <= vertices;
    is(buffer, vertices, buffer >= buffers ? SC_BAD_VALUE : fits ? SC_WRONG_SOURCE : SC_TOO_SMALL);
  }
  c.expect(c.arena.kept_but({}), "a check writes");
}

// One edit, and what it must answer.
Status edit(Case& c, std::uint64_t* ignored, sc_code& wanted) {
  const std::size_t parts = c.view().part_count();
  const std::size_t part = draw_index(c, parts), other = draw_index(c, parts);
  const int on = c.random.one_in(2) ? 0 : -3;
  wanted = part < parts && other < parts ? SC_OK : SC_BAD_VALUE;
  return sc_ignore_parts(&c.asset, ignored, part, other, on);
}

}  // namespace

void fuzz_open(Case& c) {
  if (!draw_asset(c)) {
    ++c.tally.refused;
  }
  // Once more, with what else may be wrong.
  auto* const data = c.arena.add<std::uint64_t>(8);
  auto* const asset = c.arena.add<Asset>(1);
  const std::size_t size = c.random.below(65), message_size = c.random.below(200);
  char* const message = c.arena.add<char>(message_size);
  const std::uint32_t way = c.random.below(5);
  c.arena.seal();
  const Status status =
      sc_asset_open(way == 0 ? nullptr : asset, way == 1 ? SC_ABI_VERSION + 1 + c.random.below(9) : SC_ABI_VERSION,
                    way == 2   ? nullptr
                    : way == 3 ? static_cast<void*>(reinterpret_cast<char*>(data) + 1)
                               : data,
                    size, message, message_size);
  const sc_code wanted[] = {SC_NULL, SC_WRONG_ABI, SC_NULL, SC_MISALIGNED, SC_NOT_AN_ASSET};
  c.expect(status == wanted[way] || (way == 4 && status == SC_CORRUPT), "the status of sc_asset_open");
  c.expect(way < 2 || !is_open(asset), "hostile bytes are open");
  c.expect(c.arena.kept_but({bytes_of(message, message_size), bytes_of(asset, way < 2 ? 0 : 1)}),
           "sc_asset_open writes what it must not");
  c.expect(message_size == 0 || std::memchr(message, 0, message_size) != nullptr, "a message without its end");
  ++c.tally.ran;
}

void fuzz_accessors(Case& c) {
  if (!draw_asset(c)) {
    ++c.tally.refused;
    return;
  }
  ++c.tally.ran;
  const Asset* const asset = &c.asset;
  const AssetInfo info = sc_asset_get_info(asset);
  const std::size_t i = draw_index(c, c.random.one_in(2) ? info.bone_count : info.sphere_count);
  c.expect((sc_asset_bone(asset, i).name != nullptr) == (i < info.bone_count), "a bone's name");
  c.expect((sc_asset_part(asset, i).name != nullptr) == (i < info.part_count), "a part's name");
  c.expect((sc_asset_morph_name(asset, i) != nullptr) == (i < info.morph_count), "a morph's name");
  c.expect((sc_asset_region_name(asset, i) != nullptr) == (i < info.region_count), "a region's name");
  c.expect((sc_asset_sphere(asset, i).radius > 0) == (i < info.sphere_count), "a sphere's radius");
  if (i >= info.source_buffer_count) c.expect(sc_asset_source_buffer(asset, i).vertex_count == 0, "no buffer");
  c.expect(sc_code_text(draw_none<sc_code>(c, 22)) != nullptr && sc_field_name(draw_none<sc_field>(c, 32)) != nullptr &&
               sc_target_name(draw_none<Target>(c, 8)) != nullptr,
           "text of what does not exist");
  for (const Asset* none : {static_cast<const Asset*>(nullptr), static_cast<const Asset*>(&c.closed)}) {
    c.expect(!is_open(none) && sc_pair_words(none) + detect_table_words(none) + skin_table_words(none) +
                                       skin_scratch_words(none) + sc_crowd_scratch_words(none, 3) ==
                                   0,
             "sizes of an asset that is not open");
  }
  ask_source(c);
}

void fuzz_filter(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  const Filter filter = draw_filter(c);
  auto* words = const_cast<std::uint64_t*>(filter.ignored);
  if (c.random.one_in(3)) {
    if (c.random.one_in(2)) {
      words = nullptr;
      c.spoil(SC_NULL, SC_FIELD_IGNORED_PAIRS);
    } else {
      put_askew(c, words);
      c.spoil(SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS);
    }
  }
  c.arena.seal();
  for (int i = 0; i < 8; ++i) {
    sc_code wanted = SC_OK;
    const Status status = edit(c, words, wanted);
    c.expect(c.spoiled > 0 ? status == c.wanted : status == wanted, "the status of an edit");
    c.expect(status == SC_OK || status.field != SC_FIELD_NONE, "an edit's status without its field");
    (status == SC_OK ? c.tally.ran : c.tally.refused) += 1;
  }
  const std::vector<Bytes> own = {bytes_of(filter.ignored, filter.ignored_words)};
  c.expect(c.arena.kept_but(c.spoiled > 0 ? std::vector<Bytes>() : own), "an edit writes past the ignored pairs");
}

void fuzz_prepare(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  const bool is_skin = c.random.one_in(2);
  const std::size_t needed = is_skin ? skin_table_words(&c.asset) : detect_table_words(&c.asset);
  if (needed > (std::size_t{1} << 18)) {
    return;
  }
  const sc_field field = is_skin ? SC_FIELD_SKIN_TABLE : SC_FIELD_TABLE;
  const Asset* asset = &c.asset;
  std::size_t count = needed + c.random.below(2);
  auto* words = c.arena.add<std::uint64_t>(count);
  Filter filter;
  const Filter* used = nullptr;
  if (!is_skin && c.random.one_in(2)) filter = draw_filter(c), used = &filter;
  auto radius = static_cast<Radius>(c.random.below(2));
  if (needed == 0) {
    c.spoil(SC_NOT_IN_ASSET, SC_FIELD_ASSET);
  } else {
    Ways ways = {[&] { words = nullptr, c.spoil(SC_NULL, field); },
                 [&] { put_askew(c, words), c.spoil(SC_MISALIGNED, field); },
                 [&] { count = c.random.up_to(needed - 1), c.spoil(SC_TOO_SMALL, field); }};
    add_asset_ways(c, asset, ways);
    if (!is_skin) {
      ways.emplace_back([&] { radius = draw_none<Radius>(c, 2), c.spoil(SC_BAD_VALUE, SC_FIELD_RADIUS); });
    }
    if (used != nullptr) ways.emplace_back([&] { spoil_filter(c, filter); });
    spoil_some(c, ways);
  }
  Call call;
  call.run = [&] {
    return is_skin ? prepare_skin(asset, words, count) : prepare_detect(asset, radius, used, words, count);
  };
  call.outputs = [&] { return std::vector<Bytes>{bytes_of(words, needed)}; };
  call.writes_all = false;  // gaps of alignment
  run_twice(c, call);
}

void fuzz_binding(Case& c) {
  if (!draw_asset(c) || skin_table_words(&c.asset) > (std::size_t{1} << 18)) {
    return;
  }
  const std::vector<Bone> joints = draw_engine_joints(c);
  char message[160] = "";
  Pose pose;
  draw_bones(c, pose);
  const MatrixLayout layout = c.random.one_in(8) ? draw_none<MatrixLayout>(c, 5) : SC_ROWS_3X4;
  std::vector<std::uint32_t> joint_of_bone(c.view().bone_count(), 77);
  std::vector<float> gathered(12 * c.view().bone_count());
  c.arena.seal();
  const Status bound = sc_bind_joints(&c.asset, joints.data(), joints.size(), layout, joint_of_bone.data(),
                                      joint_of_bone.size(), message, sizeof message);
  c.expect(bound == SC_OK || (bound.field != SC_FIELD_NONE && message[0] != '\0'),
           "a refusal to bind without a reason");
  if (bound == SC_OK) {
    for (const std::uint32_t joint : joint_of_bone) {
      c.expect(joint == SC_NO_JOINT || joint < joints.size(), "a joint that does not exist");
    }
    const Status status = sc_gather_bones(&c.asset, joint_of_bone.data(), &pose, gathered.data());
    c.expect(status == SC_OK, "matrices are not gathered");
    message[0] = '\0';
    const Status rest = check_rest_pose(c.asset, pose, message, sizeof message);
    c.expect(rest == SC_OK || message[0] != '\0', "a refusal of the rest pose without a reason");
  }
  (bound == SC_OK ? c.tally.ran : c.tally.refused) += 1;
  c.expect(c.arena.kept_but({}), "binding writes into what it reads");
}

}  // namespace spherechain::test
