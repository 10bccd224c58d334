// SPDX-License-Identifier: MIT
// How far must one set of triangles move along a direction to be clear of another? In the view along the direction, a
// pair of triangles that overlap blocks an interval of the way; the answer is the end of the first run of intervals,
// the first place that no pair blocks. It is found without a list of intervals: start at 0, and while some pair blocks
// the place, go to the end of that pair's interval. Each pass looks at pairs of blocks of 16 triangles by their boxes,
// and pairs that blocked earlier directions are asked first.
#pragma once

#include "runtime/src/depth/contour.h"
#include "runtime/src/depth/shadow.h"
#include "runtime/src/skin/left_out.h"

namespace spherechain {

// Selects the pairs of triangles that count: those that the contact job would report.
struct PairRule {
  const Surface* surface = nullptr;  // null: all pairs, those of two bodies
  Span<const std::uint64_t> ignored;
  bool apart = true, neighbours = false, layers = true;

  bool counts(std::uint32_t a, std::uint32_t b) const;
  // False if no two triangles of these spheres count.
  bool may_count(std::size_t sphere_a, std::size_t sphere_b) const;
  bool leaves_out(std::uint32_t cluster) const { return surface != nullptr && !layers && is_buried(*surface, cluster); }
};

// The end of the way: the pair of triangles that blocks it last.
struct WayOut {
  double depth = 0;
  std::uint32_t a = kNoPlace, b = kNoPlace;
  Double3 point_a{}, point_b{};  // on the triangles, before the move: point_a - point_b = depth * direction
  Double3 normal{};              // of the surfaces where they part, along the direction; of unit length, or zero
};

struct Volume {
  double volume = 0;
  double area = 0;   // of b's skin inside a, seen along the direction: what faces away counts negative
  double total = 0;  // of all that area was made of
};

class Sweep {
 public:
  // `gap`: free places shorter than that do not end the way.
  Sweep(const Skins& skins, const PairRule& rule, double gap) : skins_(skins), rule_(rule), gap_(gap) {}
  void set_gap(double gap) { gap_ = gap; }
  void take(WordMemory& memory, const SkinSizes& a, const SkinSizes& b);
  // Call it once, before anything else.
  void clear();

  // Sets the triangles of both sides. `origin` is a point near the contact. Call keep_near() or keep_on_way() next.
  void set_sides(Span<const TriangleRun> a, Span<const TriangleRun> b, const Double3& origin);
  // Keeps the triangles that may meet when b moves by up to `depth` in any direction. Later searches are exact only for
  // ways up to `depth`. An infinite depth keeps all triangles.
  void keep_near(double depth);
  // Keeps the triangles that may meet when b moves by up to `depth` along `direction`.
  void keep_on_way(const Double3& direction, double depth);

  // Lower bound of the way out: the distance that the contour's own triangles block. The search ends at `bound`.
  double find_by_contour(const Double3& direction, const Contour& contour, double bound, WayOut& out);
  // Returns false if the way out is not shorter than `bound`: `out` then holds the pair that blocks it.
  bool find(const Double3& direction, const Contour& contour, double bound, WayOut& out);
  // True if one body lies inside the other after b has moved along `way`. `outwards` is -1 if the skins are inside out.
  bool is_enclosed(const Double3& direction, const WayOut& way, const Contour& contour, double outwards);
  // Volume of b inside a, seen along the direction of a way of length `depth`; or only that of the outer layers of
  // both. Keeps the triangles on that way.
  Volume volume(const Double3& direction, double depth, bool of_outer_layers);

 private:
  // The triangles of one side, in blocks of kBlock that follow one another, and their boxes in view: along u, v (across
  // the direction) and d (along it). Boxes past the last are empty.
  static constexpr std::size_t kBlock = 16;
  struct Boxes {
    std::uint32_t *triangle = nullptr, *corners = nullptr;  // three places in vertices_ each
    std::size_t count = 0;
    std::uint32_t* sphere = nullptr;       // of all triangles of a block; kNoPlace where they have several
    float *middle[3] = {}, *half[3] = {};  // a block's box along x, y, z, relative to vertices_.origin
    std::uint32_t* is_live = nullptr;      // 1: a triangle of the block may meet one of the other side, and count
    // The blocks that may meet the other side in this view.
    std::uint32_t* block = nullptr;  // their numbers, ascending
    std::size_t block_count = 0;
    float *block_low[3] = {}, *block_high[3] = {};  // their boxes, in the order of `block`
    float *low[3] = {}, *high[3] = {};              // their triangles' boxes; make_boxes() sets them
    std::uint32_t* has_boxes = nullptr;             // 1: make_boxes() has set them, in the order of `block`

