// SPDX-License-Identifier: MIT
#include <type_traits>

#include "sphere_chains_generated.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

namespace fb = flatbuffers;

// The runtime's views have the schema's layout: runtime/src/asset/open.cpp asserts it.
template <typename Stored, typename View>
const Stored* stored(const View& view) {
  static_assert(sizeof(Stored) == sizeof(View) && alignof(Stored) == alignof(View));
  return reinterpret_cast<const Stored*>(&view);
}

template <typename Stored, typename View>
fb::Offset<fb::Vector<const Stored*>> structs(fb::FlatBufferBuilder& builder, const std::vector<View>& views) {
  return builder.CreateVectorOfStructs(views.empty() ? nullptr : stored<Stored>(views[0]), views.size());
}

// Builds the tables of one asset, with what `parts.without` names left out.
class Builder {
 public:
  explicit Builder(const AssetParts& parts) : parts_(parts) {}

  std::vector<std::uint8_t> run() {
    const auto provenance = schema::CreateProvenanceDirect(fb_, parts_.writer.c_str(), parts_.settings.c_str(),
                                                           parts_.settings_sha256.c_str());
    const auto source = source_table();
    const auto frame = schema::CreateFrame(fb_, unless<schema::Vec3>("frame.origin", parts_.origin),
                                           unless<schema::Vec3>("frame.left", parts_.left),
                                           unless<schema::Vec3>("frame.up", parts_.up),
                                           unless<schema::Vec3>("frame.forward", parts_.forward), parts_.height);
    const auto fit = schema::CreateFit(fb_, unless<schema::FitError>("fit.phi1", parts_.phi1),
                                       unless<schema::FitError>("fit.phi1_adjusted", parts_.phi1_adjusted),
                                       unless<schema::FitError>("fit.phi2", parts_.phi2));
    const auto regions = tables(parts_.regions, [&](const RegionEntry& region) {
      return schema::CreateRegion(fb_, fb_.CreateString(region.name), region.triangle_count);
    });
    const auto body_parts = tables(parts_.parts, [&](const PartEntry& part) {
      return schema::CreatePart(fb_, fb_.CreateString(part.name), static_cast<schema::Side>(part.side), part.bone,
                                part.parent, part.mobility);
    });
    const auto spheres = structs<schema::Sphere>(fb_, parts_.spheres);
    const auto pivots = structs<schema::Pivot>(fb_, parts_.pivots);
    const auto chains = chain_tables();
    const auto ignored = fb_.CreateVector(parts_.ignored);
    const auto rest_fit = structs<schema::RestPair>(fb_, parts_.rest_fit);
    const auto rest_detect = structs<schema::RestPair>(fb_, parts_.rest_detect);
    const auto joints = tables(parts_.joints, [&](const JointEntry& joint) {
      return schema::CreateJoint(fb_, fb_.CreateString(joint.name), joint.parent,
                                 unless<schema::Vec3>("joints.position", joint.position),
                                 unless<schema::Vec3>("joints.tail", joint.tail));
    });
    const auto bones = tables(parts_.bones, [&](const BoneEntry& bone) {
      return schema::CreateBone(fb_, fb_.CreateString(bone.name),
                                unless<schema::Matrix>("inverse_bind", bone.inverse_bind), bone.is_rest);
    });
    const auto morphs = fb_.CreateVectorOfStrings(parts_.morphs);
    const auto moments = moment_table();
    const auto skin = skin_table();
    schema::FinishAssetBuffer(
        fb_, schema::CreateAsset(fb_, parts_.format_version, provenance, source, frame,
                                 static_cast<schema::Refit>(parts_.refit), fit, regions, body_parts, spheres, pivots,
                                 chains, ignored, rest_fit, rest_detect, joints, bones, morphs, moments, skin));
    return {fb_.GetBufferPointer(), fb_.GetBufferPointer() + fb_.GetSize()};
  }

 private:
  template <typename Stored, typename View>
  const Stored* unless(const char* name, const View& view) const {
    return parts_.without == name ? nullptr : stored<Stored>(view);
  }

  template <typename Entry, typename Create, typename Offset = std::invoke_result_t<Create, const Entry&>>
  fb::Offset<fb::Vector<Offset>> tables(const std::vector<Entry>& entries, const Create& create) {
    std::vector<Offset> offsets;
    for (const Entry& entry : entries) {
      offsets.push_back(create(entry));
    }
    return fb_.CreateVector(offsets);
  }

  fb::Offset<schema::Source> source_table() {
    const auto file = fb_.CreateString(parts_.source_file), sha256 = fb_.CreateString(parts_.source_sha256);
    using Buffers = fb::Offset<fb::Vector<const schema::SourceBuffer*>>;
    const Buffers buffers = parts_.buffers.empty() ? Buffers() : structs<schema::SourceBuffer>(fb_, parts_.buffers);
    return schema::CreateSource(fb_, file, sha256, parts_.vertex_count, parts_.triangle_count, parts_.rest_hash,
                                parts_.metres_per_unit, buffers);
  }

  fb::Offset<fb::Vector<fb::Offset<schema::Chain>>> chain_tables() {
    fb::Offset<fb::Vector<std::uint32_t>> spheres;
    return tables(parts_.chains, [&](const ChainEntry& chain) {
      const auto name = fb_.CreateString(chain.name);
      const auto regions = fb_.CreateVector(chain.regions);
      if (spheres.IsNull() || !parts_.chains_share_array) {
        spheres = fb_.CreateVector(chain.spheres);
      }
      return schema::CreateChain(fb_, name, regions, spheres);
    });
  }

