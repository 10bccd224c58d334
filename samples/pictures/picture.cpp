// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "baker/mesh/error.h"

// The library is C of another style: its warnings are not ours to mend.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace spherechain::pictures {
namespace {

constexpr int kSamples = 2;  // a pixel is the mean of kSamples^2
constexpr Colour kPaper{1, 1, 1};
constexpr float kSphereOpacity = 0.6f, kHighlightOpacity = 0.9f;

struct Layer {
  double depth;  // towards the viewer
  Colour colour;
  float opacity;
};

// An orthographic camera: screen x to the right, y up, z towards the viewer.
struct Camera {
  Vec3 right, up, towards;
  double x0 = 0, y0 = 0, scale = 1;  // samples a unit
  int width = 0, height = 0;         // in samples

  Vec3 project(const Vec3& p) const {
    return {(p.dot(right) - x0) * scale, height - (p.dot(up) - y0) * scale, p.dot(towards) * scale};
  }
};

Camera aim(const Picture& picture, const PictureView& view) {
  const baker::BodyFrame& f = picture.frame;
  Camera camera;
  camera.towards = (view.x() * f.left + view.y() * f.up + view.z() * f.forward).normalized();
  camera.right = f.up.cross(camera.towards).normalized();
  camera.up = camera.towards.cross(camera.right);
  return camera;
}

// Light from over the viewer's left shoulder; never black, so that form shows in the shade too.
Colour shade(const Colour& colour, const Vec3& normal, const Camera& camera) {
  const Vec3 light = (camera.towards - 0.5 * camera.right + 0.6 * camera.up).normalized();
  const auto lit = static_cast<float>(0.3 + 0.7 * std::max(0.0, normal.dot(light)));
  return {colour[0] * lit, colour[1] * lit, colour[2] * lit};
}

void blend(Colour& below, const Colour& colour, float opacity) {
  for (std::size_t k = 0; k < 3; ++k) below[k] += opacity * (colour[k] - below[k]);
}

class Canvas {
 public:
  Canvas(const Camera& camera, const Picture& picture) : camera_(camera), picture_(picture) {
    const auto size = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    depth_.assign(size, -std::numeric_limits<double>::infinity());
    skin_.assign(size, kPaper);
    draw_skin();
    image_ = skin_;
    if (!picture.spheres.empty()) draw_spheres();
    for (const PictureLine& line : picture.lines) draw_line(line);
  }
  const Colour& sample(int x, int y) const { return image_[at(x, y)]; }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
  }

  void draw_skin() {
    for (std::size_t t = 0; t < picture_.mesh.triangles.size(); ++t) {
      const baker::Triangle& v = picture_.mesh.triangles[t];
      const Vec3 a = camera_.project(picture_.mesh.positions[v[0]]), b = camera_.project(picture_.mesh.positions[v[1]]),
                 c = camera_.project(picture_.mesh.positions[v[2]]);
      const double area = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
      if (area == 0) continue;
      // Seen from behind only where one part went through another: shown as it would look from there.
      Vec3 normal = triangle_cross(picture_.mesh, t).normalized();
      if (normal.dot(camera_.towards) < 0) normal = -normal;
      const Colour colour =
          shade(picture_.triangle_colours.empty() ? kSkin : picture_.triangle_colours[t], normal, camera_);
      const int left = std::max(0, static_cast<int>(std::min({a.x(), b.x(), c.x()})));
      const int right = std::min(camera_.width - 1, static_cast<int>(std::max({a.x(), b.x(), c.x()})));
      const int top = std::max(0, static_cast<int>(std::min({a.y(), b.y(), c.y()})));
      const int bottom = std::min(camera_.height - 1, static_cast<int>(std::max({a.y(), b.y(), c.y()})));
      for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
          const double px = x + 0.5, py = y + 0.5;
          const double wb = ((px - a.x()) * (c - a).y() - (py - a.y()) * (c - a).x()) / area;
          const double wc = ((b - a).x() * (py - a.y()) - (b - a).y() * (px - a.x())) / area;
          if (wb < 0 || wc < 0 || wb + wc > 1) continue;
          const double depth = a.z() + wb * (b - a).z() + wc * (c - a).z();
          if (depth <= depth_[at(x, y)]) continue;
          depth_[at(x, y)] = depth;
          skin_[at(x, y)] = colour;
        }
      }
    }
  }

  void draw_spheres() {
    struct Disc {
      Vec3 center;
      double radius;
      const PictureSphere* sphere;
    };
    std::vector<Disc> discs;
    for (const PictureSphere& s : picture_.spheres) {
      discs.push_back({camera_.project(s.center), s.radius * camera_.scale, &s});
    }
    std::vector<Layer> layers;
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        layers.clear();
        for (const Disc& disc : discs) {
          const double dx = x + 0.5 - disc.center.x(), dy = y + 0.5 - disc.center.y();
          const double rest = disc.radius * disc.radius - dx * dx - dy * dy;
          if (rest < 0) continue;
          const double dz = std::sqrt(rest);
          const Vec3 normal = (dx * camera_.right - dy * camera_.up + dz * camera_.towards) / disc.radius;
          const bool lit = disc.sphere->highlighted;
          layers.push_back({disc.center.z() + dz, shade(lit ? kHighlight : disc.sphere->colour, normal, camera_),
                            lit ? kHighlightOpacity : kSphereOpacity});
        }
        if (layers.empty() && picture_.skin_opacity >= 1) continue;
        if (std::isfinite(depth_[at(x, y)])) {
          layers.push_back({depth_[at(x, y)], skin_[at(x, y)], static_cast<float>(picture_.skin_opacity)});
        }
        std::stable_sort(layers.begin(), layers.end(),
                         [](const Layer& a, const Layer& b) { return a.depth < b.depth; });
        Colour colour = kPaper;
        for (const Layer& layer : layers) blend(colour, layer.colour, layer.opacity);
        image_[at(x, y)] = colour;
      }
    }
  }

  void draw_line(const PictureLine& line) {
    const Vec3 a = camera_.project(line.from), b = camera_.project(line.to);
    const auto stamp = [&](const Vec3& p, int radius) {
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          const int x = static_cast<int>(p.x()) + dx, y = static_cast<int>(p.y()) + dy;
          const bool inside = x >= 0 && y >= 0 && x < camera_.width && y < camera_.height;
          if (inside && dx * dx + dy * dy <= radius * radius) image_[at(x, y)] = line.colour;
        }
      }
    };
    const int steps = 1 + static_cast<int>((b - a).head<2>().norm());
    for (int i = 0; i <= steps; ++i) stamp(a + (b - a) * i / steps, kSamples);
    stamp(a, 3 * kSamples);
  }

  const Camera& camera_;
  const Picture& picture_;
  std::vector<double> depth_;
  std::vector<Colour> skin_, image_;
};

