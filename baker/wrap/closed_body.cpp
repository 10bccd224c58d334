// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrap/closed_body.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "mesh/error.h"
#include "mesh/surface_query.h"
#include "wrap/alpha_wrap.h"
#include "wrap/close_cracks.h"
#include "wrap/stitch.h"

namespace spherechain::baker {
namespace {

// Of the skin's diameter: what single precision and exporters' rounding leave between vertices that were one.
constexpr double kCrack = 1e-4;

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

// The piece with the largest area, and where its vertices and triangles came from.
struct Piece {
  Mesh mesh;
  std::vector<Index> of_vertex, of_triangle;
};

Piece largest_piece(const Mesh& mesh) {
  const Components components = connected_components(mesh);
  std::vector<double> area(components.count, 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area[components.of_triangle[t]] += triangle_area(mesh, t);
  const auto largest = static_cast<Index>(std::max_element(area.begin(), area.end()) - area.begin());
  Piece piece;
  std::vector<Index> place(mesh.positions.size(), kNoIndex);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (components.of_triangle[t] != largest) continue;
    Triangle corners = mesh.triangles[t];
    for (Index& v : corners) {
      if (place[v] == kNoIndex) {
        place[v] = static_cast<Index>(piece.mesh.positions.size());
        piece.mesh.positions.push_back(mesh.positions[v]);
        piece.of_vertex.push_back(v);
      }
      v = place[v];
    }
    piece.mesh.triangles.push_back(corners);
    piece.of_triangle.push_back(t);
  }
  return piece;
}

double volume(const Mesh& mesh) {
  const Vec3 origin = mesh.positions[0];
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] - origin, b = mesh.positions[t[1]] - origin, c = mesh.positions[t[2]] - origin;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

// What is left then a wrap could not make a limb of.
bool is_all_of_skin(const Character& character) {
  constexpr double kAll = 0.98;
  return surface_area(character.body) > kAll * surface_area(character.skin);
}

double crack_of(const Mesh& skin) { return kCrack * diameter(skin); }

// Behind thin parts of a wrap there is its other side: cloth, or the wrap has got in and lines the skin.
double thin_share(const Mesh& wrap, double offset) {
  const SurfaceQuery surface(wrap);
  double thin = 0, all = 0;
  for (std::size_t t = 0; t < wrap.triangles.size(); ++t) {
    const double area = triangle_area(wrap, t);
    all += area;
    const Vec3 inwards = -triangle_cross(wrap, t).normalized();
    const auto hit = surface.first_hit(triangle_centroid(wrap, t) + 1e-3 * offset * inwards, inwards);
    if (hit && hit->distance < 3 * offset) thin += area;
  }
  return all > 0 ? thin / all : 1;
}

struct Try {
  double fineness;  // the skin's diameter over alpha
  bool holes_first;
};

// A wrap's offset, as a fraction of alpha, and the part of it that is left: with none, opposite sides of thin parts
// would coincide.
constexpr double kOffset = 0.05;
constexpr double kOffsetLeft = 0.1;

// A cape and hair are thin too, and no matter; with more than this the wrap lines the skin from inside.
constexpr double kMostThin = 0.3;

class Wrapper {
 public:
  Wrapper(Character& character, ClosingReport& report)
      : character_(character), report_(report), diameter_(diameter(character.skin)) {}

  // Nothing where the wrap would be, or is, of more triangles than a character's.
  bool wrap(const Try& with) {
    const Stopwatch stopwatch(report_.seconds);
    const double alpha = diameter_ / with.fineness, offset = kOffset * alpha;
    const Mesh& skin = with.holes_first ? closed_skin() : character_.skin;
    Mesh surface = largest_piece(alpha_wrap(skin, alpha, offset)).mesh;
    ++report_.wraps;
    if (surface.triangles.size() > kMostTriangles) return false;
    report_.alpha = 1 / with.fineness;
    report_.offset = kOffset / with.fineness;
    report_.holes_first = with.holes_first;
    report_.triangles = surface.triangles.size();
    report_.thin = thin_share(surface, offset);
    const SurfaceQuery query(skin);
    for (Vec3& p : surface.positions) {
      const SurfaceHit nearest = query.closest(p);
      if (nearest.distance < 2 * offset) p += (1 - kOffsetLeft) * (nearest.point - p);
    }
    character_.body = std::move(surface);
    character_.body_source_triangle.assign(character_.body.triangles.size(), kNoIndex);
    character_.body_of_source.assign(character_.source_positions.size(), kNoIndex);
    return true;
  }

  static constexpr std::size_t kMostTriangles = 100'000;

 private:
  const Mesh& closed_skin() {
    if (!closed_skin_) closed_skin_ = stitch(close_cracks(character_.skin, crack_of(character_.skin)).mesh).mesh;
    return *closed_skin_;
  }

