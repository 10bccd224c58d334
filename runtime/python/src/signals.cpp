// SPDX-License-Identifier: MIT
#include "signals.h"

#include <pybind11/pybind11.h>

namespace spherechain::python {
namespace {

constexpr std::chrono::milliseconds kInterval{50};
unsigned long main_thread = 0;

}  // namespace

void set_main_thread(unsigned long ident) { main_thread = ident; }

void SignalCheck::run() {
  const Clock::time_point now = Clock::now();
  if (now - last_ < kInterval) {
    return;
  }
  last_ = now;
  // A thread that asks for the GIL while Python exits is ended, in the midst of C++: never ask where nothing is gained.
  if (PyThread_get_thread_ident() == main_thread) {
    const pybind11::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) {
      throw pybind11::error_already_set();
    }
  }
}

}  // namespace spherechain::python
