// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "spherechain/types.h"

namespace spherechain::test {

TEST_CASE("every code and every field has words of its own, and one that does not exist has some") {
  const auto check = [](auto text_of, int count) {
    std::set<std::string> texts;
    for (int i = 0; i < count; ++i) {
      const std::string text = text_of(i);
      CHECK_MESSAGE(texts.insert(text).second, i, ": ", text);
    }
    CHECK(texts.insert(text_of(count)).second);
    CHECK(std::string(text_of(count)) == text_of(-1));
  };
  check([](int i) { return sc_code_text(static_cast<sc_code>(i)); }, SC_DEVICE_TOO_SMALL + 1);
  check([](int i) { return sc_field_name(static_cast<sc_field>(i)); }, SC_FIELD_STRUCT_SIZE + 1);
  CHECK(std::string(sc_field_name(SC_FIELD_BONES)) == "pose.bones");
}

}  // namespace spherechain::test
