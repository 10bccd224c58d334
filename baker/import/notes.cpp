// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/notes.h"

#include <algorithm>
#include <utility>

namespace spherechain::baker {
namespace {

std::vector<std::string>& waiting() {
  static std::vector<std::string> notes;
  return notes;
}

}  // namespace

void add_note(const std::string& note) {
  std::vector<std::string>& notes = waiting();
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
}

std::vector<std::string> take_notes() { return std::exchange(waiting(), {}); }

}  // namespace spherechain::baker
