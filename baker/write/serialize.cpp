// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "import/sha256.h"
#include "mesh/error.h"
#include "sphere_chains_generated.h"
#include "spherechain/asset.h"
#include "write/bone_tables.h"
#include "write/rest_contacts.h"
#include "write/schema_values.h"
#include "write/surface_table.h"
#include "write/version.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

static_assert(static_cast<int>(Side::kLeft) == static_cast<int>(schema::Side::left));
static_assert(static_cast<int>(Side::kRight) == static_cast<int>(schema::Side::right));
static_assert(static_cast<int>(RefitRule::kPaper) == static_cast<int>(schema::Refit::paper) &&
              static_cast<int>(RefitRule::kCalibrated) == static_cast<int>(schema::Refit::calibrated) &&
              static_cast<int>(RefitRule::kMoments) == static_cast<int>(schema::Refit::moments));

// Source triangles grouped by sphere, in it by leaf, and in source order within a leaf.
struct SurroundingTriangles {
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> first, count;
};

SurroundingTriangles group_triangles(const AssetSource& in) {
  SurroundingTriangles out;
  auto leaf = in.clusters.clusters.begin();
  for (std::uint32_t s = 0; s < in.spheres.spheres.size(); ++s) {
    out.first.push_back(static_cast<std::uint32_t>(out.triangles.size()));
    for (; leaf != in.clusters.clusters.end() && leaf->sphere == s; ++leaf) {
      for (const Index t : leaf->triangles) out.triangles.push_back(in.character.skin_source_triangle[t]);
    }
    out.count.push_back(static_cast<std::uint32_t>(out.triangles.size()) - out.first.back());
  }
  return out;
}

void add_spheres(const AssetSource& in, const SurroundingTriangles& triangles, std::vector<schema::Sphere>& spheres,
                 std::vector<schema::Pivot>& pivots) {
  for (std::size_t i = 0; i < in.spheres.spheres.size(); ++i) {
    const FittedSphere& fitted = in.spheres.spheres[i];
    const BoundSphere& bound = in.binding.spheres[i];
    spheres.emplace_back(
        to_schema(bound.rest.center), static_cast<float>(bound.rest.radius), static_cast<float>(bound.detect_radius),
        static_cast<float>(bound.spread), static_cast<std::uint32_t>(pivots.size()), triangles.first[i],
        triangles.count[i], static_cast<std::uint16_t>(bound.pivots.size()), fitted.region,
        static_cast<schema::Side>(fitted.side), static_cast<std::int16_t>(fitted.level), std::uint16_t{0});
    for (const BoundPivot& pivot : bound.pivots) {
      const Triangle& corners = in.character.source_triangles[in.character.skin_source_triangle[pivot.triangle]];
      pivots.emplace_back(corners[0], corners[1], corners[2], static_cast<float>(pivot.weight));
    }
  }
}

