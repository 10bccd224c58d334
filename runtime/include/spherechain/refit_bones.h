// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// How a matrix that moves points p to M (p; 1) lies in memory. "Row" and "column" are those of that M, its translation
// the fourth column. Libraries that write p M instead (DirectXMath, Unreal) store the transpose by rows, the
// translation last: that is kColumnMajor4x4.
enum class MatrixLayout : std::uint8_t {
  kRowMajor3x4 = 0,  // 12 floats: three rows of four
  kRowMajor4x4 = 1,  // 16 floats: four rows of four, the last 0 0 0 1 and not read
  kColumnMajor4x4 =
      2,  // 16 floats: four columns of four, the last of each 0 0 0 1 and not read: glTF, OpenGL, glm, Unity
  kColumnMajor3x4 = 3,  // 12 floats: four columns of three
};

// Bytes of one matrix; 0 for a layout that does not exist.
constexpr std::size_t size_of(MatrixLayout layout) noexcept {
  return layout == MatrixLayout::kRowMajor3x4 || layout == MatrixLayout::kColumnMajor3x4   ? 48
         : layout == MatrixLayout::kRowMajor4x4 || layout == MatrixLayout::kColumnMajor4x4 ? 64
                                                                                           : 0;
}

struct BoneMatrices {
  const float* data = nullptr;
  std::size_t count = 0;
  MatrixLayout layout = MatrixLayout::kRowMajor3x4;
  std::size_t stride = 48;  // bytes from one matrix to the next; a multiple of 4, at least size_of(layout)
};

// Moves the spheres with the skeleton, without the mesh: for games that skin on the GPU. Under linear blend skinning a
// pivot's centroid is linear in the bones' matrices, so these are the spheres that RefitJob makes of the skinned and
// morphed mesh, but for rounding.
//
// What to pass: for each of Asset::bone(), in that order, the matrix that takes the rest pose to the deformed one: the
// world matrix of the bone's joint times bone.inverse_bind. "World" may be any space, and is the space the spheres come
// in. It is the palette that the skinning shader gets wherever the engine kept the file's own vertices, inverse bind
// matrices and order of joints; bone.name and bone.inverse_bind tell. A glTF of several skins lists a joint once more
// for each different inverse bind matrix, all of them from the one rest pose of the asset. An automatic rig's joints
// rest unrotated at Asset::joint().position. Where the last bone is_rest, it moves what no bone moves: pass the matrix
// from the rest pose to the same "world", the identity where that is the rest pose's space.
// A pose that blends others linearly, a Bezier curve of poses, is as linear in the matrices: blend those.
//
// The arithmetic is fixed, in single precision, so that every backend gives the same spheres, bit for bit. fma(a, b, c)
// is a*b + c rounded once, on machines without such an instruction too; nothing else is contracted.
//
// Under the refit rules kPaper and kCalibrated, of a group of eight pivots (see BoneTables), for each lane:
//   term   x = fma(weight, x_t, x) for each of the term's morph terms t, in order, of their targets' weights; so y and
//   z p      for each row m of a bone's matrix: even + odd, which start at 0 and take up term after term:
//          even = fma(m2, z, fma(m0, x, even)), odd = fma(m3, w, fma(m1, y, odd))
//   s      a * p of the sphere's first group, a the pivot's share of the centre; then s = fma(a, p, s) of each further
//          one
// and of a sphere
//   centre the sum over the lanes of s; with tree(v) = (((v0 + v4) + (v2 + v6)) + ((v1 + v5) + (v3 + v7)))
//   d      sqrt(fma(dz, dz, fma(dy, dy, dx*dx))) of p - centre, 0 in a spare lane, summed over the groups in order
//   mean   tree(d) / float(K)
// and the radius follows from the mean as in RefitJob.
//
// Under kMoments (see MomentTables) no pivot is moved and morph weights change nothing. Of a bone whose matrix has the
// rows (a0 a1 a2 t), m = 0, 1, 2; o the origin, "ref" the reference bone:
//   p[m]    fma(a2, o.z, fma(a1, o.y, fma(a0, o.x, t)))
//   C[m]    (a0, a1, a2, p[m] - p_ref[m]), of each 0 where it is less than 2^-62 and more than -2^-62
//           (kLeastMatrixFigure)
// of a pair of bones k, l, and r, c = 0 to 3:
//   G[r][c] fma(Ck[2][r], Cl[2][c], fma(Ck[1][r], Cl[1][c], Ck[0][r] * Cl[0][c]))
// of a sphere
//   S[r][c] M[4r + c] * G[r][c] of its first pair, M the pair's moment; then fma(M[4r + c], G[r][c], S[r][c]) of each
//           further one
//   square  the sum of all sixteen by halves: v[i] + v[i + 8] of the 4r + c, so to eight, v[i] + v[i + 4] to four,
//           v[i] + v[i + 2] to two and their sum
//   radius  wanted * sqrt(square <= 0 ? 0 : square), wanted the rest sphere's radius or detect_radius; no number where
//           square is not finite
//   centre  for each row m: s[j] = C[m][j] * u[j] of its first bone, u its share (x, y, z, w) of the centre; then
//           fma(C[m][j], u[j], s[j]) of each further one; ((s[0] + s[2]) + (s[1] + s[3])) + p_ref[m]
//
// Fill in the fields and call run(). Allocates nothing, needs some 40 KiB of stack, takes no lock; jobs on other
// buffers may run at the same time. Fastest where the asset's bytes start at a multiple of 64.
struct SPHERECHAIN_API RefitBonesJob {
  const Asset* asset = nullptr;     // open
  BoneMatrices bones;               // at least asset->bone_count()
  Span<const float> morph_weights;  // empty where nothing morphs, or at least asset->morph_count()
  RadiusKind radius = RadiusKind::kDetect;
  Target target = Target::kBest;
  Span<Sphere> spheres;  // out: at least asset->spheres().size; further entries are left alone

  // kOk, kNullArgument, kNotOpen, kBadArgument, kBadStride, kNotInAsset, kTooFewBones, kTooFewMorphs, kTooFewSpheres,
  // kUnsupportedTarget, kMisaligned or kSharedMemory; nothing is written unless kOk. Matrices and weights that are not
  // finite give spheres that are not finite, and those touch nothing.
  Status run() const noexcept;
};

}  // namespace spherechain
