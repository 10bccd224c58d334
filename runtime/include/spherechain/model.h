/* SPDX-License-Identifier: MIT */
/* A baked character, its tables and the engine's joints: made once, shared by all of its bodies and by threads. */
#pragma once

#include "spherechain/pose.h"

/* Memory for models and bodies. It is called when they are made and destroyed, never in a frame, on the thread that
 * makes or destroys them. Alignment is a power of two, 64 at most. */
typedef struct sc_allocator {
  void* (*allocate)(void* user, size_t size, size_t alignment)SC_ZERO; /* null on failure */
  void (*release)(void* user, void* memory, size_t size, size_t alignment) SC_ZERO;
  void* user SC_ZERO;
} sc_allocator;

/* A model never changes. Threads may share it. It must outlive its bodies. */
typedef struct sc_model sc_model;

typedef struct sc_model_def {
  uint32_t struct_size SC_SIZE_OF(sc_model_def);
  sc_matrix_layout inverse_bind_layout SC_ZERO; /* of the joints that have an inverse bind matrix */
  const void* data SC_ZERO;                     /* the bytes of a .sphc file, copied */
  size_t size SC_ZERO;
  /* The engine's joints, in the order of its palettes; null: palettes come in the asset's own order of bones. */
  const sc_bone* joints SC_ZERO;
  size_t joint_count SC_ZERO;
  const sc_allocator* allocator SC_ZERO; /* copied; null: malloc */
} sc_model_def;

/* Where a triangle of the source belongs. */
typedef struct sc_triangle {
  uint32_t part, region, sphere; /* SC_NO_PART, each: the triangle was left out of the skin, as degenerate ones are */
} sc_triangle;

#define SC_NO_PART 0xFFFFFFFFu

#if defined(__cplusplus)
extern "C" {
#endif

/* Pass SC_ABI_VERSION for `abi`. On failure *model is null and `message`, where it is not null, says what to do: a
 * status of sc_asset_open() or sc_bind_joints(), SC_NULL, SC_BAD_VALUE or SC_NO_MEMORY. */
SPHERECHAIN_API sc_status sc_create_model(uint32_t abi, const sc_model_def* def, sc_model** model, char* message,
                                          size_t message_size) SC_NOEXCEPT;
SPHERECHAIN_API void sc_destroy_model(sc_model* model) SC_NOEXCEPT; /* null is fine */

SPHERECHAIN_API const sc_asset* sc_get_asset(const sc_model* model) SC_NOEXCEPT;

/* The engine's joint that moves a body part; SC_NO_JOINT where none does. */
SPHERECHAIN_API uint32_t sc_get_part_joint(const sc_model* model, uint32_t part) SC_NOEXCEPT;

/* `triangle` is the source's number. */
SPHERECHAIN_API sc_triangle sc_get_triangle(const sc_model* model, uint32_t triangle) SC_NOEXCEPT;

/* A self-check for the first run: `palette` is what the engine gives while the character stands in its bind pose. There
 * every bone's matrix is the same, the model's own. SC_OTHER_BIND: the message names the first bone whose matrix moves
 * the character otherwise, by more than a thousandth of its height. It finds wrong strides, matrices that lack the
 * inverse bind matrix, and other rest poses; off the origin also the wrong one of the two layouts of 4 by 4. Rows in
 * place of columns of 3 by 4, and wrong orders, do not show in this pose: bind by name. */
SPHERECHAIN_API sc_status sc_check_rest(const sc_model* model, const sc_pose* palette, char* message,
                                        size_t message_size) SC_NOEXCEPT;

#if defined(__cplusplus)
}

namespace spherechain {

using Allocator = sc_allocator;
using ModelDef = sc_model_def;
using TriangleOwner = sc_triangle;

/* Owns an sc_model. It moves, and does not copy. One that was not made converts to false, and message() says why. */
class Model {
 public:
  Model() = default;
  explicit Model(const ModelDef& def) noexcept {
    status_ = sc_create_model(SC_ABI_VERSION, &def, &handle_, message_, sizeof message_);
  }
  Model(const void* data, size_t size, const Bone* joints, size_t joint_count, MatrixLayout layout) noexcept
      : Model(make_def(data, size, joints, joint_count, layout)) {}
  Model(Model&& other) noexcept { *this = static_cast<Model&&>(other); }
  Model& operator=(Model&& other) noexcept {
    sc_model* const own = handle_;
    handle_ = other.handle_;
    other.handle_ = own;
    status_ = other.status_;
    for (size_t i = 0; i < sizeof message_; ++i) message_[i] = other.message_[i];
    return *this;
  }
  ~Model() { sc_destroy_model(handle_); }

  explicit operator bool() const noexcept { return handle_ != nullptr; }
  Status status() const noexcept { return status_; }
  const char* message() const noexcept { return message_; }

  /* The rest needs a model that was made. */
  const sc_model* handle() const noexcept { return handle_; }
  const Asset& asset() const noexcept { return *sc_get_asset(handle_); }
  Status check_rest(const Pose& palette) noexcept {
    return sc_check_rest(handle_, &palette, message_, sizeof message_);
  }
  AssetInfo info() const noexcept { return sc_asset_get_info(&asset()); }
  uint32_t part_count() const noexcept { return static_cast<uint32_t>(info().part_count); }
  BodyPart part(uint32_t part) const noexcept { return sc_asset_part(&asset(), part); }
  const char* part_name(uint32_t part) const noexcept { return sc_asset_part(&asset(), part).name; }
  uint32_t part_joint(uint32_t part) const noexcept { return sc_get_part_joint(handle_, part); }
  TriangleOwner triangle(uint32_t number) const noexcept { return sc_get_triangle(handle_, number); }
  /* A length in the units of a pose that has the asset's scale. */
  float millimetres(float length) const noexcept { return 1000 * length * info().metres_per_unit; }

 private:
  static ModelDef make_def(const void* data, size_t size, const Bone* joints, size_t joint_count,
                           MatrixLayout layout) noexcept {
    ModelDef def;
    def.inverse_bind_layout = layout;
    def.data = data;
    def.size = size;
    def.joints = joints;
    def.joint_count = joint_count;
    return def;
  }

  sc_model* handle_ = nullptr;
  Status status_{};
  char message_[256] = {};
};

}  // namespace spherechain
#endif
