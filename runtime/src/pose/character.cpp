// SPDX-License-Identifier: MIT
// The short way: an object that owns the asset's bytes, its binding, its tables and its outputs.
#include "spherechain/character.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

#include "asset/message.h"
#include "asset/status.h"
#include "pose/pose.h"

struct sc_character {
  sc_asset asset;
  void* blocks[9];  // what the pointers below and the asset point into
  std::size_t block_count;
  std::uint32_t* joint_of_bone;  // null: palettes come in the asset's order
  float* bones;
  std::uint64_t *skin_table, *scratch;
  sc_part_contact* contacts;
  std::size_t contact_capacity;
  sc_triangle_contact* triangles;
  std::size_t triangle_capacity;
  std::uint64_t* measure_scratch;
  sc_penetration* penetrations;  // as many as contacts
};

namespace spherechain {
namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kTrianglesMin = 4096;  // pairs that a frame has room for, at least; else half of the triangles

// Room for `count` entries, from a cache line on. False where there is no memory.
template <typename T>
bool allocate(sc_character& c, T*& out, std::size_t count) {
  void* const block = std::malloc(count * sizeof(T) + kLine);
  c.blocks[c.block_count++] = block;
  out = reinterpret_cast<T*>((reinterpret_cast<std::uintptr_t>(block) + kLine - 1) / kLine * kLine);
  return block != nullptr;
}

Status fill(sc_character& c, std::uint32_t abi, const void* data, std::size_t size, const sc_bone* joints,
            std::size_t joint_count, sc_matrix_layout layout, char* message, std::size_t message_size) {
  const Status no_memory = refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  unsigned char* bytes = nullptr;
  if (!allocate(c, bytes, size)) {
    return no_memory;
  }
  std::memcpy(bytes, data, size);
  Status status = sc_asset_open(&c.asset, abi, bytes, size, message, message_size);
  if (status != SC_OK) {
    return status;
  }
  const AssetView& view = view_of(c.asset);
  const std::size_t table_words = sc_skin_table_words(&c.asset);
  if (table_words == 0) {
    Message(message, message_size).wrong("asset: it has no triangles, so there are no skin contacts");
    return refuse(SC_NOT_IN_ASSET, SC_FIELD_ASSET);
  }
  const std::size_t bones = view.bone_count();
  c.contact_capacity = view.part_count() * (view.part_count() + 1) / 2;
  c.triangle_capacity = std::max(kTrianglesMin, view.skin().sizes.triangles / 2);
  if (!allocate(c, c.skin_table, table_words) || !allocate(c, c.scratch, sc_skin_scratch_words(&c.asset)) ||
      !allocate(c, c.contacts, c.contact_capacity) || !allocate(c, c.triangles, c.triangle_capacity) ||
      !allocate(c, c.measure_scratch, sc_penetration_scratch_words(&c.asset, c.triangle_capacity)) ||
      !allocate(c, c.penetrations, c.contact_capacity) ||
      (joints != nullptr && (!allocate(c, c.joint_of_bone, bones) || !allocate(c, c.bones, 12 * bones)))) {
    return no_memory;
  }
  if (joints != nullptr) {
    status = sc_bind_joints(&c.asset, joints, joint_count, layout, c.joint_of_bone, bones, message, message_size);
  }
  return status == SC_OK ? sc_prepare_skin(&c.asset, c.skin_table, table_words) : status;
}

// The palette's bones in the asset's order.
Status gather(sc_character& c, const sc_pose& palette, sc_pose& pose) {
  pose = palette;
  if (c.joint_of_bone == nullptr || palette.bones == nullptr) {
    return done();
  }
  const Status status = sc_gather_bones(&c.asset, c.joint_of_bone, &palette, c.bones);
  pose.bones = c.bones;
  pose.bone_count = view_of(c.asset).bone_count();
  pose.bone_layout = SC_ROWS_3X4;
  pose.bone_stride = 0;
  return status;
}

// Fills in and runs a job whose outputs are set, but for the parts.
Status find(sc_character& c, const sc_pose& palette, SkinContactJob& job) {
  const Status gathered = gather(c, palette, job.pose);
  if (gathered != SC_OK) {
    return gathered;
  }
  job.asset = &c.asset;
  job.skin_table = c.skin_table;
  job.scratch = c.scratch;
  job.scratch_words = sc_skin_scratch_words(&c.asset);
  job.parts = c.contacts;
  job.part_capacity = c.contact_capacity;
  return job.run();
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_character_create(uint32_t abi, const void* data, size_t size, const sc_bone* joints, size_t joint_count,
                              sc_matrix_layout inverse_bind_layout, sc_character** character, char* message,
                              size_t message_size) noexcept {
  Message sentence(message, message_size);
  if (character == nullptr || data == nullptr) {
    sentence.wrong("%s: null", character == nullptr ? "character" : "data");
    return refuse(SC_NULL, character == nullptr ? SC_FIELD_OUTPUT : SC_FIELD_DATA);
  }
  *character = nullptr;
  void* const memory = std::malloc(sizeof(sc_character));
  Status status = refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  if (memory != nullptr) {
    auto* const made = new (memory) sc_character{};
    status = fill(*made, abi, data, size, joints, joint_count, inverse_bind_layout, message, message_size);
    if (status == SC_OK) {
      *character = made;
      return status;
    }
    sc_character_destroy(made);
  }
  if (status == SC_NO_MEMORY) {
    sentence.wrong("out of memory");
  }
  return status;
}

void sc_character_destroy(sc_character* character) noexcept {
  if (character == nullptr) {
    return;
  }
  for (void* block : character->blocks) {
    std::free(block);
  }
  std::free(character);
}

const sc_asset* sc_character_asset(const sc_character* character) noexcept {
  return character == nullptr ? nullptr : &character->asset;
}

sc_status sc_character_check_rest(sc_character* character, const sc_pose* palette, char* message,
                                  size_t message_size) noexcept {
  if (character == nullptr || palette == nullptr) {
    return refuse(SC_NULL, character == nullptr ? SC_FIELD_NONE : SC_FIELD_BONES);
  }
  sc_pose pose{};
  const Status status = gather(*character, *palette, pose);
  return status == SC_OK ? sc_check_rest_pose(&character->asset, &pose, message, message_size) : status;
}

sc_status sc_character_contacts(sc_character* character, const sc_pose* palette, const sc_part_contact** contacts,
                                size_t* count) noexcept {
  if (character == nullptr || palette == nullptr || contacts == nullptr || count == nullptr) {
    return refuse(SC_NULL, palette == nullptr ? SC_FIELD_BONES : SC_FIELD_OUTPUT);
  }
  *contacts = character->contacts;
  *count = 0;
  SkinContactJob job;
  const Status status = find(*character, *palette, job);
  *count = status == SC_OK ? job.part_count : 0;
  return status;
}

sc_status sc_character_penetrations(sc_character* character, const sc_pose* palette,
                                    const sc_penetration** penetrations, size_t* count) noexcept {
  if (character == nullptr || palette == nullptr || penetrations == nullptr || count == nullptr) {
    return refuse(SC_NULL, palette == nullptr ? SC_FIELD_BONES : SC_FIELD_OUTPUT);
  }
  *penetrations = character->penetrations;
  *count = 0;
  SkinContactJob found;
  found.triangles = character->triangles;
  found.triangle_capacity = character->triangle_capacity;
  Status status = find(*character, *palette, found);
  if (status != SC_OK) {
    return status;
  }
  PenetrationJob job;
  job.asset = &character->asset;
  job.pose = found.pose;
  job.skin_table = character->skin_table;
  job.contacts = found.triangles;
  job.contact_count = found.triangle_count;
  job.quick = 1;
  job.scratch = character->measure_scratch;
  job.scratch_words = sc_penetration_scratch_words(&character->asset, character->triangle_capacity);
  job.penetrations = character->penetrations;
  job.penetration_capacity = character->contact_capacity;
  status = job.run();
  *count = status == SC_OK ? job.penetration_count : 0;
  return status;
}

}  // extern "C"
