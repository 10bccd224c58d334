// SPDX-License-Identifier: MIT
// Contact rows: from what is found in a pose, and what is kept from the frames before, to spots that must stay apart.
#pragma once

#include "runtime/src/response/response.h"

namespace spherechain {

// The state's rows, carried into response.world.
void carry_rows(sc_response& response, const State& state, const sc_response_frame& frame, double seconds);
// Finds the contacts of response.world, the body's pose, and merges them into the rows. Rows age by `seconds`.
Status find_rows(sc_response& response, const sc_response_frame& frame, double seconds);
// Adds rows of what comes near there without touching.
Status find_gaps(sc_response& response, const sc_response_frame& frame);
void forget_gaps(sc_response& response);
// How far each row is to open: little more than what the animated pose lacks.
void set_wanted(sc_response& response, const sc_response_frame& frame);
// How far the row of a contact that lacks most is from what it is to have.
double most_lacking(const sc_response& response);
void keep_rows(const sc_response& response, State& state);

}  // namespace spherechain
