// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdexcept>

#include "pair_finder.h"
#include "runtime/src/pairs/detect_job.h"

namespace spherechain::bench {
namespace {

enum class Output { kList, kBits };

class RuntimeFinder : public PairFinder {
 public:
  RuntimeFinder(const Asset& asset, std::string name, Output output, bool has_table)
      : PairFinder(std::move(name), Found::kExactly),
        sphere_count_(view_of(asset).spheres().size),
        pairs_(output == Output::kList ? sphere_count_ * sphere_count_ : 0),
        bits_(output == Output::kBits ? sc_pair_words(&asset) : 0),
        table_(detect_table_words(&asset)) {
    if (prepare_detect(&asset, job_.radius, nullptr, table_.data(), table_.size()) != SC_OK) {
      throw std::logic_error(this->name);
    }
    job_.asset = &asset;
    job_.sphere_count = sphere_count_;
    job_.table = has_table ? table_.data() : nullptr;
    if (output == Output::kList) {
      job_.pairs = pairs_.data();
      job_.pair_capacity = pairs_.size();
    } else {
      job_.bits = bits_.data();
      job_.bit_words = bits_.size();
    }
  }

  void find(const Sphere* spheres) override {
    job_.spheres = spheres;
    if (job_.run() != SC_OK) {
      throw std::logic_error(name);
    }
  }

  std::vector<Pair> pairs() const override {
    if (!pairs_.empty()) {
      return {pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(job_.pair_count)};
    }
    std::vector<Pair> out;
    for (std::uint32_t b = 1; b < sphere_count_; ++b) {
      for (std::uint32_t a = 0; a < b; ++a) {
        if (test_bit({bits_.data(), bits_.size()}, ignored_bit(a, b))) {
          out.push_back({a, b});
        }
      }
    }
    return out;
  }

 private:
  std::size_t sphere_count_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> bits_, table_;
  DetectJob job_;
};

}  // namespace

PairFinders runtime_finders(const Asset& asset) {
  PairFinders out;
  out.push_back(std::make_unique<RuntimeFinder>(asset, "spherechain all pairs, list", Output::kList, true));
  out.push_back(std::make_unique<RuntimeFinder>(asset, "spherechain all pairs, bits", Output::kBits, true));
  out.push_back(std::make_unique<RuntimeFinder>(asset, "spherechain all pairs, list, no table", Output::kList, false));
  return out;
}

}  // namespace spherechain::bench
