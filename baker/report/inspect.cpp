// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/report/parts.h"
#include "baker/report/piece_rows.h"
#include "baker/report/report.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

const char* side_name(std::uint8_t side) {
  return side == SC_SIDE_LEFT ? "left" : side == SC_SIDE_RIGHT ? "right" : "none";
}

std::size_t bits_in(Span<const std::uint64_t> words) {
  std::size_t count = 0;
  for (const std::uint64_t word : words) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

// Pairs of clusters that are layers of one place; the surface has each both ways.
std::size_t count_layers(const Surface& surface) {
  return bits_in({surface.layer_bits.data, surface.first_of_layers[surface.clusters.size]}) / 2;
}

std::size_t count_buried(const Surface& surface) { return bits_in({surface.buried.data, surface.buried.size}); }

std::size_t count_ignored(const OpenAsset& asset) { return bits_in(asset->ignored()); }

std::size_t count_chain_entries(const OpenAsset& asset) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < asset->chain_count(); ++i) count += asset->chain(i).spheres.size;
  return count;
}

std::size_t spheres_in_region(const OpenAsset& asset, std::size_t region) {
  std::size_t count = 0;
  for (const RestSphere& sphere : asset->spheres()) count += sphere.region == region ? 1 : 0;
  return count;
}

// Floats as the shortest decimals that give them back.
ordered_json number(float value) { return ordered_json::parse(fmt::format("{}", value)); }
ordered_json to_json(const spherechain::Vec3& v) { return {number(v.x), number(v.y), number(v.z)}; }
ordered_json to_json(const FitError& e) {
  return {{"mean_abs_F", number(e.mean_abs_f)}, {"max_abs_F", number(e.max_abs_f)}};
}

ordered_json bones_json(const OpenAsset& asset) {
  ordered_json bones = ordered_json::array();
  for (std::size_t i = 0; i < asset->bone_count(); ++i) {
    const BoneView bone = asset->bone(i);
    ordered_json inverse_bind = ordered_json::array();
    for (std::size_t e = 0; e < 12; ++e) inverse_bind.push_back(number(bone.inverse_bind[e]));
    bones.push_back({{"name", bone.name}, {"inverse_bind", std::move(inverse_bind)}, {"is_rest", bone.is_rest}});
  }
  return bones;
}

std::size_t bytes_of(const MomentTables& tables) {
  const auto bytes = [](const auto& span) { return span.size * sizeof(span[0]); };
  return bytes(tables.batches) + bytes(tables.pairs) + bytes(tables.spheres) + bytes(tables.bone_counts) +
         bytes(tables.bones) + bytes(tables.centers) + bytes(tables.pair_places) + bytes(tables.moments);
}

// As the asset has it, packed.
std::size_t bytes_of(const SkinData& skin) {
  const auto bytes = [](const auto&... spans) { return (... + (spans.size * sizeof(spans[0]))); };
  return bytes(skin.triangles, skin.cluster_vertices, skin.cluster_bones, skin.sources, skin.welds,
               skin.influence_bones, skin.rest_contacts, skin.hull_points, skin.part_run_ends, skin.part_runs,
               skin.corners, skin.influence_counts, skin.morph_counts, skin.clusters, skin.positions,
               skin.influence_weights, skin.morphs, skin.boxes, skin.bounds_term_counts, skin.bounds_term_bones,
               skin.bounds_terms, skin.bounds_morph_counts, skin.bounds_morph_targets, skin.bounds_morphs, skin.hulls,
               skin.hull_bones);
}

