// SPDX-License-Identifier: MIT
#include "clip.h"

#include <cstring>
#include <fstream>
#include <iterator>

namespace spherechain::test {
namespace {

using Matrix = std::array<double, 12>;
constexpr Matrix kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// From -1 to 1 and back, `pace` times over the clip, in steps that are exact.
double swing(std::size_t frame, std::size_t pace, std::size_t start) {
  const std::size_t at = (frame * pace + start) % kFrames;
  const std::size_t up = at < kFrames / 2 ? at : kFrames - at;
  return (static_cast<double>(up) - kFrames / 4.0) / (kFrames / 4.0);
}

// About an axis (0: x, 1: y, 2: z) by the angle whose half has the tangent t.
Matrix turn(int axis, double t) {
  const double c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
  Matrix m = kIdentity;
  const auto p = static_cast<std::size_t>((axis + 1) % 3), q = static_cast<std::size_t>((axis + 2) % 3);
  m[4 * p + p] = m[4 * q + q] = c;
  m[4 * p + q] = -s;
  m[4 * q + p] = s;
  return m;
}

Matrix times(const Matrix& l, const Matrix& r) {
  Matrix out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      double sum = column == 3 ? l[4 * row + 3] : 0;
      for (std::size_t k = 0; k < 3; ++k) sum += l[4 * row + k] * r[4 * k + column];
      out[4 * row + column] = sum;
    }
  }
  return out;
}

Matrix about(const Vec3& place, const Matrix& turned) {
  Matrix there = kIdentity, back = kIdentity;
  const float p[3] = {place.x, place.y, place.z};
  for (std::size_t k = 0; k < 3; ++k) {
    there[4 * k + 3] = double{p[k]};
    back[4 * k + 3] = -double{p[k]};
  }
  return times(times(there, turned), back);
}

struct Move {
  const char* joint;
  int axis;
  double middle, width;  // tangents of half the angle
  std::size_t pace, start;
};
constexpr Move kMoves[] = {
    {"spine", 0, 0.0625, 0.125, 2, 0},          {"left_shoulder", 2, -0.375, 0.375, 3, 10},
    {"left_shoulder", 1, -0.25, 0.5, 5, 40},    {"left_elbow", 1, -0.5, 0.5, 7, 0},
    {"right_shoulder", 2, 0.375, 0.375, 3, 90}, {"right_shoulder", 1, 0.25, 0.5, 4, 70},
    {"right_elbow", 1, 0.5, 0.5, 6, 30},        {"left_hip", 0, -0.25, 0.375, 2, 0},
    {"left_hip", 2, -0.0625, 0.125, 5, 0},      {"left_knee", 0, 0.375, 0.375, 3, 60},
    {"right_hip", 0, -0.25, 0.375, 2, 128},     {"right_hip", 2, 0.0625, 0.125, 4, 0},
    {"right_knee", 0, 0.375, 0.375, 3, 0},      {"head", 1, 0, 0.25, 1, 0},
};

double squared_distance(const double (&p)[3], const JointView& joint) {
  const double from[3] = {joint.position.x, joint.position.y, joint.position.z};
  const double to[3] = {joint.tail.x, joint.tail.y, joint.tail.z};
  double along = 0, length = 0;
  for (int k = 0; k < 3; ++k) {
    along += (p[k] - from[k]) * (to[k] - from[k]);
    length += (to[k] - from[k]) * (to[k] - from[k]);
  }
  const double f = length <= 0 || along <= 0 ? 0 : along >= length ? 1 : along / length;
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = p[k] - from[k] - f * (to[k] - from[k]);
    sum += d * d;
  }
  return sum;
}

// Whole numbers alone.
bool read_obj(const std::string& path, std::vector<float>& corners) {
  std::ifstream file(path);
  std::vector<std::array<int, 3>> vertices;
  std::string kind;
  std::array<int, 3> three{};
  while (file >> kind >> three[0] >> three[1] >> three[2]) {
    if (kind == "v") {
      vertices.push_back(three);
      continue;
    }
    for (const int v : three) {
      for (const int coordinate : vertices.at(static_cast<std::size_t>(v - 1))) {
        corners.push_back(static_cast<float>(coordinate));
      }
    }
  }
  return file.eof() && !corners.empty();
}

}  // namespace

