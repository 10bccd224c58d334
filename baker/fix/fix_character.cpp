// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/fix_character.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>

#include "baker/check/run.h"
#include "baker/fix/rigged_glb.h"
#include "baker/fix/turned_fbx.h"
#include "baker/fix/turned_recording.h"
#include "baker/fix/write_clip.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/mesh/utf8.h"
#include "baker/motion/carried_motion.h"
#include "baker/motion/frame_times.h"
#include "baker/os/written_file.h"
#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// "b/c.glb" and "c.glb" are ends of "/a/b/c.glb".
bool is_end_of(const std::string& end, const fs::path& path) {
  const fs::path tail(end), whole = as_utf8(fs::absolute(path).lexically_normal().string());
  const auto count = std::distance(tail.begin(), tail.end()), all = std::distance(whole.begin(), whole.end());
  return count > 0 && count <= all && std::equal(tail.begin(), tail.end(), std::prev(whole.end(), count));
}

Clip with_rotations(Clip clip, const std::vector<Channel>& channels) {
  for (const Channel& channel : channels) {
    const auto found = std::find_if(clip.channels.begin(), clip.channels.end(), [&](const Channel& own) {
      return own.path == ChannelPath::kRotation && own.target == channel.target;
    });
    if (found == clip.channels.end()) {
      clip.channels.push_back(channel);
    } else {
      *found = channel;
    }
  }
  return clip;
}

class Fixer {
 public:
  // `bytes`: the character's file, where that is written.
  Fixer(const FixJob& job, RiggedSource source, std::string bytes, const Bake& baked,
        const std::function<void(const std::string&)>& report)
      : job_(job), roles_(baked.roles), report_(report), is_used_(job.decisions.size(), 0) {
    out_.source = std::move(source);
    out_.bytes = std::move(bytes);
    out_.asset.assign(reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size());
    animated_.emplace(OpenAsset(out_.asset, job.input), job.input, out_.source.file, MotionChoice{{}, job.clip, {}},
                      FrameChoice{0, 0});
    parts_ = body_parts_of(animated_->asset()).parts;
    const auto is_part = [&](const std::string& name) {
      return std::any_of(parts_.begin(), parts_.end(), [&](const BodyPart& part) { return part.name == name; });
    };
    for (const std::string& name : job.config.rules.named_parts()) {
      if (!is_part(name)) out_.unused_parts.push_back(name);
    }
    for (const std::string& name : job.parts) {
      if (!is_part(name)) fail_part(name);
    }
  }

  FixedCharacter run() {
    const bool has_own = job_.recordings.empty() || job_.numbers;
    if (has_own && rig().clips.empty()) fail("has no clips to mend (--motion brings one)");
    if (animated_->asset()->bone_count() == 0 || rig().bones.empty()) fail("no bones move it");
    if (are_bound_at_one_place())
      fail("its joints are all bound at one place, and turn about no point of their own (bind them where they are)");
    clip_count_ = job_.recordings.size();
    if (has_own) clip_count_ += job_.numbers ? job_.numbers->size() : animated_->clips().size();
    if (has_own) fix_own();
    for (const std::string& recording : job_.recordings) fix_recording(recording);
    for (std::size_t d = 0; d < job_.decisions.size(); ++d) {
      if (is_used_[d] == 0) out_.unused_decisions.push_back(job_.decisions[d]);
    }
    return std::move(out_);
  }

