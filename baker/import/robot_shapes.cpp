// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <numbers>

#include "baker/import/robot_model.h"

namespace spherechain::baker {
namespace {

// The corners of the triangles lie on the primitive.
constexpr std::size_t kSides = 48, kRings = 12;  // around, and from the equator to a pole

// Each side has corners of its own, so that it is drawn flat.
Mesh box(const Vec3& half) {
  constexpr std::array<std::array<int, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  Mesh out;
  for (const auto& side : kSides) {
    const auto first = static_cast<Index>(out.positions.size());
    for (const int corner : side) {
      out.positions.push_back(
          half.cwiseProduct(Vec3((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1)));
    }
    out.triangles.push_back({first, first + 1, first + 2});
    out.triangles.push_back({first, first + 2, first + 3});
  }
  return out;
}

// A surface of revolution about z between two poles: `profile` has radius and height of its rings, from below.
Mesh revolve(const std::vector<std::array<double, 2>>& profile, double bottom, double top) {
  Mesh out;
  out.positions.emplace_back(0, 0, bottom);
  for (const auto& [radius, height] : profile) {
    for (std::size_t i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kSides;
      out.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  }
  out.positions.emplace_back(0, 0, top);
  const auto at = [](std::size_t ring, std::size_t i) { return static_cast<Index>(1 + ring * kSides + i % kSides); };
  const auto last = static_cast<Index>(out.positions.size() - 1);
  for (std::size_t i = 0; i < kSides; ++i) {
    out.triangles.push_back({0, at(0, i + 1), at(0, i)});
    for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
      out.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      out.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
    out.triangles.push_back({last, at(profile.size() - 1, i), at(profile.size() - 1, i + 1)});
  }
  return out;
}

Mesh capsule(double radius, double half) {
  std::vector<std::array<double, 2>> profile;
  const auto ring = [&](std::size_t r, double side) {
    const double angle = std::numbers::pi / 2 * static_cast<double>(r) / kRings;
    profile.push_back({radius * std::cos(angle), side * (half + radius * std::sin(angle))});
  };
  for (std::size_t r = kRings - 1; r > 0; --r) ring(r, -1);
  ring(0, -1);
  if (half > 0) ring(0, 1);
  for (std::size_t r = 1; r < kRings; ++r) ring(r, 1);
  return revolve(profile, -half - radius, half + radius);
}

}  // namespace

Mesh triangles_of(const RobotShape& shape) {
  const Vec3& size = shape.size;
  if (shape.kind == ShapeKind::kBox) return box(size);
  if (shape.kind == ShapeKind::kCapsule) return capsule(size[0], size[1]);
  if (shape.kind == ShapeKind::kCylinder) return revolve({{size[0], -size[1]}, {size[0], size[1]}}, -size[1], size[1]);
  Mesh out = shape.kind == ShapeKind::kEllipsoid ? capsule(1, 0) : shape.mesh;
  for (Vec3& p : out.positions) p = p.cwiseProduct(size);
  if (size.prod() < 0) {
    for (Triangle& t : out.triangles) std::swap(t[1], t[2]);
  }
  return out;
}

}  // namespace spherechain::baker
