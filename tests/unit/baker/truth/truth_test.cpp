// SPDX-License-Identifier: GPL-3.0-or-later
// The true intersections, against CGAL's own search and against shapes where it is known; and the score kept of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "baked_human.h"
#include "baker/truth/intersections.h"
#include "baker/truth/missed_depth.h"
#include "baker/truth/score.h"
#include "baker/truth/truth.h"
#include "baker/truth/truth_cache.h"
#include "mesh_self_intersections.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using spherechain::Pair;

namespace {

// Triangles of which each is a source triangle, a skin triangle and a region of its own: `corners` of shared vertices.
TruthSurface loose_surface(const std::vector<Triangle>& corners, const std::vector<std::uint32_t>& spheres) {
  TruthSurface surface;
  for (Index t = 0; t < corners.size(); ++t) {
    surface.source_triangle.push_back(t);
    surface.of_source.push_back(t);
    surface.corners.push_back(corners[t]);
    surface.welded.push_back(corners[t]);
    surface.sphere.push_back(spheres[t]);
    surface.of_sphere.resize(std::max<std::size_t>(surface.of_sphere.size(), spheres[t] + 1));
    surface.of_sphere[spheres[t]].push_back(t);
  }
  return surface;
}

const std::vector<Triangle> kTwo{{0, 1, 2}, {3, 4, 5}};
const std::vector<float> kFloor{0, 0, 0, 4, 0, 0, 0, 4, 0};  // the first of them; the second follows

std::vector<float> with_floor(const std::vector<float>& second) {
  std::vector<float> positions = kFloor;
  positions.insert(positions.end(), second.begin(), second.end());
  return positions;
}

bool meets_floor(const std::vector<float>& second) {
  const Intersections found = find_intersections(loose_surface(kTwo, {0, 1}), with_floor(second));
  CHECK(found.degenerate == 0);
  return found.pairs == std::vector<Pair>{{0, 1}};
}

}  // namespace

