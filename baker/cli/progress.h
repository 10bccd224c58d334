// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace spherechain::baker {

// Shows the work of a command: a line on stderr that is replaced by the next. Where stderr is no terminal, a line every
// ten seconds, for logs.
class Progress {
 public:
  explicit Progress(std::string title);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(const std::string& text);

 private:
  void write_lines();

  std::string title_, text_;
  bool terminal_, is_waiting_ = false, is_over_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread writer_;  // of lines
};

}  // namespace spherechain::baker
