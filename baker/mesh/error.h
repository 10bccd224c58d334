// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace spherechain::baker {

// The command line's exit codes (README). Values are part of the contract.
enum class ExitCode : int {
  kDone = 0,
  kInternal = 1,
  kUsage = 2,
  kFile = 3,          // a file cannot be read or written, or has the wrong content
  kSegmentation = 4,  // the body that was asked for is not there
  kTargetMissed = 5,  // done, but a target in the settings was not met
  kCheckFailed = 6,   // done, but a library fails by its rules
};

// An error that the user can mend. what() is one line: "FILE: what is wrong (what to do)".
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace spherechain::baker
