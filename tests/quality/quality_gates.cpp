// SPDX-License-Identifier: MIT
// Bakes, validates and checks what README.md calls gates; a gate that fails prints the commands that show it.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kKeys[] = {"mesh",   "motion", "poses",    "clip",  "frames",   "profile", "settings",
                                 "radius", "study",  "contacts", "quick", "at_least", "at_most"};

struct TestDataMissing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Where a gate's file is: models/ (assimp-testmodels), samples/ (of this repository), data/ (SPHERECHAIN_TEST_DATA).
std::string resolve(const std::string& name) {
  const auto below = [&](const std::string& prefix) { return name.substr(prefix.size()); };
  if (name.starts_with("models/")) return "/usr/share/assimp/models/" + below("models/");
  if (name.starts_with("samples/")) return SPHERECHAIN_SAMPLES "/" + below("samples/");
  if (!name.starts_with("data/")) throw std::runtime_error(name + ": begins with none of models/, samples/, data/");
  const char* data = std::getenv("SPHERECHAIN_TEST_DATA");
  if (data == nullptr) throw TestDataMissing("SPHERECHAIN_TEST_DATA names no folder of characters");
  return std::string(data) + "/" + below("data/");
}

std::string quoted(const std::string& word) { return "'" + word + "'"; }

int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

json read_json(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return json::parse(in);
}

// "chains.pair_recall": a figure of `validate --json`.
double figure(const json& found, const std::string& name) {
  std::string pointer = "/" + name;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  const json::json_pointer place(pointer);
  if (!found.contains(place) || !found[place].is_number()) throw std::runtime_error("validate tells no " + name);
  return found[place].get<double>();
}

class Gate {
 public:
  explicit Gate(const fs::path& file) : name_(file.stem().string()), gate_(read_json(file)) {
    for (const auto& [key, value] : gate_.items()) {
      if (std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys)) {
        throw std::runtime_error(file.string() + ": unknown key " + key);
      }
    }
    if (text("mesh").empty() || limits("at_least").size() + limits("at_most").size() == 0) {
      throw std::runtime_error(file.string() + ": names no mesh, or asks for nothing");
    }
  }

  const std::string& name() const { return name_; }
  bool is_quick() const { return gate_.value("quick", false); }
  bool is_study() const { return gate_.value("study", false); }
  std::string mesh() const { return resolve(text("mesh")); }
  std::string settings() const { return gate_.value("settings", json::object()).dump(); }

  // With what the gate's asset is baked.
  std::string bake_options(const std::string& config) const {
    return fmt::format("--profile {} --config {}", gate_.value("profile", "balanced"), config);
  }
  std::string validate_options() const {
    std::string out = fmt::format("--source {}", quoted(mesh()));
    for (const char* choice : {"motion", "poses"}) {
      if (!text(choice).empty()) out += fmt::format(" --{} {}", choice, quoted(resolve(text(choice))));
    }
    if (!text("clip").empty()) out += " --clip " + quoted(text("clip"));
    if (gate_.contains("frames")) out += fmt::format(" --frames {}", gate_["frames"].get<int>());
    out += fmt::format(" --radius {}", gate_.value("radius", "detect"));
    return out + (gate_.value("contacts", false) ? " --contacts" : "");
  }

  // Missed gates, a sentence each. A limit may be another figure's name.
  std::vector<std::string> failures(const json& found) const {
    std::vector<std::string> out;
    const auto limit = [&](const json& value) {
      return value.is_string() ? figure(found, value.get<std::string>()) : value.get<double>();
    };
    const json at_least = limits("at_least"), at_most = limits("at_most");
    for (const auto& [key, value] : at_least.items()) {
      if (!(figure(found, key) >= limit(value))) {
        out.push_back(fmt::format("{} is {:.4f}, at least {} = {:.4f} is asked", key, figure(found, key), value.dump(),
                                  limit(value)));
      }
    }
    for (const auto& [key, value] : at_most.items()) {
      if (!(figure(found, key) <= limit(value))) {
        out.push_back(fmt::format("{} is {:.4f}, at most {} = {:.4f} is asked", key, figure(found, key), value.dump(),
                                  limit(value)));
      }
    }
    return out;
  }

 private:
  std::string text(const char* key) const { return gate_.value(key, ""); }
  json limits(const char* key) const { return gate_.value(key, json::object()); }

  std::string name_;
  json gate_;
};