  Character& character_;
  ClosingReport& report_;
  double diameter_;
  std::optional<Mesh> closed_skin_;
};

// What a character most likely is, where the settings do not say.
bool is_expected(const Regions& regions, const SegmentSettings& settings) {
  return settings.body != BodyKind::kUnknown || is_biped(regions);
}

// Looks for the wrap to segment. On a human the balls are of 14, 9, 20, 30 and 45 mm: at 20 mm armpit and crotch are
// webbed enough to see, at 30 mm the arms of an A-pose may have grown to the body.
class WrapSearch {
 public:
  WrapSearch(Character& character, const SegmentSettings& settings, ClosingReport& report, std::optional<Error> error)
      : character_(character), settings_(settings), report_(report), wrapper_(character, report), error_(error) {}

  Regions run() {
    report_.body = BodySource::kWrapped;
    // A coarse wrap is quick, and tells a character from a cloud of triangles.
    constexpr Try kCoarse{60, false};
    constexpr double kOfHuman = 6000;  // triangles at 60; stouter bodies have more, and shorter limbs to tell apart
    if (!is_one_shape(kCoarse)) refuse();
    if (report_.thin > kMostThin) {
      // Through holes wider than the ball, and finer wraps would be slow: holes closed by fans, or larger balls.
      for (const Try& with : {Try{60, true}, Try{90, true}, Try{40, false}, Try{40, true}}) {
        if (attempt(with) == Outcome::kGood) break;
      }
    } else {
      const double usual = 130 * std::min(1.0, std::sqrt(kOfHuman / static_cast<double>(report_.triangles)));
      const Outcome first = attempt({usual, false});
      const double finest =
          usual * std::sqrt(static_cast<double>(Wrapper::kMostTriangles) / static_cast<double>(report_.triangles));
      for (const double fineness : {200.0, 90.0, 60.0}) {
        if (first == Outcome::kGood || (first == Outcome::kLeaks && fineness > usual) || fineness > finest) continue;
        if (attempt({fineness, false}) == Outcome::kGood) break;
      }
    }
    if (best_) return take_best();
    if (error_) throw *error_;
    refuse();
  }

 private:
  enum class Outcome : std::uint8_t { kGood, kLeaks, kFails };

  [[noreturn]] void refuse() const {
    throw Error(ExitCode::kSegmentation, character_.file +
                                             ": its triangles enclose no body (close the holes that are "
                                             "as wide as its limbs)");
  }

  bool is_one_shape(const Try& with) {
    // Of the area: a human's wrap has 5,600 triangles at 60, and finer ones grow with the square.
    constexpr std::size_t kMostTriangles = 20'000;
    constexpr std::ptrdiff_t kMostHandles = 20;
    if (!wrapper_.wrap(with)) return false;
    const Mesh& mesh = character_.body;
    const auto faces = static_cast<std::ptrdiff_t>(mesh.triangles.size());
    const std::ptrdiff_t handles = 1 - (static_cast<std::ptrdiff_t>(mesh.positions.size()) - faces / 2) / 2;
    return mesh.triangles.size() <= kMostTriangles && handles <= kMostHandles;
  }

  struct Result {
    Regions regions;
    Mesh body;
    ClosingReport report;
  };

  Outcome attempt(const Try& with) {
    constexpr double kGood = 0.02;
    if (!wrapper_.wrap(with)) return Outcome::kFails;
    if (report_.thin > kMostThin) return Outcome::kLeaks;
    try {
      Regions regions = segment(character_, settings_);
      const bool expected = is_expected(regions, settings_);
      // A wrap's false branches make six legs of four: limbs that are not a biped's count when two wraps have as many.
      const bool again = !expected && best_ && best_->regions.limbs.size() == regions.limbs.size();
      const bool replaces = !best_ || (expected && !is_expected(best_->regions, settings_)) ||
                            (expected == is_expected(best_->regions, settings_) && report_.thin < best_->report.thin);
      if (replaces) best_ = Result{std::move(regions), character_.body, report_};
      if (report_.thin > kGood) return Outcome::kLeaks;
      return expected || again ? Outcome::kGood : Outcome::kFails;
    } catch (const Error& caught) {
      if (caught.code() != ExitCode::kSegmentation) throw;
      if (!error_) error_ = caught;
      return report_.thin <= kGood ? Outcome::kFails : Outcome::kLeaks;
    }
  }

  Regions take_best() {
    best_->report.wraps = report_.wraps;
    best_->report.seconds = report_.seconds;
    report_ = best_->report;
    character_.body = std::move(best_->body);
    character_.body_source_triangle.assign(character_.body.triangles.size(), kNoIndex);
    return std::move(best_->regions);
  }

