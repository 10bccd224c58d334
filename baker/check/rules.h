// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "baker/check/results.h"
#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

enum class Severity { kError, kWarning, kIgnore };

// Rules for a library, written by a person: which penetrations are acceptable.
struct Rules {
  static constexpr double kAnyDepthMm = 1e6;

  // A depth that is allowed: in mm, in percent of the height, or whichever of them is more. 0: none is.
  struct Depth {
    double mm = 0, percent = 0;
    bool covers(const Event& event) const {
      return (mm > 0 && event.depth_mm <= mm) || (percent > 0 && event.depth_percent <= percent);
    }
    std::string text() const;  // "15 mm are allowed"
  };

  // The depth that a pair of parts may have; "*" stands for any part.
  struct Allowed {
    std::array<std::string, 2> parts;
    Depth depth;
  };
  std::vector<Allowed> allowed;
  std::vector<std::string> left_out;  // parts that are not checked
  Depth max_depth;                    // faults up to this depth are accepted
  Severity penetration = Severity::kError, deep_fold = Severity::kWarning;

  bool leaves_out(const std::array<std::string, 2>& parts) const;
  // Says in words which rule excuses a fault. Empty if none does.
  std::string excuse(const Event& event) const;
  // Body parts that any rule names.
  std::vector<std::string> named_parts() const;
  Severity severity(PenetrationClass kind) const;
};

// A config file: rules, and the settings of bakes.
struct CheckConfig {
  Rules rules;
  BakeSettings bake;
};

// `json` is an object with the keys `allow`, `filter`, `leave_out`, `max_depth_mm`, `max_depth_percent`, `severity` and
// `bake`, any of them;
// what it does not have is as in `start`. Paths are relative to `file`. Throws Error(kFile) that names `file`, `place`
// (where in the file the object is: "'characters', entry 2"; empty: it is the file) and the key.
CheckConfig read_config(const std::string& json, const std::string& file, const CheckConfig& start,
                        const std::string& place = {});
CheckConfig default_config();

}  // namespace spherechain::baker
