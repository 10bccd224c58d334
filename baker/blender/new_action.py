# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a new action from the joints that `fix` turned. The old action stays as it is."""

import bpy
import numpy as np
from mathutils import Euler, Matrix, Quaternion

from . import glb, results
from .character import Refused

TURNED = 0.001  # degrees: less is rounding
SAME = 0.05  # degrees that the new action may differ from the tool's file
CHANNELS = {"QUATERNION": ("rotation_quaternion", 4), "AXIS_ANGLE": ("rotation_axis_angle", 4)}


def refuse_tracks(armature):
    if not (armature.animation_data and armature.animation_data.action):
        raise Refused(f"{armature.name} has no action to mend: choose one in the Action Editor")


def from_mended(character, path):
    """Yields progress; a sentence at the end. The new action is a copy of the old one with other keys for what turned."""
    armature = character.armature
    wanted = glb.rotations(path, character.bones, len(character.pose), character.fps)
    translations, rotations, scales = glb.split(character.local_pose())
    turned = glb.angles(wanted, rotations) > TURNED
    if not turned.any():
        return "No joint had to turn: no new action"
    pose = chained(character, translations, np.where(turned[..., None], wanted, rotations), scales)
    old = armature.animation_data.action
    old.use_fake_user = True  # it has no other user soon, and Blender would not save it
    new = old.copy()
    new.name = results.suffixed(old.name, " fixed")
    changed = 0
    for at, name in enumerate(character.bones):
        bone = armature.pose.bones[name]
        yield f"making the new action: {name}"
        basis = [own_turn(bone, character, pose, frame, at) for frame in range(len(pose))]
        before = [own_turn(bone, character, character.pose, frame, at) for frame in range(len(pose))]
        differs = glb.angles(np.array(basis), np.array(before)) > TURNED
        if differs.any():
            key(new, bone, basis, np.flatnonzero(differs) + character.first, character)
            changed += 1
    armature.animation_data.action = new
    yield "looking at the new action"
    bad = yield from off(character, pose)
    if bad:
        armature.animation_data.action = old
        bpy.data.actions.remove(new)
        raise Refused(f"Constraints or drivers turn {', '.join(bad[:3])}{' and others' * (len(bad) > 3)}: "
                      "bake the action first (Pose > Animation > Bake Action, with visual keying and clear constraints)")
    return f"New action '{new.name}': {changed} bones turn"


def chained(character, translations, rotations, scales):
    """Poses in the armature's space from each bone's place in its parent's."""
    x, y, z, w = np.moveaxis(rotations, -1, 0)
    local = np.zeros((*rotations.shape[:2], 4, 4))
    local[..., 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1)
    local[..., 1, :3] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1)
    local[..., 2, :3] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1)
    local[..., :3, :3] *= scales[..., None, :]
    local[..., :3, 3] = translations
    local[..., 3, 3] = 1
    for at, parent in enumerate(character.parents):  # parents come first
        if parent >= 0:
            local[:, at] = local[:, parent] @ local[:, at]
    return local


def own_turn(bone, character, pose, frame, at):
    """The bone's own rotation (x, y, z, w), which its channels hold, in a pose."""
    rest, parent = bone.bone, character.parents[at]
    above = {} if parent < 0 else {"parent_matrix": Matrix(pose[frame, parent]), "parent_matrix_local": rest.parent.matrix_local}
    basis = rest.convert_local_to_pose(Matrix(pose[frame, at]), rest.matrix_local, invert=True, **above)
    turn = basis.to_quaternion()
    return (turn.x, turn.y, turn.z, turn.w)


def key(action, bone, basis, frames, character):
    """Keys at each frame between the old keys around the frames that turn. Beyond them the old curves stay."""
    path, width = CHANNELS.get(bone.rotation_mode, ("rotation_euler", 3))
    path = f'{bone.path_from_id()}.{path}'
    curves = [action.fcurves.find(path, index=at) or action.fcurves.new(path, index=at, action_group=bone.name)
              for at in range(width)]
    old = sorted({point.co.x for curve in curves for point in curve.keyframe_points})
    spans = joined([(max([x for x in old if x <= frame - 1], default=character.first),
                     min([x for x in old if x >= frame + 1], default=character.last)) for frame in frames])
    before = [[curve.evaluate(character.first + at) for curve in curves] for at in range(len(basis))]
    values = np.array([in_mode(bone.rotation_mode, turn, near) for turn, near in zip(basis, before)])
    for at, curve in enumerate(curves):
        for modifier in [modifier for modifier in curve.modifiers if modifier.type != "CYCLES"]:
            curve.modifiers.remove(modifier)
        for first, last in spans:
            replace(curve, first, last, frames, values[:, at], character.first)
        curve.update()


def joined(spans):
    """Spans in order, those that meet as one."""
    result = []
    for first, last in sorted(spans):
        if result and first <= result[-1][1]:
            result[-1] = (result[-1][0], max(last, result[-1][1]))
        else:
            result.append((first, last))
    return result


def replace(curve, first, last, turned, values, start):
    """Keys at each frame from `first` to `last`, but for a first or last key whose frame did not turn."""
    points = curve.keyframe_points
    for at in reversed(range(len(points))):
        x = points[at].co.x
        if first < x < last or (x in (first, last) and x in turned):
            points.remove(points[at], fast=True)
        elif x in (first, last):
            points[at].handle_left_type = points[at].handle_right_type = "FREE"  # the curve beyond keeps its shape
            if x == first:
                points[at].interpolation = "LINEAR"
    there = {point.co.x for point in points}
    for frame in range(int(np.ceil(first)), int(np.floor(last)) + 1):
        if frame not in there:
            points.insert(frame, values[frame - start], options={"FAST"}).interpolation = "LINEAR"


def in_mode(mode, turn, near):
    """A rotation as the bone's channels hold it, in the form that is near these values."""
    x, y, z, w = turn
    turn = Quaternion((w, x, y, z))
    if mode == "QUATERNION":
        return tuple(-turn if turn.dot(Quaternion(near)) < 0 else turn)
    if mode == "AXIS_ANGLE":
        axis, angle = turn.to_axis_angle()
        return (-angle, *-axis) if axis.dot(near[1:]) < 0 else (angle, *axis)
    return tuple(turn.to_euler(mode, Euler(near, mode)))


def off(character, pose):
    """Plays the new action; names of bones that do not turn as the tool's file says."""
    yield from character.sample()
    played, wanted = glb.split(character.local_pose())[1], glb.split(character.local_pose(pose))[1]
    wrong = glb.angles(played, wanted).max(0) > SAME
    return [name for name, is_wrong in zip(character.bones, wrong) if is_wrong]
