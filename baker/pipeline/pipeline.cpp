// SPDX-License-Identifier: GPL-3.0-or-later
// One character through all stages.
#include "pipeline/pipeline.h"

#include <array>
#include <chrono>

#include "mesh/error.h"
#include "pipeline/segment_wraps.h"
#include "segment/by_rig.h"
#include "segment/by_shape.h"
#include "wrap/repair_body.h"
#include "wrap/wrap_skin.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

using Progress = std::function<void(const std::string&)>;

template <typename Run>
void stage(Bake& out, const Progress& progress, const char* name, const Run& run) {
  if (progress) progress(name);
  const auto start = std::chrono::steady_clock::now();
  run();
  out.times.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
}

// Regions that a strategy found. Where there is a reservation later strategies are tried, too; these regions are taken
// where none of them has better ones.
struct Proposal {
  Regions regions;
  std::string reservation;
  std::string strategy;  // which variant, where the strategy has several
};

struct Strategy {
  const char* name;
  std::function<Attempt<Proposal>()> run;  // may change the body
};

// A proposal with a reservation, and what it was made on.
struct Reserve {
  Proposal proposal;
  Mesh body;
  std::vector<Index> body_source_triangle, body_of_source;
  ClosingReport closing;
};

void run_after_fit(Bake& out, const Progress& progress) {
  const BakeSettings& settings = out.settings;
  stage(out, progress, "chains", [&] {
    std::vector<LimbPlace> limbs;
    for (const Limb& limb : out.regions.limbs) {
      limbs.push_back({static_cast<std::uint8_t>(limbs.size()), limb.side, limb.along});
    }
    out.chains = build_chains(out.spheres, limbs);
  });
  stage(out, progress, "rig", [&] {
    if (!is_biped(out.regions) || !out.joints.empty()) return;
    out.joints = place_joints(out.character, out.regions);
    if (out.character.rig.bones.empty()) out.rig_weights = rig_weights(out.character, out.joints);
  });
  stage(out, progress, "bind", [&] {
    out.binding = bind_spheres(out.character, out.regions, out.spheres, settings.bind);
    out.body_parts = find_body_parts(out.character, out.roles, out.regions, out.joints, out.rig_weights);
    out.bones = bind_bones(out.character, out.joints, out.rig_weights);
    out.moments = bind_moments(out.character, out.bones, out.rig_weights, out.binding);
  });
  stage(out, progress, "clusters", [&] {
    out.clusters = make_clusters(out.character, out.binding, out.bones, out.rig_weights, settings.clusters);
  });
  stage(out, progress, "write", [&] {
    out.asset = serialize({out.character, out.regions, out.spheres, out.chains, out.binding, out.joints, out.bones,
                           out.moments, out.body_parts, out.clusters, to_json(settings)});
  });
}

void run_fit(Bake& out, const Progress& progress) {
  stage(out, progress, "fit", [&] { out.spheres = fit_spheres(out.character, out.regions, out.settings.fit); });
}

}  // namespace

