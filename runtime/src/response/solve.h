// SPDX-License-Identifier: MIT
// The smallest turns of the joints that open all rows.
#pragma once

#include "runtime/src/response/response.h"

namespace spherechain {

// Turns the joints further: to the turns nearest to `rest` that open the rows as far as they are to, as response.world
// lets them.
void solve_rows(sc_response& response, const Double3* rest, Double3* turns);

// Turns the joints so that planted ones come nearer to where they are animated.
void solve_planted(const sc_response& response, Double3* turns);
// How far planted joints are from there in response.world, as a share of the height.
double off_planted(const sc_response& response);

// Keeps turns within the joints' budgets, and bent elbows from bending backward. The number of joints that wanted more.
std::uint32_t limit_turns(const sc_response& response, Double3* turns);

}  // namespace spherechain
