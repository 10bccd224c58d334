// SPDX-License-Identifier: MIT
// Skin contacts against a plain loop over every two triangles of the source, which knows nothing of the packed skin.
#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "jobs.h"
#include "owned_filter.h"
#include "palette.h"
#include "random_poses.h"
#include "runtime/src/triangles/exact_triangles.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kBones = 6, kMorphs = 3;

struct Posable {
  explicit Posable(unsigned seed, bool is_band = true, std::size_t spheres = 11)
      : tiny(is_band ? random_band(spheres, seed) : random_asset(spheres, seed)),
        skin(add_bones(tiny, kBones, seed + 1)) {
    add_skin(tiny, &skin, 1 + seed % 5);
  }
  TinyAsset tiny;
  TinySkin skin;
};

// The contacts that a job is to find, from where the source's vertices are.
class PlainContacts {
 public:
  PlainContacts(const TinyAsset& tiny, const std::vector<float>& positions) : tiny_(tiny), positions_(positions) {
    for (std::uint32_t s = 0; s < tiny.triangles.size(); ++s) {
      for (const std::uint32_t t : tiny.triangles[s]) sphere_of_[t] = s;
    }
    const SkinParts& skin = tiny.parts.skin;
    const Numbers &rest = skin.rest_contacts, &layers = skin.layer_pairs;
    for (std::size_t i = 0; i < rest.size(); i += 2) at_rest_.insert({rest[i], rest[i + 1]});
    for (std::size_t i = 0; i < layers.size(); i += 2) layers_.insert({layers[i], layers[i + 1]});
    for (std::uint32_t c = 0, place = 0; c < skin.clusters.size(); ++c) {
      for (std::size_t i = 0; i < skin.clusters[c].triangle_count; ++i) cluster_of_[skin.triangles[place++]] = c;
    }
  }

  // `but_layers`: without clusters that are layers of one place, and buried ones.
  template <typename IsWanted>
  SkinContacts find(const IsWanted& is_wanted, bool but_layers) const {
    SkinContacts out{{SC_OK, SC_FIELD_NONE}, {}, {}, {}};
    std::set<Pair> spheres;
    std::map<Pair, PartContact> parts;
    for (const auto& [a, sphere_a] : sphere_of_) {
      for (const auto& [b, sphere_b] : sphere_of_) {
        const Pair pair{std::min(sphere_a, sphere_b), std::max(sphere_a, sphere_b)};
        if (a >= b || !is_wanted(pair) || (but_layers && are_layers(a, b)) || at_rest_.count({a, b}) != 0 ||
            are_neighbours(a, b))
          continue;
        const TriangleCorners p = corners_of(a), q = corners_of(b);
        if (!triangles_intersect(p, q)) continue;
        const std::uint32_t part_a = tiny_.part_of_triangle[a], part_b = tiny_.part_of_triangle[b];
        const Segment segment = crossing_segment(p, q);
        out.triangles.push_back({a, b, sphere_a, sphere_b, part_a, part_b, segment.from, segment.to});
        spheres.insert(pair);
        const Pair of_parts{std::min(part_a, part_b), std::max(part_a, part_b)};
        const auto added = parts.try_emplace(of_parts, PartContact{of_parts.a, of_parts.b, 0, p.p[0], p.p[0]});
        PartContact& contact = added.first->second;
        ++contact.triangle_pairs;
        for (const TriangleCorners* corners : {&p, &q}) {
          for (const Vec3& v : corners->p) {
            contact.low = {std::min(contact.low.x, v.x), std::min(contact.low.y, v.y), std::min(contact.low.z, v.z)};
            contact.high = {std::max(contact.high.x, v.x), std::max(contact.high.y, v.y),
                            std::max(contact.high.z, v.z)};
          }
        }
      }
    }
    out.spheres.assign(spheres.begin(), spheres.end());
    for (const auto& [pair, contact] : parts) out.parts.push_back(contact);
    return out;
  }

  SkinContacts find(Scope scope, const std::set<Pair>& ignored) const {
    return find(
        [&](const Pair& pair) {
          const bool is_apart = pair.a != pair.b && ignored.count(pair) == 0;
          return scope == SC_SCOPE_ALL || is_apart == (scope != SC_SCOPE_NEIGHBOURS);
        },
        scope == SC_SCOPE_APART);
  }
  SkinContacts find(Scope scope) const { return find(scope, {tiny_.ignored_pairs.begin(), tiny_.ignored_pairs.end()}); }

