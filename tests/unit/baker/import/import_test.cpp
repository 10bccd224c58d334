// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/import.h"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "closed_shapes.h"
#include "human.h"
#include "refusal.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

}  // namespace

TEST_CASE("the human comes in whole: a closed body, welded, and the eyes beside it") {
  const Character& character = human().character;
  CHECK(character.largest_piece.mesh.triangles.size() == 26756);
  CHECK(character.largest_piece.mesh.positions.size() == 13380);
  CHECK(count_open_edges(character.largest_piece.mesh) == 0);
  CHECK(character.source_triangles.size() == 28796);
  CHECK(character.skin.triangles.size() == 28796);
  CHECK(character.report.components == 5);
  CHECK(character.metres_per_unit == 1);
  CHECK(character.sha256.size() == 64);
  // Source corners and body corners are the same places.
  for (std::size_t t = 0; t < character.largest_piece.mesh.triangles.size(); t += 101) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index source = character.source_triangles[character.largest_piece.source_triangle[t]][k];
      CHECK(character.largest_piece.of_source[source] == character.largest_piece.mesh.triangles[t][k]);
      CHECK(character.source_positions[source] ==
            character.largest_piece.mesh.positions[character.largest_piece.mesh.triangles[t][k]]);
    }
  }
}

TEST_CASE("what is no character is refused with the file's name and the cause") {
  const TemporaryFolder folder;
  CHECK(contains(refusal(folder.path / "nowhere.obj"), "no such file"));
  CHECK(contains(refusal(folder.path), "is a folder"));
  CHECK(contains(refusal(folder.write("notes.txt", "dear diary")), "not a mesh"));
  CHECK(contains(refusal(folder.write("broken.dae", "<COLLADA><asset>")), "not a mesh"));
  CHECK(contains(refusal(folder.write("empty.obj", "")), "is empty"));
  CHECK(contains(refusal(folder.write("short.GLB", "glTF")), "cut short"));
  CHECK(refusal(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")) != "accepted");
  CHECK(contains(refusal(folder.write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n")), "no triangles"));
  CHECK(
      contains(refusal(folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")), "no triangles with an area"));
  CHECK(contains(refusal(folder.write("dot.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n")), "no size"));
  CHECK(contains(refusal(folder.write("nan.obj", std::string("v nan 0 0\n") + kTetrahedron)), "not finite"));
  CHECK(contains(refusal(folder.write("inf.obj", std::string("v 0 inf 0\n") + kTetrahedron)), "not finite"));
  CHECK(refusal(folder.write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")) != "accepted");
}

TEST_CASE("files that importers stumble over are refused or read, in bounded memory") {
  // Debian's assimp-testmodels: counts of 10^9 in 300 bytes, and an importer that leaves one of two objects out.
  // Sanitizers bear no limit of memory: there the time ends it, after a minute where nobody says less.
  const auto peak_kib = [](int who) {
    rusage usage{};
    REQUIRE(getrusage(who, &usage) == 0);
    return usage.ru_maxrss;
  };
  [[maybe_unused]] const long before = std::max(peak_kib(RUSAGE_CHILDREN), peak_kib(RUSAGE_SELF));
#if defined(__SANITIZE_ADDRESS__)
  ::setenv("SPHERECHAIN_IMPORT_SECONDS", "4", 1);
#else
  ::setenv("SPHERECHAIN_IMPORT_MEMORY", "256", 1);
#endif
  CHECK(refusal("/usr/share/assimp/models/invalid/OutOfMemory.off") != "accepted");
  ::unsetenv("SPHERECHAIN_IMPORT_SECONDS");
  ::unsetenv("SPHERECHAIN_IMPORT_MEMORY");
#if !defined(__SANITIZE_ADDRESS__)
  CHECK(peak_kib(RUSAGE_CHILDREN) < before + 300 * 1024);
#endif
  CHECK(import_character("/usr/share/assimp/models/RAW/WithColor.raw").source_triangles.size() == 2);
}

TEST_CASE("indices out of range and positions beyond single precision are refused whatever the importer") {
  SourceMesh mesh = ball_mesh(8);
  mesh.triangles[3][1] = 100000;
  CHECK_THROWS_WITH_AS(build_character(mesh, "x.obj"), "x.obj: triangle 3 uses vertex 100000 of 114", Error);
  mesh = ball_mesh(8);
  mesh.positions[5].x() = 1e300;
  CHECK_THROWS_WITH_AS(build_character(mesh, "x.obj"), doctest::Contains("single precision"), Error);
}

TEST_CASE("a character of a size that lengths cannot be squared in is refused, in any sensible unit it is read") {
  const auto scaled = [](double by) {
    SourceMesh mesh = ball_mesh(8);
    for (Vec3& p : mesh.positions) p *= by;
    return build_character(mesh, "x.obj");
  };
  for (const double by : {1e30, 1e13, 1e-7, 1e-20, 1e-38}) {
    CAPTURE(by);
    CHECK_THROWS_WITH_AS(scaled(by), doctest::Contains("x.obj: is "), Error);
    CHECK_THROWS_WITH_AS(scaled(by), doctest::Contains("units across (a character is from 1e-06 to 1e+12"), Error);
  }
  for (const double by : {1e10, 1e-5}) CHECK(scaled(by).skin.triangles.size() == ball_mesh(8).triangles.size());
}

TEST_CASE("degenerate and duplicate triangles are dropped and counted, and split vertices welded") {
  const TemporaryFolder folder;
  // Two corners at one place, three on a line, one triangle twice (turned, and once inside out); vertex 5 repeats
  // vertex 1.
  const auto path =
      folder.write("dirty.obj",
                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 0\nv 0.5 0 0\nf 1 3 2\nf 5 2 4\nf 2 3 4\nf 3 1 4\n"
                   "f 1 5 2\nf 1 6 2\nf 3 2 1\nf 2 3 1\n");
  const Character character = import_character(path);
  CHECK(character.largest_piece.mesh.triangles.size() == 4);
  CHECK(character.report.degenerate_dropped == 2);
  CHECK(character.report.duplicates_dropped == 2);
  CHECK(character.report.welded_vertices == 4);
  CHECK(count_open_edges(character.largest_piece.mesh) == 0);
  CHECK(character.source_triangles.size() == 8);
}

TEST_CASE("the largest piece by area is the body, whichever comes first") {
  SourceMesh small = ball_mesh(6), large = ball_mesh(12);
  for (Vec3& p : large.positions) p = 5 * p + Vec3(20, 0, 0);
  const auto join = [](SourceMesh a, const SourceMesh& b) {
    const auto base = static_cast<Index>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    return a;
  };
  for (const SourceMesh& mesh : {join(small, large), join(large, small)}) {
    const Character character = build_character(mesh, "two.obj");
    CHECK(character.report.components == 2);
    CHECK(character.largest_piece.mesh.triangles.size() == large.triangles.size());
    CHECK(character.skin.triangles.size() == small.triangles.size() + large.triangles.size());
  }
}
