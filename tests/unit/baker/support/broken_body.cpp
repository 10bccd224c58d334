// SPDX-License-Identifier: GPL-3.0-or-later
#include "broken_body.h"

#include <algorithm>
#include <limits>
#include <map>
#include <random>

#include "baker/mesh/surface_query.h"

using namespace spherechain::baker;

namespace {

// Where on the intact body a place is, given as fractions of the height.
Vec3 at(const Vec3& place) {
  const BodyFrame& frame = human().regions.frame;
  return frame.origin + frame.height * (place.x() * frame.left + place.y() * frame.up + place.z() * frame.forward);
}

std::vector<Vec3> vertex_normals(const SourceMesh& mesh) {
  const Mesh plain{mesh.positions, mesh.triangles};
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) normals[v] += triangle_cross(plain, t);
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

template <typename Keep>
void keep_where(BrokenBody& body, const Keep& keep) {
  std::size_t kept = 0;
  for (Index t = 0; t < body.source.triangles.size(); ++t) {
    if (!keep(t)) continue;
    body.source.triangles[kept] = body.source.triangles[t];
    body.of_intact[kept++] = body.of_intact[t];
  }
  body.source.triangles.resize(kept);
  body.of_intact.resize(kept);
}

}  // namespace

BrokenBody intact_body() {
  const Character& character = human().character;
  BrokenBody body;
  body.source.importer = "test";
  body.source.positions = character.largest_piece.mesh.positions;
  body.source.triangles = character.largest_piece.mesh.triangles;
  for (Index t = 0; t < body.source.triangles.size(); ++t) body.of_intact.push_back(t);
  return body;
}

void subdivide(BrokenBody& body, int times) {
  for (; times > 0; --times) {
    BrokenBody fine;
    fine.source = body.source;
    fine.source.triangles.clear();
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [found, is_new] = middles.emplace(std::minmax(a, b), static_cast<Index>(fine.source.positions.size()));
      if (is_new) fine.source.positions.push_back(0.5 * (body.source.positions[a] + body.source.positions[b]));
      return found->second;
    };
    for (std::size_t t = 0; t < body.source.triangles.size(); ++t) {
      const auto [a, b, c] = body.source.triangles[t];
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Triangle& part :
           {Triangle{a, ab, ca}, Triangle{b, bc, ab}, Triangle{c, ca, bc}, Triangle{ab, bc, ca}}) {
        fine.source.triangles.push_back(part);
        fine.of_intact.push_back(body.of_intact[t]);
      }
    }
    body = std::move(fine);
  }
}

void cut_into_pieces(BrokenBody& body, std::size_t pieces, double shrink) {
  SourceMesh& mesh = body.source;
  const Mesh plain{mesh.positions, mesh.triangles};
  std::mt19937 random(7);
  std::vector<Vec3> seeds;
  for (std::size_t i = 0; i < pieces; ++i) seeds.push_back(mesh.positions[random() % mesh.positions.size()]);
  std::vector<std::size_t> piece_of;
  std::vector<Vec3> middle(pieces, Vec3::Zero());
  std::vector<double> count(pieces, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 p = triangle_centroid(plain, t);
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < seeds.size(); ++i) {  // in plain numbers, because tests are not optimised
      const double *a = seeds[i].data(), *b = p.data();
      const double off = (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
      if (off < least) {
        least = off;
        nearest = i;
      }
    }
    piece_of.push_back(nearest);
    middle[piece_of.back()] += p;
    ++count[piece_of.back()];
  }
  std::map<std::pair<std::size_t, Index>, Index> copies;
  mesh.positions.clear();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t piece = piece_of[t];
    const Vec3 center = middle[piece] / count[piece];
    for (Index& v : mesh.triangles[t]) {
      const auto [found, is_new] = copies.emplace(std::pair(piece, v), static_cast<Index>(mesh.positions.size()));
      if (is_new) mesh.positions.push_back(center + (1 - shrink) * (plain.positions[v] - center));
      v = found->second;
    }
  }
}

void flip(BrokenBody& body, double share) {
  std::mt19937 random(3);
  std::bernoulli_distribution chosen(share);
  for (Triangle& t : body.source.triangles) {
    if (chosen(random)) std::swap(t[1], t[2]);
  }
}

void punch(BrokenBody& body, double share) {
  std::mt19937 random(4);
  std::bernoulli_distribution chosen(share);
  keep_where(body, [&](Index) { return !chosen(random); });
}

void split_one_side(BrokenBody& body, double share) {
  std::mt19937 random(5);
  std::bernoulli_distribution chosen(share);
  const std::size_t count = body.source.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    if (!chosen(random)) continue;
    const Triangle v = body.source.triangles[t];
    const auto middle = static_cast<Index>(body.source.positions.size());
    body.source.positions.push_back(0.5 * (body.source.positions[v[0]] + body.source.positions[v[1]]));
    body.source.triangles[t] = {v[0], middle, v[2]};
    body.source.triangles.push_back({middle, v[1], v[2]});
    body.of_intact.push_back(body.of_intact[t]);
  }
}

void cut_hole(BrokenBody& body, const Vec3& place, double radius) {
  const HumanFixture& intact = human();
  const Vec3 center = SurfaceQuery(intact.regions.body.mesh).closest(at(place)).point;
  keep_where(body, [&](Index t) {
    return body.of_intact[t] == kNoIndex ||
           (triangle_centroid(intact.regions.body.mesh, body.of_intact[t]) - center).norm() >
               radius * intact.regions.frame.height;
  });
}

void add_hair(BrokenBody& body, double distance) {
  const BodyFrame& frame = human().regions.frame;
  const std::vector<Vec3> normals = vertex_normals(body.source);
  const Mesh plain{body.source.positions, body.source.triangles};
  std::map<Index, Index> copies;
  for (std::size_t t = 0; t < plain.triangles.size(); ++t) {
    const Vec3 p = (triangle_centroid(plain, t) - frame.origin) / frame.height;
    if (p.dot(frame.up) < 0.94 && (p.dot(frame.up) < 0.88 || p.dot(frame.forward) > 0)) continue;
    Triangle copy = plain.triangles[t];
    for (Index& v : copy) {
      const auto [found, is_new] = copies.emplace(v, static_cast<Index>(body.source.positions.size()));
      if (is_new) body.source.positions.push_back(plain.positions[v] + distance * frame.height * normals[v]);
      v = found->second;
    }
    body.source.triangles.push_back(copy);
    body.of_intact.push_back(kNoIndex);
  }
}

void add_inner_surface(BrokenBody& body, double distance) {
  const std::vector<Vec3> normals = vertex_normals(body.source);
  const auto base = static_cast<Index>(body.source.positions.size());
  for (Index v = 0; v < base; ++v) {
    body.source.positions.push_back(body.source.positions[v] - distance * human().regions.frame.height * normals[v]);
  }
  const std::size_t count = body.source.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle v = body.source.triangles[t];
    body.source.triangles.push_back({v[0] + base, v[2] + base, v[1] + base});
    body.of_intact.push_back(kNoIndex);
  }
}

void tear(BrokenBody& body, double distance) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> move(-distance, distance);
  std::vector<Vec3> positions;
  for (Triangle& t : body.source.triangles) {
    for (Index& v : t) {
      const double height = human().regions.frame.height;
      positions.push_back(body.source.positions[v] + height * Vec3(move(random), move(random), move(random)));
      v = static_cast<Index>(positions.size() - 1);
    }
  }
  body.source.positions = std::move(positions);
}
