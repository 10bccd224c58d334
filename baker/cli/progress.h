// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace spherechain::baker {

// A line on stderr that is replaced by the next; silent where stderr is no terminal.
class Progress {
 public:
  explicit Progress(std::string title);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(const std::string& text);

 private:
  std::string title_;
  bool terminal_;
};

}  // namespace spherechain::baker
