// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are whole or not there, whatever ends the program.
#include "baker/os/written_file.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <set>

#include "baker/mesh/error.h"
#include "baker/os/atomic_file.h"
#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;
using spherechain::baker::write_atomically;

namespace {

const std::string& long_bytes() {
  static const std::string bytes(std::size_t{256} << 20, 'x');  // longer to write than to send a signal
  return bytes;
}

// How a child ended that was sent `signal` as soon as it had begun to write.
int end_while_writing(const fs::path& target, int signal) {
  const std::size_t before = tool::files_in(target.parent_path());
  const std::string& bytes = long_bytes();
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(signal, SIG_DFL);  // instead of the tests' own
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    write_atomically(target, bytes);
    ::_exit(0);
  }
  REQUIRE(child > 0);
  int status = 0;
  while (tool::files_in(target.parent_path()) == before) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
  }
  ::kill(child, signal);
  REQUIRE(::waitpid(child, &status, 0) == child);
  return status;
}

}  // namespace

TEST_CASE("a signal that ends the program leaves no half-written file, and what was there stays") {
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) {
    CAPTURE(signal);
    const TemporaryFolder folder;
    int status = 0;
    for (int attempt = 0; attempt < 10 && WIFEXITED(status); ++attempt) {  // a busy machine may be too late
      const auto target = folder.write("out.sphc", "as it was");
      status = end_while_writing(target, signal);
    }
    REQUIRE(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal);
    CHECK(tool::files_in(folder.path) == 1);
    CHECK(tool::contents(folder.path / "out.sphc") == "as it was");
  }
}

TEST_CASE("a signal that is ignored, as nohup does, stays so") {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGHUP, SIG_IGN);
    write_atomically(folder.path / "out", "all of it");
    std::raise(SIGHUP);
    ::_exit(7);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 7);
  CHECK(tool::contents(folder.path / "out") == "all of it");
}

TEST_CASE("a link stays, and what it leads to is replaced whole: through other links, and where nothing is yet") {
  const TemporaryFolder folder;
  fs::create_directories(folder.path / "there/deep");
  folder.write("there/old", "as it was");
  fs::create_symlink("there/old", folder.path / "link");
  fs::create_symlink(folder.path / "link", folder.path / "link of a link");
  fs::create_symlink("there/deep", folder.path / "folder");
  fs::create_symlink("../new", folder.path / "there/deep/dangling");
  for (const auto& [link, leads_to] : std::initializer_list<std::pair<const char*, const char*>>{
           {"link", "there/old"}, {"link of a link", "there/old"}, {"folder/dangling", "there/new"}}) {
    for (const std::string bytes : {"first", "second"}) {
      CAPTURE(link);
      write_atomically(folder.path / link, bytes);
      CHECK(fs::is_symlink(folder.path / link));
      CHECK(!fs::is_symlink(folder.path / leads_to));
      CHECK(tool::contents(folder.path / leads_to) == bytes);
    }
  }
  CHECK(tool::files_in(folder.path) == 4);
  CHECK(tool::files_in(folder.path / "there") == 3);
  CHECK(tool::files_in(folder.path / "there/deep") == 1);
}

TEST_CASE("a file that is given up half-way is as it was, and so is its folder") {
  const TemporaryFolder folder;
  const fs::path target = folder.write("out", "as it was");
  {
    spherechain::baker::AtomicFile file(target);
    file.write("half of");
    CHECK(tool::files_in(folder.path) == 2);
    CHECK(tool::contents(target) == "as it was");
  }
  CHECK(tool::files_in(folder.path) == 1);
  CHECK(tool::contents(target) == "as it was");
  spherechain::baker::AtomicFile file(target);
  for (const char* piece : {"all", "", " of it"}) file.write(piece);
  file.finish();
  CHECK(tool::files_in(folder.path) == 1);
  CHECK(tool::contents(target) == "all of it");
}

