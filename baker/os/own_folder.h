// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace spherechain::baker {

// A folder that a command fills, and fills again: a report. It is the tool's by its list, the file `.spherechain`, of
// what was written there and the hash of each. A file that is not in the list is somebody's: it is neither replaced nor
// deleted. Nor is one of the folder's top whose bytes are no longer those of the list.
class OwnFolder {
 public:
  // Before the work that takes long. Throws Error(kFile) where `folder` cannot be made or written to, holds something
  // and no list, or where somebody's file has a name that is to be written (`is_name`, of a file in its top). `kind`
  // is what the list says is there: "check report".
  static void check(const std::filesystem::path& folder, const std::string& kind,
                    bool (*is_name)(const std::string& name));

  // Makes the folder. Waits while another process writes to it.
  OwnFolder(std::filesystem::path folder, std::string kind);
  ~OwnFolder();
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;

  // Names are paths below the folder. A file is whole or not there. Throws Error(kFile), also for somebody's file.
  void write(const std::string& name, std::string_view bytes);
  // Deletes what earlier runs wrote and this one did not.
  void finish();

 private:
  using Hashes = std::multimap<std::string, std::string>;
  static Hashes read_list(const std::filesystem::path& folder, const std::string& kind);
  static bool is_listed(const Hashes& list, const std::string& name, const std::string& hash);

  // Before it is written: a run that is killed leaves nothing that the next one does not know.
  void add_to_list(const std::string& name, const std::string& hash);
  // True if `name` has these bytes already. Throws if this tool did not write it.
  bool is_there(const std::string& name, const std::string& hash) const;

  std::filesystem::path folder_;
  std::string kind_;
  Hashes old_;
  std::map<std::string, std::string> new_;
  int lock_ = -1, list_ = -1;
};

}  // namespace spherechain::baker