  Character& character_;
  const SegmentSettings& settings_;
  ClosingReport& report_;
  Wrapper wrapper_;
  std::optional<Result> best_;
  std::optional<Error> error_;  // the first: of the body, or of the finest wrap
};

}  // namespace

bool repair_body(Character& character, ClosingReport& report) {
  const Stopwatch stopwatch(report.seconds);
  const Mesh& skin = character.skin;
  const Uncracked uncracked = close_cracks(skin, crack_of(skin));
  const Stitched stitched = stitch(uncracked.mesh);
  report.welded = uncracked.welded;
  report.t_junctions = uncracked.t_junctions;
  report.turned = stitched.turned;
  report.parted = stitched.parted;
  report.holes = stitched.holes;

  Piece piece = largest_piece(stitched.mesh);
  double area = 0;
  std::vector<Index> source_triangle;
  for (std::size_t t = 0; t < piece.of_triangle.size(); ++t) {
    const Index of_uncracked = stitched.of_triangle[piece.of_triangle[t]];
    const bool fan = of_uncracked == kNoIndex;
    source_triangle.push_back(fan ? kNoIndex : character.skin_source_triangle[uncracked.of_triangle[of_uncracked]]);
    if (!fan) area += triangle_area(piece.mesh, t);
  }
  if (count_open_edges(piece.mesh) > 0 || area <= kMostOfSkin * surface_area(skin)) return false;
  if (volume(piece.mesh) < 0) {
    for (Triangle& t : piece.mesh.triangles) std::swap(t[1], t[2]);
  }
  std::vector<Index> of_skin(skin.positions.size(), kNoIndex);
  for (Index v = 0; v < piece.of_vertex.size(); ++v) {
    const Index welded = stitched.of_vertex[piece.of_vertex[v]];
    if (welded != kNoIndex && of_skin[welded] == kNoIndex) of_skin[welded] = v;
  }
  for (std::size_t v = 0; v < character.source_positions.size(); ++v) {
    const Index on_skin = character.skin_of_source[v];
    character.body_of_source[v] = on_skin == kNoIndex ? kNoIndex : of_skin[uncracked.welded_to[on_skin]];
  }
  character.body = std::move(piece.mesh);
  character.body_source_triangle = std::move(source_triangle);
  report.body = BodySource::kRepaired;
  return true;
}

bool wrap_body(Character& character, ClosingReport& report) {
  Character wrapped = character;
  ClosingReport of_wrap = report;
  of_wrap.body = BodySource::kWrapped;
  Wrapper wrapper(wrapped, of_wrap);
  // As fine as the limbs need: stout bodies, which have more skin for their size, less so than a human.
  constexpr double kOfHuman = 0.46;  // area over diameter squared
  constexpr double kCoarsest = 90;
  const double stoutness = surface_area(character.skin) / std::pow(diameter(character.skin), 2);
  const double usual = std::max(kCoarsest, 130 * std::min(1.0, std::sqrt(kOfHuman / stoutness)));
  for (const double fineness : {usual, 0.7 * usual, 0.46 * usual}) {
    if (!wrapper.wrap({fineness, false}) || of_wrap.thin > kMostThin) continue;
    character = std::move(wrapped);
    report = of_wrap;
    return true;
  }
  report.seconds = of_wrap.seconds;
  return false;
}

Regions segment_closed(Character& character, const SegmentSettings& settings, ClosingReport& report) {
  std::optional<Error> error;
  if (is_whole(character) || repair_body(character, report)) {
    try {
      Regions regions = segment(character, settings);
      // A head of its own piece, and the rest is taken for a quadruped: then a wrap around both says more.
      if (is_all_of_skin(character) || is_expected(regions, settings)) return regions;
      Character wrapped = character;
      ClosingReport wrap_report = report;
      try {
        Regions of_wrap = WrapSearch(wrapped, settings, wrap_report, error).run();
        if (is_expected(of_wrap, settings)) {
          character = std::move(wrapped);
          report = wrap_report;
          return of_wrap;
        }
      } catch (const Error& caught) {
        if (caught.code() != ExitCode::kSegmentation) throw;
      }
      report.seconds = wrap_report.seconds;
      return regions;
    } catch (const Error& caught) {
      if (caught.code() != ExitCode::kSegmentation || is_all_of_skin(character)) throw;
      error = caught;
    }
  }
  return WrapSearch(character, settings, report, error).run();
}

void close_body(Character& character, const SegmentSettings& settings) {
  if (is_whole(character) && is_all_of_skin(character)) return;
  ClosingReport report;
  segment_closed(character, settings, report);
}

}  // namespace spherechain::baker
