// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace spherechain::baker {

// The file that a name in another file leads to. Files come from strangers: a name leads to files in the folder of the
// file that has it, and below, whatever links are on the way.
struct NamedFile {
  std::filesystem::path path;     // empty where the name is refused
  bool is_there = false;          // it is a regular file
  const char* refusal = nullptr;  // why the name is refused, as in "it IS ..."

  // For a message: "is not there", or why it is refused.
  const char* what_is_wrong() const { return refusal != nullptr ? refusal : "is not there"; }
};

// `name` is relative to `folder`; a backslash is a slash, as in files made on Windows.
NamedFile named_file(const std::filesystem::path& folder, std::string name);

// The same of a URI, in which characters may be escaped (%20).
NamedFile named_by_uri(const std::filesystem::path& folder, const std::string& uri);

// A picture that another format than glTF names, often by its place on its author's disk: the longest end of the name
// that is a file in the folder, "tex/skin.png" before "skin.png" of "C:\hero\tex\skin.png".
NamedFile named_picture(const std::filesystem::path& folder, std::string name);

// Files that a file names and that are missing, for a note (notes.h).
class LostFiles {
 public:
  void add(const std::string& name, const NamedFile& file);
  void note(const std::string& file) const;  // a line where something is lost

 private:
  std::vector<std::string> lost_;
};

// A name as messages quote it: no longer than a line has room for.
std::string in_quotes(const std::string& name);

}  // namespace spherechain::baker
