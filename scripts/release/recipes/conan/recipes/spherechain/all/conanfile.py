# SPDX-License-Identifier: MIT
# Untested: no Conan has run this. For Conan 2. Whoever publishes the recipe fills in conandata.yml.
import os

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, get, rmdir

required_conan_version = ">=2.0"


class SpherechainConan(ConanFile):
    name = "spherechain"
    description = "Finds where the body parts of an animated character penetrate each other, and keeps arms out of the body"
    license = "MIT"
    topics = ("animation", "collision-detection", "character", "self-collision")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False]}
    default_options = {"shared": False, "fPIC": True}
    implements = ["auto_shared_fpic"]

    def layout(self):
        cmake_layout(self, src_folder="src")

    # The library is compiled with their headers, and tested with these versions: Debian 12's. A program that links it needs neither.
    def requirements(self):
        self.requires("flatbuffers/2.0.8", visible=False, libs=False, run=False)
        self.requires("highway/1.0.3", visible=False, libs=False, run=False)

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.25 <4]")
        self.tool_requires("flatbuffers/<host_version>")

    def validate(self):
        check_min_cppstd(self, 17)

    def source(self):
        get(self, **self.conan_data["sources"][self.version], strip_root=True)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for part in ("BAKER", "TESTS", "STUDIES", "CUDA", "PYTHON", "JAVASCRIPT"):
            toolchain.cache_variables["SPHERECHAIN_" + part] = "OFF"
        flatc = "flatc.exe" if self.settings_build.os == "Windows" else "flatc"
        toolchain.cache_variables["SPHERECHAIN_FLATC"] = os.path.join(self.dependencies.build["flatbuffers"].cpp_info.bindir, flatc)
        for name in ("FLATBUFFERS", "HIGHWAY"):
            headers = self.dependencies[name.lower()].cpp_info.includedirs[0]
            toolchain.cache_variables["SPHERECHAIN_%s_INCLUDE_DIR" % name] = headers
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", os.path.join(self.source_folder, "runtime"), os.path.join(self.package_folder, "licenses"))
        copy(self, "copyright", os.path.join(self.source_folder, "runtime"), os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        for folder in (("lib", "cmake"), ("lib", "pkgconfig"), ("share",)):  # Conan writes its own
            rmdir(self, os.path.join(self.package_folder, *folder))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "spherechain")
        self.cpp_info.set_property("cmake_target_name", "spherechain::runtime")
        self.cpp_info.set_property("pkg_config_name", "spherechain")
        self.cpp_info.libs = ["spherechain"]
        if self.options.shared:
            self.cpp_info.defines = ["SPHERECHAIN_SHARED"]
        if self.settings.os in ("Linux", "FreeBSD"):
            self.cpp_info.system_libs = ["m"]
