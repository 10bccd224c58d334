// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>

#include "baker/mesh/error.h"
#include "baker/os/sha256.h"
#include "baker/write/moment_tables.h"
#include "baker/write/schema_values.h"
#include "baker/write/skin_packing.h"
#include "baker/write/version.h"
#include "baker/write/write.h"
#include "runtime/src/asset/asset_view.h"
#include "sphere_chains_generated.h"

namespace spherechain::baker {
namespace {

static_assert(static_cast<int>(Side::kLeft) == static_cast<int>(schema::Side::left));
static_assert(static_cast<int>(Side::kRight) == static_cast<int>(schema::Side::right));
static_assert(static_cast<int>(RefitRule::kPaper) == static_cast<int>(schema::Refit::paper) &&
              static_cast<int>(RefitRule::kMoments) == static_cast<int>(schema::Refit::moments));

std::vector<std::uint32_t> triangle_counts(const AssetSource& in) {
  std::vector<std::uint32_t> out(in.spheres.spheres.size(), 0);
  for (const Cluster& cluster : in.clusters.clusters) {
    out[cluster.sphere] += static_cast<std::uint32_t>(cluster.triangles.size());
  }
  return out;
}

// The part that most of a sphere's triangles are of.
std::vector<std::uint8_t> main_parts_of(const AssetSource& in) {
  std::vector<std::map<std::uint8_t, std::size_t>> counts(in.spheres.spheres.size());
  for (const Cluster& cluster : in.clusters.clusters) {
    for (const Index t : cluster.triangles) {
      ++counts[cluster.sphere][in.parts.of_triangle[in.character.skin_source_triangle[t]]];
    }
  }
  std::vector<std::uint8_t> out;
  for (const auto& of_sphere : counts) {
    const auto most = std::ranges::max_element(of_sphere, {}, [](const auto& of_part) { return of_part.second; });
    out.push_back(most == of_sphere.end() ? std::uint8_t{0} : most->first);
  }
  return out;
}

void add_spheres(const AssetSource& in, const std::vector<std::uint32_t>& triangle_counts,
                 std::vector<schema::Sphere>& spheres, std::vector<schema::Pivot>& pivots) {
  const std::vector<std::uint8_t> main_parts = main_parts_of(in);
  for (std::size_t i = 0; i < in.spheres.spheres.size(); ++i) {
    const FittedSphere& fitted = in.spheres.spheres[i];
    const BoundSphere& bound = in.binding.spheres[i];
    spheres.emplace_back(
        to_schema(bound.rest.center), static_cast<float>(bound.rest.radius), static_cast<float>(bound.detect_radius),
        static_cast<float>(bound.spread), static_cast<std::uint32_t>(pivots.size()), triangle_counts[i],
        static_cast<std::uint16_t>(bound.pivots.size()), fitted.region, static_cast<schema::Side>(fitted.side),
        static_cast<std::int16_t>(fitted.level), main_parts[i], std::uint8_t{0});
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

std::vector<schema::RestPair> rest_pairs_of(const std::vector<BoundPair>& pairs) {
  std::vector<schema::RestPair> out;
  for (const BoundPair& pair : pairs) out.emplace_back(pair.a, pair.b, pair.rest_scale);
  return out;
}

// Over the spheres that have all three fits, the torso's: mean of mean |F|, largest |F|.
schema::FitError fit_error(const AssetSource& in, Ball TorsoFit::*which) {
  FError sum;
  for (const TorsoFit& fit : in.spheres.torso) {
    const FError error = f_error(fit.*which, in.regions.body.mesh, fit.vertices);
    sum.mean_abs += error.mean_abs / static_cast<double>(in.spheres.torso.size());
    sum.max_abs = std::max(sum.max_abs, error.max_abs);
  }
  return {static_cast<float>(sum.mean_abs), static_cast<float>(sum.max_abs)};
}

std::vector<std::uint8_t> bytes_of(const AssetSource& in) {
  flatbuffers::FlatBufferBuilder builder(1 << 20);
  const std::vector<std::uint32_t> counts = triangle_counts(in);
  std::vector<schema::Sphere> spheres;
  std::vector<schema::Pivot> pivots;
  add_spheres(in, counts, spheres, pivots);

  std::vector<flatbuffers::Offset<schema::Region>> regions;
  for (std::size_t r = 0; r < in.regions.count(); ++r) {
    std::uint32_t count = 0;
    for (const std::uint32_t i : in.spheres.of_region[r]) count += counts[i];
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
  std::vector<flatbuffers::Offset<schema::Part>> parts;
  for (const BodyPart& part : in.parts.parts) {
    parts.push_back(schema::CreatePartDirect(builder, part.name.c_str(), static_cast<schema::Side>(part.side),
                                             part.bone, part.parent, part.mobility));
  }
  const std::vector<flatbuffers::Offset<schema::Bone>> bones = create_bones(builder, in.bones);
  const auto moments = create_moments(builder, in.moments);
  const auto skin =
      create_skin(builder, in.character, in.bones, in.clusters, in.parts, in.layers, in.spheres.spheres.size());
  const std::vector<std::uint64_t> ignored = ignored_bits(in);
  const std::vector<schema::RestPair> rest_fit = rest_pairs_of(in.binding.rest_fit),
                                      rest_detect = rest_pairs_of(in.binding.rest_detect);

  const std::string writer = std::string("spherechain ") + kVersion, settings_hash = sha256_of_text(in.settings);
  const auto provenance =
      schema::CreateProvenanceDirect(builder, writer.c_str(), in.settings.c_str(), settings_hash.c_str());
  std::vector<schema::SourceBuffer> buffers;
  for (const SourceBuffer& buffer : in.character.buffers) {
    buffers.emplace_back(buffer.mesh, buffer.primitive, buffer.first_vertex, buffer.vertex_count, buffer.hash);
  }
  const auto source = schema::CreateSourceDirect(
      builder, in.character.file.c_str(), in.character.sha256.c_str(),
      static_cast<std::uint32_t>(in.character.source_positions.size()),
      static_cast<std::uint32_t>(in.character.source_triangles.size()),
      sc_hash_positions(pack(in.character.source_positions).data(), in.character.source_positions.size(), 12),
      static_cast<float>(in.character.metres_per_unit), &buffers);
  const BodyFrame& f = in.regions.frame;
  const schema::Vec3 origin = to_schema(f.origin), left = to_schema(f.left), up = to_schema(f.up),
                     forward = to_schema(f.forward);
  const auto frame = schema::CreateFrame(builder, &origin, &left, &up, &forward, static_cast<float>(f.height));
  const schema::FitError phi1 = fit_error(in, &TorsoFit::phi1), adjusted = fit_error(in, &TorsoFit::phi1_adjusted),
                         phi2 = fit_error(in, &TorsoFit::phi2);
  const auto fit = schema::CreateFit(builder, &phi1, &adjusted, &phi2);

  const auto morphs = builder.CreateVectorOfStrings(in.bones.morphs);
  const auto regions_at = builder.CreateVector(regions);
  const auto parts_at = builder.CreateVector(parts);
  const auto spheres_at = builder.CreateVectorOfStructs(spheres);
  const auto pivots_at = builder.CreateVectorOfStructs(pivots);
  const auto chains_at = builder.CreateVector(chains);
  const auto ignored_at = builder.CreateVector(ignored);
  const auto rest_fit_at = builder.CreateVectorOfStructs(rest_fit);
  const auto rest_detect_at = builder.CreateVectorOfStructs(rest_detect);
  const auto joints_at = builder.CreateVector(joints);
  const auto bones_at = builder.CreateVector(bones);
  builder.Finish(schema::CreateAsset(builder, kFormatVersion, provenance, source, frame,
                                     static_cast<schema::Refit>(in.binding.rule), fit, regions_at, parts_at, spheres_at,
                                     pivots_at, chains_at, ignored_at, rest_fit_at, rest_detect_at, joints_at, bones_at,
                                     morphs, moments, skin),
                 schema::AssetIdentifier());
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

}  // namespace

std::vector<std::uint8_t> serialize(const AssetSource& in) {
  std::vector<std::uint8_t> bytes = bytes_of(in);
  sc_asset check;
  char message[256];
  if (sc_asset_open(&check, SC_ABI_VERSION, bytes.data(), bytes.size(), message, sizeof(message)) != SC_OK) {
    throw Error(ExitCode::kInternal, in.character.file + ": the baked asset does not open: " + message);
  }
  return bytes;
}

}  // namespace spherechain::baker