ordered_json sphere_json(const OpenAsset& asset, std::size_t i) {
  const RestSphere& sphere = asset->spheres()[i];
  ordered_json pivots = ordered_json::array();
  for (std::uint32_t k = 0; k < sphere.pivot_count; ++k) {
    const Pivot& pivot = asset->pivots()[sphere.first_pivot + k];
    pivots.push_back({{"vertices", {pivot.a, pivot.b, pivot.c}}, {"weight", number(pivot.weight)}});
  }
  return {{"id", i},
          {"center", to_json(sphere.center)},
          {"radius", number(sphere.radius)},
          {"detect_radius", number(sphere.detect_radius)},
          {"region", asset->region(sphere.region).name},
          {"level", sphere.level},
          {"side", side_name(sphere.side)},
          {"triangles", sphere.triangle_count},
          {"pivots", std::move(pivots)}};
}

}  // namespace

const char* refit_name(spherechain::RefitRule rule) {
  return rule == spherechain::RefitRule::kPaper ? "paper" : "moments";
}

std::string inspect_json(const OpenAsset& asset) {
  const AssetInfo info = asset->info();
  const FitErrors fit = asset->fit();
  ordered_json buffers = ordered_json::array();
  for (const sc_source_buffer& buffer : asset->source_buffers()) {
    buffers.push_back({{"mesh", buffer.mesh},
                       {"primitive", buffer.primitive},
                       {"first_vertex", buffer.first_vertex},
                       {"vertices", buffer.vertex_count},
                       {"hash", fmt::format("{:016x}", buffer.hash)}});
  }
  ordered_json regions = ordered_json::array(), spheres = ordered_json::array(), chains = ordered_json::array(),
               joints = ordered_json::array(), morphs = ordered_json::array();
  for (std::size_t r = 0; r < asset->region_count(); ++r) {
    regions.push_back({{"name", asset->region(r).name},
                       {"triangles", asset->region(r).triangle_count},
                       {"spheres", spheres_in_region(asset, r)}});
  }
  for (std::size_t i = 0; i < asset->spheres().size; ++i) spheres.push_back(sphere_json(asset, i));
  for (std::size_t c = 0; c < asset->chain_count(); ++c) {
    const ChainView chain = asset->chain(c);
    ordered_json names = ordered_json::array();
    for (const std::uint8_t r : chain.regions) names.push_back(asset->region(r).name);
    chains.push_back({{"name", chain.name},
                      {"regions", std::move(names)},
                      {"spheres", std::vector<std::uint32_t>(chain.spheres.begin(), chain.spheres.end())}});
  }
  for (std::size_t j = 0; j < asset->joint_count(); ++j) {
    const JointView joint = asset->joint(j);
    joints.push_back({{"name", joint.name},
                      {"parent", joint.parent},
                      {"position", to_json(joint.position)},
                      {"tail", to_json(joint.tail)}});
  }
  for (std::size_t m = 0; m < asset->morph_count(); ++m) morphs.push_back(asset->morph_name(m));
  const MomentTables& moments = asset->moment_tables();
  const ordered_json out{
      {"format_version", kFormatVersion},
      {"writer", info.writer},
      {"settings", ordered_json::parse(info.settings, nullptr, false)},
      {"settings_sha256", info.settings_sha256},
      {"source",
       {{"file", info.source_file},
        {"sha256", info.source_sha256},
        {"vertices", info.vertex_count},
        {"triangles", info.triangle_count},
        {"rest_hash", fmt::format("{:016x}", info.source_rest_hash)},
        {"metres_per_unit", number(info.metres_per_unit)},
        {"buffers", std::move(buffers)}}},
      {"frame",
       {{"origin", to_json(info.origin)},
        {"left", to_json(info.left)},
        {"up", to_json(info.up)},
        {"forward", to_json(info.forward)},
        {"height", number(info.height)}}},
      {"refit", refit_name(asset->refit_rule())},
      {"sphere_count", asset->spheres().size},
      {"chain_entries", count_chain_entries(asset)},
      {"ignored_pairs", count_ignored(asset)},
      {"rest_pairs",
       {{"fit", asset->rest_pairs(SC_RADIUS_FIT).size}, {"detect", asset->rest_pairs(SC_RADIUS_DETECT).size}}},
      {"regions", std::move(regions)},
      {"parts", parts_json(part_rows(asset))},
      {"spheres", std::move(spheres)},
      {"chains", std::move(chains)},
      {"joints", std::move(joints)},
      {"bones", bones_json(asset)},
      {"morphs", std::move(morphs)},
      {"moment_tables",
       {{"batches", moments.batches.size},
        {"pairs", moments.pairs.size},
        {"sphere_bones", moments.centers.size},
        {"sphere_pairs", moments.moments.size},
        {"bytes", bytes_of(moments)}}},
      {"skin",
       {{"clusters", asset.surface().clusters.size},
        {"vertices", asset.surface().source_vertices.size},
        {"rest_contacts", asset.surface().rest_contacts.size},
        {"buried_clusters", count_buried(asset.surface())},
        {"layer_pairs", count_layers(asset.surface())},
        {"pieces", pieces_json(piece_rows(asset))},
        {"bytes", bytes_of(asset->skin())}}},
      {"fit",
       {{"phi1", to_json(fit.phi1)}, {"phi1_adjusted", to_json(fit.phi1_adjusted)}, {"phi2", to_json(fit.phi2)}}}};
  return json_text(out, 1) + "\n";
}

