// SPDX-License-Identifier: MIT
// A model: a copy of the asset's bytes, the tables that questions read, and which joint moves which bone.
#include "runtime/src/bodies/model.h"

#include <cstdlib>
#include <cstring>
#include <new>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/message.h"
#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/pose/pose.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_model_def, allocator);

namespace {

void* allocate_with_malloc(void*, std::size_t size, std::size_t alignment) {
  // The block's own address lies before what is handed out.
  auto* const block = static_cast<unsigned char*>(std::malloc(size + alignment + sizeof(void*)));
  if (block == nullptr) {
    return nullptr;
  }
  const auto first = reinterpret_cast<std::uintptr_t>(block) + sizeof(void*);
  void* const out = block + ((first + alignment - 1) / alignment * alignment - reinterpret_cast<std::uintptr_t>(block));
  std::memcpy(static_cast<unsigned char*>(out) - sizeof(void*), &block, sizeof block);
  return out;
}

void release_with_malloc(void*, void* memory, std::size_t, std::size_t) {
  void* block = nullptr;
  std::memcpy(&block, static_cast<unsigned char*>(memory) - sizeof(void*), sizeof block);
  std::free(block);
}

constexpr std::size_t words_of(std::size_t bytes) {
  return (bytes + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
}

// Tables of an open asset; of null words it only counts them.
std::size_t lay_out(sc_model& model, const sc_model_def& def, std::uint64_t* words) {
  WordMemory memory(words);
  memory.take(model.skin_table, skin_table_words(&model.asset));
  memory.take(model.detect_table, detect_table_words(&model.asset));
  if (def.joints != nullptr) {
    memory.take(model.joint_of_bone, view_of(model.asset).bone_count());
  }
  return memory.used();
}

Status fill(sc_model& model, const sc_model_def& def, char* message, std::size_t message_size) {
  Message sentence(message, message_size);
  const Status no_memory = refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  if (!model.bytes.allocate(model.allocator, words_of(def.size))) {
    sentence.wrong("out of memory");
    return no_memory;
  }
  std::memcpy(model.bytes.words, def.data, def.size);
  Status status = sc_asset_open(&model.asset, SC_ABI_VERSION, model.bytes.words, def.size, message, message_size);
  if (status != SC_OK) {
    return status;
  }
  if (!model.tables.allocate(model.allocator, lay_out(model, def, nullptr))) {
    sentence.wrong("out of memory");
    return no_memory;
  }
  lay_out(model, def, model.tables.words);
  if (def.joints != nullptr) {
    status = sc_bind_joints(&model.asset, def.joints, def.joint_count, def.inverse_bind_layout, model.joint_of_bone,
                            view_of(model.asset).bone_count(), message, message_size);
    if (status != SC_OK) {
      return status;
    }
  }
  if (has_skin(view_of(model.asset))) {
    status = prepare_skin(&model.asset, model.skin_table, skin_table_words(&model.asset));
  }
  return status != SC_OK ? status
                         : prepare_detect(&model.asset, SC_RADIUS_DETECT, nullptr, model.detect_table,
                                          detect_table_words(&model.asset));
}

}  // namespace

const sc_allocator& malloc_allocator() {
  static constexpr sc_allocator kMalloc{allocate_with_malloc, release_with_malloc, nullptr};
  return kMalloc;
}

Status choose_allocator(const sc_allocator* wanted, const sc_allocator& otherwise, sc_allocator& out) {
  out = wanted == nullptr ? otherwise : *wanted;
  return out.allocate == nullptr || out.release == nullptr ? refuse(SC_NULL, SC_FIELD_ALLOCATOR) : done();
}

bool Block::allocate(const sc_allocator& allocator, std::size_t wanted) {
  words =
      static_cast<std::uint64_t*>(allocator.allocate(allocator.user, wanted * sizeof(std::uint64_t), kBlockAlignment));
  count = words == nullptr ? 0 : wanted;
  return words != nullptr;
}

void Block::release(const sc_allocator& allocator) {
  if (words != nullptr) {
    allocator.release(allocator.user, words, count * sizeof(std::uint64_t), kBlockAlignment);
  }
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_create_model(uint32_t abi, const sc_model_def* def, sc_model** model, char* message,
                          size_t message_size) noexcept {
  Message sentence(message, message_size);
  if (model != nullptr) {
    *model = nullptr;
  }
  sc_model_def wanted{};
  Status known = check_abi(abi, sentence);
  if (known == SC_OK && def != nullptr) {
    known = read_struct(def, wanted);
    if (known != SC_OK) {
      sentence.wrong("struct_size: not that of an sc_model_def, or fields are set that this library does not have");
    }
  }
  if (known != SC_OK) {
    return known;
  }
  if (model == nullptr || wanted.data == nullptr) {
    sentence.wrong("%s: null", model == nullptr ? "model" : "data");
    return refuse(SC_NULL, model == nullptr ? SC_FIELD_OUTPUT : SC_FIELD_DATA);
  }
  sc_allocator allocator{};
  const Status complete = choose_allocator(wanted.allocator, malloc_allocator(), allocator);
  if (complete != SC_OK) {
    sentence.wrong("allocator: a function is null");
    return complete;
  }
  void* const memory = allocator.allocate(allocator.user, sizeof(sc_model), kBlockAlignment);
  if (memory == nullptr) {
    sentence.wrong("out of memory");
    return refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  }
  auto* const made = new (memory) sc_model{};
  made->allocator = allocator;
  const Status status = fill(*made, wanted, message, message_size);
  if (status == SC_OK) {
    *model = made;
  } else {
    sc_destroy_model(made);
  }
  return status;
}

void sc_destroy_model(sc_model* model) noexcept {
  if (model != nullptr) {
    const sc_allocator allocator = model->allocator;
    model->tables.release(allocator);
    model->bytes.release(allocator);
    allocator.release(allocator.user, model, sizeof(sc_model), kBlockAlignment);
  }
}

const sc_asset* sc_get_asset(const sc_model* model) noexcept { return model == nullptr ? nullptr : &model->asset; }

uint32_t sc_get_part_joint(const sc_model* model, uint32_t part) noexcept {
  if (model == nullptr || part >= view_of(model->asset).part_count()) {
    return SC_NO_JOINT;
  }
  const std::int32_t bone = view_of(model->asset).part(part).bone;
  return bone < 0                          ? SC_NO_JOINT
         : model->joint_of_bone == nullptr ? static_cast<std::uint32_t>(bone)
                                           : model->joint_of_bone[bone];
}

sc_triangle sc_get_triangle(const sc_model* model, uint32_t triangle) noexcept {
  Surface surface;
  if (model == nullptr || !has_skin(view_of(model->asset)) ||
      read_skin_table(view_of(model->asset), model->skin_table, surface) != SC_OK ||
      triangle >= surface.place_of_source.size || surface.place_of_source[triangle] == kNoPlace) {
    return {SC_NO_PART, SC_NO_PART, SC_NO_PART};
  }
  const std::uint32_t place = surface.place_of_source[triangle], sphere = surface.triangle_spheres[place];
  return {surface.parts[place], view_of(model->asset).spheres()[sphere].region, sphere};
}

sc_status sc_check_rest(const sc_model* model, const sc_pose* palette, char* message, size_t message_size) noexcept {
  if (model == nullptr || palette == nullptr) {
    Message(message, message_size).wrong("%s: null", model == nullptr ? "model" : "palette");
    return refuse(SC_NULL, model == nullptr ? SC_FIELD_ASSET : SC_FIELD_BONES);
  }
  if (model->joint_of_bone == nullptr) {
    return check_rest_pose(model->asset, *palette, message, message_size);
  }
  Block bones;
  const std::size_t count = view_of(model->asset).bone_count();
  if (!bones.allocate(model->allocator, words_of(12 * count * sizeof(float)))) {
    Message(message, message_size).wrong("out of memory");
    return refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  }
  auto* const gathered = reinterpret_cast<float*>(bones.words);
  Status status = sc_gather_bones(&model->asset, model->joint_of_bone, palette, gathered);
  if (status == SC_OK) {
    sc_pose pose{};
    pose.bones = gathered;
    pose.bone_count = count;
    pose.bone_layout = SC_ROWS_3X4;
    status = check_rest_pose(model->asset, pose, message, message_size);
  } else {
    Message(message, message_size).wrong("%s: %s", sc_field_name(status.field), sc_code_text(status.code));
  }
  bones.release(model->allocator);
  return status;
}

}  // extern "C"
