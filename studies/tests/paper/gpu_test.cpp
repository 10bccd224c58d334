// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 16: what another machine measured, read, judged and shown. figure16.json beside this file is made up.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "baker/mesh/error.h"
#include "csv.h"
#include "gpu_claims.h"
#include "gpu_time.h"

using spherechain::paper::evaluate_gpu_m1_faster;
using spherechain::paper::evaluate_gpu_needs_many;
using spherechain::paper::gpu_medians;
using spherechain::paper::GpuTime;
using spherechain::paper::read_gpu_time;
using spherechain::paper::Table;

namespace {

// Times of 50, 84 and 10,000 spheres: kernel, and launch and copies on top of it.
struct Times {
  const char* method;
  double kernel[3];
};

Table medians_of(const std::vector<Times>& methods, double overhead) {
  Table out{"figure16_medians",
            {"spheres", "parts", "method", "frames", "overlaps", "kernel_us", "launch_us", "frame_us"},
            {}};
  const double spheres[3] = {50, 84, 10000};
  for (int i = 0; i < 3; ++i) {
    for (const Times& t : methods) {
      const bool gpu = std::string(t.method).rfind("gpu", 0) == 0;
      using spherechain::paper::Cell;
      out.add({spheres[i], i == 2 ? 200 : 1, t.method, 80, 1, t.kernel[i], gpu ? Cell(t.kernel[i] + overhead) : Cell(),
               gpu ? Cell(t.kernel[i] + overhead) : Cell()});
    }
  }
  return out;
}

std::string m1_faster(const Times& m2, const Times& chain, const Times& place, double overhead) {
  return evaluate_gpu_m1_faster(medians_of({m2, chain, place}, overhead)).verdict;
}

std::string needs_many(const Times& gpu, const Times& cpu) {
  return evaluate_gpu_needs_many(medians_of({gpu, cpu, {"cpu_m1", {1e9, 1e9, 1e9}}}, 0)).verdict;
}

std::string written(const std::string& text) {
  const auto file =
      std::filesystem::temp_directory_path() / ("spherechain_gpu_test_" + std::to_string(getpid()) + ".json");
  std::ofstream(file) << text;
  return file.string();
}

}  // namespace

TEST_CASE("where no GPU was run there are no times, and both claims say so") {
  const GpuTime time = read_gpu_time("nowhere/figure16.json");
  CHECK(time.frames.empty());
  CHECK(gpu_medians(time).empty());
  CHECK(evaluate_gpu_m1_faster(gpu_medians(time)).verdict == "not run");
  CHECK(evaluate_gpu_needs_many(gpu_medians(time)).verdict == "not run");
}

TEST_CASE("a file that is not the program's is refused by name, not taken for a run without times") {
  for (const char* text : {"", "[]", "{\"series\": []}",
                           R"({"chip":"a","runtime":"b","driver":"c","processor":"d","date":"e","command":"f",
                               "characters":[{"spheres":50,"parts":1}],"series":[{"spheres":50,"animation":"arms",
                               "method":"gpu_empty","frame":[0,1],"overlaps":[0],"kernel_us":[1,1]}]})"}) {
    const std::string file = written(text);
    CHECK_THROWS_WITH_AS(read_gpu_time(file), doctest::Contains(file.c_str()), spherechain::baker::Error);
    std::filesystem::remove(file);
  }
}

