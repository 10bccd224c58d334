// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/segment_wraps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "baker/segment/by_shape.h"
#include "baker/wrap/wrap_skin.h"

namespace spherechain::baker {
namespace {

// Whether a coarse wrap is of a character, not of a cloud of triangles.
bool is_one_shape(const Mesh& wrap) {
  // A human's has 5,600 triangles at fineness 60.
  constexpr std::size_t kTrianglesMax = 20'000;
  constexpr std::ptrdiff_t kHandlesMax = 20;
  const auto faces = static_cast<std::ptrdiff_t>(wrap.triangles.size());
  const std::ptrdiff_t handles = 1 - (static_cast<std::ptrdiff_t>(wrap.positions.size()) - faces / 2) / 2;
  return wrap.triangles.size() <= kTrianglesMax && handles <= kHandlesMax;
}

std::string name_of(const WrapSize& size) {
  return fmt::format("shape of a wrap with alpha = diameter / {:.0f}{}", size.fineness,
                     size.holes_first ? ", holes closed first" : "");
}

// On a human the balls are of 14, 9, 20, 30 and 45 mm. At 20 mm armpit and crotch are webbed enough to see; at 30 mm
// the arms of an A-pose may have grown to the body.
class WrapSearch {
 public:
  WrapSearch(const Character& character, const SegmentSettings& settings, const std::optional<Reason>& of_body,
             ClosingReport& closing)
      : character_(character), settings_(settings), closing_(closing), reason_(of_body) {}

  Attempt<SegmentedWrap> run(std::vector<PassedOver>& passed_over) {
    constexpr std::size_t kTrianglesMin = 48;  // a trunk and five limbs, each of four sides
    if (character_.skin.triangles.size() < kTrianglesMin) return Reason{"it has too few triangles for five limbs"};
    const Reason no_body{"its triangles enclose no body (close the holes that are as wide as its limbs)"};
    // A coarse wrap is quick.
    constexpr WrapSize kCoarse{60};
    Attempt<Wrap> coarse = wrap_skin(character_.skin, kCoarse, closing_);
    if (!coarse || !is_one_shape(coarse->surface)) return no_body;
    triangles_ = coarse->surface.triangles.size();
    if (coarse->lines_skin()) {
      // Through holes wider than the ball, and finer wraps would be slow: holes closed by fans, or larger balls.
      for (const WrapSize& size : {WrapSize{60, true}, WrapSize{90, true}, WrapSize{40}, WrapSize{40, true}}) {
        if (attempt(size) == WrapResult::kGood) break;
      }
    } else {
      constexpr double kOfHuman = 6000;  // triangles at 60; stouter bodies have more, and shorter limbs to tell apart
      const double usual = 130 * std::min(1.0, std::sqrt(kOfHuman / static_cast<double>(triangles_)));
      const WrapResult first = attempt({usual});
      const double finest = usual * std::sqrt(static_cast<double>(kWrapTrianglesMax) / static_cast<double>(triangles_));
      for (const double fineness : {200.0, 90.0, kCoarse.fineness}) {
        if (first == WrapResult::kGood || (first == WrapResult::kLeaks && fineness > usual) || fineness > finest)
          continue;
        const bool is_coarse = fineness == kCoarse.fineness;
        if ((is_coarse ? attempt(kCoarse, std::move(coarse)) : attempt({fineness})) == WrapResult::kGood) break;
      }
    }
    for (std::size_t i = 0; i < tried_.size(); ++i) {
      if (!best_ || i != best_->tried) passed_over.push_back(tried_[i]);
    }
    if (!best_) return reason_.value_or(no_body);
    report_wrap(best_->wrap, closing_);
    return SegmentedWrap{std::move(best_->regions), tried_[best_->tried].strategy};
  }

 private:
  enum class WrapResult : std::uint8_t { kGood, kLeaks, kFails };

  struct Result {
    Regions regions;
    Wrap wrap;
    std::size_t tried;  // its place in tried_
  };

  WrapResult attempt(const WrapSize& size) { return attempt(size, wrap_skin(character_.skin, size, closing_)); }

  WrapResult attempt(const WrapSize& size, Attempt<Wrap> wrap) {
    tried_.push_back({name_of(size), {}});
    Reason& reason = tried_.back().reason;
    if (!wrap) {
      reason = wrap.reason();
      return WrapResult::kFails;
    }
    triangles_ = wrap->surface.triangles.size();
    if (wrap->lines_skin()) {
      reason = {"it lines the skin from inside"};
      return WrapResult::kLeaks;
    }
    constexpr double kThinGood = 0.02;
    const bool leaks = wrap->thin > kThinGood;
    Attempt<Regions> regions = segment_by_shape(character_, body_of(*wrap, character_), settings_);
    if (!regions) {
      reason = regions.reason();
      if (!reason_) reason_ = reason;
      return leaks ? WrapResult::kLeaks : WrapResult::kFails;
    }
    reason = {"another wrap is better"};
    const bool expected = is_expected(*regions, settings_);
    // A wrap's false branches make six legs of four: limbs that are not a biped's count when two wraps have as many.
    const bool again = !expected && best_ && best_->regions.limbs.size() == regions->limbs.size();
    if (!best_ || is_better(expected, wrap->thin)) {
      best_ = Result{std::move(*regions), std::move(*wrap), tried_.size() - 1};
    }
    if (leaks) return WrapResult::kLeaks;
    return expected || again ? WrapResult::kGood : WrapResult::kFails;
  }

  bool is_better(bool expected, double thin) const {
    const bool best_expected = is_expected(best_->regions, settings_);
    return expected != best_expected ? expected : thin < best_->wrap.thin;
  }

  const Character& character_;
  const SegmentSettings& settings_;
  ClosingReport& closing_;
  std::optional<Reason> reason_;  // the first: of the body, or of the finest wrap
  std::optional<Result> best_;
  std::vector<PassedOver> tried_;
  std::size_t triangles_ = 0;  // of the latest wrap
};

}  // namespace

bool is_expected(const Regions& regions, const SegmentSettings& settings) {
  return settings.body != BodyKind::kUnknown || is_biped(regions);
}

Attempt<SegmentedWrap> segment_wraps(const Character& character, const SegmentSettings& settings,
                                     const std::optional<Reason>& of_body, ClosingReport& closing,
                                     std::vector<PassedOver>& passed_over) {
  return WrapSearch(character, settings, of_body, closing).run(passed_over);
}

}  // namespace spherechain::baker
