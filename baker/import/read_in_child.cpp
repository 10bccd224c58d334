// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/read_in_child.h"

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>

#include "baker/mesh/error.h"
#include "baker/os/child_process.h"
#include "baker/os/write_all.h"

namespace spherechain::baker {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char *kSecondsName = "SPHERECHAIN_IMPORT_SECONDS", *kMemoryName = "SPHERECHAIN_IMPORT_MEMORY";
constexpr std::string_view kDamaged = " (the file is damaged, or its counts are wrong; ";

int limit(const char* name, int otherwise) {
  constexpr int kMax = 1000000;
  const char* text = std::getenv(name);
  if (text == nullptr || *text == '\0') return otherwise;
  int value = 0;
  const char* end = text + std::strlen(text);
  const auto [last, failed] = std::from_chars(text, end, value);
  if (failed != std::errc() || last != end || value < 1 || value > kMax) {
    throw Error(ExitCode::kUsage, std::string(name) + ": '" + text + "' is no whole number from 1 to 1000000");
  }
  return value;
}

// Status byte of the child. It follows the bytes read, or an error's words and exit code.
enum class ChildStatus : char { kRead, kError, kInternal, kMemory };

std::string message(std::string bytes, ChildStatus outcome) {
  bytes.push_back(static_cast<char>(outcome));
  return bytes;
}

std::string outcome_of(const std::function<std::string()>& read) {
  try {
    return message(read(), ChildStatus::kRead);
  } catch (const Error& error) {
    return message(std::string(error.what()) + static_cast<char>(error.code()), ChildStatus::kError);
  } catch (const std::bad_alloc&) {
    return message({}, ChildStatus::kMemory);
  } catch (const std::exception& error) {
    return message(error.what(), ChildStatus::kInternal);
  }
}

// A child process that has ended: its output, and if it ended in time.
struct Ended {
  std::string bytes;
  bool is_in_time = false;
  ProcessEnd how{0};
};

Ended run_child(const std::string& file, const std::function<std::string()>& read, int seconds, int megabytes) {
  try {
    ChildProcess child(ChildProcess::Kind::kReader, [&](int pipe) {
      limit_process(seconds, megabytes);
      write_all(pipe, outcome_of(read));
    });
    Ended out;
    out.is_in_time = child.read_until(Clock::now() + std::chrono::seconds(seconds), out.bytes);
    if (!out.is_in_time) child.kill();
    out.how = child.wait();
    if (out.how.is_by_time_limit()) out.is_in_time = false;
    return out;
  } catch (const std::system_error& error) {
    throw Interrupted(file + ": cannot be read (" + error.what() + ")");
  }
}

}  // namespace

std::string read_in_child(const std::string& file, const std::function<std::string()>& read) {
  const int seconds = limit(kSecondsName, kImportSeconds), megabytes = limit(kMemoryName, kImportMemory);
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, file + ": " + what); };
  const auto is_killed = [](const Ended& child) { return child.is_in_time && child.how.is_killed_from_outside(); };
  Ended child = run_child(file, read, seconds, megabytes);
  if (is_killed(child)) child = run_child(file, read, seconds, megabytes);
  if (!child.is_in_time) {
    fail("takes more than " + std::to_string(seconds) + " s to read" + std::string(kDamaged) + kSecondsName +
         " allows more)");
  }
  if (is_killed(child)) {
    throw Interrupted(file + ": its importer was killed twice (" + child.how.signal_name() +
                      "; is memory short? run it again)");
  }
  std::string bytes = std::move(child.bytes);
  if (child.how.is_by_signal() || bytes.empty()) {
    const char* how = child.how.is_by_signal() ? child.how.signal_name() : "it ends early";
    fail(std::string("crashes its importer (") + how + "; the file is damaged: export it again)");
  }
  const auto outcome = static_cast<ChildStatus>(bytes.back());
  bytes.pop_back();
  switch (outcome) {
    case ChildStatus::kRead:
      return bytes;
    case ChildStatus::kError:
      throw Error(static_cast<ExitCode>(bytes.back()), bytes.substr(0, bytes.size() - 1));
    case ChildStatus::kMemory:
      fail("needs more than " + std::to_string(megabytes) + " MB of memory to read" + std::string(kDamaged) +
           kMemoryName + " allows more)");
    case ChildStatus::kInternal:
      break;
  }
  throw std::runtime_error(bytes);
}

}  // namespace spherechain::baker
