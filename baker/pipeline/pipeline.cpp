// SPDX-License-Identifier: GPL-3.0-or-later
// One character through all stages.
#include "baker/pipeline/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "baker/calibrate/calibrate.h"
#include "baker/edits/held_props.h"
#include "baker/edits/hidden_contacts.h"
#include "baker/edits/ignore_parts.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/pipeline/fit_prop.h"
#include "baker/pipeline/segment_wraps.h"
#include "baker/segment/by_bones.h"
#include "baker/segment/by_rig.h"
#include "baker/segment/by_shape.h"
#include "baker/wrap/repair_body.h"
#include "baker/wrap/wrap_skin.h"
#include "baker/write/write.h"

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
  std::function<Attempt<Proposal>()> run;
};

// A proposal with a reservation, and how its body was closed.
struct Reserve {
  Proposal proposal;
  ClosingReport closing;
};

void run_rig(Bake& out, const Progress& progress) {
  stage(out, progress, "rig", [&] {
    if (is_biped(out.regions) && out.joints.empty()) {
      out.joints = place_joints(out.regions);
      if (out.character.rig.bones.empty()) out.rig_weights = rig_weights(out.character, out.regions.body, out.joints);
    }
    out.body_parts = find_body_parts(out.character, out.roles, out.regions, out.joints, out.rig_weights);
    if (out.settings.import.prop) {
      out.body_parts.parts[0].name = std::filesystem::path(out.character.file).stem().string();
    }
  });
}

void run_after_fit(Bake& out, const Progress& progress) {
  const BakeSettings& settings = out.settings;
  stage(out, progress, "chains", [&] {
    std::vector<LimbPlace> limbs;
    for (const Limb& limb : out.regions.limbs) {
      limbs.push_back({static_cast<std::uint8_t>(limbs.size()), limb.side, limb.along});
    }
    out.chains =
        out.regions.is_tree() ? build_tree_chains(out.spheres, out.regions.parents) : build_chains(out.spheres, limbs);
  });
  stage(out, progress, "bind", [&] {
    out.bones = bind_bones(out.character, out.joints, out.rig_weights);
    out.moments = bind_moments(out.character, out.bones, out.rig_weights, out.binding);
  });
  stage(out, progress, "clusters", [&] {
    out.clusters = make_clusters(out.character, out.binding, out.bones, out.rig_weights, settings.clusters);
  });
  const auto write = [&] {
    return serialize({out.character, out.regions, out.spheres, out.chains, out.binding, out.joints, out.bones,
                      out.moments, out.body_parts, out.clusters, out.layers, to_json(settings)});
  };
  stage(out, progress, "layers", [&] { out.layers = find_layers(write(), out.character); });
  if (settings.bind.rule != RefitRule::kPaper && !settings.import.prop) {
    stage(out, progress, "calibrate", [&] {
      const std::vector<std::uint8_t> draft = write();  // for the runtime, which moves the spheres
      calibrate(out.character, out.regions, out.joints, draft, out.binding);
    });
  }
  stage(out, progress, "write", [&] { out.asset = write(); });
}

// Lets parts that a hand holds ignore it (`held`), changes the spheres as a person asked, and binds them again.
void edit(Bake& out, const PartPairs& held) {
  const Edits& edits = out.settings.edits;
  std::vector<AppliedEdit> applied;
  PartPairs ignored = held;
  ignored.insert(ignored.end(), edits.ignored_parts.begin(), edits.ignored_parts.end());
  out.spheres = add_part_spheres(out.character, out.regions, out.spheres, out.body_parts, ignored);
  out.spheres = edit_spheres(out.character, out.regions, out.spheres, edits.spheres, out.edits_done, applied);
  Attempt<Binding> binding = bind_spheres(out.character, out.regions, out.spheres, out.settings.bind);
  if (!binding) {
    throw Error(ExitCode::kSegmentation, out.character.file + ": with its edits: " + binding.reason().what);
  }
  if (!edits.empty()) out.edits_done.notes = hidden_contacts(out.character, out.body_parts, out.binding, *binding);
  out.binding = std::move(*binding);
  check_places(out.regions, out.spheres, out.binding, edits.spheres, applied, out.edits_done);
  out.quality = measure_fit(out.character, out.regions, out.binding);
  const double gap = out.settings.bind.neighbour_gap * out.regions.frame.height;
  EditsDone not_asked_for;
  ignore_parts(out.character, out.regions, out.spheres, out.body_parts, held, gap, out.binding, not_asked_for);
  ignore_parts(out.character, out.regions, out.spheres, out.body_parts, edits.ignored_parts, gap, out.binding,
               out.edits_done);
}