// Every view gets the same scale and the same height; a width that fits.
std::vector<Camera> fit_cameras(const Picture& picture) {
  std::vector<Camera> cameras;
  std::vector<Eigen::AlignedBox2d> boxes;
  double tallest = 0;
  for (const PictureView& view : picture.views) {
    const Camera camera = aim(picture, view);
    Eigen::AlignedBox2d box;
    const auto add = [&](const Vec3& p, double r) {
      const Eigen::Vector2d at(p.dot(camera.right), p.dot(camera.up));
      box.extend(at - Eigen::Vector2d(r, r));
      box.extend(at + Eigen::Vector2d(r, r));
    };
    for (const Vec3& p : picture.mesh.positions) add(p, 0);
    for (const PictureSphere& s : picture.spheres) add(s.center, s.radius);
    tallest = std::max(tallest, box.sizes().y());
    cameras.push_back(camera);
    boxes.push_back(box);
  }
  const double margin = 0.03 * tallest;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    Camera& camera = cameras[i];
    camera.height = kSamples * picture.height;
    camera.scale = camera.height / (tallest + 2 * margin);
    camera.width = kSamples * static_cast<int>((boxes[i].sizes().x() + 2 * margin) * camera.scale / kSamples);
    camera.x0 = boxes[i].min().x() - margin;
    camera.y0 = boxes[i].center().y() - 0.5 * tallest - margin;
  }
  return cameras;
}

}  // namespace

void write_picture(const std::filesystem::path& path, const Picture& picture) {
  const std::vector<Camera> cameras = fit_cameras(picture);
  int width = 0;
  for (const Camera& camera : cameras) width += camera.width / kSamples;
  std::vector<unsigned char> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(picture.height) * 3);
  int x0 = 0;
  for (const Camera& camera : cameras) {
    const Canvas canvas(camera, picture);
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < camera.width / kSamples; ++x) {
        for (std::size_t k = 0; k < 3; ++k) {
          float sum = 0;
          for (int s = 0; s < kSamples * kSamples; ++s) {
            sum += canvas.sample(kSamples * x + s % kSamples, kSamples * y + s / kSamples)[k];
          }
          const auto pixel =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x0 + x);
          pixels[3 * pixel + k] =
              static_cast<unsigned char>(std::clamp(sum / (kSamples * kSamples), 0.0f, 1.0f) * 255 + 0.5f);
        }
      }
    }
    x0 += camera.width / kSamples;
  }
  if (stbi_write_png(path.string().c_str(), width, picture.height, 3, pixels.data(), 3 * width) == 0) {
    throw baker::Error(baker::ExitCode::kFile, path.string() + ": cannot be written (check the folder)");
  }
}

}  // namespace spherechain::pictures
