# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the add-on's .zip as the preferences' button does, and keeps it enabled."""

import sys

import bpy

bpy.ops.preferences.addon_install(filepath=sys.argv[-1])
bpy.ops.preferences.addon_enable(module="spherechain")
bpy.ops.wm.save_userpref()
print("trial: installed", sys.modules["spherechain"].bl_info["version"])
