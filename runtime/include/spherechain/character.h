/* SPDX-License-Identifier: MIT */
/* The short way for a game: an asset, its binding and its working memory in one object. It allocates when it is made,
 * never in a frame. One object serves any number of characters of one asset, one at a time: make one a thread. */
#pragma once

#include "spherechain/penetrations.h"

typedef struct sc_character sc_character;

#if defined(__cplusplus)
extern "C" {
#endif

/* Copies the asset's bytes, opens them and binds the engine's joints (sc_bind_joints()). With `joints` null, palettes
 * come in the asset's own order. On failure *character is null and `message` says why; a status of sc_asset_open() or
 * sc_bind_joints(), or SC_NO_MEMORY. Pass SC_ABI_VERSION for `abi`. */
SPHERECHAIN_API sc_status sc_character_create(uint32_t abi, const void* data, size_t size, const sc_bone* joints,
                                              size_t joint_count, sc_matrix_layout inverse_bind_layout,
                                              sc_character** character, char* message, size_t message_size) SC_NOEXCEPT;
SPHERECHAIN_API void sc_character_destroy(sc_character* character) SC_NOEXCEPT; /* null is fine */

SPHERECHAIN_API const sc_asset* sc_character_asset(const sc_character* character) SC_NOEXCEPT;

/* sc_check_rest_pose() of a palette in the engine's order. */
SPHERECHAIN_API sc_status sc_character_check_rest(sc_character* character, const sc_pose* palette, char* message,
                                                  size_t message_size) SC_NOEXCEPT;

/* The pairs of body parts whose skins intersect in this pose: *contacts points to *count of them, sorted by (part_a,
 * part_b), valid until the next call. `palette` has the bones in the engine's joint order; it may have vertices too. */
SPHERECHAIN_API sc_status sc_character_contacts(sc_character* character, const sc_pose* palette,
                                                const sc_part_contact** contacts, size_t* count) SC_NOEXCEPT;

/* The same with depth, direction and class, measured quickly (sc_penetration_job.quick): *penetrations points to *count of
 * them, sorted by (part_a, part_b), valid until the next call. SC_OVERFLOW, with none: more pairs of triangles intersect
 * than the character has room for (the larger of 4,096 and half of its triangles); ask sc_character_contacts(). */
SPHERECHAIN_API sc_status sc_character_penetrations(sc_character* character, const sc_pose* palette,
                                                    const sc_penetration** penetrations, size_t* count) SC_NOEXCEPT;

#if defined(__cplusplus)
}

namespace spherechain {

/* Owns an sc_character. Moves, does not copy. */
class Character {
 public:
  Character() = default;
  Character(Character&& other) noexcept : handle_(other.handle_) { other.handle_ = nullptr; }
  Character& operator=(Character&& other) noexcept {
    sc_character* const own = handle_;
    handle_ = other.handle_;
    other.handle_ = own;
    return *this;
  }
  ~Character() { sc_character_destroy(handle_); }

  Status create(const void* data, size_t size, const Bone* joints, size_t joint_count, MatrixLayout inverse_bind_layout,
                char* message, size_t message_size) noexcept {
    sc_character_destroy(handle_);
    return sc_character_create(SC_ABI_VERSION, data, size, joints, joint_count, inverse_bind_layout, &handle_, message,
                               message_size);
  }
  /* Those below need a character that was created. */
  const Asset& asset() const noexcept { return *sc_character_asset(handle_); }
  Status check_rest(const Pose& palette, char* message, size_t message_size) noexcept {
    return sc_character_check_rest(handle_, &palette, message, message_size);
  }
  Status contacts(const Pose& palette, const PartContact*& contacts, size_t& count) noexcept {
    return sc_character_contacts(handle_, &palette, &contacts, &count);
  }
  Status penetrations(const Pose& palette, const Penetration*& penetrations, size_t& count) noexcept {
    return sc_character_penetrations(handle_, &palette, &penetrations, &count);
  }
  const char* part_name(size_t part) const noexcept { return sc_asset_part(&asset(), part).name; }

 private:
  sc_character* handle_ = nullptr;
};

}  // namespace spherechain
#endif
