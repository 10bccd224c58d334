// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/fill_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/report/json_text.h"

namespace spherechain::baker {

PageTemplate::PageTemplate(const std::string& file) {
  const std::string page = read_file(file);
  const std::string open = R"(<script id="spherechain-data" type="application/json">)", hole = "null</script>";
  const std::size_t at = page.find(open + hole);
  if (at == std::string::npos) {
    throw Error(ExitCode::kFile, file + ": is not the viewer's page (build it again)");
  }
  before_ = page.substr(0, at + open.size());
  after_ = page.substr(at + open.size() + std::string("null").size());
}

std::string PageTemplate::fill(const nlohmann::ordered_json& data) const {
  std::string text = json_text(data, -1);
  // Nothing in it may end the script.
  for (std::size_t i = text.find('<'); i != std::string::npos; i = text.find('<', i)) text.replace(i, 1, "\\u003c");
  return before_ + text + after_;
}

void check_size(const AnimatedAsset& animated, double still, double moving, const PageOptions& options) {
  const int frames = animated.frame_count();
  const double max = static_cast<double>(options.max_bytes);
  if (still + moving <= max) return;
  // Later frames may have more contacts than those that were played.
  const int fewer = still < max ? static_cast<int>(0.5 * frames * (max - still) / moving) : 0;
  throw Error(ExitCode::kUsage,
              fmt::format("{}: {} frames make a page of {:.1f} MB, of which browsers open {:.1f} MB ({})",
                          animated.file(), frames, (still + moving) / 1e6, max / 1e6,
                          fewer > 0 ? fmt::format("--frames {}, or one clip by --clip", fewer)
                                    : "its mesh has too many triangles"));
}

}  // namespace spherechain::baker
