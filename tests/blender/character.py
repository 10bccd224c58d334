# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks, mends and masks a character in Blender: `blender -b --python character.py -- WALK.glb CHECKED.json`.

The JSON is what the tool finds in the file itself: the add-on must find the same in the scene, however it is set up.
"""

import json
import os
import sys
import time
import traceback

import bmesh
import bpy
import numpy

numpy.bool = bool  # Debian's importer of Blender 3.4 uses this old name

WALK, CHECKED = sys.argv[-2:]


def enable():
    bpy.ops.preferences.addon_enable(module="spherechain_blender")


def imported(fps=30):
    """An empty file with the character, active."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    enable()
    bpy.context.scene.render.fps = fps
    bpy.ops.import_scene.gltf(filepath=WALK)
    armature = next(item for item in bpy.data.objects if item.type == "ARMATURE")
    for item in list(bpy.data.objects):
        if item.type == "EMPTY":
            bpy.data.objects.remove(item)
    bpy.context.view_layer.objects.active = armature
    return armature


def body_of(armature):
    return max((item for item in armature.children if item.type == "MESH"), key=lambda item: len(item.data.vertices))


def shown(armature, first=0):
    return [(row.name, row.first - first, row.last - first, row.worst - first) for row in armature.spherechain.events]


def contents():
    """All that a check must leave as it was."""
    view = bpy.context.view_layer
    return (sorted(bpy.data.objects.keys()), sorted(bpy.data.scenes.keys()), sorted(bpy.data.meshes.keys()),
            sorted(bpy.data.actions.keys()), bpy.context.scene.frame_current, view.objects.active.name,
            sorted(item.name for item in bpy.data.objects if item.select_get()))


def refused(operator, *words):
    try:
        operator()
    except RuntimeError as problem:
        assert all(word in str(problem) for word in words), problem
        return
    raise AssertionError(f"nothing said {words}")


def expected():
    with open(CHECKED, encoding="utf-8") as file:
        clip = json.load(file)["clips"][0]
    return [(f"{e['parts'][0]} in {e['parts'][1]}", e["from"], e["to"], e["deepest"])
            for e in clip["events"] if e["class"] in ("inside", "penetration", "deep_fold")]


def finds_what_the_tool_finds():
    armature = imported()
    scene = bpy.context.scene
    scene.timeline_markers.new("jump", frame=3)
    scene.timeline_markers.new("sc: of an older check", frame=4)
    scene.frame_set(7)
    before = contents()
    bpy.ops.spherechain.check()
    assert shown(armature) == expected() != [], shown(armature)
    assert contents() == before, contents()
    markers = sorted((marker.frame, marker.name) for marker in scene.timeline_markers)
    assert len(markers) == 1 + len(expected()) and (3, "jump") in markers, markers
    assert all(name.startswith("sc: ") for _, name in markers if name != "jump"), markers
    armature.spherechain.active = 0
    assert scene.frame_current == armature.spherechain.events[0].worst
    contacts = sys.modules["spherechain_blender.drawing"].shown[armature.name]
    inside, faults, touches, depths = contacts.at(scene.frame_current)
    assert faults and len(depths) >= 2 and contacts.holds(armature, scene.frame_current)
    # The deepest points lie on the skin that Blender draws.
    posed = body_of(armature).evaluated_get(bpy.context.evaluated_depsgraph_get())
    for point in depths:
        found, place, _, _ = posed.closest_point_on_mesh(posed.matrix_world.inverted() @ type(posed.location)(point))
        assert found and (posed.matrix_world @ place - type(place)(point)).length < 1e-3, point
    armature.pose.bones[0].location.x += 1
    bpy.context.view_layer.update()
    assert not contacts.holds(armature, scene.frame_current)


def finds_the_same_however_the_scene_is_set_up():
    for set_ups in ((names, later), (slower, moved), (faster,), (scaled,), (in_centimetres, with_modifiers)):
        armature = imported()
        first = sum(set_up(armature) or 0 for set_up in set_ups)
        what = ", ".join(set_up.__name__.replace("_", " ") for set_up in set_ups)
        bpy.ops.spherechain.check()
        assert shown(armature, first) == expected(), (what, shown(armature, first), expected())
        print("trial: the same events,", what)


def names(armature):
    armature.name, armature.animation_data.action.name = "Heldin Käthe 1", "Gehen ü \"schnell\""
    body_of(armature).name = "Körper / nackt"