    void take(WordMemory& memory, std::size_t capacity);
    void view_blocks(const View& view);
    void keep_blocks(const float (&least)[3], const float (&most)[3]);
    // Empties the boxes past the last, and forgets those of all triangles.
    void close();
    // Makes the boxes of the triangles of `block[i]`, and a closer box of the block. Returns false if they were there.
    bool make_boxes(std::size_t i, const float* const (&seen)[3]);
  };
  // The vertices of both sides' triangles, and their coordinates in view.
  struct Vertices {
    std::uint32_t *vertex = nullptr, *place = nullptr;  // the other way round: kNoPlace where it is not there
    float *at[3] = {}, *seen[3] = {};                   // relative to `origin`
    Double3 origin{};
    std::size_t count = 0;
  };
  // The triangles of one body. Numbers of its vertices start at `first_vertex`, so that two bodies share none.
  struct Side {
    const PosedSkin& skin;
    std::uint32_t first_vertex;
    Span<const TriangleRun> runs;
  };
  Side side_a() const { return {skins_.a, 0, side_a_}; }
  Side side_b() const { return {skins_.b, skins_.first_vertex_of_b(), side_b_}; }

  void list_vertices(const Side& side, Boxes& boxes);
  void look_along(const Double3& direction);
  // Sees the boxes of all blocks that can block a way longer than `depth`.
  void see_boxes(double depth);
  // The farthest that b may move up and down along each axis.
  struct Reach {
    Double3 up, down;
  };
  void keep(const Reach& reach);
  void keep_runs(const Side& side, const Side& other, const Reach& reach, Boxes& out);
  void widen_blocks(const PosedSkin& skin, const TriangleRun& run, bool is_live, Boxes& out) const;
  bool may_count(std::size_t sphere_a, std::size_t sphere_b) const {
    return counts_all_ || sphere_a == kNoPlace || sphere_b == kNoPlace || rule_.may_count(sphere_a, sphere_b);
  }
  bool may_block(std::uint32_t a, std::uint32_t b, double depth) const;
  void block(std::uint32_t a, std::uint32_t b, double& depth, WayOut& out);
  // Moves of b along the direction, above `from` and up to `to`.
  struct Moves {
    double from, to;
  };
  // Calls visit(a, b, block of b) for triangles that may meet after such a move, by their boxes. Starts at that block
  // of b; ends where visit() says false. visit() may narrow the moves.
  template <typename Visit>
  void for_pairs(std::size_t first, const Moves& moves, const Visit& visit);
  void vote(const Side& side, const Double3* points, std::size_t count, bool up, double outwards, int* inside) const;
  void vote_by(const Corners& triangle, const Double3* points, std::size_t count, bool up, double handedness,
               double* nearest, int* inside) const;
  void remember(const WayOut& out);
  // One side's triangles that were looked at last in this view: each has one place, by its number.
  struct SeenTriangles {
    static constexpr std::size_t kCount = 256;
    struct Entry {
      std::uint64_t key;  // the view's number and the triangle's
      SeenTriangle seen;
    };
    Entry* entries = nullptr;
  };
  const SeenTriangle& see(SeenTriangles& of, const PosedSkin& skin, std::uint32_t triangle);

  const Skins& skins_;
  const PairRule& rule_;
  double gap_;
  bool counts_all_ = false;  // pairs that do not count, too: they limit volumes
  View view_{{0, 0, 1}, {0, 0, 0}};
  Span<const TriangleRun> side_a_, side_b_;
  Boxes a_, b_;
  SeenTriangles seen_a_, seen_b_;
  std::uint32_t view_number_ = 0;
  Vertices vertices_;
  // Pairs that ended the ways along earlier directions: they are likely to block the next one.
  static constexpr std::size_t kRemembered = 64;
  Pair remembered_[kRemembered] = {};
  std::size_t remembered_count_ = 0;
  std::size_t first_block_ = 0;  // of b, where the last blocker was
};

}  // namespace spherechain
