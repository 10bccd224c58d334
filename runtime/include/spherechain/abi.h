/* SPDX-License-Identifier: MIT */
/* How the headers bind to the library. C99 and C++17. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* The version of the binary interface. It changes with every incompatible change of a struct or function.
 * sc_asset_open() compares the program's number with the library's and refuses another (SC_WRONG_ABI). */
#define SC_ABI_VERSION 11

/* Marks what a shared library exports. The CMake target and pkg-config define SPHERECHAIN_SHARED where the library is
 * shared; SPHERECHAIN_BUILDING is defined only while the library itself is built. */
#if !defined(SPHERECHAIN_SHARED)
#define SPHERECHAIN_API
#elif !defined(_WIN32)
#define SPHERECHAIN_API __attribute__((visibility("default")))
#elif defined(SPHERECHAIN_BUILDING)
#define SPHERECHAIN_API __declspec(dllexport)
#else
#define SPHERECHAIN_API __declspec(dllimport)
#endif

/* Every struct and enum is defined once, for C and C++ alike. All fields default to zero: C++ initialises them, C
 * programs write `sc_detect_job job = {0};`. Enums are 32-bit integers on both sides. */
#if defined(__cplusplus)
#define SC_ZERO \
  {}
#define SC_NOEXCEPT noexcept
#define SC_ENUM(name) enum name : int32_t
#else
#define SC_ZERO
#define SC_NOEXCEPT
#define SC_ENUM(name)   \
  typedef int32_t name; \
  enum
#endif
