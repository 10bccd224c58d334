// SPDX-License-Identifier: MIT
#include "spherechain/detect.h"

#include <algorithm>
#include <limits>

#include "asset/memory.h"
#include "asset/status.h"
#include "pairs/cone.h"
#include "pairs/filter.h"
#include "pairs/pair_bits.h"
#include "simd/simd.h"

namespace spherechain {
namespace {

constexpr std::uint64_t kMagic = 0x73656e6f63646373;  // says that the words are a table
constexpr std::size_t kBlock = 16;                    // a multiple of each target's lanes
constexpr float kNever = std::numeric_limits<float>::quiet_NaN();
enum Place : std::size_t { kIsTable, kAsset, kSpheres, kLinks, kHeaderWords };

std::uint64_t key_of(const AssetView& asset) { return reinterpret_cast<std::uintptr_t>(asset.spheres().data); }
constexpr std::size_t stride_of(std::size_t links) { return (links + kBlock - 1) / kBlock * kBlock; }
constexpr std::size_t words_of(std::size_t links) {
  return kHeaderWords + stride_of(links) + stride_of(links) * links / 2;
}
Pair* links_in(std::uint64_t* words) { return reinterpret_cast<Pair*>(words + kHeaderWords); }
float* scales_in(std::uint64_t* words, std::size_t links) {
  return reinterpret_cast<float*>(words + kHeaderWords + stride_of(links));
}

// Of a table that the caller says is one.
Status check_table(const std::uint64_t* words, std::size_t size, bool has_size) {
  if (words == nullptr || any_misaligned(words)) {
    return refuse(words == nullptr ? SC_NULL : SC_MISALIGNED, SC_FIELD_TABLE);
  }
  if (has_size && size < kHeaderWords) {
    return refuse(SC_TOO_SMALL, SC_FIELD_TABLE);
  }
  if (words[kIsTable] != kMagic || words[kLinks] > kMaxCones) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TABLE);
  }
  return has_size && size < words_of(static_cast<std::size_t>(words[kLinks])) ? refuse(SC_TOO_SMALL, SC_FIELD_TABLE)
                                                                              : done();
}

bool is_set(const std::uint64_t* words, std::size_t bit) { return (words[bit / 64] >> (bit % 64) & 1U) != 0; }

bool is_never(const std::uint64_t* ignored, Pair l, Pair r) {
  const auto are_neighbours = [&](std::uint32_t a, std::uint32_t b) {
    return is_set(ignored, ignored_bit(std::min(a, b), std::max(a, b)));
  };
  return l.a == r.a || l.a == r.b || l.b == r.a || l.b == r.b ||
         (are_neighbours(l.a, r.a) && are_neighbours(l.a, r.b) && are_neighbours(l.b, r.a) && are_neighbours(l.b, r.b));
}

// 1 where they do not touch at rest.
float rest_scale(const Cone& a, const Cone& b) {
  if (!cones_touch(a, b, 1)) {
    return 1;
  }
  float low = 0, high = 1;
  for (int i = 0; i < 24; ++i) {
    const float middle = 0.5F * (low + high);
    (cones_touch(a, b, middle) ? high : low) = middle;
  }
  return kRestShare * high;
}

Status check_links(const AssetView& asset, const Pair* links, std::size_t count) {
  const Status status = links == nullptr ? refuse(SC_NULL, SC_FIELD_PAIRS) : check_list(links, count, SC_FIELD_PAIRS);
  if (status != SC_OK) {
    return status;
  }
  if (count > kMaxCones) {
    return refuse(SC_BAD_VALUE, SC_FIELD_PAIRS);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (links[i].a >= asset.spheres().size || links[i].b >= asset.spheres().size) {
      return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
    }
  }
  return done();
}

Status check(const ConeJob& job, Target& resolved, ConeTable& table) {
  if (job.asset == nullptr) {
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  const AssetView& asset = view_of(*job.asset);
  if (!asset.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const std::size_t n = asset.spheres().size;
  fetch(range_of(Span<const Sphere>{job.spheres, job.spheres == nullptr ? 0 : n}));
  for (const Status& status :
       {check_list(job.spheres, 1, SC_FIELD_SPHERES),
        job.sphere_count < n ? refuse(SC_TOO_SMALL, SC_FIELD_SPHERES) : done(),
        check_list(job.pairs, job.pair_capacity, SC_FIELD_PAIRS), check_table(job.table, 0, false)}) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.table[kAsset] != key_of(asset) || job.table[kSpheres] != n) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TABLE);
  }
  table.count = static_cast<std::size_t>(job.table[kLinks]);
  table.stride = stride_of(table.count);
  std::uint64_t* const words = const_cast<std::uint64_t*>(job.table);
  table.links = links_in(words);
  table.scales = scales_in(words, table.count);
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  return any_shared({range_of(Span<Pair>{job.pairs, job.pair_capacity})},
                    {range_of(Span<const Sphere>{job.spheres, n}),
                     range_of(Span<const std::uint64_t>{job.table, words_of(table.count)})})
             ? refuse(SC_ALIASED, SC_FIELD_PAIRS)
             : done();
}

