// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "baker/events/event.h"
#include "baker/events/join_events.h"
#include "baker/play/play.h"
#include "baker/play/skin_player.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// Two triangles of the skin that intersect: one of the part with the lesser number, one of the other.
using TrianglePair = std::array<std::uint32_t, 2>;

// True if reports show the triangles of contacts of that class.
inline bool is_shown(PenetrationClass kind) { return is_fault(kind) || kind == SC_CLASS_TOUCH; }

// Everything that touches in the frames of a clip.
struct ClipEvents {
  std::vector<FramePenetration> penetrations;       // by frame, then by parts
  std::vector<std::vector<TrianglePair>> contacts;  // of each penetration that is shown
  std::vector<EventSpan> spans;                     // of each event
  std::vector<Event> events;                        // by where they begin; without eyes and pictures
  bool loops = false;                               // the last frame is the first again
  std::string unseen;                               // text of unseen_text()
};

// Finds the events of one character's clips, one clip after another.
class EventFinder {
 public:
  // `animated` must outlive it, and may play other motions in between.
  EventFinder(const AnimatedAsset& animated, Target target, const BodyFrame& axes);

  // Looks at all frames of one of animated.clips(), then measures the worst frame of each event in full. `observe` is
  // called with each frame's pose before the frame is looked at.
  ClipEvents find(const ClipFrames& clip, const std::function<void(int frame, const Deformation&)>& observe);

 private:
  void look(const ClipFrames& clip, const std::function<void(int, const Deformation&)>& observe, ClipEvents& out);
  void measure(const ClipFrames& clip, FramePenetration& penetration, std::vector<TrianglePair>& triangles);
  void find_worst(const ClipFrames& clip, ClipEvents& found, EventSpan& span);
  Event event_of(const ClipFrames& clip, const ClipEvents& found, const EventSpan& span) const;

  const AnimatedAsset& animated_;
  SkinPlayer player_;
  BodyParts parts_;
  double mm_;  // a unit of the source
  BodyFrame axes_;
};

}  // namespace spherechain::baker
