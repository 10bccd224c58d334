// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/attempt.h"
#include "baker/wrap/closing_report.h"

namespace spherechain::baker {

struct WrapSize {
  double fineness;           // the skin's diameter over alpha
  bool holes_first = false;  // the skin's holes are closed by fans before
};

// The largest closed surface around a skin in any state, drawn on to the skin where it is near.
struct Wrap {
  Mesh surface;
  WrapSize size;
  double thin;  // share of its area with nothing but offset behind it: cloth, or it has got inside through a hole

  // True if so much is thin that the wrap lines the skin from inside. Capes and hair are thin, too, but smaller.
  bool lines_skin() const;
};

inline constexpr std::size_t kWrapTrianglesMax = 100'000;

// Counts and times itself in `report`. There is no wrap of more than kWrapTrianglesMax triangles.
Attempt<Wrap> wrap_skin(const Mesh& skin, const WrapSize& size, ClosingReport& report);

// The wrap as a body. It has no triangle of the source.
BodyMesh body_of(const Wrap& wrap, const Character& character);
// Says in `report` that the body is this wrap.
void report_wrap(const Wrap& wrap, ClosingReport& report);

}  // namespace spherechain::baker
