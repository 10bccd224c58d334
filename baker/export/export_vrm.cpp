// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/formats.h"
#include "mesh/error.h"

namespace spherechain::baker {

Export export_vrm(const Colliders&, const SourceGlb&) { throw Error(ExitCode::kInternal, "not written yet"); }

}  // namespace spherechain::baker
