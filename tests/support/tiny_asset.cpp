// SPDX-License-Identifier: MIT
#include "tiny_asset.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "sphere_chains_generated.h"

namespace spherechain::test {
namespace {

namespace fb = flatbuffers;

schema::Vec3 stored(const Vec3& v) { return {v.x, v.y, v.z}; }
schema::Outline stored(const Outline& o) {
  return {o.first_leaf,  o.first_bone,     o.first_point, o.first_weight, o.bone_count,
          o.point_count, stored(o.center), o.radius,      o.slack};
}
schema::OutlineBone stored(const OutlineBone& b) { return {b.bone, b.x, b.y, b.z, b.w}; }
schema::FitError stored(const FitError& e) { return {e.mean_abs_f, e.max_abs_f}; }
schema::Pivot stored(const Pivot& p) { return {p.a, p.b, p.c, p.weight}; }
schema::SourcePart stored(const SourcePart& p) { return {p.mesh, p.primitive, p.first_vertex, p.vertex_count, p.hash}; }
schema::NearPair stored(const NearPair& p) { return {p.a, p.b, p.reach}; }
schema::Sphere stored(const RestSphere& s) {
  return {stored(s.center), s.radius,         s.detect_radius, s.pivot_spread, s.first_pivot,
          s.first_triangle, s.triangle_count, s.pivot_count,   s.region,       static_cast<schema::Side>(s.side),
          s.level,          s.reserved};
}

fb::span<const float, kPivotLanes> lanes(const float (&values)[kPivotLanes]) {
  return fb::span<const float, kPivotLanes>(values, kPivotLanes);
}
schema::Lanes stored(const PivotLanes& l) { return schema::Lanes(lanes(l.values)); }
schema::BoneTerm stored(const BoneTerm& t) { return {lanes(t.x), lanes(t.y), lanes(t.z), lanes(t.w)}; }
schema::MorphTerm stored(const MorphTerm& t) { return {lanes(t.x), lanes(t.y), lanes(t.z)}; }

schema::MomentBatch stored(const MomentBatch& b) { return {b.pair_count, b.sphere_count}; }
schema::BonePair stored(const BonePair& p) { return {p.a, p.b}; }
schema::CenterTerm stored(const CenterTerm& t) { return {t.x, t.y, t.z, t.w}; }
schema::Moment stored(const Moment& m) {
  return schema::Moment(fb::span<const float, kMomentSize>(m.values, kMomentSize));
}

schema::Leaf stored(const Leaf& l) {
  return {l.sphere,      l.first_triangle, l.first_vertex,   l.first_bone,   l.first_slot, l.first_weight,
          l.first_morph, l.morph_count,    l.triangle_count, l.vertex_count, l.bone_count, l.reserved};
}
schema::BallLanes stored(const BallLanes& b) { return {lanes(b.x), lanes(b.y), lanes(b.z), lanes(b.radius)}; }
schema::BoxLanes stored(const BoxLanes& b) {
  return {lanes(b.x), lanes(b.y), lanes(b.z), lanes(b.half_x), lanes(b.half_y), lanes(b.half_z), lanes(b.radius)};
}
schema::CoverTerm stored(const CoverTerm& t) { return {lanes(t.weights), lanes(t.deviations)}; }
schema::SlotMorph stored(const SlotMorph& m) { return {m.target, m.slot, stored(m.delta)}; }
schema::TrianglePair stored(const TrianglePair& p) { return {p.a, p.b}; }

template <typename Stored, typename View>
auto struct_vector(fb::FlatBufferBuilder& builder, const std::vector<View>& views) {
  std::vector<Stored> values;
  for (const View& view : views) {
    values.push_back(stored(view));
  }
  return builder.CreateVectorOfStructs(values);
}

fb::Offset<schema::Frame> build_frame(fb::FlatBufferBuilder& builder, const AssetParts& parts) {
  const auto origin = stored(parts.origin), left = stored(parts.left), up = stored(parts.up);
  const auto forward = stored(parts.forward);
  const auto unless = [&](const char* name, const schema::Vec3& v) { return parts.without == name ? nullptr : &v; };
  return schema::CreateFrame(builder, unless("frame.origin", origin), unless("frame.left", left),
                             unless("frame.up", up), unless("frame.forward", forward), parts.height);
}

fb::Offset<schema::Fit> build_fit(fb::FlatBufferBuilder& builder, const AssetParts& parts) {
  const auto phi1 = stored(parts.phi1), adjusted = stored(parts.phi1_adjusted), phi2 = stored(parts.phi2);
  const auto unless = [&](const char* name, const schema::FitError& e) { return parts.without == name ? nullptr : &e; };
  return schema::CreateFit(builder, unless("fit.phi1", phi1), unless("fit.phi1_adjusted", adjusted),
                           unless("fit.phi2", phi2));
}

auto build_chains(fb::FlatBufferBuilder& builder, const AssetParts& parts) {
  std::vector<fb::Offset<schema::Chain>> chains;
  fb::Offset<fb::Vector<std::uint32_t>> spheres;
  for (const ChainParts& chain : parts.chains) {
    const auto name = builder.CreateString(chain.name);
    const auto regions = builder.CreateVector(chain.regions);
    if (spheres.IsNull() || !parts.chains_share_array) {
      spheres = builder.CreateVector(chain.spheres);
    }
    chains.push_back(schema::CreateChain(builder, name, regions, spheres));
  }
  return builder.CreateVector(chains);
}

auto build_joints(fb::FlatBufferBuilder& builder, const AssetParts& parts) {
  std::vector<fb::Offset<schema::Joint>> joints;
  for (const JointParts& joint : parts.joints) {
    const auto position = stored(joint.position), tail = stored(joint.tail);
    joints.push_back(schema::CreateJoint(builder, builder.CreateString(joint.name), joint.parent,
                                         parts.without == "joints.position" ? nullptr : &position,
                                         parts.without == "joints.tail" ? nullptr : &tail));
  }
  return builder.CreateVector(joints);
}

fb::Offset<schema::Moments> build_moments(fb::FlatBufferBuilder& builder, const AssetParts& parts) {
  const MomentParts& in = parts.bone_refit.moments;
  if (in.batches.empty()) {
    return 0;
  }
  const schema::Vec3 origin = stored(in.origin);
  const auto batches = struct_vector<schema::MomentBatch>(builder, in.batches);
  const auto pairs = struct_vector<schema::BonePair>(builder, in.pairs);
  const auto spheres = builder.CreateVector(in.spheres);
  const auto bone_counts = builder.CreateVector(in.bone_counts);
  const auto bones = builder.CreateVector(in.bones);
  const auto centers = struct_vector<schema::CenterTerm>(builder, in.centers);
  const auto pair_places = builder.CreateVector(in.pair_places);
  const auto moments = struct_vector<schema::Moment>(builder, in.moments);
  return schema::CreateMoments(builder, parts.without == "moments.origin" ? nullptr : &origin, in.reference, batches,
                               pairs, spheres, bone_counts, bones, centers, pair_places, moments);
}

fb::Offset<schema::BoneRefit> build_bone_refit(fb::FlatBufferBuilder& builder, const AssetParts& parts) {
  const BoneRefitParts& in = parts.bone_refit;
  if (in.weights.empty() && in.bones.empty()) {
    return 0;
  }
  std::vector<fb::Offset<schema::Bone>> bones;
  for (const BoneParts& bone : in.bones) {
    const schema::Matrix matrix(fb::span<const float, 12>(bone.inverse_bind.data(), 12));
    bones.push_back(schema::CreateBone(builder, builder.CreateString(bone.name),
                                       parts.without == "inverse_bind" ? nullptr : &matrix, bone.is_rest));
  }
  const auto bone_vector = builder.CreateVector(bones);
  const auto morphs = builder.CreateVectorOfStrings(in.morphs);
  const auto weights = struct_vector<schema::Lanes>(builder, in.weights);
  const auto term_counts = builder.CreateVector(in.term_counts);
  const auto term_bones = builder.CreateVector(in.term_bones);
  const auto terms = struct_vector<schema::BoneTerm>(builder, in.terms);
  const auto morph_term_counts = builder.CreateVector(in.morph_term_counts);
  const auto morph_targets = builder.CreateVector(in.morph_targets);
  const auto morph_terms = struct_vector<schema::MorphTerm>(builder, in.morph_terms);
  const auto moments = build_moments(builder, parts);
  return schema::CreateBoneRefit(builder, bone_vector, morphs, weights, term_counts, term_bones, terms,
                                 morph_term_counts, morph_targets, morph_terms, moments);
}

fb::Offset<schema::Surface> build_surface(fb::FlatBufferBuilder& builder, const SurfaceParts& in) {
  if (in.leaves.empty()) {
    return 0;
  }
  const auto leaves = struct_vector<schema::Leaf>(builder, in.leaves);
  const auto balls = struct_vector<schema::BallLanes>(builder, in.leaf_balls);
  const auto leaf_vertices = builder.CreateVector(in.leaf_vertices);
  const auto leaf_bones = builder.CreateVector(in.leaf_bones);
  const auto corners = builder.CreateVector(in.corners);
  const auto source_vertices = builder.CreateVector(in.source_vertices);
  const auto welds = builder.CreateVector(in.welds);
  const auto positions = builder.CreateVector(in.slot_positions);
  const auto weights = builder.CreateVector(in.slot_weights);
  const auto morphs = struct_vector<schema::SlotMorph>(builder, in.slot_morphs);
  const auto term_counts = builder.CreateVector(in.cover_term_counts);
  const auto term_bones = builder.CreateVector(in.cover_term_bones);
  const auto terms = struct_vector<schema::CoverTerm>(builder, in.cover_terms);
  const auto morph_counts = builder.CreateVector(in.cover_morph_counts);
  const auto morph_targets = builder.CreateVector(in.cover_morph_targets);
  const auto cover_morphs = struct_vector<schema::BallLanes>(builder, in.cover_morphs);
  const auto rest_contacts = struct_vector<schema::TrianglePair>(builder, in.rest_contacts);
  using Boxes = fb::Offset<fb::Vector<const schema::BoxLanes*>>;
  const Boxes boxes = in.leaf_boxes.empty() ? Boxes() : struct_vector<schema::BoxLanes>(builder, in.leaf_boxes);
  fb::Offset<fb::Vector<const schema::Outline*>> outlines;
  fb::Offset<fb::Vector<const schema::OutlineBone*>> outline_bones;
  fb::Offset<fb::Vector<float>> outline_points, outline_weights;
  if (!in.outlines.empty()) {
    outlines = struct_vector<schema::Outline>(builder, in.outlines);
    outline_bones = struct_vector<schema::OutlineBone>(builder, in.outline_bones);
    outline_points = builder.CreateVector(in.outline_points);
    outline_weights = builder.CreateVector(in.outline_weights);
  }
  return schema::CreateSurface(builder, leaves, balls, leaf_vertices, leaf_bones, corners, source_vertices, welds,
                               positions, weights, morphs, term_counts, term_bones, terms, morph_counts, morph_targets,
                               cover_morphs, rest_contacts, boxes, outlines, outline_bones, outline_points,
                               outline_weights);
}

}  // namespace

std::vector<std::uint8_t> build(const AssetParts& parts) {
  fb::FlatBufferBuilder builder;
  std::vector<fb::Offset<schema::Region>> regions;
  for (const RegionParts& region : parts.regions) {
    regions.push_back(schema::CreateRegion(builder, builder.CreateString(region.name), region.triangle_count));
  }
  const auto provenance = schema::CreateProvenanceDirect(builder, parts.writer.c_str(), parts.settings.c_str(),
                                                         parts.settings_sha256.c_str());
  const auto source_file = builder.CreateString(parts.source_file);
  const auto source_sha256 = builder.CreateString(parts.source_sha256);
  using Parts = fb::Offset<fb::Vector<const schema::SourcePart*>>;
  const Parts source_parts =
      parts.source_parts.empty() ? Parts() : struct_vector<schema::SourcePart>(builder, parts.source_parts);
  const auto source = schema::CreateSource(builder, source_file, source_sha256, parts.vertex_count,
                                           parts.triangle_count, parts.rest_hash, parts.metres_per_unit, source_parts);
  const auto frame = build_frame(builder, parts);
  const auto fit = build_fit(builder, parts);
  const auto region_vector = builder.CreateVector(regions);
  const auto spheres = struct_vector<schema::Sphere>(builder, parts.spheres);
  const auto pivots = struct_vector<schema::Pivot>(builder, parts.pivots);
  const auto triangles = builder.CreateVector(parts.triangles);
  const auto chains = build_chains(builder, parts);
  const auto ignored = builder.CreateVector(parts.ignored);
  const auto near_fit = struct_vector<schema::NearPair>(builder, parts.near_fit);
  const auto near_detect = struct_vector<schema::NearPair>(builder, parts.near_detect);
  using Joints = decltype(build_joints(builder, parts));
  const Joints joints = parts.joints.empty() ? Joints() : build_joints(builder, parts);
  using Indices = fb::Offset<fb::Vector<std::uint32_t>>;
  const Indices pivot_vertices = parts.pivot_vertices.empty() || parts.without == "pivot_vertices"
                                     ? Indices()
                                     : builder.CreateVector(parts.pivot_vertices);
  using Pivots = fb::Offset<fb::Vector<const schema::Pivot*>>;
  const Pivots packed = parts.pivot_vertices.empty() || parts.without == "packed_pivots"
                            ? Pivots()
                            : struct_vector<schema::Pivot>(builder, parts.packed_pivots);
  const auto bone_refit = build_bone_refit(builder, parts);
  const auto surface = build_surface(builder, parts.surface);
  schema::FinishAssetBuffer(
      builder, schema::CreateAsset(builder, parts.format_version, provenance, source, frame,
                                   static_cast<schema::Refit>(parts.refit), fit, region_vector, spheres, pivots,
                                   triangles, chains, parts.chain_entries_table1, ignored, near_fit, near_detect,
                                   joints, pivot_vertices, packed, bone_refit, surface));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random() >> 8) / 16777216.0F);
}