def later(armature):
    """An action that begins at frame 101."""
    for curve in armature.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            for point in (key.co, key.handle_left, key.handle_right):
                point.x += 101
    return 101


def slower(_):
    bpy.context.scene.render.fps = 24


def faster(_):
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = 60, 1.001


def scaled(armature):
    """Bones in centimetres below an object of a hundredth, as FBX files have it."""
    grow(armature, 100)
    armature.scale = (0.01, 0.01, 0.01)


def moved(armature):
    armature.location, armature.rotation_mode, armature.rotation_euler = (3, -2, 1), "XYZ", (0, 0, 1)


def in_centimetres(armature):
    armature.scale = (100, 100, 100)
    bpy.context.scene.unit_settings.scale_length = 0.01


def with_modifiers(armature):
    """A subdivision for the picture, and a mesh that is not seen."""
    body = body_of(armature)
    body.modifiers.new("Subdivision", "SUBSURF")
    double = body.copy()
    bpy.context.scene.collection.objects.link(double)
    double.hide_set(True)


def grow(armature, factor):
    """Bones and skin `factor` times as large, with the same motion."""
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in armature.data.edit_bones:
        bone.use_connect = False
    for bone in armature.data.edit_bones:
        bone.head, bone.tail = bone.head * factor, bone.tail * factor
    bpy.ops.object.mode_set(mode="OBJECT")
    for item in armature.children:
        for vertex in item.data.vertices:
            vertex.co *= factor
    for curve in armature.animation_data.action.fcurves:
        if curve.data_path.endswith("location"):
            for key in curve.keyframe_points:
                key.co.y, key.handle_left.y, key.handle_right.y = (y * factor for y in (key.co.y, key.handle_left.y, key.handle_right.y))


def says_what_is_wrong():
    armature = imported()
    armature.animation_data.action = None
    refused(bpy.ops.spherechain.check, "has no action")
    armature = imported()
    body = body_of(armature)
    for item in armature.children:
        item.hide_set(True)
    refused(bpy.ops.spherechain.check, "moves no visible mesh")
    bpy.ops.wm.read_factory_settings()
    enable()
    bpy.context.view_layer.objects.active = bpy.data.objects["Cube"]
    refused(bpy.ops.spherechain.check, "Select a character")
    imported()
    preferences = bpy.context.preferences.addons["spherechain_blender"].preferences
    preferences.tool = "/nowhere/spherechain"
    refused(bpy.ops.spherechain.check, "/nowhere/spherechain is no program", "preferences")
    broken = os.path.join(bpy.app.tempdir, "tool")
    with open(broken, "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\necho 'spherechain: error: '$2': out of luck (try again)' >&2\nexit 3\n")
    os.chmod(broken, 0o755)
    preferences.tool = broken
    refused(bpy.ops.spherechain.check, "Armature: out of luck (try again)")
    preferences.tool = ""


def can_be_cancelled():
    armature = imported()
    runner = sys.modules["spherechain_blender.tasks"].runner
    tool = sys.modules["spherechain_blender.results"].find_tool("")
    before = contents()
    runner.start("check", bpy.context, tool)
    while runner.step() and "check" not in running():
        time.sleep(0.02)
    assert "check" in running()
    began = time.monotonic()
    runner.cancel()
    assert time.monotonic() - began < 3 and runner.task is None and runner.error == "cancelled"
    time.sleep(0.2)  # the system removes what has ended
    assert running() == ""
    assert contents() == before and not bpy.context.scene.timeline_markers and not armature.spherechain.checked


def running():
    """Commands of the tool that this Blender's files are given to."""
    found = ""
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/cmdline", encoding="utf-8") as file:
                words = file.read().split("\0")
        except (OSError, UnicodeDecodeError):
            continue
        if words[0].endswith("spherechain") and any(bpy.app.tempdir.rstrip("/") in word for word in words):
            found += " ".join(words)
    return found


