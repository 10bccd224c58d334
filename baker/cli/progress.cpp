// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "cli/console.h"

namespace spherechain::baker {

Progress::Progress(std::string title) : title_(std::move(title)), terminal_(::isatty(STDERR_FILENO) == 1) {
  if (!terminal_) writer_ = std::thread([this] { write_lines(); });
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
  over_.notify_one();
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
  constexpr std::chrono::seconds kPause(30);
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kPause, [this] { return is_over_; })) {
    std::fprintf(stderr, "spherechain: %s\n", one_line(title_ + " " + text_).c_str());
  }
}

}  // namespace spherechain::baker