Segmentation segment_character(Character& character, const Roles& roles, const SegmentSettings& settings) {
  Segmentation out;
  const bool rigged = !roles.limbs.empty() && !character.rig.weights.empty();
  const bool whole = is_whole(character);
  std::optional<Reason> failure;
  std::optional<Reserve> reserve;

  const auto does_not_apply = [](const char* what) { return Reason{what, Reason::Cause::kDoesNotApply}; };
  const auto by_shape = [&]() -> Attempt<Proposal> {
    Attempt<Regions> regions = segment_by_shape(character, settings);
    if (!regions) return *(failure = regions.reason());
    // A head of its own piece, and the rest is taken for a quadruped: a wrap around both tells more.
    const bool complete = rigged || covers_skin(character) || is_expected(*regions, settings);
    return Proposal{std::move(*regions), complete ? "" : "it is no biped, and pieces of the skin are left out", {}};
  };
  const auto by_rig = [&]() -> Attempt<Proposal> {
    Attempt<Regions> regions = segment_by_rig(character, roles, settings);
    if (!regions) return *(failure = regions.reason());
    return Proposal{std::move(*regions), {}, {}};
  };

  // Shape knows a biped's armpit and crotch best, a rig knows all else.
  const std::array strategies{
      Strategy{"shape",
               [&]() -> Attempt<Proposal> {
                 if (!whole) return does_not_apply("the skin is not one closed surface");
                 if (rigged && roles.kind != BodyKind::kBiped) return does_not_apply("the rig is not a biped's");
                 return by_shape();
               }},
      Strategy{"shape of the repaired skin",
               [&]() -> Attempt<Proposal> {
                 if (whole) return does_not_apply("the skin needs no repair");
                 if (rigged) return does_not_apply("a rig needs no closed surface");
                 if (const auto reason = repair_body(character, out.closing)) return *reason;
                 return by_shape();
               }},
      Strategy{"rig",
               [&]() -> Attempt<Proposal> {
                 if (!rigged) return does_not_apply("there is no rig with limbs");
                 if (!whole) return does_not_apply("the skin is not one closed surface");
                 return by_rig();
               }},
      Strategy{"rig on all pieces of the skin",
               [&]() -> Attempt<Proposal> {
                 if (!rigged) return does_not_apply("there is no rig with limbs");
                 take_all_pieces(character);
                 Attempt<Proposal> proposal = by_rig();
                 if (proposal && limbs_are_in_shards(character.skin, proposal->regions)) {
                   proposal->reservation = "most of the limbs' skin is in small pieces";
                 }
                 return proposal;
               }},
      Strategy{"rig on a wrap",
               [&]() -> Attempt<Proposal> {
                 if (!rigged) return does_not_apply("there is no rig with limbs");
                 if (!reserve) return does_not_apply("a wrap does not change the rig");
                 for (const WrapSize& size : wrap_sizes_of_limbs(character.skin)) {
                   const Attempt<Wrap> wrap = wrap_skin(character.skin, size, out.closing);
                   if (!wrap || wrap->lines_skin()) continue;
                   use_wrap(character, *wrap, out.closing);
                   return by_rig();
                 }
                 return Reason{"every wrap lines the skin from inside"};
               }},
      Strategy{"shape of a wrap",
               [&]() -> Attempt<Proposal> {
                 if (rigged) return does_not_apply("the rig decides");
                 if (failure && covers_skin(character)) return does_not_apply("a wrap has no more limbs than the skin");
                 Attempt<SegmentedWrap> found =
                     segment_wraps(character, settings, failure, out.closing, out.choice.passed_over);
                 if (!found) return *(failure = found.reason());
                 const bool expected = is_expected(found->regions, settings);
                 return Proposal{std::move(found->regions), expected ? "" : "it is no biped", found->strategy};
               }},
  };

  const auto take = [&](Proposal& proposal) {
    out.regions = std::move(proposal.regions);
    out.choice.strategy = std::move(proposal.strategy);
    return std::move(out);
  };
  for (const Strategy& strategy : strategies) {
    Attempt<Proposal> proposal = strategy.run();
    if (!proposal) {
      out.choice.passed_over.push_back({strategy.name, proposal.reason()});
      continue;
    }
    if (proposal->strategy.empty()) proposal->strategy = strategy.name;
    if (proposal->reservation.empty()) return take(*proposal);
    out.choice.passed_over.push_back({proposal->strategy, {proposal->reservation}});
    if (!reserve) {
      reserve = Reserve{std::move(*proposal), character.body, character.body_source_triangle, character.body_of_source,
                        out.closing};
    }
  }
  if (!reserve) throw Error(ExitCode::kSegmentation, character.file + ": " + failure->what);
  character.body = std::move(reserve->body);
  character.body_source_triangle = std::move(reserve->body_source_triangle);
  character.body_of_source = std::move(reserve->body_of_source);
  reserve->closing.seconds = out.closing.seconds;
  out.closing = reserve->closing;
  return take(reserve->proposal);
}

void close_body(Character& character, const SegmentSettings& settings) {
  if (!is_whole(character) || !covers_skin(character)) segment_character(character, {}, settings);
}

Bake bake(const std::filesystem::path& input, const BakeSettings& settings, const Progress& progress) {
  Bake out;
  out.settings = settings;
  stage(out, progress, "import", [&] { out.character = import_character(input, settings.import); });
  stage(out, progress, "roles", [&] {
    out.roles = find_roles(out.character.rig, out.character.source_positions, settings.roles, settings.segment.body);
  });
  stage(out, progress, "segment", [&] {
    Segmentation found = segment_character(out.character, out.roles, settings.segment);
    out.regions = std::move(found.regions);
    out.closing = found.closing;
    out.segmented_by = std::move(found.choice);
  });
  if (out.closing.seconds > 0) {
    out.times.back().seconds -= out.closing.seconds;
    out.times.insert(out.times.end() - 1, {"wrap", out.closing.seconds});
  }
  run_fit(out, progress);
  run_after_fit(out, progress);
  return out;
}

Bake rebake(const Bake& bake, const BakeSettings& settings) {
  Bake out;
  out.settings = settings;
  out.character = bake.character;
  out.roles = bake.roles;
  out.regions = bake.regions;
  out.joints = bake.joints;
  out.rig_weights = bake.rig_weights;
  out.closing = bake.closing;
  out.segmented_by = bake.segmented_by;
  if (settings.fit == bake.settings.fit) {
    out.spheres = bake.spheres;
  } else {
    run_fit(out, {});
  }
  run_after_fit(out, {});
  return out;
}

}  // namespace spherechain::baker
