// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "baker/page/from_runtime.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// The page's `mesh`. `rest` are the positions that bones and morphs move, source order.
nlohmann::ordered_json page_mesh(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles,
                                 const std::vector<VertexWeights>& weights, const PageParts& parts,
                                 const std::vector<PageSphere>& spheres);
// The mesh that plays.
nlohmann::ordered_json page_mesh(const AnimatedAsset& animated, const std::vector<Vec3>& rest, const PageParts& parts,
                                 const std::vector<PageSphere>& spheres);

}  // namespace spherechain::baker
