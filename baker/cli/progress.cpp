// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.h"

#include <unistd.h>

#include <cstdio>

#include "cli/console.h"

namespace spherechain::baker {

Progress::Progress(std::string title) : title_(std::move(title)), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_) std::fprintf(stderr, "\r\033[K");
}

void Progress::show(const std::string& text) {
  if (terminal_) std::fprintf(stderr, "\r\033[K%s", one_line(title_ + " " + text).c_str());
}

}  // namespace spherechain::baker
