# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the add-on's .zip as the preferences' button does, and keeps it enabled."""

import importlib.util
import sys

import bpy

assert importlib.util.find_spec("spherechain"), "PYTHONPATH names no package spherechain, so its clash with the add-on is not tried"
bpy.ops.preferences.addon_install(filepath=sys.argv[-1])
bpy.ops.preferences.addon_enable(module="spherechain_blender")
bpy.ops.wm.save_userpref()
print("trial: installed", sys.modules["spherechain_blender"].bl_info["version"])
