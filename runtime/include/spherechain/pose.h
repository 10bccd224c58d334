/* SPDX-License-Identifier: MIT */
/* How a character stands: bone matrices, deformed vertices, or both. */
#pragma once

#include "spherechain/asset.h"

/* How a matrix that moves points p to M (p; 1) lies in memory. Rows and columns are those of M, its translation the
 * fourth column. Libraries that write p M (DirectXMath, Unreal) store the transpose by rows: that is SC_COLUMNS_4X4.
 * There is no default. */
SC_ENUM(sc_matrix_layout){
    SC_LAYOUT_UNSET = 0, /* refused */
    SC_ROWS_3X4 = 1,     /* 12 floats: three rows of four */
    SC_ROWS_4X4 = 2,     /* 16 floats: four rows, the last 0 0 0 1 and not read */
    SC_COLUMNS_4X4 = 3,  /* 16 floats: four columns: glTF, OpenGL, glm, Unity */
    SC_COLUMNS_3X4 = 4,  /* 12 floats: four columns of three */
};

/* Bones: for each bone of the asset, in its order, the skinning matrix: the world matrix of the bone's joint times its
 * inverse bind matrix. It is the palette that a skinning shader gets. "World" may be any space; results come in it.
 * Vertices: the source's deformed vertices in the source's order, in any space with the asset's scale.
 * With both, bones bound the search, and vertices say where the skin is. */
typedef struct sc_pose {
  const float* bones SC_ZERO;           /* null: none */
  size_t bone_count SC_ZERO;            /* at least the asset's */
  sc_matrix_layout bone_layout SC_ZERO; /* required with bones */
  size_t bone_stride SC_ZERO;           /* bytes from one matrix to the next; 0: side by side */
  const float* morph_weights SC_ZERO;   /* null: nothing morphs. Goes with bones */
  size_t morph_weight_count SC_ZERO;    /* at least the asset's morph targets */
  const float* vertices SC_ZERO;        /* null: none; x, y, z */
  size_t vertex_count SC_ZERO;          /* at least the source's */
  size_t vertex_stride SC_ZERO;         /* bytes from one vertex to the next; 0: 12 */
} sc_pose;

/* Where a joint is in its parent's space, or a character in the world: its own p is at
 * translation + rotation (scale p) there. */
typedef struct sc_transform {
  sc_vec3 translation;
  float rotation[4]; /* a quaternion: x, y, z, w; of about unit length */
  sc_vec3 scale;     /* along its own axes; negative mirrors. There is no default: {1, 1, 1} keeps the size */
} sc_transform;

#if defined(__cplusplus)
extern "C" {
#endif

/* Maps an engine's joints to the asset's bones, once: joint_of_bone[b] becomes the joint that moves bone b, or
 * SC_NO_JOINT for the bone without a name. Joints are matched by name; of several of one name, the one whose inverse
 * bind matrix is the asset's. Pass inverse bind matrices where the engine has them (null: not compared): a matrix that
 * differs by more than a thousandth, relative to its size, is another rest pose, unit or axis convention.
 * SC_NO_SUCH_BONE and SC_OTHER_BIND: the message names the bone, and what differs. On failure joint_of_bone holds
 * nothing of use. */
#define SC_NO_JOINT 0xFFFFFFFFu
SPHERECHAIN_API sc_status sc_bind_joints(const sc_asset* asset, const sc_bone* joints, size_t joint_count,
                                         sc_matrix_layout inverse_bind_layout, uint32_t* joint_of_bone, size_t capacity,
                                         char* message, size_t message_size) SC_NOEXCEPT;

/* Writes the matrices of a palette in the engine's order into `bones`, in the asset's order, as SC_ROWS_3X4: 12 floats
 * a bone. The bone without a name gets the identity. */
SPHERECHAIN_API sc_status sc_gather_bones(const sc_asset* asset, const uint32_t* joint_of_bone, const sc_pose* palette,
                                          float* bones) SC_NOEXCEPT;

/* Multiplies matrices in SC_ROWS_3X4, as sc_gather_bones() writes them, by a transform: from a character's own space to
 * the world, where others are. SC_BAD_VALUE: it is not finite, or its quaternion is of length zero. */
SPHERECHAIN_API sc_status sc_place_bones(const sc_transform* transform, float* bones, size_t bone_count) SC_NOEXCEPT;

#if defined(__cplusplus)
}
namespace spherechain {
using MatrixLayout = sc_matrix_layout;
using Pose = sc_pose;
using Transform = sc_transform;
}  // namespace spherechain
#endif