TEST_CASE("medians are over the frames of both animations, and a CPU's method has but one time") {
  const GpuTime time = read_gpu_time(SPHERECHAIN_MADE_UP_GPU_TIME);
  CHECK(time.machine.find("Made-up GPU, CUDA 1.1 (driver: CUDA 1.2)") == 0);
  CHECK(time.frames.rows.size() == 2 * (18 + 18 + 15));
  const Table medians = gpu_medians(time);
  CHECK(medians.rows.size() == 18);
  const Table m2 = medians.where("spheres", 84.0).where("method", "gpu_m2_sphere");
  // 8 us times 1, 10.1, 1.02 and 1.02, 1.03, 1.04; with copies the second is 1.01
  CHECK(m2.number(0, "kernel_us") == doctest::Approx(8 * 1.025));
  CHECK(m2.number(0, "frame_us") == doctest::Approx(8 * 1.02 + 9));
  CHECK(m2.number(0, "overlaps") == 1.5);
  const Table cpu = medians.where("spheres", 10000.0).where("method", "cpu_m2");
  CHECK(cpu.number(0, "kernel_us") == doctest::Approx(2.8e5 * 1.015));
  CHECK(std::isnan(cpu.number(0, "frame_us")));
  CHECK(cpu.number(0, "parts") == 200);
  CHECK(cpu.number(0, "frames") == 4);
  CHECK(m2.number(0, "frames") == 6);
}

TEST_CASE("M1 is faster on the GPU where its better kernel leads by a twentieth at the paper's counts, by both times") {
  const Times m2{"gpu_m2_sphere", {10, 20, 100}}, slow{"gpu_m1_chain", {50, 90, 1e6}};
  CHECK(m1_faster(m2, slow, {"gpu_m1_sphere", {5, 10, 200}}, 0) == "holds");  // what 10,000 do is not asked
  CHECK(m1_faster(m2, {"gpu_m1_chain", {5, 10, 200}}, {"gpu_m1_sphere", {50, 90, 300}}, 0) == "holds");
  CHECK(m1_faster(m2, slow, {"gpu_m1_sphere", {5, 10, 200}}, 1000) == "holds in part");  // drowned by the overhead
  CHECK(m1_faster(m2, slow, {"gpu_m1_sphere", {5, 30, 50}}, 0) == "holds in part");
  CHECK(m1_faster(m2, slow, {"gpu_m1_sphere", {9.6, 19.2, 50}}, 0) == "does not hold");
  CHECK(m1_faster(m2, slow, {"gpu_m1_sphere", {20, 40, 50}}, 0) == "does not hold");
}

TEST_CASE("many spheres are needed where the CPU leads below 10,000 and the GPU there") {
  CHECK(needs_many({"gpu_m1_sphere", {9, 9, 9}}, {"cpu_m2", {1, 2, 100}}) == "holds");
  CHECK(needs_many({"gpu_m1_sphere", {9, 9, 9}}, {"cpu_m2", {1, 20, 100}}) == "holds in part");
  CHECK(needs_many({"gpu_m1_sphere", {9, 9, 9}}, {"cpu_m2", {10, 20, 100}}) == "does not hold");
  CHECK(needs_many({"gpu_m1_sphere", {9, 9, 900}}, {"cpu_m2", {1, 2, 100}}) == "does not hold");
}

TEST_CASE("the page of a run with a GPU's times has Figure 16, its machine and its verdicts") {
  const std::vector<Row> medians = read_csv("figure16_medians.csv"), claims = read_csv("claims.csv");
  CHECK(medians.size() == 18);
  CHECK(only(claims, "id", "gpu").front().at("verdict") == "holds");  // least lead, 50 spheres with copies: 12 of 13 us
  CHECK(only(claims, "id", "gpu_many").front().at("verdict") == "holds");
  const std::string markdown = read_output("paper.md"), page = read_output("index.html");
  for (const char* word : {"Figure 16: time of a frame on a GPU", "Made-up GPU", "M1, a thread a chain"}) {
    CHECK(markdown.find(word) != std::string::npos);
    CHECK(page.find(word) != std::string::npos);
  }
  CHECK(markdown.find("![figure16](paper/figure16.svg)") != std::string::npos);
  const std::string svg = read_output("paper/figure16.svg");
  CHECK(svg.find("legs, 10000 spheres") != std::string::npos);
  CHECK(svg.find("M1, a thread a sphere") != std::string::npos);
}