// Assets baked so far, one for all gates of the same mesh and settings; gone with it.
class Workshop {
 public:
  Workshop() {
    std::string name = (fs::temp_directory_path() / "quality-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~Workshop() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  json validate(const Gate& gate) {
    const fs::path found = folder_ / "found.json";
    fs::remove(found);  // the last gate's
    const std::string command =
        fmt::format("{} {} {} --json {} >/dev/null", gate.is_study() ? SPHERECHAIN_STUDY : SPHERECHAIN_TOOL " validate",
                    asset(gate).string(), gate.validate_options(), found.string());
    if (run(command) != 0) throw std::runtime_error("validate failed");
    return read_json(found);
  }

 private:
  fs::path asset(const Gate& gate) {
    const std::string key = gate.mesh() + gate.bake_options(gate.settings());
    if (const auto known = assets_.find(key); known != assets_.end()) return known->second;
    const fs::path out = folder_ / fmt::format("{}.sphc", assets_.size()), config = folder_ / "config.json";
    std::ofstream(config) << gate.settings();
    const std::string command = fmt::format("{} bake {} -o {} {} >/dev/null", SPHERECHAIN_TOOL, quoted(gate.mesh()),
                                            out.string(), gate.bake_options(config.string()));
    if (run(command) != 0) throw std::runtime_error("bake failed");
    return assets_[key] = out;
  }

  fs::path folder_;
  std::map<std::string, fs::path> assets_;
};

// True where the gate holds, or cannot be tried.
bool passes(const Gate& gate, Workshop& workshop) {
  std::vector<std::string> failures;
  try {
    const json found = workshop.validate(gate);
    failures = gate.failures(found);
    const auto share = [&](const char* name) {  // of nothing: null
      return found.at(name).is_null() ? "-" : fmt::format("{:.3f}", figure(found, name));
    };
    fmt::print("{:<6} {:<32} recall {}, precision {}, {:.1f} pairs a frame\n", failures.empty() ? "ok" : "FAILED",
               gate.name(), share("pair_recall"), share("precision"), figure(found, "reported_per_frame"));
  } catch (const TestDataMissing& missing) {
    fmt::print("skipped: {} ({})\n", gate.name(), missing.what());
    return true;
  } catch (const std::exception& error) {
    fmt::print("FAILED {}\n", gate.name());
    failures.emplace_back(error.what());
  }
  for (const std::string& failure : failures) fmt::print("  {}\n", failure);
  if (!failures.empty()) {
    fmt::print("  to see it:\n    echo {} > gate.json\n    {} bake {} -o gate.sphc {}\n    {} validate gate.sphc {}\n",
               quoted(gate.settings()), SPHERECHAIN_TOOL, quoted(gate.mesh()), gate.bake_options("gate.json"),
               SPHERECHAIN_TOOL, gate.validate_options());
  }
  std::fflush(stdout);
  return failures.empty();
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool quick = !arguments.empty() && arguments[0] == "--quick";
  if (quick) arguments.erase(arguments.begin());
  if (arguments.size() != 1) {
    fmt::print(stderr, "usage: quality_gates [--quick] FOLDER\n");
    return 2;
  }
  try {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(arguments[0])) {
      if (entry.path().extension() == ".json") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    Workshop workshop;
    std::size_t tried = 0, failed = 0;
    for (const fs::path& file : files) {
      const Gate gate(file);
      if (quick && !gate.is_quick()) continue;
      ++tried;
      failed += passes(gate, workshop) ? 0u : 1u;
    }
    fmt::print("{} gates, {} failed\n", tried, failed);
    return tried > 0 && failed == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "quality_gates: {}\n", error.what());
    return 1;
  }
}
