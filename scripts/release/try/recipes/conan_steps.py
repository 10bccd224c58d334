#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the steps of the Conan recipe on stubs of Conan's modules: `conan_steps.py RECIPE BUILD PREFIX`.

Variables of the toolchain must be known to BUILD, a build of CMake. The library and folders that the recipe names must be in
PREFIX, where it was installed.
"""
import importlib.util
import re
import sys
import types
from pathlib import Path
from unittest import mock

recipe, build, prefix = (Path(argument) for argument in sys.argv[1:])


class Toolchain:
    made = None

    def __init__(self, conanfile):
        self.cache_variables = {}

    def generate(self):
        Toolchain.made = self


removed = []
modules = {"conan": types.SimpleNamespace(ConanFile=object), "conan.tools": types.SimpleNamespace(),
           "conan.tools.build": types.SimpleNamespace(check_min_cppstd=lambda recipe, least: None, can_run=lambda recipe: True),
           "conan.tools.cmake": types.SimpleNamespace(CMake=mock.MagicMock(), CMakeToolchain=Toolchain, cmake_layout=mock.MagicMock()),
           "conan.tools.files": types.SimpleNamespace(copy=mock.MagicMock(), get=mock.MagicMock(),
                                                      rmdir=lambda recipe, folder: removed.append(Path(folder)))}
sys.modules.update(modules)


def load(path):
    spec = importlib.util.spec_from_file_location(path.parent.name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


load(recipe / "test_package" / "conanfile.py")
conanfile = load(recipe / "conanfile.py").SpherechainConan()
conanfile.requires, conanfile.tool_requires = mock.MagicMock(), mock.MagicMock()
conanfile.settings = conanfile.settings_build = types.SimpleNamespace(os="Linux")
conanfile.options = types.SimpleNamespace(shared=False)
conanfile.dependencies, conanfile.cpp_info = mock.MagicMock(), mock.MagicMock()
conanfile.dependencies.build.__getitem__.return_value.cpp_info.bindir = "/usr/bin"
conanfile.source_folder, conanfile.package_folder = "src", str(prefix)
conanfile.conan_data, conanfile.version = {"sources": {"0": {"url": "", "sha256": ""}}}, "0"
for step in ("layout", "requirements", "build_requirements", "validate", "source", "generate", "build", "package", "package_info"):
    getattr(conanfile, step)()

cache = (build / "CMakeCache.txt").read_text()
wrong = ["the build knows no %s" % name for name in Toolchain.made.cache_variables if not re.search(r"^%s:" % name, cache, re.M)]
wrong += ["%s is not installed" % folder for folder in removed if not folder.is_dir()]
wrong += ["lib%s.a is not installed" % name for name in conanfile.cpp_info.libs if not (prefix / "lib" / ("lib%s.a" % name)).is_file()]
targets = (prefix / "lib/cmake/spherechain/spherechainTargets.cmake").read_text()
properties = {call.args[0]: call.args[1] for call in conanfile.cpp_info.set_property.call_args_list}
if "add_library(%s STATIC IMPORTED)" % properties["cmake_target_name"] not in targets:
    wrong.append("CMake's own target has another name")
for line in wrong:
    print("FAILED: " + line)
print("the recipe's steps ran: %d variables of CMake" % len(Toolchain.made.cache_variables))
sys.exit(1 if wrong else 0)
