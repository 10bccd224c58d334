# SPDX-License-Identifier: GPL-3.0-or-later
"""Spherechain in Blender: finds and mends self-penetration of the active character. It calls the tool `spherechain`."""

bl_info = {
    "name": "Spherechain",
    "author": "The spherechain authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Spherechain",
    "description": "Find and mend self-penetration of animated characters",
    "category": "Animation",
}

import bpy

from . import drawing, panel
from .tasks import runner

handler = None


@bpy.app.handlers.persistent
def on_load(*_):
    """Another file: nothing of the old one runs or is drawn."""
    runner.cancel()
    runner.error = ""
    drawing.forget()


def register():
    global handler
    panel.register()
    bpy.app.handlers.load_pre.append(on_load)
    if not bpy.app.background:
        handler = bpy.types.SpaceView3D.draw_handler_add(drawing.draw, (), "WINDOW", "POST_VIEW")


def unregister():
    global handler
    runner.cancel()
    drawing.forget()
    if handler:
        bpy.types.SpaceView3D.draw_handler_remove(handler, "WINDOW")
        handler = None
    bpy.app.handlers.load_pre.remove(on_load)
    panel.unregister()