std::vector<std::uint64_t> ignored_bits(const AssetSource& in) {
  const std::size_t n = in.spheres.spheres.size();
  std::vector<std::uint64_t> words((n * (n - 1) / 2 + 63) / 64, 0);
  for (const auto& [a, b] : in.binding.ignored) {
    const std::size_t bit = std::size_t{b} * (b - 1) / 2 + a;
    words[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  return words;
}

std::vector<schema::NearPair> near_pairs_of(const std::vector<BoundPair>& pairs) {
  std::vector<schema::NearPair> out;
  for (const BoundPair& pair : pairs) out.emplace_back(pair.a, pair.b, static_cast<float>(pair.reach));
  return out;
}

// Over the spheres that have all three fits, the torso's: mean of mean |F|, largest |F|.
schema::FitError fit_error(const AssetSource& in, Ball TorsoFit::*which) {
  FError sum;
  for (const TorsoFit& fit : in.spheres.torso) {
    const FError error = f_error(fit.*which, in.character.body, fit.vertices);
    sum.mean_abs += error.mean_abs / static_cast<double>(in.spheres.torso.size());
    sum.max_abs = std::max(sum.max_abs, error.max_abs);
  }
  return {static_cast<float>(sum.mean_abs), static_cast<float>(sum.max_abs)};
}

std::vector<std::uint8_t> bytes_of(const AssetSource& in, const std::vector<TrianglePair>& rest_contacts) {
  flatbuffers::FlatBufferBuilder builder(1 << 20);
  const SurroundingTriangles triangles = group_triangles(in);
  std::vector<schema::Sphere> spheres;
  std::vector<schema::Pivot> pivots;
  add_spheres(in, triangles, spheres, pivots);

  std::vector<flatbuffers::Offset<schema::Region>> regions;
  for (std::size_t r = 0; r < in.regions.count(); ++r) {
    std::uint32_t count = 0;
    for (const std::uint32_t i : in.spheres.of_region[r]) count += triangles.count[i];
    regions.push_back(schema::CreateRegionDirect(builder, in.regions.name(r).c_str(), count));
  }
  std::vector<flatbuffers::Offset<schema::Chain>> chains;
  for (const Chain& chain : in.chains.chains) {
    chains.push_back(schema::CreateChainDirect(builder, chain.name.c_str(), &chain.regions, &chain.spheres));
  }
  std::vector<flatbuffers::Offset<schema::Joint>> joints;
  for (const Joint& joint : in.joints) {
    const schema::Vec3 position = to_schema(joint.position), tail = to_schema(joint.tail);
    joints.push_back(schema::CreateJointDirect(builder, joint.name.c_str(), joint.parent, &position, &tail));
  }
  const PackedPivots packed = pack_pivots(pivots);
  const auto bone_refit = create_bone_refit(builder, in.bones, in.moments);
  const auto surface = create_surface(builder, in.character, in.bones, in.clusters, rest_contacts);
  const std::vector<std::uint64_t> ignored = ignored_bits(in);
  const std::vector<schema::NearPair> near_fit = near_pairs_of(in.binding.near_fit),
                                      near_detect = near_pairs_of(in.binding.near_detect);

  const std::string writer = std::string("spherechain ") + kVersion, settings_hash = sha256_of_text(in.settings);
  const auto provenance =
      schema::CreateProvenanceDirect(builder, writer.c_str(), in.settings.c_str(), settings_hash.c_str());
  std::vector<schema::SourcePart> parts;
  for (const SourcePart& part : in.character.parts) {
    parts.emplace_back(part.mesh, part.primitive, part.first_vertex, part.vertex_count, part.hash);
  }
  const auto source = schema::CreateSourceDirect(
      builder, in.character.file.c_str(), in.character.sha256.c_str(),
      static_cast<std::uint32_t>(in.character.source_positions.size()),
      static_cast<std::uint32_t>(in.character.source_triangles.size()),
      hash_positions(pack(in.character.source_positions).data(), in.character.source_positions.size()),
      static_cast<float>(in.character.metres_per_unit), &parts);
  const BodyFrame& f = in.regions.frame;
  const schema::Vec3 origin = to_schema(f.origin), left = to_schema(f.left), up = to_schema(f.up),
                     forward = to_schema(f.forward);
  const auto frame = schema::CreateFrame(builder, &origin, &left, &up, &forward, static_cast<float>(f.height));
  const schema::FitError phi1 = fit_error(in, &TorsoFit::phi1), adjusted = fit_error(in, &TorsoFit::phi1_adjusted),
                         phi2 = fit_error(in, &TorsoFit::phi2);
  const auto fit = schema::CreateFit(builder, &phi1, &adjusted, &phi2);

  builder.Finish(schema::CreateAssetDirect(
                     builder, kFormatVersion, provenance, source, frame, static_cast<schema::Refit>(in.binding.rule),
                     fit, &regions, &spheres, &pivots, &triangles.triangles, &chains,
                     static_cast<std::uint32_t>(in.chains.entries_table1), &ignored, &near_fit, &near_detect, &joints,
                     &packed.vertices, &packed.pivots, bone_refit, surface),
                 schema::AssetIdentifier());
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

}  // namespace

std::vector<std::uint8_t> serialize(const AssetSource& in) {
  std::vector<std::uint8_t> bytes = bytes_of(in, {});
  const std::vector<TrianglePair> rest_contacts = find_rest_contacts(bytes, pack(in.character.source_positions));
  if (!rest_contacts.empty()) bytes = bytes_of(in, rest_contacts);

  Asset check;
  char message[256];
  if (check.open(bytes.data(), bytes.size(), message, sizeof(message)) != Status::kOk) {
    throw Error(ExitCode::kInternal, in.character.file + ": the baked asset does not open: " + message);
  }
  return bytes;
}

}  // namespace spherechain::baker