std::vector<Sphere> random_spheres(std::size_t count, std::mt19937& random) {
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    if (random() % 2 == 0) {
      const auto eighths = [&](unsigned below) { return static_cast<float>(random() % below) / 8.0F; };
      spheres.push_back({eighths(8), eighths(8), eighths(8), eighths(3)});
    } else {
      const auto any = [&] { return uniform(random, 0.0F, 1.0F); };
      spheres.push_back({any(), any(), any(), uniform(random, 0.01F, 0.25F)});
    }
  }
  return spheres;
}

namespace {

// Four small triangles round the centre, so that the mean of their centroids is the centre.
void add_pivots(TinyAsset& tiny, const Vec3& center, float spread) {
  constexpr std::array<Vec3, 4> kDirections{{{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}};
  constexpr std::array<Vec3, 3> kCorners{{{0.01F, 0.01F, 0}, {-0.01F, 0, 0.01F}, {0, -0.01F, -0.01F}}};
  for (const Vec3& direction : kDirections) {
    const auto first = static_cast<std::uint32_t>(tiny.rest.size() / 3);
    for (const Vec3& corner : kCorners) {
      tiny.rest.insert(tiny.rest.end(),
                       {center.x + spread * direction.x + corner.x, center.y + spread * direction.y + corner.y,
                        center.z + spread * direction.z + corner.z});
    }
    tiny.parts.pivots.push_back({first, first + 1, first + 2, 0.25F});
    tiny.parts.triangles.push_back(first / 3);
  }
}

void add_spheres(TinyAsset& tiny, std::size_t count, std::mt19937& random) {
  for (std::size_t i = 0; i < count; ++i) {
    RestSphere sphere{};
    sphere.center = {uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
    sphere.radius = uniform(random, 0.05F, 0.25F);
    sphere.detect_radius = sphere.radius * 1.25F;
    sphere.pivot_spread = sphere.radius * 0.75F;
    sphere.first_pivot = static_cast<std::uint32_t>(tiny.parts.pivots.size());
    sphere.first_triangle = static_cast<std::uint32_t>(tiny.parts.triangles.size());
    sphere.pivot_count = 4;
    sphere.triangle_count = 4;
    sphere.region = static_cast<std::uint8_t>(i % 5);
    sphere.side = i % 5 == 4 ? (i % 2 == 0 ? Side::kLeft : Side::kRight) : Side::kNone;
    sphere.level = i % 5 == 4 ? static_cast<std::int16_t>(i / 5) : std::int16_t{-1};
    add_pivots(tiny, sphere.center, sphere.pivot_spread);
    tiny.parts.spheres.push_back(sphere);
  }
  tiny.parts.vertex_count = static_cast<std::uint32_t>(tiny.rest.size() / 3);
  tiny.parts.triangle_count = tiny.parts.vertex_count / 3;
  tiny.parts.rest_hash = hash_positions(tiny.rest.data(), tiny.parts.vertex_count);
  // A buffer of four vertices, and one of the rest.
  const std::uint32_t rest = tiny.parts.vertex_count - 4;
  tiny.parts.source_parts = {{1, 0, 0, 4, hash_positions(tiny.rest.data(), 4)},
                             {0, 2, 4, rest, hash_positions(tiny.rest.data() + 12, rest)}};
}

void add_chains(AssetParts& parts, std::mt19937& random) {
  const std::size_t n = parts.spheres.size();
  for (unsigned c = 0; c < 4; ++c) {
    std::vector<std::uint32_t> members(n);
    std::iota(members.begin(), members.end(), 0U);
    for (std::size_t i = n; i > 1; --i) {
      std::swap(members[i - 1], members[random() % i]);
    }
    members.resize((n + 1) / 2);  // half of them, in no order: neither sorted nor disjoint from the other chains
    parts.chain_entries_table1 += static_cast<std::uint32_t>(members.size());
    parts.chains.push_back({"zeta" + std::to_string(c), {static_cast<std::uint8_t>(c % 4), 4}, members});
  }
}

void add_exceptions(TinyAsset& tiny, std::mt19937& random) {
  const auto n = static_cast<std::uint32_t>(tiny.parts.spheres.size());
  const std::size_t pairs = std::size_t{n} * (n - 1) / 2;
  tiny.parts.ignored.assign((pairs + 63) / 64, 0);
  std::size_t bit = 0;
  for (std::uint32_t b = 1; b < n; ++b) {
    for (std::uint32_t a = 0; a < b; ++a, ++bit) {
      if (random() % 5 == 0) {
        tiny.parts.ignored[bit / 64] |= std::uint64_t{1} << (bit % 64);
        tiny.ignored_pairs.push_back({a, b});
      }
    }
  }
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = a + 1; b < n; ++b) {
      if (random() % 5 == 0) {
        tiny.parts.near_fit.push_back({a, b, uniform(random, 0.3F, 1.0F)});
      }
      if (random() % 5 == 0) {
        tiny.parts.near_detect.push_back({a, b, uniform(random, 0.3F, 1.0F)});
      }
    }
  }
}

}  // namespace

TinyAsset random_asset(std::size_t sphere_count, unsigned seed) {
  std::mt19937 random(seed);
  TinyAsset tiny;
  for (const char* name : {"left_arm", "right_arm", "left_leg", "right_leg", "torso"}) {
    tiny.parts.regions.push_back({name, static_cast<std::uint32_t>(tiny.parts.regions.size() + 10)});
  }
  tiny.parts.joints = {{"hips", -1, {0, 1, 0}, {0, 1.25F, 0}},
                       {"spine", 0, {0, 1.25F, 0}, {0, 1.5F, 0}},
                       {"left_thigh", 0, {0.125F, 1, 0}, {0.125F, 0.5F, 0}}};
  add_spheres(tiny, sphere_count, random);
  add_chains(tiny.parts, random);
  add_exceptions(tiny, random);
  return tiny;
}

OpenedAsset::OpenedAsset(const AssetParts& parts) : bytes(build(parts)), message(160, '\0') {
  status = asset.open(bytes.data(), bytes.size(), message.data(), message.size());
  message.resize(message.find('\0'));
}

}  // namespace spherechain::test
