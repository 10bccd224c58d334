// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "baker/page/page.h"

namespace spherechain::baker {

// The page's template, split at the place for its data. Throws Error(kFile) if it is not a template.
class PageTemplate {
 public:
  explicit PageTemplate(const std::string& file);

  std::string fill(const nlohmann::ordered_json& data) const;
  // True if it contains the runtime, which finds contacts of poses that are made in the page.
  bool has_runtime() const { return before_.find("data-runtime") != std::string::npos; }
  std::size_t size() const { return before_.size() + after_.size(); }

 private:
  std::string before_, after_;
};

// Throws Error(kUsage) where the page is larger than browsers open: `still` bytes that are the same in however many
// frames, and `moving` of all of them.
void check_size(const AnimatedAsset& animated, double still, double moving, const PageOptions& options);

}  // namespace spherechain::baker