bool is_link(const AssetView& asset, Pair link) {
  return link.a != link.b && asset.spheres()[link.a].region == asset.spheres()[link.b].region &&
         test_bit(asset.ignored(), ignored_bit(link.a, link.b));
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_chain_links(const sc_asset* asset, sc_pair* links, size_t capacity) noexcept {
  if (sc_asset_is_open(asset) == 0 || (links == nullptr && capacity > 0) || any_misaligned(links)) {
    return 0;
  }
  const AssetView& view = view_of(*asset);
  const std::size_t n = view.spheres().size;
  if (n > kMaxCones) {
    return 0;
  }
  std::uint64_t joined[words_for(pairs_of(kMaxCones))] = {};
  bool is_joined[kMaxCones] = {};
  for (std::size_t c = 0; c < view.chain_count(); ++c) {
    const Span<const std::uint32_t> run = view.chain(c).spheres;
    for (std::size_t i = 1; i < run.size; ++i) {
      const Pair link{std::min(run[i - 1], run[i]), std::max(run[i - 1], run[i])};
      if (is_link(view, link)) {
        set_bit({joined, words_for(pairs_of(n))}, ignored_bit(link.a, link.b));
        is_joined[link.a] = is_joined[link.b] = true;
      }
    }
  }
  std::size_t count = 0;
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = a; b < n; ++b) {
      const bool is_wanted = a == b ? !is_joined[a] : test_bit({joined, words_for(pairs_of(n))}, ignored_bit(a, b));
      if (is_wanted && count++ < capacity) {
        links[count - 1] = {a, b};
      }
    }
  }
  return count;
}

size_t sc_cone_table_words(size_t link_count) noexcept { return link_count <= kMaxCones ? words_of(link_count) : 0; }

sc_status sc_prepare_cones(const sc_asset* asset, const sc_filter* filter, const sc_pair* links, size_t link_count,
                           const sc_sphere* rest, uint64_t* words, size_t word_count) noexcept {
  if (asset == nullptr) {
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  const AssetView& view = view_of(*asset);
  if (!view.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const std::size_t n = view.spheres().size;
  for (const Status& status :
       {check_links(view, links, link_count), filter == nullptr ? done() : check_filter(view, *filter),
        any_misaligned(rest) ? refuse(SC_MISALIGNED, SC_FIELD_SPHERES) : done(),
        words == nullptr        ? refuse(SC_NULL, SC_FIELD_TABLE)
        : any_misaligned(words) ? refuse(SC_MISALIGNED, SC_FIELD_TABLE)
                                : done(),
        word_count < words_of(link_count) ? refuse(SC_TOO_SMALL, SC_FIELD_TABLE) : done()}) {
    if (status != SC_OK) {
      return status;
    }
  }
  const FilterRanges ranges = ranges_of(filter);
  const std::size_t stride = stride_of(link_count);
  if (any_shared({range_of(Span<std::uint64_t>{words, words_of(link_count)})},
                 {range_of(Span<const Pair>{links, link_count}), range_of(view.ignored()),
                  range_of(Span<const Sphere>{rest, rest == nullptr ? 0 : n}), ranges.ignored, ranges.disabled})) {
    return refuse(SC_ALIASED, SC_FIELD_TABLE);
  }
  words[kIsTable] = kMagic;
  words[kAsset] = key_of(view);
  words[kSpheres] = n;
  words[kLinks] = link_count;
  std::copy(links, links + link_count, links_in(words));
  std::fill(links_in(words) + link_count, links_in(words) + stride, Pair{0, 0});
  float* const scales = scales_in(words, link_count);
  std::fill(scales, scales + stride * link_count, kNever);
  const std::uint64_t* const ignored = filter != nullptr ? filter->ignored : view.ignored().data;
  const auto is_disabled = [&](Pair link) {
    return filter != nullptr && filter->disabled_words > 0 &&
           (is_set(filter->disabled, link.a) || is_set(filter->disabled, link.b));
  };
  const auto is_whole = [&](Pair link) { return is_cone_end(rest[link.a]) && is_cone_end(rest[link.b]); };
  for (std::size_t a = 0; a < link_count; ++a) {
    for (std::size_t b = a + 1; b < link_count; ++b) {
      if (is_disabled(links[a]) || is_disabled(links[b]) || is_never(ignored, links[a], links[b])) {
        continue;
      }
      const bool has_rest = rest != nullptr && is_whole(links[a]) && is_whole(links[b]);
      scales[a * stride + b] = has_rest ? rest_scale(cone_of(rest[links[a].a], rest[links[a].b]),
                                                     cone_of(rest[links[b].a], rest[links[b].b]))
                                        : 1.0F;
    }
  }
  return done();
}

sc_status sc_scale_cones(uint64_t* words, size_t word_count, uint32_t a, uint32_t b, float scale) noexcept {
  const Status status = check_table(words, word_count, true);
  if (status != SC_OK) {
    return status;
  }
  const auto count = static_cast<std::size_t>(words[kLinks]);
  if (a >= b || b >= count) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  scales_in(words, count)[a * stride_of(count) + b] = scale >= 0 && scale <= kLargestScale ? scale : kNever;
  return done();
}

sc_status sc_detect_cones(sc_cone_job* job) noexcept {
  if (job == nullptr) {
    return refuse(SC_NULL, SC_FIELD_NONE);
  }
  Target resolved{};
  ConeTable table;
  const Status status = check(*job, resolved, table);
  if (status != SC_OK) {
    return status;
  }
  FoundCones found{job->pairs, job->pair_capacity, 0};
  find_cones(resolved, table, job->spheres, found);
  job->pair_count = found.count;
  return job->pair_capacity > 0 && found.count > job->pair_capacity ? refuse(SC_OVERFLOW, SC_FIELD_PAIRS) : done();
}

}  // extern "C"