 private:
  Vec3 place(const std::vector<float>& from, std::uint32_t v) const {
    return {from[3 * v], from[3 * v + 1], from[3 * v + 2]};
  }
  TriangleCorners corners_of(std::uint32_t t) const {
    const auto& c = tiny_.corners[t];
    return {{place(positions_, c[0]), place(positions_, c[1]), place(positions_, c[2])}};
  }
  bool are_layers(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t p = cluster_of_.at(a), q = cluster_of_.at(b);
    const std::vector<PackedCluster>& clusters = tiny_.parts.skin.clusters;
    return clusters[p].is_buried != 0 || clusters[q].is_buried != 0 ||
           layers_.count({std::min(p, q), std::max(p, q)}) != 0;
  }
  // Do they share a position at rest?
  bool are_neighbours(std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t v : tiny_.corners[a]) {
      for (const std::uint32_t w : tiny_.corners[b]) {
        const Vec3 p = place(tiny_.rest, v), q = place(tiny_.rest, w);
        if (p.x == q.x && p.y == q.y && p.z == q.z) return true;
      }
    }
    return false;
  }

  const TinyAsset& tiny_;
  const std::vector<float>& positions_;
  std::map<std::uint32_t, std::uint32_t> sphere_of_;
  std::map<std::uint32_t, std::uint32_t> cluster_of_;
  std::set<Pair> at_rest_, layers_;
};

constexpr Scope kScopes[] = {SC_SCOPE_APART, SC_SCOPE_NEIGHBOURS, SC_SCOPE_ALL, SC_SCOPE_LAYERS};

SkinContactJob job_of(const OpenedAsset& opened, Scope scope = SC_SCOPE_APART) {
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  SkinContactJob job;
  job.asset = &opened.asset;
  job.scope = scope;
  return job;
}

void give_vertices(Pose& pose, const std::vector<float>& vertices) {
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
}

void check_same(const SkinContacts& found, const SkinContacts& expected) {
  CHECK(found.status == SC_OK);
  CHECK(same_bits(found.parts, expected.parts));
  CHECK(same_bits(found.spheres, expected.spheres));
  CHECK(same_bits(found.triangles, expected.triangles));
}

// The job's answers with all lists, and with spheres alone.
void check_job(SkinContactJob job, const SkinContacts& expected) {
  for (const Target target : supported_targets()) {
    INFO(std::string(sc_target_name(target)));
    job.target = target;
    check_same(find_contacts(job), expected);
    job.spheres_only = 1;
    const SkinContacts spheres = find_contacts(job);
    CHECK(spheres.status == SC_OK);
    CHECK(spheres.spheres == expected.spheres);
    job.spheres_only = 0;
  }
}

// Some move all bones alike, and some of those stretch along the axes alone.
std::vector<Matrix> pose_number(int number, std::mt19937& random) {
  const PoseKind kind = kPoseKinds[static_cast<std::size_t>(number) % std::size(kPoseKinds)];
  if (number % 5 < 3) return random_pose(kBones, kind, 1.0F, random);
  return std::vector<Matrix>(kBones, random_pose(1, kind, 1.0F, random)[0]);
}

}  // namespace

TEST_CASE("contacts are a plain loop's, from vertices, from bones and from both, in every scope") {
  std::size_t total = 0, pairs_of_parts = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Posable p(seed, seed % 3 != 0);
    const OpenedAsset opened(p.tiny.parts);
    std::mt19937 random(seed);
    for (int number = 0; number < 12; ++number) {
      CAPTURE(seed);
      CAPTURE(number);
      const std::vector<Matrix> matrices = pose_number(number, random);
      const std::vector<float> weights = number % 2 == 0 ? std::vector<float>() : random_morph_weights(kMorphs, random);
      Pose from_bones = pose_of(matrices, weights);
      // The bits that the job skins by; each source vertex of a packed one.
      std::vector<float> vertices = skinned(p.tiny, p.skin, matrices, weights);
      const std::vector<float> own = skin(opened.asset, from_bones);
      const Numbers& sources = p.tiny.parts.skin.sources;
      for (const std::uint32_t v : sources) std::copy_n(&own[3 * v], 3, &vertices[3 * v]);
      for (std::uint32_t v = 0; v < p.tiny.parts.vertex_count; ++v) {
        for (std::uint32_t w = 0; w < v; ++w) {
          const bool is_twin = std::equal(&p.tiny.rest[3 * v], &p.tiny.rest[3 * v] + 3, &p.tiny.rest[3 * w]) &&
                               p.skin.weights[v] == p.skin.weights[w] && p.skin.morphs[v] == p.skin.morphs[w];
          if (is_twin) std::copy_n(&vertices[3 * w], 3, &vertices[3 * v]);
        }
      }
      Pose from_vertices, from_both = from_bones;
      give_vertices(from_vertices, vertices);
      give_vertices(from_both, vertices);
      for (const Scope scope : kScopes) {
        const SkinContacts expected = PlainContacts(p.tiny, vertices).find(scope);
        total += expected.triangles.size();
        pairs_of_parts += expected.parts.size();
        SkinContactJob job = job_of(opened, scope);
        for (const Pose& pose : {from_vertices, from_bones, from_both}) {
          job.pose = pose;
          check_job(job, expected);
        }
      }
    }
  }
  CHECK(total > 10000);
  CHECK(pairs_of_parts > 1000);
}