 private:
  const SourceRig& rig() const { return animated_->character().rig; }
  // Whether the skin alone says where joints turn, or they turn about places that lie far apart and are bound near one.
  bool are_bound_at_one_place() const {
    if (rig().pivots.empty() || rig().are_pivots_from_skin) return rig().are_pivots_from_skin;
    Eigen::AlignedBox3d bound, turning;
    for (const Bone& bone : rig().bones) {
      turning.extend(rig().pivots[bone.node]);
      if (std::abs(bone.inverse_bind.linear().determinant()) > 0)
        bound.extend(Vec3(bone.inverse_bind.inverse().translation()));
    }
    constexpr double kNear = 0.3;
    return bound.isEmpty() || bound.diagonal().norm() < kNear * turning.diagonal().norm();
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, job_.input + ": " + what); }
  [[noreturn]] void fail_part(const std::string& name) const {
    std::string all;
    for (const BodyPart& part : parts_) all += (all.empty() ? "" : ", ") + part.name;
    throw Error(ExitCode::kUsage, "--parts: " + job_.input + " has no '" + name + "' (it has " + all + ")");
  }

  void fix_own() {
    const std::vector<std::string> names = unique_clip_names(rig());
    const auto number_of = [&](const ClipFrames& clip) {
      return static_cast<std::size_t>(clip.clip - rig().clips.data());
    };
    std::vector<ClipFrames> clips = animated_->clips();
    std::erase_if(clips, [&](const ClipFrames& clip) {
      return job_.numbers &&
             std::find(job_.numbers->begin(), job_.numbers->end(), number_of(clip)) == job_.numbers->end();
    });
    if (job_.is_fbx_written) {
      std::vector<const Clip*> read;
      for (const ClipFrames& clip : clips) read.push_back(clip.clip);
      check_turnable_clips(out_.bytes, job_.input, read);
    }
    for (const ClipFrames& clip : clips) {
      const std::vector<Channel> turned =
          mend(clip, roles_, [&](const KnownEvent& event) { return event.clip == names[number_of(clip)]; });
      if (job_.is_fbx_written)
        out_.bytes = with_turned_joints(out_.bytes, job_.input, rig(), *clip.clip, turned,
                                        out_.clips.back().mend.in_window, clip.fps);
      else
        out_.bytes = with_channels(out_.bytes, job_.input, rig(), clip.clip->in_file, {}, turned);
    }
  }

  void fix_recording(const std::string& recording) {
    report_("carrying over");
    const auto carried =
        carried_motion(recording, rig(), animated_->character().source_positions, animated_->frame(), job_.input);
    Clip before = carried->clip();
    before.name = free_name(fs::path(recording).stem().string());
    animated_->play_clip(before, {0, 0});
    const ClipFrames clip = animated_->clips()[0];
    const Roles roles = job_.is_recording_written ? recorded_roles(*carried) : roles_;
    const std::vector<Channel> turned =
        mend(clip, roles, [&](const KnownEvent& event) { return is_end_of(event.clip, recording); });
    const Clip& after = out_.after.back();
    if (job_.is_recording_written) {
      out_.bytes = turned_recording(*carried, rig(), before, after, out_.clips.back().mend.in_window, clip.fps);
      return;
    }
    out_.bytes = with_channels(out_.bytes, job_.input, rig(), -1, after.name, after.channels);
  }

  std::string free_name(const std::string& wanted) {
    std::string name = wanted;
    const auto is_taken = [&](const Clip& clip) { return clip.name == name; };
    const auto any = [&](const std::vector<Clip>& clips) { return std::any_of(clips.begin(), clips.end(), is_taken); };
    for (int n = 2; any(rig().clips) || any(out_.before); ++n) name = fmt::format("{} ({})", wanted, n);
    return name;
  }

  // Roles of the joints that the recording contains. No other joint may turn.
  Roles recorded_roles(const CarriedMotion& carried) const {
    const std::vector<Index> nodes = carried.recorded_nodes();
    const std::set<Index> recorded(nodes.begin(), nodes.end());
    if (recorded.empty()) fail("none of its joints is in the recording alone (write a .glb)");
    Roles out = roles_;
    for (Index n = 0; n < out.of_node.size(); ++n) {
      if (!recorded.contains(n)) out.of_node[n].role.clear();
    }
    return out;
  }

  template <typename IsOfClip>
  std::vector<Channel> mend(const ClipFrames& clip, const Roles& roles, const IsOfClip& is_of_clip) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<const KnownEvent*> accepted;
    for (const KnownEvent& event : job_.baseline.events) {
      const bool is_it = is_end_of(event.character, job_.input) && is_of_clip(event);
      out_.is_in_baseline |= is_it;
      if (is_it && event.state == EventState::kAccepted) accepted.push_back(&event);
    }
    const auto leave = [&](const Event& event) {
      return !is_asked_for(event) || job_.config.rules.leaves_out(event.parts) ||
             !job_.config.rules.excuse(event).empty() ||
             std::any_of(accepted.begin(), accepted.end(), [&](const KnownEvent* known) {
               return is_same(*known, event, clip.fps) && !is_worse(*known, event);
             });
    };
    MendOptions options = job_.mend;
    options.is_soft_parted = !job_.parts.empty();  // who names a part means it
    const auto report = [&](const std::string& doing) { report_(clip_line(clip.name) + doing); };
    const ClipFacts facts = clip_facts(*animated_, roles, clip, options);
    MendedClip mended{clip.name, mend_clip(facts, leave, report)};
    decide(facts, report, mended);
    leave_out_others(mended);
    report("comparing");
    measure_acting(facts, mended);
    std::vector<Channel> turned;
    if (!mended.mend.is_still()) {
      const TurnedClip with_turns(rig(), *clip.clip, clip.fps, clip.own_count, mended.mend.joints);
      turned = turned_channels(with_turns, mended.mend.turns, mended.mend.in_window);
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    mended.seconds = seconds.count();
    out_.clips.push_back(std::move(mended));
    out_.before.push_back(*clip.clip);
    out_.after.push_back(with_rotations(*clip.clip, turned));
    return turned;
  }

  // "clip 3 of 12, walk: "
  std::string clip_line(const std::string& name) const {
    const std::string place = fmt::format("clip {} of {}, ", out_.clips.size() + 1, clip_count_);
    return (clip_count_ > 1 ? place : "") + name + ": ";
  }

  void decide(const ClipFacts& facts, const std::function<void(const std::string&)>& report, MendedClip& mended) {
    std::vector<char> is_refused(mended.mend.events.size(), 0);
    for (std::size_t d = 0; d < job_.decisions.size(); ++d) {
      for (std::size_t e = 0; e < is_refused.size(); ++e) {
        if (!job_.decisions[d].is_of(mended.name, mended.mend.events[e])) continue;
        is_used_[d] = 1;
        if (job_.decisions[d].is_refused) is_refused[e] = 1;
      }
    }
    if (std::find(is_refused.begin(), is_refused.end(), 1) == is_refused.end()) return;
    report("leaving what was refused");
    mended.refusals = refuse_events(facts, roles_, is_refused, mended.mend);
  }

  // Removes the events that nobody asked for.
  void leave_out_others(MendedClip& mended) const {
    std::vector<MendedEvent> events;
    std::vector<std::vector<std::size_t>> held_by;
    std::vector<std::size_t> places(mended.mend.events.size(), 0);
    for (std::size_t e = 0; e < places.size(); ++e) {
      places[e] = events.size();
      if (!is_asked_for(mended.mend.events[e].before)) continue;
      events.push_back(std::move(mended.mend.events[e]));
      if (!mended.refusals.held_by.empty()) held_by.push_back(mended.refusals.held_by[e]);
    }
    for (std::vector<std::size_t>& holders : held_by) {
      for (std::size_t& holder : holders) holder = places[holder];
    }
    mended.others = static_cast<int>(places.size() - events.size());
    mended.mend.events = std::move(events);
    mended.refusals.held_by = std::move(held_by);
  }

  void measure_acting(const ClipFacts& facts, MendedClip& mended) const {
    ActingMeasure measure(facts, roles_);
    mended.acting = measure.of_clip(mended.mend.turns);
    for (std::size_t e = 0; e < mended.mend.events.size(); ++e) {
      mended.event_acting.push_back(measure.of_event(mended.mend.events, e, mended.mend.turns));
    }
  }

  bool is_asked_for(const Event& event) const {
    return job_.parts.empty() || std::any_of(job_.parts.begin(), job_.parts.end(), [&](const std::string& part) {
             return part == event.parts[0] || part == event.parts[1];
           });
  }

  const FixJob& job_;
  const Roles& roles_;
  const std::function<void(const std::string&)>& report_;
  std::optional<AnimatedAsset> animated_;
  std::vector<BodyPart> parts_;
  std::size_t clip_count_ = 0;  // that are to be fixed
  std::vector<char> is_used_;   // by decision
  FixedCharacter out_;
};

}  // namespace

