// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cli/progress.h"

#include <chrono>
#include <cstdio>

#include "baker/cli/console.h"
#include "baker/os/terminal.h"

namespace spherechain::baker {

Progress::Progress(std::string title) : title_(std::move(title)), terminal_(is_error_stream_terminal()) {
  if (terminal_) return;
  std::unique_lock lock(mutex_);
  writer_ = std::thread([this] { write_lines(); });
  // A child that is forked while a thread starts may inherit a lock that nobody releases.
  changed_.wait(lock, [this] { return is_waiting_; });
}

Progress::~Progress() {
  if (terminal_) {
    std::fprintf(stderr, "\r\033[K");
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_one();
  writer_.join();
}

void Progress::show(const std::string& text) {
  if (terminal_) {
    std::fprintf(stderr, "\r\033[K%s", one_line(title_ + " " + text).c_str());
    return;
  }
  const std::lock_guard lock(mutex_);
  text_ = text;
}

void Progress::write_lines() {
  constexpr std::chrono::seconds kPause(10);
  std::unique_lock lock(mutex_);
  is_waiting_ = true;
  changed_.notify_one();
  while (!changed_.wait_for(lock, kPause, [this] { return is_over_; })) {
    std::fprintf(stderr, "spherechain: %s\n", one_line(title_ + " " + text_).c_str());
  }
}

}  // namespace spherechain::baker