std::string inspect_text(const OpenAsset& asset) {
  const AssetInfo info = asset->info();
  const FitErrors fit = asset->fit();
  std::string out = fmt::format("format {}, written by {}\n", kFormatVersion, info.writer);
  out += fmt::format("source   {} ({} vertices, {} triangles)\n         sha256 {}\n", info.source_file,
                     info.vertex_count, info.triangle_count, info.source_sha256);
  out += fmt::format("settings {}\n         sha256 {}\n", info.settings, info.settings_sha256);
  out += fmt::format("refit    {}\n", refit_name(asset->refit_rule()));
  out += fmt::format("spheres  {}, {} chain entries, {} pairs ignored, {} joints\n", asset->spheres().size,
                     count_chain_entries(asset), count_ignored(asset), asset->joint_count());
  out += fmt::format("bones    {}, {} morph targets\n", asset->bone_count(), asset->morph_count());
  if (const MomentTables& moments = asset->moment_tables(); moments.moments.size > 0) {
    out += fmt::format("moments  {} batches of {} bone pairs; spheres: {} bones, {} pairs, {} bytes\n",
                       moments.batches.size, moments.pairs.size, moments.centers.size, moments.moments.size,
                       bytes_of(moments));
  }
  const Surface& surface = asset.surface();
  out += fmt::format("skin     {} clusters, {} vertices, {} contacts at rest, {} bytes\n", surface.clusters.size,
                     surface.source_vertices.size, surface.rest_contacts.size, bytes_of(asset->skin()));
  out += fmt::format("layers   {} clusters buried, {} pairs of clusters lie over each other\n", count_buried(surface),
                     count_layers(surface));
  out += fmt::format("\n{:<14} {:>9} {:>7}\n", "region", "triangles", "spheres");
  for (std::size_t r = 0; r < asset->region_count(); ++r) {
    out += fmt::format("{:<14} {:>9} {:>7}\n", asset->region(r).name, asset->region(r).triangle_count,
                       spheres_in_region(asset, r));
  }
  out += parts_text(part_rows(asset));
  out += pieces_text(piece_rows(asset));
  for (std::size_t c = 0; c < asset->chain_count(); ++c) {
    const ChainView chain = asset->chain(c);
    out += fmt::format("{}{:<8}", c == 0 ? "\n" : "", chain.name);
    for (const std::uint32_t i : chain.spheres) out += fmt::format(" {}", i);
    out += "\n";
  }
  out += fmt::format("\nmean |F| over the torso: phi1 {:.4g}, phi1' {:.4g}, phi2 {:.4g} (source units)\n",
                     fit.phi1.mean_abs_f, fit.phi1_adjusted.mean_abs_f, fit.phi2.mean_abs_f);
  return out;
}

}  // namespace spherechain::baker