def mends_into_a_new_action():
    armature = imported()
    old = armature.animation_data.action
    elbow = next(bone for bone in armature.pose.bones if bone.name == "left_elbow")
    in_euler_angles(old, elbow)
    before = curves_of(old)
    bpy.ops.spherechain.fix()
    new = armature.animation_data.action
    assert new.name == old.name + " fixed" and old.use_fake_user, new.name
    assert curves_of(old) == before and curves_of(new) != before
    glb, character = sys.modules["spherechain_blender.glb"], sys.modules["spherechain_blender.character"]
    mended = max((os.path.join(folder, name) for folder, _, files in os.walk(bpy.app.tempdir) for name in files
                  if name == "mended.glb"), key=os.path.getmtime)
    played = character.Character(bpy.context)
    for _ in played.sample():
        pass
    wanted = glb.rotations(mended, played.bones, len(played.pose), played.fps)
    degrees = glb.angles(wanted, glb.split(played.local_pose())[1]).max()
    assert degrees < 0.05, degrees
    print(f"trial: the new action is within {degrees:.4f} degrees of the tool's file")
    bpy.ops.spherechain.check()
    left = [row.name for row in armature.spherechain.events if row.kind != "deep fold"]
    assert not left, left

    armature.animation_data.action = old
    arm = armature.pose.bones["left_shoulder"].constraints.new("COPY_ROTATION")
    arm.influence, arm.target, arm.subtarget, arm.owner_space, arm.target_space = 0.05, armature, "left_hip", "LOCAL", "LOCAL"
    refused(bpy.ops.spherechain.fix, "Constraints or drivers turn left_shoulder")
    assert armature.animation_data.action == old and len(bpy.data.actions) == 2


def in_euler_angles(action, bone):
    """The bone's keys as Euler angles."""
    path = f'pose.bones["{bone.name}"].'
    curves = [action.fcurves.find(path + "rotation_quaternion", index=at) for at in range(4)]
    frames = [key.co.x for key in curves[0].keyframe_points]
    turns = [[curve.evaluate(frame) for curve in curves] for frame in frames]
    for curve in curves:
        action.fcurves.remove(curve)
    bone.rotation_mode = "YZX"
    angles = [action.fcurves.new(path + "rotation_euler", index=at) for at in range(3)]
    near = None
    for frame, turn in zip(frames, turns):
        turn = type(bone.rotation_quaternion)(turn)
        near = turn.to_euler("YZX", near) if near else turn.to_euler("YZX")
        for curve, value in zip(angles, near):
            curve.keyframe_points.insert(frame, value)


def curves_of(action):
    return {(curve.data_path, curve.array_index): [tuple(key.co) for key in curve.keyframe_points] for curve in action.fcurves}


def masks_the_skin_below_a_shirt():
    armature = imported()
    body = body_of(armature)
    for eyes in set(armature.children) - {body}:
        eyes.hide_set(True)
    chest = {group.index for group in body.vertex_groups if group.name in {"chest", "spine"}}
    worn = {vertex.index for vertex in body.data.vertices
            if sum(entry.weight for entry in vertex.groups if entry.group in chest) > 0.5}
    shirt = body.copy()
    shirt.data = body.data.copy()
    shirt.name = "Hemd"
    bpy.context.scene.collection.objects.link(shirt)
    cut = bmesh.new()
    cut.from_mesh(shirt.data)
    bmesh.ops.delete(cut, geom=[vertex for vertex in cut.verts if vertex.index not in worn], context="VERTS")
    bmesh.ops.remove_doubles(cut, verts=cut.verts, dist=1e-5)  # the file has four vertices for each face
    cut.normal_update()
    for vertex, normal in [(vertex, vertex.normal.copy()) for vertex in cut.verts]:
        vertex.co += 0.01 * normal
    cut.to_mesh(shirt.data)
    cut.free()
    bpy.ops.spherechain.mask()
    group = body.vertex_groups["spherechain hidden"].index
    hidden = {vertex.index for vertex in body.data.vertices if any(entry.group == group for entry in vertex.groups)}
    assert len(hidden) > 0.1 * len(worn) and len(hidden - worn) < 0.05 * len(hidden), (len(hidden), len(hidden - worn))
    print(f"trial: {len(hidden)} vertices of the body hidden below the shirt's {len(worn)}")


def main():
    if os.environ.get("ONLY"):
        return globals()[os.environ["ONLY"]]()
    for test in (finds_what_the_tool_finds, finds_the_same_however_the_scene_is_set_up, says_what_is_wrong, can_be_cancelled,
                 mends_into_a_new_action, masks_the_skin_below_a_shirt):
        test()
        print("trial:", test.__name__.replace("_", " "), flush=True)


try:
    main()
except Exception:  # Blender goes on after an exception
    traceback.print_exc()
    sys.exit(1)
