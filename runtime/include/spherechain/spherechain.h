/* SPDX-License-Identifier: MIT */
/* All of the runtime, for C and C++. C++ programs find the same types in namespace spherechain. */
#pragma once

#include "spherechain/asset.h"
#include "spherechain/body.h"
#include "spherechain/contacts.h"
#include "spherechain/crowd.h"
#include "spherechain/model.h"
#include "spherechain/pose.h"
#include "spherechain/response.h"
#include "spherechain/rule.h"
#include "spherechain/types.h"
