// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/turned_fbx.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "baker/fix/fbx_joint.h"
#include "baker/fix/turned_clip.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr double kUnturnedMost = 1e-6;  // radians

class FbxTurner {
 public:
  FbxTurner(const FbxFile& fbx, const std::string& file, const SourceRig& rig, const Clip& before,
            const std::vector<char>& in_window, double fps)
      : fbx_(fbx),
        file_(file),
        rig_(rig),
        before_(before),
        in_window_(in_window),
        fps_(fps),
        animation_(fbx, file, before),
        start_(animation_.start_of(rig, before)),
        changes_(fbx.tree) {
    for (const FbxRecord& object : fbx.tree.find("Objects")->inside) {
      const std::vector<FbxValue> values = fbx.tree.values(object);
      if (!values.empty() && values[0].whole) taken_ids_.insert(*values[0].whole);
    }
  }

  void turn(const Channel& turned) {
    const Node& node = rig_.nodes[turned.target];
    const FbxObject* const model = animation_.object(node.fbx_id);
    if (model == nullptr || !turned_models_.insert(model->id).second) fail(node.name, "is no model of its own");
    check_axes(*model);
    const JointAngles angles(*model);
    AnimatedProperty rotation(fbx_, animation_, *model, "Lcl Rotation", file_);
    check_same(rotation, angles, turned.target);
    std::optional<AnimatedProperty> translation;
    if (!angles.arm().isZero(1e-9)) translation.emplace(fbx_, animation_, *model, "Lcl Translation", file_);
    std::set<std::int64_t> own = rotation.ticks();
    if (translation) own.merge(translation->ticks());
    for (const Run& run : runs_of(turned, own)) {
      const std::vector<Vec3> degrees = degrees_of(turned, rotation, angles, run);
      for (std::size_t k = 0; k < run.size(); ++k) {
        const std::int64_t tick = run[k];
        const auto [from, to] = turn_at(turned, seconds_of(tick));
        const bool turns = from.angularDistance(to) > kUnturnedMost;
        rotation.set(tick, degrees[k], turns || (degrees[k] - rotation.at(tick)).norm() > kUnturnedMost);
        // A turn about a pivot would move the joint.
        if (translation) translation->set(tick, translation->at(tick) + from * angles.arm() - to * angles.arm(), turns);
      }
      rotation.lead(run.front(), run.back());
      if (translation) translation->lead(run.front(), run.back());
    }
    write(rotation);
    if (translation) write(*translation);
  }

  std::string bytes() {
    count_new_objects();
    return changes_.bytes();
  }

 private:
  using Run = std::vector<std::int64_t>;  // times of keys

  [[noreturn]] void fail(std::string_view joint, const std::string& what) const {
    throw Error(ExitCode::kFile, file_ + ": the joint '" + std::string(joint) + "' " + what + " (write a .glb)");
  }

  void check_axes(const FbxObject& model) {
    const double order = model.value("RotationOrder")[0];
    if (!(order >= 0 && order < 6)) fail(model.name, "has a spheric rotation order, which is no angles about axes");
    constexpr std::array<double, 3> kNone{};
    const bool has_more = order != 0 || model.value("PreRotation") != kNone || model.value("PostRotation") != kNone;
    if (has_more && model.value("RotationActive")[0] == 0 && !std::exchange(has_inactive_, true)) {
      add_note(
          file_ + ": the joint '" + std::string(model.name) +
          "' has a pre- or post-rotation or a rotation order, but not RotationActive: such joints are read as if " +
          "they had");
    }
  }

  // A joint's rotation before and after.
  std::pair<Eigen::Quaterniond, Eigen::Quaterniond> turn_at(const Channel& turned, double seconds) const {
    return {rotation_at(rig_, before_, turned.target, seconds), Eigen::Quaterniond(sample(turned, seconds))};
  }

