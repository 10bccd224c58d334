// SPDX-License-Identifier: MIT
// What binds a program's headers to the library it is linked with. C99 and C++.
#pragma once

// The version of the library's binary interface: it changes with every change of a struct or function that programs
// built before cannot live with, and is the number in the shared library's name, after .so. Asset::open and
// sc_asset_open take the caller's and refuse another: kWrongAbi, SC_WRONG_ABI.
#define SC_ABI_VERSION 8

// Marks what a shared library gives out. SPHERECHAIN_SHARED is defined by the CMake target and by pkg-config where the
// library is shared; SPHERECHAIN_BUILDING only while it is built. A static library gives out nothing, so that a plugin
// that contains one does not either.
#if !defined(SPHERECHAIN_SHARED)
#define SPHERECHAIN_API
#elif !defined(_WIN32)
#define SPHERECHAIN_API __attribute__((visibility("default")))
#elif defined(SPHERECHAIN_BUILDING)
#define SPHERECHAIN_API __declspec(dllexport)
#else
#define SPHERECHAIN_API __declspec(dllimport)
#endif
