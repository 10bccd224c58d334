// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/pipeline/pipeline.h"

// A rigged person (assimp-testmodels' BCN_Epileptic.X), baked once a run.
const spherechain::baker::Bake& baked_person();

// The same with three morph targets, and every fifth vertex on no bone.
const spherechain::baker::Bake& morphing_person();
