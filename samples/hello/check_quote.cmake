# SPDX-License-Identifier: MIT
# cmake -D SOURCE=main.cpp -D README=README.md -P check_quote.cmake: does README.md quote what stands between the marks?
file(READ ${SOURCE} source)
file(READ ${README} readme)
string(REGEX MATCH "// \\[hello\\](\n.*\n)  // \\[/hello\\]" found "${source}")
string(REPLACE "\n  " "\n" quote "${CMAKE_MATCH_1}")
string(FIND "${readme}" "```cpp${quote}```" place)
if(found STREQUAL "" OR place LESS 0)
  message(FATAL_ERROR "README.md does not quote this:\n${quote}")
endif()
