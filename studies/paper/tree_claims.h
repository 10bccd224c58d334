// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "claims.h"

namespace spherechain::paper {

// Evaluates the claim about trees on trees.csv (measure_trees).
Verdict evaluate_no_trees(const Table& trees);

// tree_wins.csv: a row a series and tree: the count from which on it is faster than M1, M2 and the product's job.
Table tree_wins(const Table& trees);

// A row a series and number of spheres, the methods side by side.
Table tree_times(const Table& trees);

// Whether a tree enters the product: it does where it leads on the bakes of both profiles as they are.
std::string tree_verdict(const Table& trees);

}  // namespace spherechain::paper
