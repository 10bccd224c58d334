// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <string>

#include "baker/mesh/error.h"

namespace spherechain::baker {

// The file is not to blame: a process was killed from outside or could not be started, or the file changed
// meanwhile. The same work may succeed later.
class Interrupted : public Error {
 public:
  explicit Interrupted(const std::string& message) : Error(ExitCode::kFile, message) {}
};

// The first thing that a process does that `parent` has just forked. It gets the signal `last` when its parent ends,
// and ends at once if the parent is gone. Signals that the parent ignores stay ignored (nohup); others end it. It
// prints nothing.
void become_child(pid_t parent, int last);

// True if a signal from outside ended a process, by its status from waitpid: a user, a batch system, or a kernel that
// is short of memory. Its own crashes are no such signals.
bool is_killed_from_outside(int status);

}  // namespace spherechain::baker
