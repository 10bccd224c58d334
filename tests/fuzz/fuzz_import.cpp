// SPDX-License-Identifier: GPL-3.0-or-later
// Real files, damaged, into the command line tool: fuzz_import TOOL [--mutations N] [--seed S] [--keep FOLDER]
// Every run must end in time with a documented exit code, one line on stderr where it fails, and no output where it is
// not done. `--keep` copies the files that break this. The files are those of Debian's assimp-testmodels, and of the
// folder that SPHERECHAIN_TEST_DATA names.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "random.h"
#include "temporary_folder.h"

namespace fs = std::filesystem;

namespace {

using spherechain::test::Random;

// A file, and those that are read with it. A bake without a rig takes too long to try it often.
struct Source {
  std::vector<fs::path> files;
  bool bakes = false;
};

std::vector<Source> sources() {
  const fs::path models = "/usr/share/assimp/models";
  std::vector<Source> all;
  for (const char* name : {"AC/Wuson.acc",
                           "ASE/anim2.ASE",
                           "B3D/WusonBlitz.b3d",
                           "BLEND/Suzanne_248.blend",
                           "BVH/01_03.bvh",
                           "COB/spider_6_6.cob",
                           "Collada/human.zae",
                           "DXF/wuson.dxf",
                           "FBX/spider.fbx",
                           "IRRMesh/cellar.irrmesh",
                           "LWO/LWO2/hierarchy.lwo",
                           "M3D/cube_normals.m3d",
                           "MD2/sydney.md2",
                           "MS3D/Wuson.ms3d",
                           "OBJ/spider.obj",
                           "OFF/Wuson.off",
                           "PLY/Wuson.ply",
                           "SMD/WusonSMD.smd",
                           "STL/Spider_ascii.stl",
                           "STL/Spider_binary.stl",
                           "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb",
                           "Ogre/TheThing/Mesh.mesh.xml"}) {
    all.push_back({{models / name}});
  }
  for (const char* name : {"3DS/fels.3ds", "AMF/test9.amf", "Collada/duck.dae", "FBX/animation_with_skeleton.fbx",
                           "FBX/huesitos.fbx", "IQM/mrfixit.iqm", "X/BCN_Epileptic.X", "X/Testwuson.X"}) {
    all.push_back({{models / name}, true});
  }
  if (const char* folder = std::getenv("SPHERECHAIN_TEST_DATA")) {
    const fs::path data = folder;
    for (const char* name : {"CesiumMan.glb", "Fox.glb", "cesium_man_khronos.gltf", "godette.vrm", "hand_fist.glb",
                             "quaternius_dragon.fbx", "quaternius_spider.glb"}) {
      all.push_back({{data / name}, true});
    }
    all.push_back({{data / "ninja_ogre/ninja.mesh.xml", data / "ninja_ogre/ninja.skeleton.xml"}, true});
  }
  return all;
}

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_file(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

struct Block {
  std::size_t first, size;
};
Block some_block(const std::string& bytes, Random& random) {
  const std::size_t first = random.up_to(bytes.size() - 1), longest = std::size_t{1} << random.below(12);
  return {first, 1 + random.up_to(std::min(bytes.size() - first, longest) - 1)};
}

// Another number in place of the digits at or after a random place.
void change_text_number(std::string& bytes, Random& random) {
  constexpr const char* kDigits = "0123456789";
  const char* const numbers[] = {"0",     "-1",  "1",          "65536",      "2147483647", "4294967295", "1e38",
                                 "1e-38", "nan", "2147483648", "1000000000", "0.00000001", "-",          ""};
  const std::size_t first = bytes.find_first_of(kDigits, random.up_to(bytes.size() - 1));
  if (first == bytes.npos) return;
  const std::size_t last = std::min(bytes.find_first_not_of(kDigits, first), bytes.size());
  bytes.replace(first, last - first, random.pick(numbers));
}

void change_binary_number(std::string& bytes, Random& random) {
  const std::uint32_t numbers[] = {0,          1,          0xFF,       0xFFFF,     0x7FFFFFFF, 0x80000000,
                                   0xFFFFFFFF, 0x7F800000, 0x7FC00000, 0x7F7FFFFF, 0x00000001, 1000000000};
  const std::uint32_t number = random.one_in(4) ? static_cast<std::uint32_t>(random.bits()) : random.pick(numbers);
  const std::size_t size = std::size_t{1} << random.below(3);
  if (bytes.size() >= size) std::memcpy(bytes.data() + random.up_to(bytes.size() - size), &number, size);
}

// Most damage leaves the file's structure as it is, so that it goes deep into the importers.
void damage(std::string& bytes, bool text, Random& random) {
  if (bytes.empty()) return;
  const std::uint32_t way = random.below(10);
  const auto [first, size] = some_block(bytes, random);
  const std::string block = bytes.substr(first, size);
  if (way < 4) {
    for (std::size_t n = 1 + random.up_to(3); n > 0 && !bytes.empty(); --n) {
      text ? change_text_number(bytes, random) : change_binary_number(bytes, random);
    }
  } else if (way < 6) {
    for (std::size_t n = 1 + random.up_to(7); n > 0; --n) {
      bytes[random.up_to(bytes.size() - 1)] ^= static_cast<char>(1U << random.below(8));
    }
  } else if (way == 6) {
    bytes.replace(random.up_to(bytes.size() - size), size, block);
  } else if (way == 7) {
    bytes.insert(random.up_to(bytes.size()), block);
  } else if (way == 8) {
    bytes.erase(first, size);
  } else {
    bytes.resize(first);
  }
}

// Where a run takes longer, it hangs. The importer has far less; a bake without a rig takes some twenty seconds.
constexpr int kRunSeconds = 240;
constexpr const char *kImportSeconds = "10", *kImportMemory = "1024";

struct Ended {
  bool in_time;
  int status;
};

Ended run(const std::vector<std::string>& command, const fs::path& error) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<char*> words;
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    ::dup2(::open("/dev/null", O_WRONLY), STDOUT_FILENO);
    ::dup2(::open(error.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execv(words[0], words.data());
    ::_exit(127);
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kRunSeconds);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return {false, status};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {true, status};
}

// Says how a run failed. Empty if it did not.
std::string fault(const Ended& ended, const std::string& error, bool bakes, bool has_output) {
  if (!ended.in_time) return "runs for more than " + std::to_string(kRunSeconds) + " s";
  if (!WIFEXITED(ended.status)) return std::string("ends by a signal: ") + ::strsignal(WTERMSIG(ended.status));
  const int code = WEXITSTATUS(ended.status);
  const bool done = code == 0 || (bakes && code == 5);
  if (!done && code != 3 && !(bakes && code == 4)) return "ends with " + std::to_string(code) + ": " + error;
  if (!done && (error.rfind("spherechain: error: ", 0) != 0 || std::count(error.begin(), error.end(), '\n') != 1)) {
    return "has no error of one line: " + error;
  }
  if (has_output != (bakes && done)) return has_output ? "leaves an output behind" : "has no output";
  return {};
}

class Campaign {
 public:
  Campaign(std::string tool, fs::path keep) : tool_(std::move(tool)), keep_(std::move(keep)) {}

  void mutate(const Source& source, Random& random, const std::string& label) {
    const std::vector<fs::path>& files = source.files;
    const TemporaryFolder folder;
    const std::size_t damaged = random.up_to(files.size() - 1);
    for (std::size_t f = 0; f < files.size(); ++f) {
      std::string bytes = read_file(files[f]);
      if (bytes.empty()) std::printf("%s is missing\n", files[f].c_str());
      const bool text = bytes.substr(0, 4096).find('\0') == std::string::npos;
      for (std::size_t n = random.one_in(3) ? 3 : 1; f == damaged && n > 0; --n) damage(bytes, text, random);
      write_file(folder.path / files[f].filename(), bytes);
    }
    const fs::path input = folder.path / files[0].filename();
    const bool bakes = source.bakes && random.one_in(4),
               fixes = bakes && input.extension() == ".fbx" && random.one_in(2);
    const fs::path output = folder.path / (fixes ? "out.fbx" : "out.sphc");
    const std::string verb = fixes ? "fix" : bakes ? "bake" : "inspect";
    std::vector<std::string> command{tool_, "inspect", "--roles", input.string()};
    if (bakes) command = {tool_, verb, input.string(), "-o", output.string()};
    const TemporaryFolder words;
    const Ended ended = run(command, words.path / "error");
    const std::string error = read_file(words.path / "error");
    const auto there = static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path), {}));
    ++runs_;
    if (WIFEXITED(ended.status)) ++codes_[WEXITSTATUS(ended.status)];
    if (error.find("crashes its importer") != std::string::npos) ++crashes_;
    if (error.find(" s to read") != std::string::npos) ++hangs_;
    if (error.find("of memory to read") != std::string::npos) ++floods_;
    const std::string what = fault(ended, error, bakes, there > files.size());
    if (what.empty()) return;
    ++faults_;
    std::printf("%s, %s: %s %s\n", label.c_str(), verb.c_str(), files[0].filename().c_str(), what.c_str());
    std::fflush(stdout);
    if (!keep_.empty()) fs::copy(folder.path, keep_ / label, fs::copy_options::recursive);
  }

  bool report(std::size_t source_count) const {
    std::printf("%zu damaged files of %zu sources:", runs_, source_count);
    for (const auto& [code, count] : codes_) std::printf(" %zu ended with %d,", count, code);
    std::printf(" %zu faults\nassimp crashed in %zu, hung in %zu, ran out of memory in %zu\n", faults_, crashes_,
                hangs_, floods_);
    return faults_ == 0;
  }

 private:
  std::string tool_;
  fs::path keep_;
  std::map<int, std::size_t> codes_;
  std::size_t runs_ = 0, faults_ = 0, crashes_ = 0, hangs_ = 0, floods_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::string tool, keep;
  std::size_t mutations = 200, seed = 1;
  for (int a = 1; a < argc; ++a) {
    const std::string word = argv[a];
    const bool valued = a + 1 < argc;
    if (valued && word == "--mutations")
      mutations = std::stoul(argv[++a]);
    else if (valued && word == "--seed")
      seed = std::stoul(argv[++a]);
    else if (valued && word == "--keep")
      keep = argv[++a];
    else
      tool = word;
  }
  if (tool.empty()) {
    std::fprintf(stderr, "fuzz_import TOOL [--mutations N] [--seed S] [--keep FOLDER]\n");
    return 2;
  }
  ::setenv("SPHERECHAIN_IMPORT_SECONDS", kImportSeconds, 1);
  ::setenv("SPHERECHAIN_IMPORT_MEMORY", kImportMemory, 1);
  const std::vector<Source> all = sources();
  Campaign campaign(tool, keep);
  for (std::size_t m = 0; m < mutations; ++m) {
    // A mutation depends on the seed and its number alone.
    Random random(seed * 1000003 + m);
    campaign.mutate(all[m % all.size()], random, "seed " + std::to_string(seed) + " number " + std::to_string(m));
  }
  return campaign.report(all.size()) ? 0 : 1;
}