  fb::Offset<schema::Moments> moment_table() {
    const MomentParts& in = parts_.moments;
    if (in.batches.empty()) {
      return 0;
    }
    const auto batches = structs<schema::MomentBatch>(fb_, in.batches);
    const auto pairs = structs<schema::BonePair>(fb_, in.pairs);
    const auto spheres = fb_.CreateVector(in.spheres);
    const auto bone_counts = fb_.CreateVector(in.bone_counts);
    const auto bones = fb_.CreateVector(in.bones);
    const auto centers = structs<schema::CenterTerm>(fb_, in.centers);
    const auto pair_places = fb_.CreateVector(in.pair_places);
    const auto moments = structs<schema::Moment>(fb_, in.moments);
    return schema::CreateMoments(fb_, unless<schema::Vec3>("moments.origin", in.origin), in.reference, batches, pairs,
                                 spheres, bone_counts, bones, centers, pair_places, moments);
  }

  fb::Offset<schema::Skin> skin_table() {
    const SkinParts& in = parts_.skin;
    const auto stream = [&](const Numbers& numbers) { return fb_.CreateVector(encode(numbers)); };
    const auto triangles = stream(in.triangles), part_run_ends = stream(in.part_run_ends);
    const auto cluster_vertices = stream(in.cluster_vertices), cluster_bones = stream(in.cluster_bones);
    const auto sources = stream(in.sources), welds = stream(in.welds), influence_bones = stream(in.influence_bones);
    const auto rest_contacts = stream(in.rest_contacts), hull_points = stream(in.hull_points);
    const auto corners = fb_.CreateVector(in.corners), part_runs = fb_.CreateVector(in.part_runs);
    const auto influence_counts = fb_.CreateVector(in.influence_counts);
    const auto clusters = structs<schema::Cluster>(fb_, in.clusters);
    const auto positions = fb_.CreateVector(in.positions), weights = fb_.CreateVector(in.influence_weights);
    const auto morph_counts = fb_.CreateVector(in.morph_counts);
    const auto morphs = structs<schema::MorphDelta>(fb_, in.morphs);
    const auto boxes = structs<schema::BoxLanes>(fb_, in.boxes);
    const auto term_counts = fb_.CreateVector(in.bounds_term_counts);
    const auto term_bones = fb_.CreateVector(in.bounds_term_bones);
    const auto terms = structs<schema::BoundsTerm>(fb_, in.bounds_terms);
    const auto bounds_morph_counts = fb_.CreateVector(in.bounds_morph_counts);
    const auto bounds_morph_targets = fb_.CreateVector(in.bounds_morph_targets);
    const auto bounds_morphs = structs<schema::BallLanes>(fb_, in.bounds_morphs);
    const auto pieces = tables(in.pieces, [&](const auto& piece) {
      return schema::CreatePiece(fb_, fb_.CreateString(piece.first), piece.second);
    });
    const auto covers = stream(in.covers);
    const auto cover_distances = fb_.CreateVector(in.cover_distances);
    const auto layer_pairs = stream(in.layer_pairs), layer_run_ends = stream(in.layer_run_ends);
    const auto layer_runs = fb_.CreateVector(in.layer_runs);
    // Skins without triangles have these, too.
    const auto or_zeros = [](const auto& numbers, std::size_t count) {
      return numbers.empty() ? std::decay_t<decltype(numbers)>(count, 0) : numbers;
    };
    const std::size_t cores = kCorePoints * parts_.parts.size();
    const auto windings = fb_.CreateVector(or_zeros(in.windings, 3 * parts_.spheres.size()));
    const auto core_windings = fb_.CreateVector(or_zeros(in.core_windings, 3 * cores));
    const auto core_triangles = stream(or_zeros(in.core_triangles, cores));
    const auto hulls = structs<schema::Hull>(fb_, in.hulls);
    const auto hull_bones = structs<schema::HullBone>(fb_, in.hull_bones);
    return schema::CreateSkin(fb_, in.vertex_count, triangles, corners, part_runs, part_run_ends, clusters,
                              cluster_vertices, cluster_bones, sources, welds, positions, influence_counts,
                              influence_bones, weights, morph_counts, morphs, boxes, term_counts, term_bones, terms,
                              bounds_morph_counts, bounds_morph_targets, bounds_morphs, pieces, covers, cover_distances,
                              rest_contacts, layer_pairs, layer_runs, layer_run_ends, windings, core_triangles,
                              core_windings, hulls, hull_bones, hull_points);
  }

  const AssetParts& parts_;
  fb::FlatBufferBuilder fb_;
};

}  // namespace

std::vector<std::uint8_t> encode(const Numbers& numbers) {
  std::vector<std::uint8_t> bytes;
  std::int64_t last = 0;
  for (const std::uint32_t number : numbers) {
    const std::int64_t difference = number - last;
    last = number;
    auto code = static_cast<std::uint64_t>(difference < 0 ? -2 * difference - 1 : 2 * difference);
    for (; code >= 128; code /= 128) {
      bytes.push_back(static_cast<std::uint8_t>(code % 128 + 128));
    }
    bytes.push_back(static_cast<std::uint8_t>(code));
  }
  return bytes;
}

std::vector<std::uint8_t> build(const AssetParts& parts) { return Builder(parts).run(); }

OpenedAsset::OpenedAsset(const AssetParts& parts) : bytes(build(parts)), message(160, '\0') {
  status = sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), bytes.size(), message.data(), message.size());
  message.resize(message.find('\0'));
}

}  // namespace spherechain::test
