// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <assimp/scene.h>

namespace spherechain::baker {

// Where several parts of an Ogre mesh share one list of vertices, assimp gives each part the weights of all parts
// before it, too, by vertex numbers that mean nothing there. This takes them out.
void separate_shared_weights(aiScene& scene);

}  // namespace spherechain::baker
