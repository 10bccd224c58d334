// SPDX-License-Identifier: GPL-3.0-or-later
// Reading in a child process: whatever happens there, one error with the file's name comes back.
#include "baker/import/read_in_child.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "baker/import/archive.h"
#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "human.h"
#include "temporary_folder.h"

using namespace spherechain::baker;

namespace {

struct Environment {
  Environment(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  ~Environment() { ::unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
};

std::string error_of(const std::function<std::string()>& read) {
  try {
    read_in_child("a.fbx", read);
  } catch (const Error& error) {
    return std::to_string(static_cast<int>(error.code())) + " " + error.what();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "none";
}

std::string for_ever() {
  for (volatile bool on = true; on;) continue;
  return {};
}

std::string much_memory() { return std::string(std::size_t{100} << 20, 'x'); }

}  // namespace

TEST_CASE("what a child process reads comes back whole, and so do its errors") {
  const std::string large(5000000, 'x');
  CHECK(read_in_child("a.fbx", [] { return std::string(); }).empty());
  CHECK(read_in_child("a.fbx", [&] { return large; }) == large);
  CHECK(error_of([]() -> std::string { throw Error(ExitCode::kSegmentation, "a.fbx: no legs"); }) ==
        "4 a.fbx: no legs");
  CHECK(error_of([]() -> std::string { throw std::runtime_error("a fault"); }) == "a fault");
}

TEST_CASE("a child process that crashes, hangs or grows ends with an error that names the file and the cause") {
  CHECK(error_of([]() -> std::string { std::abort(); }) ==
        "3 a.fbx: crashes its importer (Aborted; the file is damaged: export it again)");
  CHECK(error_of([]() -> std::string { std::_Exit(0); }) ==
        "3 a.fbx: crashes its importer (it ends early; the file is damaged: export it again)");

  {
    const Environment seconds("SPHERECHAIN_IMPORT_SECONDS", "1");
    const auto start = std::chrono::steady_clock::now();
    CHECK(error_of(for_ever) ==
          "3 a.fbx: takes more than 1 s to read (the file is damaged, or its counts are wrong; "
          "SPHERECHAIN_IMPORT_SECONDS allows more)");
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  }

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const Environment memory("SPHERECHAIN_IMPORT_MEMORY", "50");
  CHECK(error_of(much_memory) ==
        "3 a.fbx: needs more than 50 MB of memory to read (the file is damaged, or its counts are wrong; "
        "SPHERECHAIN_IMPORT_MEMORY allows more)");
  const Environment more("SPHERECHAIN_IMPORT_MEMORY", "500");
  CHECK(error_of(much_memory) == "none");
#endif
}

TEST_CASE("a child process that is killed from outside is started once more, and no file is called damaged") {
  CHECK(error_of([]() -> std::string {
          ::raise(SIGKILL);
          return {};
        }) == "3 a.fbx: its importer was killed twice (Killed; is memory short? run it again)");
  const TemporaryFolder folder;
  const std::string mark = (folder.path / "killed").string();
  CHECK(read_in_child("a.fbx", [&]() -> std::string {
          if (::access(mark.c_str(), F_OK) == 0) return "read";
          folder.write("killed", "");
          ::raise(SIGTERM);
          return {};
        }) == "read");
}

TEST_CASE("a signal that a process ignores, as under nohup, does not end the child that reads for it") {
  const auto before = ::signal(SIGHUP, SIG_IGN);
  CHECK(read_in_child("a.fbx", []() -> std::string {
          ::raise(SIGHUP);
          return "read";
        }) == "read");
  ::signal(SIGHUP, before);
}

TEST_CASE("a limit that is no number is a usage error") {
  for (const char* value : {"0", "-1", "ten", "1.5", "1000001", "5 "}) {
    const Environment seconds("SPHERECHAIN_IMPORT_SECONDS", value);
    CHECK(error_of(much_memory) ==
          std::string("2 SPHERECHAIN_IMPORT_SECONDS: '") + value + "' is no whole number from 1 to 1000000");
  }
  const Environment seconds("SPHERECHAIN_IMPORT_SECONDS", "");  // a script's variable that is not set
  CHECK(error_of(much_memory) == "none");
}

TEST_CASE("a character comes out of its child process as it went in") {
  for (const char* file : {kHumanFile, "/usr/share/assimp/models/X/BCN_Epileptic.X"}) {
    CHECK(to_bytes(read_source(file)) == to_bytes(read_with_assimp(file)));
  }
  const std::string bytes = to_bytes(read_with_assimp(kHumanFile));
  CHECK(to_bytes(from_bytes<SourceMesh>(bytes)) == bytes);
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{1000}, bytes.size() - 1}) {
    CHECK_THROWS_AS(from_bytes<SourceMesh>(bytes.substr(0, size)), std::out_of_range);
  }
}