TEST_CASE("what a link leads to is as it was where it cannot be replaced") {
  const TemporaryFolder folder;
  folder.write("old", "as it was");
  fs::create_symlink("old", folder.path / "link");
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit little{16, 16};
    ::setrlimit(RLIMIT_FSIZE, &little);
    try {
      write_atomically(folder.path / "link", "more than sixteen bytes");
    } catch (const spherechain::baker::Error&) {
      ::_exit(3);
    }
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WEXITSTATUS(status) == 3);
  CHECK(tool::contents(folder.path / "link") == "as it was");
  CHECK(tool::files_in(folder.path) == 2);
}

TEST_CASE("a ring of links is an error, and stays") {
  const TemporaryFolder folder;
  fs::create_symlink("b", folder.path / "a");
  fs::create_symlink("a", folder.path / "b");
  tool::check_error(tool::run(fmt::format("bake {} -o {}/a", kHumanFile, folder.path.string())), 3,
                    {"/a: cannot be created (Too many levels of symbolic links)"});
  CHECK(fs::is_symlink(folder.path / "a"));
}

TEST_CASE("a name may be as long as the file system takes, in letters of several bytes too") {
  const TemporaryFolder folder;
  std::string letters;
  for (int i = 0; i < 85; ++i) letters += "\u20ac";
  for (const std::string& name : {std::string(255, 'x'), letters}) {
    REQUIRE(name.size() == 255);
    write_atomically(folder.path / name, "all of it");
    CHECK(tool::contents(folder.path / name) == "all of it");
  }
  CHECK(tool::files_in(folder.path) == 2);
}

TEST_CASE("a file that may not grow (ulimit -f) is one that cannot be written, and none stays" *
          doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const tool::Run run = tool::run(fmt::format("bake {} -o {}/out.sphc", kHumanFile, folder.path.string()),
                                  "bash -c 'ulimit -f 8; exec \"$0\" \"$@\"'");
  tool::check_error(run, 3, {"out.sphc: cannot be written (File too large)"});
  CHECK(tool::files_in(folder.path) == 0);
}

namespace {

// Writes in a process of its own.
void write_in_child(const fs::path& target) {
  const pid_t child = ::fork();
  if (child == 0) {
    write_atomically(target, "all of it");
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(status == 0);
}

}  // namespace

TEST_CASE("what a killed process left half-written goes with the next file, what a living one writes stays") {
  const TemporaryFolder folder;
  folder.write(".spherechain-notes.tmp", "mine");
  fs::create_symlink(folder.path / ".spherechain-notes.tmp", folder.path / ".spherechain-aaaaaaaaaaaaaaaa.tmp");
  const pid_t child = ::fork();
  if (child == 0) {
    spherechain::baker::AtomicFile file(folder.path / "half");
    file.write("half of");
    for (;;) ::pause();
  }
  while (tool::files_in(folder.path) == 2) ::usleep(1000);
  write_in_child(folder.path / "first");
  CHECK(tool::files_in(folder.path) == 4);
  ::kill(child, SIGKILL);
  REQUIRE(::waitpid(child, nullptr, 0) == child);
  write_in_child(folder.path / "second");
  CHECK(tool::files_in(folder.path) == 4);
  CHECK(tool::contents(folder.path / ".spherechain-notes.tmp") == "mine");
  CHECK(fs::is_symlink(folder.path / ".spherechain-aaaaaaaaaaaaaaaa.tmp"));
}

TEST_CASE("a file has the mode of the one that it replaces, from its first byte on; nobody can tell its name before") {
  const TemporaryFolder folder;
  const fs::path target = folder.write("secret", "as it was");
  std::set<fs::path> names;
  for (const fs::perms mode : {fs::perms(0600), fs::perms(0640), fs::perms(0644)}) {
    fs::permissions(target, mode);
    spherechain::baker::AtomicFile file(target);
    for (const auto& entry : fs::directory_iterator(folder.path)) {
      CHECK(entry.status().permissions() == mode);
      names.insert(entry.path().filename());
    }
    file.write("all of it");
    file.finish();
    CHECK(fs::status(target).permissions() == mode);
  }
  CHECK(names.size() == 4);
}