FixedCharacter fix_character(const FixJob& job, const std::function<void(const std::string&)>& report) {
  std::string bytes;
  if (job.is_fbx_written) {
    check_regular_file(job.input);
    bytes = read_file(job.input);
    check_turnable_fbx(bytes, job.input);
  } else if (!job.is_recording_written) {
    bytes = read_as_glb(job.input);
  }
  Bake baked = bake(job.input, job.config.bake, report);
  RiggedSource source{job.input, nullptr};
  if (!job.recordings.empty() && baked.character.rig.bones.empty()) {
    bytes = rigged_glb(job.is_recording_written ? read_as_glb(job.input) : bytes, job.input, baked);
    source.folder = std::make_shared<WorkFolder>(fs::temp_directory_path());
    source.file = (source.folder->path() / fs::path(job.input).stem()).string() + ".glb";
    write_atomically(source.file, bytes);
    const std::vector<std::string> said = take_notes();  // the same that it says now
    baked = bake(source.file, job.config.bake, report);
    take_notes();
    for (const std::string& note : said) add_note(note);
  }
  return Fixer(job, std::move(source), std::move(bytes), baked, report).run();
}

double carried_over_again(const FixedCharacter& fixed, const std::string& input, const std::string& recording) {
  const AnimatedAsset animated(OpenAsset(fixed.asset, input), input, fixed.source.file, {}, {});
  const Character& character = animated.character();
  const SourceRig& rig = character.rig;
  const auto carried = carried_motion(recording, rig, character.source_positions, animated.frame(), input);
  constexpr std::size_t kVertices = 500;
  std::vector<Vec3> sample_positions;
  std::vector<VertexWeights> weights;
  const std::size_t step = std::max<std::size_t>(1, character.source_positions.size() / kVertices);
  for (std::size_t v = 0; v < character.source_positions.size(); v += step) {
    sample_positions.push_back(character.source_positions[v]);
    weights.push_back(rig.weights[v]);
  }
  const Clip& wanted = fixed.after.back();
  double farthest = 0;
  const double fps = carried->rate();
  for (int frame = 0; frame < frames_in(carried->duration(), fps); ++frame) {
    const double seconds = frame / fps, t = carried->duration() > 0 ? seconds / carried->duration() : 0;
    const std::vector<Vec3> a = deform(sample_positions, weights, carried->at(t).bones),
                            b = deform(sample_positions, weights, sample(rig, wanted, seconds).bones);
    for (std::size_t v = 0; v < a.size(); ++v) farthest = std::max(farthest, (a[v] - b[v]).norm());
  }
  return farthest * mm_per_unit(animated.asset());
}

}  // namespace spherechain::baker