Attempt<Spheres> fit_regions(const Character& character, const Regions& regions, const FitSettings& settings) {
  if (regions.is_tree()) return fit_halves(character, regions, settings);
  return fit_spheres(regions, settings);
}

}  // namespace

Attempt<Segmentation> segment_character(const Character& character, const Roles& roles, const SegmentSettings& settings,
                                        Wraps wraps) {
  Segmentation out;
  const bool rigged = !roles.limbs.empty() && !character.rig.weights.empty();
  const bool whole = is_whole(character);
  std::optional<Reason> failure;
  std::optional<Reserve> reserve;
  BodyMesh latest = character.largest_piece;  // the body that was tried last

  const auto does_not_apply = [](const char* what) { return Reason{what, Reason::Cause::kDoesNotApply}; };
  const auto by_shape = [&](const BodyMesh& body) -> Attempt<Proposal> {
    Attempt<Regions> regions = segment_by_shape(character, body, settings);
    if (!regions) return *(failure = regions.reason());
    // A head of its own piece, and the rest is taken for a quadruped: a wrap around both tells more.
    const bool complete = rigged || covers_skin(body, character.skin) || is_expected(*regions, settings);
    return Proposal{std::move(*regions), complete ? "" : "it is no biped, and pieces of the skin are left out", {}};
  };
  const auto by_rig = [&](BodyMesh body) -> Attempt<Proposal> {
    Attempt<Regions> regions = segment_by_rig(character, std::move(body), roles, settings);
    if (!regions) return *(failure = regions.reason());
    return Proposal{std::move(*regions), {}, {}};
  };

  // Shape knows a biped's armpit and crotch best, a rig knows all else.
  const std::array strategies{
      Strategy{"shape",
               [&]() -> Attempt<Proposal> {
                 if (!whole) return does_not_apply("the skin is not one closed surface");
                 if (rigged && roles.kind != BodyKind::kBiped) return does_not_apply("the rig is not a biped's");
                 return by_shape(character.largest_piece);
               }},
      Strategy{"shape of the repaired skin",
               [&]() -> Attempt<Proposal> {
                 if (whole) return does_not_apply("the skin needs no repair");
                 if (rigged) return does_not_apply("a rig needs no closed surface");
                 const Attempt<BodyMesh> body = repair_body(character, out.closing);
                 if (!body) return body.reason();
                 latest = *body;
                 return by_shape(*body);
               }},
      Strategy{"rig",
               [&]() -> Attempt<Proposal> {
                 if (!rigged) return does_not_apply("there is no rig with limbs");
                 if (!whole) return does_not_apply("the skin is not one closed surface");
                 return by_rig(character.largest_piece);
               }},
      Strategy{"rig on all pieces of the skin",
               [&]() -> Attempt<Proposal> {
                 if (!rigged) return does_not_apply("there is no rig with limbs");
                 latest = all_pieces(character);
                 Attempt<Proposal> proposal = by_rig(latest);
                 if (proposal && limbs_are_in_shards(character.skin, proposal->regions)) {
                   return *(failure = Reason{"most of the limbs' skin is in small pieces"});
                 }
                 return proposal;
               }},
      Strategy{"shape of a wrap",
               [&]() -> Attempt<Proposal> {
                 if (rigged) return does_not_apply("the rig decides");
                 if (wraps == Wraps::kUnmoved && !character.rig.weights.empty()) {
                   return does_not_apply("bones move the skin");
                 }
                 if (failure && covers_skin(latest, character.skin))
                   return does_not_apply("a wrap has no more limbs than the skin");
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
      reserve = Reserve{std::move(*proposal), out.closing};
    }
  }
  if (!reserve) return failure.value_or(Reason{"its rig has no limbs, and its skin is not one closed surface"});
  reserve->closing.seconds = out.closing.seconds;
  out.closing = reserve->closing;
  return take(reserve->proposal);
}

namespace {

using Candidate = Attempt<FittedCharacter>;

// Binds and measures what a candidate's spheres are.
Candidate bound(const Character& character, FittedCharacter candidate, Attempt<Spheres> spheres,
                const BakeSettings& settings) {
  if (!spheres) return spheres.reason();
  const Regions& regions = candidate.segmentation.regions;
  Attempt<Binding> binding = bind_spheres(character, regions, *spheres, settings.bind);
  if (!binding) return binding.reason();
  candidate.quality = measure_fit(character, regions, *binding);
  candidate.spheres = std::move(*spheres);
  candidate.binding = std::move(*binding);
  return candidate;
}

std::size_t sphere_limit(const BakeSettings& settings) {
  return static_cast<std::size_t>(settings.fit.spheres.value_or(kHalvedSpheres));
}

// `choice` becomes how the regions were found, if they were.
Candidate fit_limbs(const Character& character, const Roles& roles, const BakeSettings& settings, Wraps wraps,
                    Choice& choice) {
  FittedCharacter out;
  Attempt<Segmentation> found = segment_character(character, roles, settings.segment, wraps);
  if (!found) return found.reason();
  out.segmentation = std::move(*found);
  choice = out.segmentation.choice;
  Attempt<Spheres> spheres = fit_spheres(out.segmentation.regions, settings.fit);
  return bound(character, std::move(out), std::move(spheres), settings);
}

Candidate fit_bones(const Character& character, const Roles& roles, const BakeSettings& settings) {
  FittedCharacter out;
  std::optional<Vec3> facing = settings.segment.facing;
  const bool is_by_convention = character.rig.robot.is_robot && !facing;
  if (is_by_convention) facing = Vec3::UnitX();  // x forward, y left, z up (ROS REP 103)
  out.segmentation.regions = segment_by_bones(character, roles, facing, sphere_limit(settings));
  if (is_by_convention) out.segmentation.regions.facing = "forward is x, as robots have it";
  Attempt<Spheres> spheres = fit_halves(character, out.segmentation.regions, settings.fit);
  return bound(character, std::move(out), std::move(spheres), settings);
}

// Which regions fit well; of a left and a right limb both or none.
std::vector<bool> well_fitted(const Regions& regions, const std::vector<double>& far) {
  std::vector<bool> out;
  for (const double share : far) out.push_back(share <= kFarAreaGood);
  for (std::size_t a = 0; a < regions.limbs.size(); ++a) {
    for (std::size_t b = 0; b < regions.limbs.size(); ++b) {
      const Limb &left = regions.limbs[a], &right = regions.limbs[b];
      const bool mirrored = left.side == Side::kLeft && right.side == Side::kRight &&
                            left.name.substr(left.name.find('_')) == right.name.substr(right.name.find('_'));
      if (mirrored) out[a] = out[b] = out[a] && out[b];
    }
  }
  return out;
}

// Limbs and torso where they fit well, and bones for the rest.
Candidate fit_mixed(const Character& character, const FittedCharacter& limbed, const Roles& roles,
                    const BakeSettings& settings) {
  const Regions& regions = limbed.segmentation.regions;
  const std::vector<double>& far = limbed.quality.far_of_region;
  const std::vector<bool> kept = well_fitted(regions, far);
  std::size_t kept_spheres = 0;
  for (std::size_t region = 0; region < kept.size(); ++region) {
    if (kept[region]) kept_spheres += limbed.spheres.of_region[region].size();
  }
  const auto count = static_cast<std::size_t>(std::count(kept.begin(), kept.end(), true));
  if (!regions.has_torso || count == 0 || count == kept.size()) return Reason{"no region fits better than others"};
  if (kept_spheres >= sphere_limit(settings)) return Reason{"its limbs take all spheres"};
  FittedCharacter out;
  MixedRegions mixed = segment_rest_by_bones(character, regions, kept, roles, sphere_limit(settings) - kept_spheres);
  out.segmentation.regions = std::move(mixed.regions);
  Attempt<Spheres> spheres =
      fit_halves(character, out.segmentation.regions, settings.fit, {&limbed.spheres, std::move(mixed.kept)});
  const Choice& tried = limbed.segmentation.choice;
  out.segmentation.choice = {tried.strategy + ", in part by bones", tried.passed_over};
  for (std::size_t region = 0; region < kept.size(); ++region) {
    if (kept[region]) continue;
    out.segmentation.choice.passed_over.push_back(
        {tried.strategy + " for the " + regions.name(region),
         {fmt::format("{:.0f} % of its skin is farther from its sphere than {:.0f} % of the height", 100 * far[region],
                      100 * kWellFitted)}});
  }
  return bound(character, std::move(out), std::move(spheres), settings);
}

Reason why_not(const FittedCharacter& candidate, const FittedCharacter& taken) {
  return {fmt::format("{:.1f} % of the skin is farther from its sphere than {:.0f} % of the height, not {:.1f} %",
                      100 * candidate.quality.far_area, 100 * kWellFitted, 100 * taken.quality.far_area)};
}

}  // namespace

FittedCharacter fit_character(const Character& character, const Roles& roles, const BakeSettings& settings) {
  const auto taken_or_fail = [&](Candidate candidate) {
    if (!candidate) throw Error(ExitCode::kSegmentation, character.file + ": " + candidate.reason().what);
    return std::move(*candidate);
  };
  if (settings.import.prop) return taken_or_fail(fit_prop(character, settings));
  if (character.rig.robot.is_robot) {
    FittedCharacter bones = taken_or_fail(fit_bones(character, roles, settings));
    bones.segmentation.choice.strategy = "links";
    return bones;
  }
  const bool one_fit = settings.bind.rule == RefitRule::kPaper || settings.segment.body != BodyKind::kUnknown;
  Choice tried;
  Candidate limbed = fit_limbs(character, roles, settings, one_fit ? Wraps::kAll : Wraps::kUnmoved, tried);
  // Without bones the automatic rig is what moves a body, and it needs a biped's regions.
  const bool only_limbs = one_fit || (limbed ? character.rig.bones.empty() && is_biped(limbed->segmentation.regions)
                                             : limbed.reason().cause == Reason::Cause::kSettings);
  if (only_limbs) return taken_or_fail(std::move(limbed));
  if (limbed && !settings.fit.spheres && limbed->quality.grade() == FitGrade::kGood) return std::move(*limbed);

  const bool too_many = limbed && settings.fit.spheres && limbed->spheres.spheres.size() > sphere_limit(settings);
  Candidate mixed{Reason{"there is nothing to mix"}};
  if (limbed && !too_many && !character.rig.bones.empty()) mixed = fit_mixed(character, *limbed, roles, settings);
  if (mixed && mixed->quality.grade() == FitGrade::kGood) return std::move(*mixed);
  FittedCharacter bones = taken_or_fail(fit_bones(character, roles, settings));
  if (mixed && mixed->quality.far_area <= bones.quality.far_area) return std::move(*mixed);
  if (limbed && !too_many && limbed->quality.far_area <= bones.quality.far_area) {
    const char* name = character.rig.bones.empty() ? "pieces" : "bones";
    limbed->segmentation.choice.passed_over.push_back({name, why_not(bones, *limbed)});
    return std::move(*limbed);
  }
  const Reason reason = !limbed    ? limbed.reason()
                        : too_many ? Reason{fmt::format("it takes {} spheres", limbed->spheres.spheres.size())}
                                   : why_not(*limbed, bones);
  bones.segmentation.choice = {character.rig.bones.empty() ? "pieces" : "bones", tried.passed_over};
  bones.segmentation.choice.passed_over.push_back({tried.strategy.empty() ? "march and disk" : tried.strategy, reason});
  return bones;
}

Bake bake(const std::filesystem::path& input, const BakeSettings& settings, const Progress& progress) {
  Bake out;
  out.settings = settings;
  stage(out, progress, "import", [&] { out.character = import_character(input, settings.import); });
  stage(out, progress, "roles", [&] {
    out.roles = find_roles(out.character.rig, out.character.source_positions, settings.roles, settings.segment.body);
    if (const std::vector<std::string> limbs = limbs_by_shape(out.roles); !limbs.empty()) {
      add_note(
          fmt::format("{}: guessed from the skeleton's shape, for no joint's name tells: {} (name joints in \"roles\": "
                      "docs/settings.md)",
                      input.string(), fmt::join(limbs, ", ")));
    }
  });
  stage(out, progress, "fit", [&] {
    FittedCharacter fitted = fit_character(out.character, out.roles, settings);
    out.regions = std::move(fitted.segmentation.regions);
    out.closing = fitted.segmentation.closing;
    out.segmented_by = std::move(fitted.segmentation.choice);
    out.spheres = std::move(fitted.spheres);
    out.binding = std::move(fitted.binding);
    out.quality = std::move(fitted.quality);
  });
  out.character.metres_per_unit =
      settings.size.metres_per_unit(out.character.metres_per_unit, out.regions.frame.height);
  if (out.closing.seconds > 0) {
    out.times.back().seconds -= out.closing.seconds;
    out.times.insert(out.times.end() - 1, {"wrap", out.closing.seconds});
  }
  run_rig(out, progress);
  const bool is_paper = settings.bind.rule == RefitRule::kPaper;
  PartPairs held = is_paper ? PartPairs{} : held_props(out.body_parts);
  for (const auto& [a, b] : out.character.rig.robot.excluded) {
    const auto name = [&](Index bone) { return out.character.rig.nodes[out.character.rig.bones[bone].node].name; };
    held.push_back({name(a), name(b)});
  }
  if (!settings.edits.empty() || !held.empty()) stage(out, progress, "edits", [&] { edit(out, held); });
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
  stage(out, {}, "fit", [&] {
    const auto or_throw = [&](auto attempt) {
      if (!attempt) throw Error(ExitCode::kSegmentation, out.character.file + ": " + attempt.reason().what);
      return std::move(*attempt);
    };
    const bool same = settings.fit == bake.settings.fit;
    out.spheres = same ? bake.spheres : or_throw(fit_regions(out.character, out.regions, settings.fit));
    out.binding = or_throw(bind_spheres(out.character, out.regions, out.spheres, settings.bind));
    out.quality = measure_fit(out.character, out.regions, out.binding);
  });
  run_rig(out, {});
  run_after_fit(out, {});
  return out;
}

}  // namespace spherechain::baker