TEST_CASE("a skin that nothing moves has contacts from vertices") {
  TinyAsset tiny = random_band(9, 4);
  add_skin(tiny, nullptr, 3);
  const OpenedAsset opened(tiny.parts);
  for (const Scope scope : kScopes) {
    SkinContactJob job = job_of(opened, scope);
    give_vertices(job.pose, tiny.rest);
    check_job(job, PlainContacts(tiny, tiny.rest).find(scope));
  }
}

TEST_CASE("where corners fall together, or floats run out, contacts are those of the triangles that are left") {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    const Posable p(seed, false);
    const OpenedAsset opened(p.tiny.parts);
    for (const unsigned steps : {1U, 2U, 3U, 5U, 101U}) {  // places along an axis
      for (const float origin : {0.0F, 1e9F}) {
        CAPTURE(steps);
        CAPTURE(origin);
        std::vector<float> vertices(p.tiny.rest.size());
        for (float& figure : vertices) figure = origin + 64 * static_cast<float>(random() % steps);
        for (const Scope scope : kScopes) {
          const SkinContacts expected = PlainContacts(p.tiny, vertices).find(scope);
          CHECK((steps == 1) <= expected.triangles.empty());
          total += expected.triangles.size();
          SkinContactJob job = job_of(opened, scope);
          give_vertices(job.pose, vertices);
          check_job(job, expected);
        }
      }
    }
  }
  CHECK(total > 1000);
}

TEST_CASE("contacts are the same from vertices and from bones at any size that floats have") {
  std::size_t total = 0;
  const Posable p(1);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(1);
  for (const float size : {1e-35F, 1e-25F, 1e-18F, 1e-9F, 1e9F, 1e17F, 1e19F, 1e25F, 1e33F}) {
    for (int number = 0; number < 6; ++number) {
      CAPTURE(size);
      std::vector<Matrix> matrices = pose_number(number, random);
      for (Matrix& matrix : matrices) {
        for (float& element : matrix) element *= size;
      }
      SkinContactJob job = job_of(opened);
      job.pose = pose_of(matrices);
      // Vertices that no packed one stands for are their twins', which the job does not read.
      std::vector<float> vertices = skin(opened.asset, job.pose);
      for (float& figure : vertices) figure = figure == figure ? figure : 0;
      SkinContactJob from_vertices = job_of(opened);
      give_vertices(from_vertices.pose, vertices);
      from_vertices.target = SC_TARGET_SCALAR;
      const SkinContacts expected = find_contacts(from_vertices);
      total += expected.triangles.size();
      check_job(job, expected);
    }
  }
  CHECK(total > 1000);
}

TEST_CASE("a filter's ignored pairs stand for the asset's") {
  const Posable p(2);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(2);
  const std::vector<float> vertices = skinned(p.tiny, p.skin, random_pose(kBones, PoseKind::kGentle, 1, random), {});
  OwnedFilter owned(opened.asset);
  std::set<Pair> ignored(p.tiny.ignored_pairs.begin(), p.tiny.ignored_pairs.end());
  for (std::uint32_t b = 1; b < 11; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      if (random() % 3 != 0) continue;
      const bool on = random() % 2 == 0;
      owned.ignore(a, b, on);
      on ? (void)ignored.insert({a, b}) : (void)ignored.erase({a, b});
    }
  }
  for (const Scope scope : kScopes) {
    SkinContactJob job = job_of(opened, scope);
    give_vertices(job.pose, vertices);
    job.filter = &owned.filter;
    const SkinContacts expected = PlainContacts(p.tiny, vertices).find(scope, ignored);
    CHECK(!expected.triangles.empty());
    check_job(job, expected);
  }
}

