// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/check/verdict.h"

namespace spherechain::baker {

// A verdict for people, as a linter prints it: tickets, the worst first, each with its other events below it, then what
// is in no ticket. Or new faults alone.
std::string check_text(const Verdict& verdict, bool only_new);
// "worse than 40 mm": a known event was no deeper; else empty.
std::string worse_text(const EvaluatedEvent& evaluated);

// For pipelines (docs/json.md), CI servers (JUnit XML) and code review (SARIF 2.1.0).
std::string check_json(const Verdict& verdict);
std::string check_junit(const Verdict& verdict);
std::string check_sarif(const Verdict& verdict);

// "right hand in left thigh".
std::string parts_text(const Event& event);
// "body through shirt at abdomen".
std::string poke_text(const PokeEvent& event);
// "frames 34-41"; with frames among them that are no fault "frames 34-41, 5 faulty"; over a loop's seam "frames 28-3
// (over the loop)".
std::string frames_text(const Event& event);

}  // namespace spherechain::baker
