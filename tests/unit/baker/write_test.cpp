// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are whole or not there, whatever ends the program.
#include "write/write.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "human.h"
#include "mesh/error.h"
#include "temporary_folder.h"
#include "tool.h"

namespace {

const std::string& long_bytes() {
  static const std::string bytes(std::size_t{256} << 20, 'x');  // longer to write than to send a signal
  return bytes;
}

// How a child ended that was sent `signal` as soon as it had begun to write.
int end_while_writing(const std::filesystem::path& target, int signal) {
  const std::size_t before = tool::files_in(target.parent_path());
  const std::string& bytes = long_bytes();
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(signal, SIG_DFL);  // instead of the tests' own
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    spherechain::baker::write_atomically(target, bytes);
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
    spherechain::baker::write_atomically(folder.path / "out", "all of it");
    std::raise(SIGHUP);
    ::_exit(7);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 7);
  CHECK(tool::contents(folder.path / "out") == "all of it");
}

TEST_CASE("a file that may not grow (ulimit -f) is one that cannot be written, and none stays") {
  const TemporaryFolder folder;
  const tool::Run run = tool::run(fmt::format("bake {} -o {}/out.sphc", kHumanFile, folder.path.string()),
                                  "bash -c 'ulimit -f 8; exec \"$0\" \"$@\"'");
  tool::check_error(run, 3, {"out.sphc: cannot be written (File too large)"});
  CHECK(tool::files_in(folder.path) == 0);
}