TEST_CASE("with candidates a job finds contacts of those pairs of spheres alone, ignored or not") {
  const Posable p(3);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(3);
  const std::vector<Matrix> matrices = random_pose(kBones, PoseKind::kGentle, 1, random);
  const std::vector<float> vertices = skinned(p.tiny, p.skin, matrices, {});
  for (const unsigned share : {1U, 2U, 4U, 1000U}) {
    std::vector<Pair> candidates;
    for (std::uint32_t a = 0; a < 11; ++a) {
      for (std::uint32_t b = a; b < 11; ++b) {
        if (random() % share == 0) candidates.push_back({a, b});
      }
    }
    candidates.reserve(1);  // so that no candidates are no null
    SkinContactJob job = job_of(opened);
    give_vertices(job.pose, vertices);
    job.candidates = candidates.data();
    job.candidate_count = candidates.size();
    const SkinContacts expected =
        PlainContacts(p.tiny, vertices)
            .find([&](const Pair& pair) { return std::binary_search(candidates.begin(), candidates.end(), pair); },
                  true);
    CHECK((share < 1000) == !expected.triangles.empty());
    check_job(job, expected);
  }
}

TEST_CASE("a list that is too small gets its first entries, and the status names it") {
  const Posable p(4);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices = random_pose(kBones, PoseKind::kGentle, 1, random);
  SkinContactJob job = job_of(opened, SC_SCOPE_ALL);
  job.pose = pose_of(matrices);
  const SkinContacts all = find_contacts(job);
  REQUIRE(all.triangles.size() > 40);
  REQUIRE(all.spheres.size() > 4);
  REQUIRE(all.parts.size() > 4);
  const PreparedSkin table(opened.asset);
  std::vector<std::uint64_t> scratch(skin_scratch_words(&opened.asset));
  job.skin_table = table.words.data();
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  const auto check = [&](auto list, auto ContactJob::*data, std::size_t ContactJob::*capacity, sc_field field) {
    for (const std::size_t room : {std::size_t{1}, std::size_t{3}, list.size() - 1}) {
      auto found = list;
      found.resize(room);
      SkinContactJob small = job;
      small.*data = found.data();
      small.*capacity = room;
      CHECK(small.run() == sc_status{SC_OVERFLOW, field});
      CHECK(small.part_count == all.parts.size());
      CHECK(small.sphere_count == all.spheres.size());
      CHECK(small.triangle_count == all.triangles.size());
      list.resize(std::max(list.size(), room));
      auto first = list;
      first.resize(room);
      CHECK(same_bits(found, first));
    }
  };
  check(all.parts, &SkinContactJob::parts, &SkinContactJob::part_capacity, SC_FIELD_PARTS);
  check(all.spheres, &SkinContactJob::spheres, &SkinContactJob::sphere_capacity, SC_FIELD_SPHERES);
  check(all.triangles, &SkinContactJob::triangles, &SkinContactJob::triangle_capacity, SC_FIELD_TRIANGLES);
}

TEST_CASE("a triangle with a corner that is not finite intersects nothing") {
  const Posable p(5, false);  // of vertices that no two triangles share
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(5);
  std::vector<float> vertices(p.tiny.rest.size());
  for (float& figure : vertices) figure = uniform(random, -1, 1);
  const std::size_t before = PlainContacts(p.tiny, vertices).find(SC_SCOPE_ALL).triangles.size();
  const float odd[] = {kNan, kInfinity, -kInfinity};
  for (std::size_t i = 0; i < 12; ++i) vertices[random() % vertices.size()] = odd[i % 3];
  const SkinContacts expected = PlainContacts(p.tiny, vertices).find(SC_SCOPE_ALL);
  CHECK(!expected.triangles.empty());
  CHECK(expected.triangles.size() < before);
  SkinContactJob job = job_of(opened, SC_SCOPE_ALL);
  give_vertices(job.pose, vertices);
  check_job(job, expected);
}

}  // namespace spherechain::test
