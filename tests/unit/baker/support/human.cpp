// SPDX-License-Identifier: GPL-3.0-or-later
#include "human.h"

using namespace spherechain::baker;

const HumanFixture& human() {
  static const HumanFixture fixture = [] {
    Character character = import_character(kHumanFile);
    Regions regions = *segment_by_shape(character, character.largest_piece, {});
    return HumanFixture{std::move(character), std::move(regions)};
  }();
  return fixture;
}
