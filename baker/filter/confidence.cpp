// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/filter/confidence.h"

#include <boost/math/distributions/binomial.hpp>

namespace spherechain::baker {

double upper_bound_of_share(int seen, int count) {
  if (seen >= count) return 1;
  return boost::math::binomial_distribution<>::find_upper_bound_on_p(count, seen, 1 - kConfidence);
}

}  // namespace spherechain::baker
