// SPDX-License-Identifier: MIT
#include "spherechain/status.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

namespace spherechain {

TEST_CASE("every status has a sentence of its own") {
  std::set<std::string> sentences;
  for (int i = 0; i <= 21; ++i) {
    const std::string sentence = to_string(static_cast<Status>(i));
    CHECK_MESSAGE(sentences.insert(sentence).second, sentence);
    CHECK(sentence != "unknown status");
    CHECK(sentence.back() != '.');
  }
}

TEST_CASE("a status that does not exist still has a sentence") {
  CHECK(std::string(to_string(static_cast<Status>(99))) == "unknown status");
  CHECK(std::string(to_string(static_cast<Status>(-1))) == "unknown status");
}

}  // namespace spherechain
