// SPDX-License-Identifier: GPL-3.0-or-later
// A trunk, a coat around it without pockets, and a hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "baker/report/piece_rows.h"
#include "tiny_skin.h"
#include "two_shapes.h"

using namespace spherechain::baker;

namespace {

constexpr double kTrunk = 2.5, kCoat = 2.9;  // radii; the trunk is 40 long

Shape trunk() { return cylinder(kTrunk, 20, 24); }

// Open at both ends.
Shape coat() {
  Shape out = cylinder(kCoat, 12, 24);
  out.triangles.resize(out.triangles.size() - std::size_t{2} * 4 * 24);
  return out;
}

Shape both_of(const Shape& a, const Shape& b) {
  Shape out = a;
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  out.positions.insert(out.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return out;
}

// At rest the coat is around the trunk.
const TwoShapes& dressed() {
  static const TwoShapes shapes(trunk(), coat(), 0);
  return shapes;
}

}  // namespace

TEST_CASE("an asset knows the pieces of its skin: their hems, and how far the one is over the other at rest") {
  const OpenAsset& asset = dressed().asset();
  REQUIRE(asset->piece_count() == 2);
  const auto [closed, open] = std::minmax({asset->piece(0).border, asset->piece(1).border});
  CHECK(closed == 0);
  CHECK(open == doctest::Approx(2 * 2 * std::numbers::pi * kCoat).epsilon(0.01));
  const std::vector<PieceRow> rows = piece_rows(asset);  // one: the mesh has no name
  REQUIRE(rows.size() == 1);
  REQUIRE(rows[0].covers.size() == 1);
  const PieceRow::Cover& cover = rows[0].covers[0];
  CHECK(cover.distance_mm == doctest::Approx(1000 * (kCoat - kTrunk)).epsilon(0.1));
  CHECK(!cover.crosses);
  const double coat = 24 * kCoat, trunk = 40 * kTrunk;  // areas of the two, without the trunk's ends
  CHECK(cover.area == doctest::Approx(24 * kTrunk / (coat + trunk)).epsilon(0.2));
}

TEST_CASE("an asset whose pieces do not fit its skin is listed all the same") {
  namespace test = spherechain::test;
  for (const bool has_pieces : {false, true}) {
    test::TinyAsset tiny = test::random_band(12, 3);
    for (std::size_t i = 0; i < 12; ++i) test::give_pivots(tiny, i, 2, static_cast<unsigned>(i));
    const test::TinySkin skin = test::add_bones(tiny, 5, 2);
    test::add_skin(tiny, &skin, 4);
    test::SkinParts& parts = tiny.parts.skin;
    const std::uint32_t in_no_sphere = tiny.parts.triangle_count;
    tiny.parts.triangle_count += 2;
    parts.rest_contacts = {in_no_sphere, in_no_sphere + 1};
    if (!has_pieces) {
      parts.pieces.clear();
      std::fill(parts.covers.begin(), parts.covers.end(), 0);
    }
    const std::vector<std::uint8_t> bytes = test::build(tiny.parts);
    const OpenAsset asset({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "tiny");
    const std::vector<PieceRow> rows = piece_rows(asset);
    CHECK(rows.empty() == !has_pieces);
    CHECK(std::all_of(rows.begin(), rows.end(), [](const PieceRow& row) { return row.area > 0; }));
  }
}

TEST_CASE("a coat that slides on a trunk meets it only where layers are asked for") {
  const auto slid = shifted(1.2, 0.5, 0);
  CHECK(dressed().ask(slid, {}, SC_SCOPE_APART).empty());
  const std::vector<spherechain::Penetration> all = dressed().ask(slid, {}, SC_SCOPE_LAYERS);
  REQUIRE(all.size() == 1);
  CHECK(all[0].kind == SC_CLASS_SHELL);
}

TEST_CASE("a coat that has moved far beyond its place on the trunk meets it, whatever is asked for") {
  const auto gone = shifted(3, 29, 0);
  const std::vector<spherechain::Penetration> apart = dressed().ask(gone, {}, SC_SCOPE_APART);
  REQUIRE(apart.size() == 1);
  CHECK(apart[0].measures.depth == dressed().ask(gone, {}, SC_SCOPE_LAYERS)[0].measures.depth);
}

TEST_CASE("a hand that goes into a coat is found, and how deep, though there is a trunk below") {
  const TwoShapes shapes(both_of(trunk(), coat()), ball(2, 8));
  const auto pushed = shifted(kCoat + 2 - 1.5, 0, 0);
  for (const spherechain::Scope scope : {SC_SCOPE_APART, SC_SCOPE_LAYERS}) {
    const std::vector<spherechain::Penetration> found = shapes.ask(pushed, {}, scope);
    REQUIRE(found.size() == 1);
    CHECK(spherechain::is_fault(found[0].kind));
    CHECK(found[0].measures.depth == doctest::Approx(1.5).epsilon(0.1));
  }
}
