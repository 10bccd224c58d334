# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the 3D view's sidebar, its operators and the preferences."""

import atexit
import textwrap
import time

import bpy

from . import drawing, results
from .character import armature_of
from .tasks import runner

TICK = 0.02  # seconds between two looks at the task


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    tool: bpy.props.StringProperty(
        name="Tool", subtype="FILE_PATH", description="Path of the program spherechain; empty: the one on PATH")

    def draw(self, _context):
        self.layout.prop(self, "tool")
        found = results.find_tool(self.tool)
        self.layout.label(text=found or results.missing(self.tool), icon="CHECKMARK" if found else "ERROR")


def jump(shown, context):
    if 0 <= shown.active < len(shown.events):
        context.scene.frame_set(shown.events[shown.active].worst)


class Event(bpy.types.PropertyGroup):
    size: bpy.props.StringProperty()
    kind: bpy.props.StringProperty()
    first: bpy.props.IntProperty()
    last: bpy.props.IntProperty()
    worst: bpy.props.IntProperty()


class Shown(bpy.types.PropertyGroup):
    """The events of an armature, and how they are shown."""

    events: bpy.props.CollectionProperty(type=Event)
    active: bpy.props.IntProperty(update=jump, description="Go to the worst frame of this event")
    checked: bpy.props.StringProperty()
    note: bpy.props.StringProperty()
    draw: bpy.props.BoolProperty(name="Draw contacts", default=True, description="Draw contacts over the character")


def redraw(all_of_it):
    """The sidebars, in which progress is shown, or everything. To draw the 3D view at each step would slow the task down."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            for region in area.regions:
                if all_of_it or (area.type == "VIEW_3D" and region.type == "UI"):
                    region.tag_redraw()


def tick():
    before = runner.progress
    goes_on = runner.step()
    if not goes_on or runner.progress != before:
        redraw(all_of_it=not goes_on)
    return TICK if goes_on else None


class Start:
    """Begins a task. With a window it goes on in a timer; without one (blender -b) the operator waits for its end."""

    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return runner.task is None and context.object is not None

    def execute(self, context):
        path = context.preferences.addons[__package__].preferences.tool
        tool = results.find_tool(path)
        if tool is None:
            runner.error = results.missing(path)
            self.report({"ERROR"}, runner.error)
            return {"CANCELLED"}
        runner.start(self.kind, context, tool)
        goes_on = runner.step()  # reads the character of this window
        if goes_on and not bpy.app.background:
            bpy.app.timers.register(tick)
            return {"FINISHED"}
        while runner.step():
            time.sleep(TICK)
        if runner.error:
            self.report({"ERROR"}, runner.error)
            return {"CANCELLED"}
        return {"FINISHED"}


class Check(Start, bpy.types.Operator):
    """Find the frames in which body parts of the active character are in each other"""

    bl_idname, bl_label, kind = "spherechain.check", "Check", "check"


class Fix(Start, bpy.types.Operator):
    """Mend the active action: a new action whose joints turn until body parts are out of each other"""

    bl_idname, bl_label, kind = "spherechain.fix", "Fix", "fix"


class Mask(Start, bpy.types.Operator):
    """Make a vertex group of the skin below clothes that no action of the character shows"""

    bl_idname, bl_label, kind = "spherechain.mask", "Mask", "mask"


class Cancel(bpy.types.Operator):
    """End what runs"""

    bl_idname, bl_label = "spherechain.cancel", "Cancel"

    @classmethod
    def poll(cls, _context):
        return runner.task is not None

    def execute(self, _context):
        runner.cancel()
        return {"FINISHED"}


class EventList(bpy.types.UIList):
    bl_idname = "SPHERECHAIN_UL_events"

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_name, _index):
        layout.label(text=f"{item.size}  {item.name}", icon="ERROR" if item.kind in {"inside", "penetration"} else "DOT")


class Panel(bpy.types.Panel):
    bl_idname, bl_label = "SPHERECHAIN_PT_panel", "Spherechain"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Spherechain"

    def draw(self, context):
        layout = self.layout
        armature = armature_of(context)
        if armature is None:
            layout.label(text="Select a character", icon="INFO")
        else:
            data = armature.animation_data
            layout.label(text=armature.name, icon="ARMATURE_DATA")
            layout.label(text=data.action.name if data and data.action else "no action", icon="ACTION")
        if runner.task:
            lines(layout, context, f"{runner.kind}: {runner.progress}", "TIME")
            layout.operator("spherechain.cancel", icon="X")
        else:
            row = layout.row(align=True)
            for operator in ("check", "fix", "mask"):
                row.operator(f"spherechain.{operator}")
        if runner.error:
            lines(layout, context, runner.error, "ERROR")
        if armature is None or not armature.spherechain.checked:
            return
        shown = armature.spherechain
        lines(layout, context, shown.checked, "NONE")
        if shown.note:
            lines(layout, context, shown.note, "INFO")
        layout.template_list("SPHERECHAIN_UL_events", "", shown, "events", shown, "active", rows=6)
        if 0 <= shown.active < len(shown.events):
            event = shown.events[shown.active]
            lines(layout, context, f"{event.name}: {event.kind}, {event.size}, frames {event.first}-{event.last}", "NONE")
        layout.prop(shown, "draw")
        state = drawing.state(armature, context.scene.frame_current)
        if state:
            layout.label(text=state)


def lines(layout, context, text, icon):
    """Text as wide as the panel."""
    column = layout.column(align=True)
    width = max(int(context.region.width / (7 * context.preferences.system.ui_scale)) - 4, 12)
    for line in textwrap.wrap(text, width):
        column.label(text=line, icon=icon)
        icon = "BLANK1" if icon != "NONE" else icon


CLASSES = (Preferences, Event, Shown, Check, Fix, Mask, Cancel, EventList, Panel)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Object.spherechain = bpy.props.PointerProperty(type=Shown)
    atexit.register(runner.cancel)


def unregister():
    atexit.unregister(runner.cancel)
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
    del bpy.types.Object.spherechain
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
