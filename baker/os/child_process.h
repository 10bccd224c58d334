// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "baker/mesh/error.h"

namespace spherechain::baker {

// The file is not to blame: a process was killed from outside or could not be started, or the file changed
// meanwhile. The same work may succeed later.
class Interrupted : public Error {
 public:
  explicit Interrupted(const std::string& message) : Error(ExitCode::kFile, message) {}
};

// How a process ended.
class ProcessEnd {
 public:
  explicit ProcessEnd(int status) : status_(status) {}  // as waitpid() returns it

  int exit_code() const;  // if no signal ended it
  bool is_by_signal() const;
  const char* signal_name() const;  // "Killed"
  bool is_by_time_limit() const;
  // True if a signal from outside ended it: a user, a batch system, or a kernel that is short of memory. Its own
  // crashes are no such signals.
  bool is_killed_from_outside() const;

 private:
  int status_;
};

// A process that runs a function, and a pipe between it and this process.
class ChildProcess {
 public:
  enum class Kind {
    kWorker,   // writes into the pipe; gets SIGTERM when this process ends
    kReader,   // writes into the pipe; is killed when this process ends
    kWatchman  // reads from the pipe, which ends with this process and all its workers; outlives them
  };
  // Calls work(pipe) in the child, which then ends with exit code 0; `work` must not throw. A worker and a reader
  // print nothing, and ignore the signals that this process ignores (nohup). Throws std::system_error where no process
  // can be started.
  ChildProcess(Kind kind, const std::function<void(int pipe)>& work);
  // Closes the pipe. Ends a worker or reader that still runs; waits for a watchman.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Appends what the child has written. Waits until there is something. False: the child has closed its end.
  bool read(std::string& bytes);
  // Appends everything. False: it is not all there at `end`.
  bool read_until(std::chrono::steady_clock::time_point end, std::string& bytes);
  void kill();
  ProcessEnd wait();

  // Waits for some time until a child has written or ended. Marks those whose read() does not wait.
  static std::vector<char> wait_for_any(const std::vector<const ChildProcess*>& children, int milliseconds);

 private:
  Kind kind_;
  int pipe_ = -1;
  int pid_ = -1;  // 0: it has been waited for
};

// Limits this process: processor time, and memory beyond what it has. It leaves no core file. The sanitizers need
// memory of their own: under them memory is not limited.
void limit_process(int seconds, int megabytes);

// Peak resident memory of this process so far.
double peak_memory_mb();

}  // namespace spherechain::baker
