// SPDX-License-Identifier: GPL-3.0-or-later
// Some of the broken files that the tests hand to assimp make it leak inside itself; leaks of our own are still found.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp.so\n"; }
