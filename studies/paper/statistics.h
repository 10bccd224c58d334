// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace spherechain::paper {

// Values that are not finite are left out by all of these; of nothing they are NaN.
double mean(const std::vector<double>& values);
// The value that a share `q` of the sorted values lies below, between neighbours on a straight line.
double quantile(std::vector<double> values, double q);
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }
double least(const std::vector<double>& values);
double most(const std::vector<double>& values);

// Spearman's rank correlation; equal values share their mean rank. NaN where one of the two does not vary.
double rank_correlation(const std::vector<double>& x, const std::vector<double>& y);
// The k of y ~ x^k, by least squares of the logarithms.
double growth_exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace spherechain::paper