  // The new angles. They go on from key to key, or jump where the file's own do, whichever jumps less: keys outside of
  // the run stay.
  std::vector<Vec3> degrees_of(const Channel& turned, const AnimatedProperty& rotation, const JointAngles& angles,
                               const Run& run) const {
    const std::set<std::int64_t> own = rotation.ticks();
    const auto left = own.lower_bound(run.front()), right = own.upper_bound(run.back());
    std::vector<Vec3> best;
    double least = HUGE_VAL;
    for (const bool jumps : {true, false}) {
      std::vector<Vec3> degrees;
      Vec3 last = rotation.at(left == own.begin() ? run.front() : *std::prev(left));
      double change = 0;
      std::int64_t before = run.front();
      for (const std::int64_t tick : run) {
        const auto [from, to] = turn_at(turned, seconds_of(tick));
        const bool is_old = degrees.empty() || from.angularDistance(to) <= kUnturnedMost;
        Vec3 near = degrees.empty() ? rotation.at(tick) : last;
        if (jumps) near = is_old ? rotation.at(tick) : Vec3(last + rotation.at(tick) - rotation.at(before));
        degrees.push_back(angles.degrees(to, near));
        change += (degrees.back() - last).norm();
        last = degrees.back();
        before = tick;
      }
      if (right != own.end()) change += (rotation.at(*right) - last).norm();
      constexpr double kLess = 1;  // degrees
      if (change > least - kLess) continue;
      least = change;
      best = std::move(degrees);
    }
    return best;
  }

  double seconds_of(std::int64_t tick) const { return static_cast<double>(tick - start_) / kFbxTicks; }

  // Throws if the file turns the joint otherwise than the clip that was read from it. Axes without a curve may have
  // either of two values: the model's own or the curve node's.
  void check_same(const AnimatedProperty& rotation, const JointAngles& angles, Index node) const {
    constexpr double kSame = 5e-3;  // radians
    const Vec3 rest(rotation.model().value(rotation.name()).data());
    std::set<std::int64_t> ticks = rotation.ticks();
    if (ticks.empty()) ticks = {start_, start_ + std::llround(before_.duration * kFbxTicks)};
    for (const std::int64_t tick : ticks) {
      const double seconds = seconds_of(tick);
      if (!rotation.is_key_of_all(tick) || seconds < -kSnap || seconds > before_.duration + kSnap) continue;
      const Eigen::Quaterniond wanted = rotation_at(rig_, before_, node, seconds);
      const auto is_it = [&](const Vec3& constants) {
        return angles.rotation(rotation.at(tick, constants)).angularDistance(wanted) < kSame;
      };
      if (!is_it(rotation.still()) && !is_it(rest))
        fail(rotation.model().name, "turns otherwise in the file than in the clip '" + before_.name + "'");
    }
  }

  // The windows in which the joint turns, and one frame beside them: each frame, and the keys that are there.
  std::vector<Run> runs_of(const Channel& turned, const std::set<std::int64_t>& own) const {
    const int count = static_cast<int>(in_window_.size());
    const auto is_open = [&](int f) { return f >= 0 && f < count && in_window_[static_cast<std::size_t>(f)] != 0; };
    std::vector<Run> out;
    for (int f = 0; f < count; ++f) {
      std::set<std::int64_t> ticks;
      bool turns = false;
      for (; f < count && (is_open(f - 1) || is_open(f) || is_open(f + 1)); ++f) {
        const double seconds = f / fps_;
        const auto [from, to] = turn_at(turned, seconds);
        turns = turns || from.angularDistance(to) > kUnturnedMost;
        const std::int64_t tick = start_ + std::llround(seconds * kFbxTicks);
        const auto near = own.lower_bound(tick - kSnapTicks);
        ticks.insert(near != own.end() && *near <= tick + kSnapTicks ? *near : tick);
      }
      if (!turns) continue;
      ticks.insert(own.lower_bound(*ticks.begin()), own.upper_bound(*ticks.rbegin()));
      out.emplace_back(ticks.begin(), ticks.end());
    }
    return out;
  }

  void write(const AnimatedProperty& property) {
    const FbxRecord &objects = *fbx_.tree.find("Objects"), &links = *fbx_.tree.find("Connections");
    const auto link = [&](std::int64_t child, std::int64_t parent, const std::string& to) {
      FbxNewRecord record{"C", {std::string(to.empty() ? "OO" : "OP"), child, parent}, {}};
      if (!to.empty()) record.values.emplace_back(to);
      changes_.append(links, std::move(record));
    };
    const FbxAnimation::Track& track = property.track();
    const auto axis_name = [](std::size_t axis) { return std::string("d|") + "XYZ"[axis]; };
    const std::int64_t node = track.node == nullptr ? new_id() : track.node->id;
    if (track.node == nullptr) {
      FbxNewRecord properties{"Properties70", {}, {}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        properties.inside.push_back({"P",
                                     {axis_name(axis), std::string("Number"), std::string(), std::string("A"),
                                      property.still()[static_cast<Eigen::Index>(axis)]},
                                     {}});
      }
      const std::string letter = property.name() == "Lcl Rotation" ? "R" : "T";
      changes_.append(objects, {"AnimationCurveNode",
                                {node, letter + std::string("\0\1AnimCurveNode", 15), std::string()},
                                {std::move(properties)}});
      ++new_nodes_;
      link(node, track.layer->id, {});
      link(node, property.model().id, property.name());
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (track.curves[axis] != nullptr) {
        property.after()[axis].write(changes_);
      } else if (!property.after()[axis].is_empty()) {
        const std::int64_t id = new_id();
        changes_.append(objects, property.after()[axis].record(id));
        ++new_curves_;
        link(id, node, axis_name(axis));
      }
    }
  }