Doll::Doll(const std::string& folder, const std::string& file) {
  const std::string path = folder + "/" + file;
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> read{std::istreambuf_iterator<char>(stream), {}};
  bytes.resize((read.size() + 7) / 8);
  std::copy(read.begin(), read.end(), reinterpret_cast<char*>(bytes.data()));
  char message[160];
  if (sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), read.size(), message, sizeof message) != SC_OK) {
    error = path + ": " + message;
  } else if (!read_obj(folder + "/doll.obj", rest)) {
    error = folder + "/doll.obj: cannot be read";
  } else if (sc_check_source(&asset, SC_WHOLE_SOURCE, rest.data(), rest.size() / 3, 12) != SC_OK) {
    error = folder + "/doll.obj: not what " + file + " was baked from";
  } else if (view_of(asset).joint_count() == 0 || view_of(asset).bone_count() != view_of(asset).joint_count()) {
    error = path + ": not of an automatic rig";
  }
  for (std::size_t v = 0; error.empty() && v < rest.size() / 3; ++v) {
    const double p[3] = {rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]};
    std::size_t nearest = 0;
    const AssetView& view = view_of(asset);
    for (std::size_t j = 1; j < view.joint_count(); ++j) {
      if (squared_distance(p, view.joint(j)) < squared_distance(p, view.joint(nearest))) nearest = j;
    }
    joint_of.push_back(nearest);
  }
}

std::vector<std::array<float, 12>> matrices_at(const Asset& asset, std::size_t frame) {
  std::vector<Matrix> world;
  std::vector<std::array<float, 12>> out;
  for (std::size_t j = 0; j < view_of(asset).joint_count(); ++j) {
    const JointView joint = view_of(asset).joint(j);
    Matrix m = joint.parent < 0 ? kIdentity : world[static_cast<std::size_t>(joint.parent)];
    for (const Move& move : kMoves) {
      if (std::strcmp(move.joint, joint.name) == 0) {
        const double t = move.middle + move.width * swing(frame, move.pace, move.start);
        m = times(m, about(joint.position, turn(move.axis, t)));
      }
    }
    world.push_back(m);
    out.emplace_back();
    for (std::size_t k = 0; k < 12; ++k) out.back()[k] = static_cast<float>(m[k]);
  }
  return out;
}

std::vector<Transform> joints_at(const Asset& asset, std::size_t frame) {
  std::vector<Transform> out;
  for (std::size_t j = 0; j < view_of(asset).joint_count(); ++j) {
    const JointView joint = view_of(asset).joint(j);
    const Vec3 above =
        joint.parent < 0 ? Vec3{} : view_of(asset).joint(static_cast<std::size_t>(joint.parent)).position;
    double q[4] = {0, 0, 0, 1};
    for (const Move& move : kMoves) {
      if (std::strcmp(move.joint, joint.name) != 0) continue;
      const double t = move.middle + move.width * swing(frame, move.pace, move.start);
      const auto a = static_cast<std::size_t>(move.axis), b = (a + 1) % 3, c = (a + 2) % 3;
      const double turned[4] = {q[a] + t * q[3], q[b] + t * q[c], q[c] - t * q[b], q[3] - t * q[a]};
      q[a] = turned[0];
      q[b] = turned[1];
      q[c] = turned[2];
      q[3] = turned[3];
    }
    Transform transform{
        {joint.position.x - above.x, joint.position.y - above.y, joint.position.z - above.z}, {}, {1, 1, 1}};
    for (std::size_t k = 0; k < 4; ++k) transform.rotation[k] = static_cast<float>(q[k]);
    out.push_back(transform);
  }
  return out;
}

std::vector<std::uint32_t> parents_of(const Asset& asset) {
  std::vector<std::uint32_t> out;
  for (std::size_t j = 0; j < view_of(asset).joint_count(); ++j) {
    out.push_back(static_cast<std::uint32_t>(view_of(asset).joint(j).parent));  // -1 is SC_NO_JOINT
  }
  return out;
}

std::vector<float> positions_at(const Doll& doll, const std::vector<std::array<float, 12>>& matrices) {
  std::vector<float> out;
  for (std::size_t v = 0; v < doll.joint_of.size(); ++v) {
    const std::array<float, 12>& m = matrices[doll.joint_of[v]];
    const float* p = &doll.rest[3 * v];
    for (std::size_t row = 0; row < 3; ++row) {
      const float* r = &m[4 * row];
      out.push_back(((r[0] * p[0] + r[1] * p[1]) + r[2] * p[2]) + r[3]);
    }
  }
  return out;
}

}  // namespace spherechain::test
