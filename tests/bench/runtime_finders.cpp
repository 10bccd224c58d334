// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <stdexcept>

#include "pair_finder.h"
#include "spherechain/detect.h"

namespace spherechain::bench {
namespace {

enum class Output { kList, kBits };

class RuntimeFinder : public PairFinder {
 public:
  RuntimeFinder(const Asset& asset, std::string name, Method method, Output output, bool has_table = true)
      : PairFinder(std::move(name), method == Method::kM1 ? Found::kInChains : Found::kExactly),
        sphere_count_(asset.spheres().size),
        pairs_(output == Output::kList ? sphere_count_ * sphere_count_ : 0),
        bits_(output == Output::kBits ? DetectJob::bit_words(asset) : 0),
        words_(DetectContext::words_needed(asset)),
        context_{{words_.data(), words_.size()}},
        table_words_(DetectTable::words_needed(asset)),
        table_{{table_words_.data(), table_words_.size()}} {
    if (prepare_detect(asset, job_.radius, nullptr, table_) != Status::kOk) {
      throw std::logic_error(this->name);
    }
    job_.table = has_table ? &table_ : nullptr;
    job_.asset = &asset;
    job_.method = method;
    job_.context = &context_;
    job_.pairs = {pairs_.data(), pairs_.size()};
    job_.bits = {bits_.data(), bits_.size()};
  }

  void find(const Sphere* spheres) override {
    job_.spheres = {spheres, sphere_count_};
    if (job_.run() != Status::kOk) {
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
        const std::size_t bit = std::size_t{b} * (b - 1) / 2 + a;
        if (((bits_[bit / 64] >> (bit % 64)) & 1U) != 0) {
          out.push_back({a, b});
        }
      }
    }
    return out;
  }

 private:
  std::size_t sphere_count_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> bits_, words_;
  DetectContext context_;
  std::vector<std::uint64_t> table_words_;
  DetectTable table_;
  DetectJob job_;
};

}  // namespace

PairFinders runtime_finders(const Asset& asset) {
  PairFinders out;
  out.push_back(std::make_unique<RuntimeFinder>(asset, "spherechain M2, pair list", Method::kM2, Output::kList));
  out.push_back(std::make_unique<RuntimeFinder>(asset, "spherechain M2, bits", Method::kM2, Output::kBits));
  out.push_back(std::make_unique<RuntimeFinder>(asset, "spherechain M1, pair list", Method::kM1, Output::kList));
  for (const Method method : {Method::kM2, Method::kM1}) {
    out.push_back(std::make_unique<RuntimeFinder>(
        asset, method == Method::kM2 ? "spherechain M2, list, no table" : "spherechain M1, list, no table", method,
        Output::kList, false));
  }
  return out;
}

}  // namespace spherechain::bench
