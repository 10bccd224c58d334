// SPDX-License-Identifier: MIT
// Ctrl-C while a batch is computed without the GIL.
#pragma once

#include <chrono>

namespace spherechain::python {

// Python runs the handlers of signals in its main thread alone: name it once, when the module is made.
void set_main_thread(unsigned long ident);

class SignalCheck {
 public:
  // Call it often, without the GIL, in the thread that Python called. Every 50 ms it lets Python handle pending
  // signals, and throws what their handlers raise, as KeyboardInterrupt. In other threads than Python's main one it
  // does nothing.
  void run();

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace spherechain::python
