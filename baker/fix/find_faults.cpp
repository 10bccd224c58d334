// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/find_faults.h"

#include <algorithm>
#include <exception>
#include <thread>

#include "play/target.h"

namespace spherechain::baker {
namespace {

// Calls work(thread, i) for all i, neighbours on one thread.
template <typename Work>
void on_threads(std::size_t threads, std::size_t count, const Work& work) {
  std::vector<std::exception_ptr> failures(threads);
  const auto run = [&](std::size_t t) {
    try {
      for (std::size_t i = t * count / threads; i < (t + 1) * count / threads; ++i) work(t, i);
    } catch (...) {
      failures[t] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (std::size_t t = 1; t < threads; ++t) others.emplace_back(run, t);
  run(0);
  for (std::thread& thread : others) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

std::vector<Meeting> joined(std::vector<std::vector<Meeting>> lists) {
  std::vector<Meeting> out;
  for (const std::vector<Meeting>& list : lists) out.insert(out.end(), list.begin(), list.end());
  return out;
}

}  // namespace

FaultFinder::FaultFinder(const AnimatedAsset& animated, const TurnedClip& clip) : animated_(animated), clip_(clip) {
  const std::size_t threads = std::clamp(std::thread::hardware_concurrency(), 1U, 16U);
  for (std::size_t t = 0; t < threads; ++t) {
    players_.emplace_back(animated.asset(), choose_target("auto"));
    steps_.emplace_back(animated, choose_target("auto"));
  }
}

std::vector<Meeting> FaultFinder::look(SkinPlayer& player, double frame, const std::vector<Vec3>& turns,
                                       Depth depth) const {
  const BonePose bones(animated_.asset(), clip_.pose_of(frame, turns).deformation);
  const sc_pose pose = bones.pose();
  std::vector<Meeting> out;
  std::vector<TriangleContact> contacts = player.find(pose);
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(),
                     [&](const TriangleContact& c) { return left_out_.contains(std::minmax(c.part_a, c.part_b)); }),
      contacts.end());
  for (const Penetration& quick : player.measure_quickly(pose, contacts)) out.push_back({frame, quick});
  if (depth == Depth::kQuick) return out;
  for (Meeting& meeting : out) {
    if (!is_fault(meeting.found.kind)) continue;
    std::vector<TriangleContact> of_them;
    for (const TriangleContact& contact : contacts) {
      const auto [a, b] = std::minmax(contact.part_a, contact.part_b);
      if (a == meeting.found.part_a && b == meeting.found.part_b) of_them.push_back(contact);
    }
    meeting.found = player.measure_parts(pose, of_them);
  }
  return out;
}

std::vector<Meeting> FaultFinder::in_frames(const std::vector<double>& frames, const Turns& turns) {
  std::vector<std::vector<Meeting>> found(frames.size());
  on_threads(players_.size(), frames.size(), [&](std::size_t t, std::size_t i) {
    found[i] = look(players_[t], frames[i], clip_.turns_at(frames[i], turns), Depth::kFull);
  });
  return joined(std::move(found));
}

std::vector<std::vector<Meeting>> FaultFinder::in_poses(const std::vector<TriedPose>& poses) {
  std::vector<std::vector<Meeting>> found(poses.size());
  on_threads(players_.size(), poses.size(), [&](std::size_t t, std::size_t i) {
    found[i] = look(players_[t], poses[i].frame, poses[i].turns, Depth::kQuick);
  });
  return found;
}

std::vector<Meeting> FaultFinder::between(const std::vector<int>& frames, const Turns& turns) {
  std::vector<std::vector<Meeting>> found(frames.size());
  on_threads(players_.size(), frames.size(), [&](std::size_t t, std::size_t i) {
    const int frame = frames[i];
    if (frame + 1 >= clip_.frames()) return;
    const std::vector<StepContact> contacts =
        steps_[t].find(clip_.pose(frame, turns).deformation, clip_.pose(frame + 1, turns).deformation);
    for (const StepContact& contact : contacts) {
      if (contact.at_start != 0 || contact.at_end != 0) continue;
      const double middle = 0.5 * (double{contact.begin} + double{contact.end});
      for (const Meeting& meeting :
           look(players_[t], frame + middle, clip_.turns_at(frame + middle, turns), Depth::kFull)) {
        const auto [a, b] = std::minmax(contact.part_a, contact.part_b);
        if (meeting.found.part_a == a && meeting.found.part_b == b && is_fault(meeting.found.kind)) {
          found[i].push_back(meeting);
        }
      }
    }
  });
  return joined(std::move(found));
}

}  // namespace spherechain::baker