TEST_CASE("the posed human's intersections are those CGAL finds in its skin, but for pairs with a common vertex") {
  const Bake& bake = baked_human();
  const Character& character = bake.character;
  const TruthSurface surface = surface_of(open_asset_of(bake), character);
  CHECK(surface.corners.size() == character.skin.triangles.size());
  const std::vector<float> positions = pack(posed_human("arms_crossed.json"));

  Mesh posed = character.skin;
  for (Index v = 0; v < character.skin_of_source.size(); ++v) {
    if (character.skin_of_source[v] == kNoIndex) continue;
    posed.positions[character.skin_of_source[v]] = {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
  }
  std::vector<Pair> reference;
  for (const auto& [a, b] : mesh_self_intersections(posed)) {
    if (are_neighbours(posed.triangles[a], posed.triangles[b])) continue;
    const auto [s, t] = std::minmax({character.skin_source_triangle[a], character.skin_source_triangle[b]});
    reference.push_back({s, t});
  }
  std::sort(reference.begin(), reference.end());
  CHECK(reference.size() > 100);
  CHECK(find_intersections(surface, positions).pairs == reference);
}

TEST_CASE("what touches or lies in one plane intersects, what is one step of a float away does not") {
  const float up = std::numeric_limits<float>::denorm_min();
  CHECK(meets_floor({1, 1, -1, 1, 1, 1, 2, 1, 1}));
  CHECK(meets_floor({1, 1, 0, 1, 1, 1, 2, 1, 1}));     // a corner on the face
  CHECK(meets_floor({1, 1, 0, 2, 1, 0, 1, 2, 0}));     // inside it, in its plane
  CHECK(meets_floor({-1, -1, 0, 0, 0, 0, -1, 0, 0}));  // corner on corner
  CHECK(!meets_floor({1, 1, up, 1, 1, 1, 2, 1, 1}));
  CHECK(!meets_floor({1, 1, up, 2, 1, up, 1, 2, up}));
}

TEST_CASE("a triangle without area intersects nothing and is counted; neighbours are no contact") {
  const Intersections line = find_intersections(loose_surface(kTwo, {0, 1}), with_floor({1, 1, -1, 1, 1, 0, 1, 1, 1}));
  CHECK(line.pairs.empty());
  CHECK(line.degenerate == 1);

  TruthSurface surface = loose_surface(kTwo, {0, 1});
  const std::vector<float> crossing = with_floor({1, 1, -1, 1, 1, 1, 2, 1, 1});
  REQUIRE(find_intersections(surface, crossing).pairs.size() == 1);
  surface.welded[1][2] = 0;  // one position at rest
  CHECK(find_intersections(surface, crossing).pairs.empty());
}

TEST_CASE("how near two regions are is the distance of their faces, edges and corners") {
  const TruthSurface surface = loose_surface(kTwo, {0, 1});
  const auto closer = [&](const std::vector<float>& second, double distance) {
    const bool there = any_closer(surface, with_floor(second), {0}, {1}, distance);
    CHECK(any_closer(surface, with_floor(second), {1}, {0}, distance) == there);
    return there;
  };
  for (const std::vector<float>& second : {std::vector<float>{1, 1, 0.5F, 1, 1, 3, 2, 1, 3},  // a corner over the face
                                           std::vector<float>{1, -0.5F, -2, 1, -0.5F, 2, 1, -3, 0},    // edge to edge
                                           std::vector<float>{1, 1, 0.5F, 2, 1, 0.5F, 1, 2, 0.5F}}) {  // parallel
    CHECK(closer(second, 0.51));
    CHECK(!closer(second, 0.49));
  }
  CHECK(closer({1, 1, -1, 1, 1, 1, 2, 1, 1}, 1e-9));
  // Beside the slanting edge: the boxes overlap.
  CHECK(closer({3, 3, 0, 3, 3, 1, 3.5F, 3.5F, 0}, 1.42));
  CHECK(!closer({3, 3, 0, 3, 3, 1, 3.5F, 3.5F, 0}, 1.41));
}

TEST_CASE("intersections are found once a pose and kept in files; a broken file is not believed and is replaced") {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const fs::path cache = folder.path / "a/b";
  const TruthSurface surface = loose_surface(kTwo, {0, 1});
  const std::vector<float> crossing = with_floor({1, 1, -1, 1, 1, 1, 2, 1, 1}),
                           apart = with_floor({1, 1, 1, 1, 1, 2, 2, 1, 2});
  const auto find = [&](const std::vector<float>& positions) {
    return CachedIntersections(surface, cache).find(positions).pairs;
  };
  const auto files = [&] { return std::vector<fs::path>(fs::directory_iterator(cache), fs::directory_iterator()); };
  REQUIRE(find(crossing).size() == 1);
  REQUIRE(files().size() == 1);
  const fs::path crossing_file = files()[0];
  CHECK(find(crossing).size() == 1);
  CHECK(files().size() == 1);
  CHECK(find(apart).empty());
  REQUIRE(files().size() == 2);
  const fs::path apart_file = files()[files()[0] == crossing_file ? 1 : 0];

  const auto size = fs::file_size(crossing_file);
  fs::resize_file(crossing_file, size - 1);
  CHECK(find(crossing).size() == 1);
  CHECK(fs::file_size(crossing_file) == size);
  folder.write("a/b/" + crossing_file.filename().string(), "hello");
  CHECK(find(crossing).size() == 1);
  CHECK(fs::file_size(crossing_file) == size);
  std::fstream(crossing_file, std::ios::in | std::ios::out | std::ios::binary).seekp(-66, std::ios::end).put('x');
  CHECK(find(crossing).front() == Pair{0, 1});
  // A whole file is believed: the search was not made again.
  fs::copy_file(apart_file, crossing_file, fs::copy_options::overwrite_existing);
  CHECK(find(crossing).empty());
  // The spheres are not in the key, the triangles are.
  CHECK(CachedIntersections(loose_surface(kTwo, {1, 0}), cache).find(crossing).pairs.empty());
  CHECK(CachedIntersections(loose_surface({{1, 0, 2}, {3, 4, 5}}, {0, 1}), cache).find(crossing).pairs.size() == 1);
  // A folder that cannot be, and none.
  CHECK(CachedIntersections(surface, apart_file / "c").find(crossing).pairs.size() == 1);
  CHECK(CachedIntersections(surface, {}).find(crossing).pairs.size() == 1);
}

TEST_CASE("a method misses a fault where it reports no contact of its two body parts") {
  const std::vector<std::uint8_t> part_of{0, 1, 1, 2};
  FrameTruth truth;
  truth.contacts = {{{0, 1}, {{0, 1}}}, {{0, 2}, {{0, 2}}}, {{1, 3}, {{1, 3}}}};
  std::vector<spherechain::Penetration> found(2);
  found[0].other = found[1].part = 1;
  found[1].other = 2;
  found[0].measures.depth = 5;
  found[1].measures.depth = 7;
  found[0].kind = SC_CLASS_PENETRATION;
  found[1].kind = SC_CLASS_FOLD;
  const auto missed = [&](const std::vector<Pair>& reported, std::size_t contact) {
    return MissedDepth(part_of, truth, reported, found)(truth.contacts[contact]);
  };
  CHECK(missed({}, 0) == 5);
  CHECK(missed({{0, 2}}, 0) == 0);  // other spheres of the same parts
  CHECK(missed({}, 2) == 0);        // a fold
  found[1].kind = SC_CLASS_DEEP_FOLD;
  CHECK(missed({}, 2) == 7);
}

TEST_CASE("what is at rest too, of one sphere or of an ignored pair is counted and left out, each pair once") {
  const Bake& bake = baked_human();
  const OpenAsset asset = open_asset_of(bake);
  const TruthSurface surface = surface_of(asset, bake.character);
  const auto first = [&](std::uint32_t sphere) { return surface.source_triangle[surface.of_sphere[sphere].front()]; };
  const auto last = [&](std::uint32_t sphere) { return surface.source_triangle[surface.of_sphere[sphere].back()]; };
  const auto pair_of = [](Index a, Index b) { return Pair{std::min(a, b), std::max(a, b)}; };
  const auto [a, b] = bake.binding.ignored.front();
  std::uint32_t c = b + 1;
  while (is_ignored(asset, a, c)) ++c;
  const Pair same = pair_of(first(a), last(a)), same_at_rest = pair_of(first(b), last(b)),
             ignored = pair_of(first(a), first(b)), one = pair_of(first(a), first(c)), two = pair_of(last(a), last(c)),
             at_rest = pair_of(first(a), last(c));
  Intersections found{{same, same_at_rest, ignored, one, two, at_rest}, 0};
  std::sort(found.pairs.begin(), found.pairs.end());
  std::vector<Pair> rest{at_rest, same_at_rest};
  std::sort(rest.begin(), rest.end());

  const FrameTruth truth = frame_truth(
      found, rest, surface, [&](auto l, auto r) { return is_ignored(asset, l, r); },
      [&](const Pair& pair) { return pair == two || pair == ignored || pair == at_rest; });
  CHECK(truth.raw_pairs == 6);
  CHECK(truth.rest == 2);
  CHECK(truth.same_sphere == 1);
  CHECK(truth.ignored == 1);
  CHECK(truth.pairs.size() == 2);
  REQUIRE(truth.contacts.size() == 1);
  CHECK(truth.contacts[0].spheres == Pair{std::min(a, c), std::max(a, c)});
  CHECK(truth.contacts[0].triangles == truth.pairs);
  std::vector<Pair> far{two, ignored};  // also of spheres that the asset ignores
  std::sort(far.begin(), far.end());
  CHECK(truth.far == far);
}

TEST_CASE("a score counts triangle pairs, frames and reported spheres as the contract says") {
  FrameTruth truth;
  truth.pairs = {{1, 2}, {1, 3}, {4, 5}};
  truth.contacts = {{{0, 1}, {{1, 2}, {1, 3}}}, {{0, 2}, {{4, 5}}}};
  truth.far = {{1, 3}, {8, 9}};  // the second is of one sphere
  const auto score = [&](const std::vector<Pair>& reported) {
    return score_frame(
        truth, reported,
        [](const Pair& pair) {
          return pair == Pair{5, 6};
        },
        [](const Pair& pair) { return pair.a > 0; },
        [](const TrueContact& contact) { return static_cast<double>(contact.spheres.b); });
  };
  const Score some = score({{0, 1}, {5, 6}, {7, 8}});
  CHECK(some.pair_recall().value() == doctest::Approx(2.0 / 3));
  CHECK(some.precision().value() == doctest::Approx(2.0 / 3));  // {5, 6} is close
  CHECK(some.far_recall() == 0.5);
  CHECK(some.apart_precision() == 0.5);  // {0, 1} is near at rest
  CHECK(some.frame_any_recall() == 1);
  CHECK(some.frame_all_recall() == 0);
  CHECK(some.missed_depth == 2);
  Score both = score({{0, 1}, {0, 2}});
  CHECK(both.frame_all_recall() == 1);
  CHECK(both.missed_depth == 0);
  both.add(score({}));
  CHECK(both.pair_recall() == 0.5);
  CHECK(both.frame_any_recall() == 0.5);
  CHECK(both.reported_per_frame() == 1);
  CHECK(both.precision() == 1);
  CHECK(both.missed_depth == 2);
  truth = {};
  CHECK(!score({}).pair_recall());
  CHECK(!score({}).far_recall());
  CHECK(!score({}).precision());
  CHECK(!score({}).apart_precision());
  CHECK(score({}).true_frames == 0);
}
