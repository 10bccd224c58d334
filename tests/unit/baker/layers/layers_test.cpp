// SPDX-License-Identifier: GPL-3.0-or-later
// A trunk, a coat around it without pockets, and a hand.
#include <doctest/doctest.h>

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
