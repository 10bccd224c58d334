/* SPDX-License-Identifier: MIT */
/* All of the runtime, for C and C++. C++ programs find the same types in namespace spherechain. */
#pragma once

#include "spherechain/asset.h"
#include "spherechain/bodies.h"
#include "spherechain/body.h"
#include "spherechain/contacts.h"
#include "spherechain/crowd.h"
#include "spherechain/detect.h"
#include "spherechain/filter.h"
#include "spherechain/model.h"
#include "spherechain/penetrations.h"
#include "spherechain/pose.h"
#include "spherechain/refit.h"
#include "spherechain/rule.h"
#include "spherechain/skin_contacts.h"
#include "spherechain/steps.h"
#include "spherechain/types.h"