  // Small numbers: some readers have no exact ones above 2^53.
  std::int64_t new_id() {
    while (!taken_ids_.insert(next_id_).second) ++next_id_;
    return next_id_;
  }

  // Definitions say how many objects of each type there are.
  void count_new_objects() {
    const FbxRecord* const definitions = fbx_.tree.find("Definitions");
    if (definitions == nullptr || new_curves_ == 0) return;
    const auto add = [&](const FbxRecord& in, int more) {
      const FbxRecord* const count = in.find("Count");
      const auto values = count == nullptr ? std::vector<FbxValue>() : fbx_.tree.values(*count);
      if (more > 0 && values.size() == 1 && values[0].whole)
        changes_.set_whole(*count, static_cast<std::int32_t>(*values[0].whole + more));
    };
    add(*definitions, new_nodes_ + new_curves_);
    for (const FbxRecord& type : definitions->inside) {
      const std::vector<FbxValue> values = fbx_.tree.values(type);
      if (type.name != "ObjectType" || values.empty()) continue;
      if (values[0].text == "AnimationCurve") add(type, new_curves_);
      if (values[0].text == "AnimationCurveNode") add(type, new_nodes_);
    }
  }

  static constexpr double kSnap = 1e-4;  // seconds: a frame and a key nearer than this are one
  static constexpr std::int64_t kSnapTicks = static_cast<std::int64_t>(kSnap * kFbxTicks);

  const FbxFile& fbx_;
  const std::string& file_;
  const SourceRig& rig_;
  const Clip& before_;
  const std::vector<char>& in_window_;
  double fps_;
  FbxAnimation animation_;
  std::int64_t start_;  // the clip's time 0
  FbxChanges changes_;
  std::set<std::int64_t> turned_models_, taken_ids_;
  std::int64_t next_id_ = 1000000;
  int new_nodes_ = 0, new_curves_ = 0;
  bool has_inactive_ = false;  // of which a note tells
};

}  // namespace

void check_turnable_fbx(const std::string& fbx, const std::string& file) {
  if (!is_fbx(fbx))
    throw Error(ExitCode::kUsage, file + ": is no FBX file, which an .fbx is written of (name the output .glb)");
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, file + ": " + what); };
  const FbxTree tree = parse_fbx(fbx);
  if (tree.version < 7000 || tree.version >= 8000) {
    fail("is FBX " + std::to_string(tree.version / 1000) + "." + std::to_string(tree.version / 100 % 10) +
         ", and an .fbx is written of FBX 7 alone (save it as that, or write a .glb)");
  }
  const FbxRecord *const objects = tree.find("Objects"), *const links = tree.find("Connections");
  if (!tree.is_whole || objects == nullptr || objects->inside_end == 0 || links == nullptr || links->inside_end == 0)
    fail("its records are damaged or cut off: it cannot be written as an .fbx (export it again, or write a .glb)");
}

void check_turnable_clips(const std::string& fbx, const std::string& file, const std::vector<const Clip*>& clips) {
  const FbxFile read = read_fbx(fbx);
  for (const Clip* clip : clips) FbxAnimation(read, file, *clip);
}

std::string with_turned_joints(const std::string& fbx, const std::string& file, const SourceRig& rig,
                               const Clip& before, const std::vector<Channel>& turned,
                               const std::vector<char>& in_window, double fps) {
  if (turned.empty()) return fbx;
  check_turnable_fbx(fbx, file);
  const FbxFile read = read_fbx(fbx);
  FbxTurner turner(read, file, rig, before, in_window, fps);
  for (const Channel& channel : turned) turner.turn(channel);
  try {
    return turner.bytes();
  } catch (const std::length_error&) {
    throw Error(ExitCode::kFile, file + ": would be longer than 4 GB, which FBX 7.4 has no room for (save it as 7.5)");
  }
}

}  // namespace spherechain::baker
