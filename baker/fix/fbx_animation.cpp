// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/fbx_animation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/fix/fbx_curve.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

std::string in_quotes(std::string_view name) { return "'" + std::string(name) + "'"; }

}  // namespace

FbxAnimation::FbxAnimation(const FbxFile& fbx, const std::string& file, const Clip& clip) : fbx_(fbx), file_(file) {
  for (const FbxObject& object : fbx.objects) objects_.emplace(object.id, &object);
  for (const FbxLink& link : fbx.links) {
    by_parent_.emplace(link.parent, &link);
    by_child_.emplace(link.child, &link);
    child_and_parent_.emplace(link.child, link.parent);
  }
  stack_ = clip.fbx_id == 0 ? nullptr : object(clip.fbx_id);
  if (stack_ == nullptr)
    throw Error(ExitCode::kFile, file + ": has no stack for the clip " + in_quotes(clip.name) + " (write a .glb)");
  const auto below = by_parent_.equal_range(stack_->id);
  for (auto link = below.first; link != below.second; ++link) {
    const FbxObject* const layer = object(link->second->child);
    if (layer != nullptr && layer->kind == FbxKind::kLayer) layers_.push_back(layer);
  }
  if (layers_.empty())
    throw Error(ExitCode::kFile, file + ": the stack " + in_quotes(stack_->name) + " has no layer (write a .glb)");
  for (const FbxObject& model : fbx.objects) {
    if (model.kind == FbxKind::kModel) check_layers(model, tracks(model, "Lcl Rotation"));
  }
}

const FbxObject* FbxAnimation::object(std::int64_t id) const {
  const auto found = objects_.find(id);
  return found == objects_.end() ? nullptr : found->second;
}

FbxAnimation::Track FbxAnimation::track(const FbxObject& layer, std::int64_t node) const {
  Track out{&layer, object(node), {}};
  const auto below = by_parent_.equal_range(node);
  for (auto link = below.first; link != below.second; ++link) {
    const FbxObject* const curve = object(link->second->child);
    if (curve == nullptr || curve->kind != FbxKind::kCurve) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (link->second->property == std::string("d|") + "XYZ"[axis]) out.curves[axis] = curve;
    }
  }
  return out;
}

std::vector<FbxAnimation::Track> FbxAnimation::tracks(const FbxObject& model, const std::string& property) const {
  std::vector<Track> out;
  const auto below = by_parent_.equal_range(model.id);
  for (const FbxObject* layer : layers_) {
    for (auto link = below.first; link != below.second; ++link) {
      const FbxObject* const node = object(link->second->child);
      if (link->second->property != property || node == nullptr || node->kind != FbxKind::kCurveNode) continue;
      if (child_and_parent_.contains({node->id, layer->id})) out.push_back(track(*layer, node->id));
    }
  }
  return out;
}

void FbxAnimation::check_layers(const FbxObject& model, const std::vector<Track>& tracks) const {
  std::string layers;
  int moving = 0;
  for (const Track& track : tracks) {
    if (track.has_curves()) layers += (moving++ == 0 ? "" : ", ") + in_quotes(track.layer->name);
  }
  if (moving < 2) return;
  throw Error(ExitCode::kFile, file_ + ": several layers of the stack " + in_quotes(stack_->name) + " move the joint " +
                                   in_quotes(model.name) + ": " + layers + " (merge them into one, or write a .glb)");
}

FbxAnimation::Track FbxAnimation::track_of(const FbxObject& model, const std::string& property) const {
  Track out{layers_.front(), nullptr, {}};
  const std::vector<Track> all = tracks(model, property);
  check_layers(model, all);
  for (const Track& track : all) {
    const bool is_better = track.has_curves() || (out.node == nullptr && track.layer == layers_.front());
    if (is_better && !out.has_curves()) out = track;
  }
  const auto parents = [&](const FbxObject* one, FbxKind kind) {
    const auto above = by_child_.equal_range(one->id);
    return std::count_if(above.first, above.second, [&](const auto& link) {
      const FbxObject* const parent = object(link.second->parent);
      return parent != nullptr && parent->kind == kind;
    });
  };
  bool shares =
      out.node != nullptr && (parents(out.node, FbxKind::kLayer) > 1 || parents(out.node, FbxKind::kModel) > 1);
  for (const FbxObject* curve : out.curves) shares |= curve != nullptr && parents(curve, FbxKind::kCurveNode) > 1;
  if (shares) {
    const std::string joint = "the joint " + in_quotes(model.name) + " in the stack " + in_quotes(stack_->name);
    throw Error(ExitCode::kFile, file_ + ": " + joint +
                                     " shares its curves with another joint or animation (bake the animations, or "
                                     "write a .glb)");
  }
  return out;
}

// Assimp reads the keys between the stack's ends, and the clip begins with its first. A joint's last key in the file is
// its last in the clip, too. The median of all joints leaves aside those to which assimp adds keys.
std::int64_t FbxAnimation::start_of(const SourceRig& rig, const Clip& clip) const {
  double first = stack_->value("LocalStart")[0], last = stack_->value("LocalStop")[0];
  constexpr double kSlack = 10000;  // ticks
  if (first == 0 && last == 0) {
    first = std::numeric_limits<double>::lowest();
    last = std::numeric_limits<double>::max();
  }
  std::map<std::int64_t, std::int64_t> last_of_model;
  for (const FbxObject* layer : layers_) {
    const auto nodes = by_parent_.equal_range(layer->id);
    for (auto node = nodes.first; node != nodes.second; ++node) {
      const auto above = by_child_.equal_range(node->second->child);
      const auto to_model = std::find_if(above.first, above.second,
                                         [](const auto& one) { return one.second->property.starts_with("Lcl "); });
      if (to_model == above.second) continue;
      for (const FbxObject* curve : track(*layer, node->second->child).curves) {
        const FbxRecord* const times = curve == nullptr ? nullptr : curve->record->find("KeyTime");
        const auto array = times == nullptr ? std::nullopt : fbx_.tree.array(*times);
        if (!array) continue;
        for (std::size_t k = array->items.size(); k-- > 0;) {
          const std::int64_t tick = array->whole(k);
          const auto time = static_cast<double>(tick);
          if (!is_fbx_time(tick) || time < first - kSlack || time > last + kSlack) continue;
          const auto known = last_of_model.emplace(to_model->second->parent, tick).first;
          known->second = std::max(known->second, tick);
          break;
        }
      }
    }
  }
  std::map<std::int64_t, double> end_of_model;
  for (const Channel& channel : clip.channels) {
    if (channel.path == ChannelPath::kMorphWeight || channel.times.empty()) continue;
    double& end = end_of_model[rig.nodes[channel.target].fbx_id];
    end = std::max(end, channel.times.back());
  }
  std::vector<std::int64_t> starts;
  for (const auto& [model, tick] : last_of_model) {
    const auto end = end_of_model.find(model);
    if (end != end_of_model.end()) starts.push_back(tick - std::llround(end->second * kFbxTicks));
  }
  if (starts.empty()) {
    throw Error(ExitCode::kFile, file_ + ": the stack " + in_quotes(stack_->name) +
                                     " has no keys that its clip was read from (write a .glb)");
  }
  const auto middle = starts.begin() + static_cast<std::ptrdiff_t>(starts.size() / 2);
  std::nth_element(starts.begin(), middle, starts.end());
  return *middle;
}

}  // namespace spherechain::baker
