// SPDX-License-Identifier: GPL-3.0-or-later
// The human's body broken the ways exported characters are.
#pragma once

#include <vector>

#include "human.h"

// A mesh made of the human's body: which of the body's triangles each of its triangles was, kNoIndex for what is added.
struct BrokenBody {
  spherechain::baker::SourceMesh source;
  std::vector<spherechain::baker::Index> of_intact;
};

BrokenBody intact_body();
// Splits each triangle into four, `times` times over.
void subdivide(BrokenBody& body, int times);
// Cut along edges into this many pieces, each made smaller by `shrink` of its size about its middle.
void cut_into_pieces(BrokenBody& body, std::size_t pieces, double shrink);
// These shares of the triangles are turned inside out, are missing, or are split at the middle of an edge on one side
// of it only.
void flip(BrokenBody& body, double share);
void punch(BrokenBody& body, double share);
void split_one_side(BrokenBody& body, double share);
// A round hole about the body's vertex nearest to `place`, as fractions of the height left, up and forward.
void cut_hole(BrokenBody& body, const spherechain::baker::Vec3& place, double radius);
// A shell over the scalp, its border open, this far off the skin as a fraction of the height.
void add_hair(BrokenBody& body, double distance);
// The same surface once more inside, facing inwards.
void add_inner_surface(BrokenBody& body, double distance);
// Every triangle its own three vertices, each moved by up to this fraction of the height.
void tear(BrokenBody& body, double distance);
