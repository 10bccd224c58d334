# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the active character of a scene: its visible meshes at rest, and the poses of its action. Changes nothing of the file.

Blender's own glTF exporter takes a minute for 688 frames. Here a scene of its own, which holds the armature alone, is played
instead, and is gone before Blender draws again.
"""

import math
import time

import bpy
import numpy as np
from mathutils import Matrix

from . import glb

# Modifiers that shape the mesh before the skeleton moves it. Others, as a subdivision for the picture, are left out.
SHAPING = {"MIRROR", "SOLIDIFY", "WELD", "TRIANGULATE", "DECIMATE", "ARRAY", "BEVEL"}
TO_GLTF = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


class Refused(Exception):
    """A sentence for the artist: why this cannot be checked."""


def armature_of(context):
    """The armature that is active, or that moves the active mesh; None without one."""
    active = context.object
    if active is None or active.type == "ARMATURE":
        return active
    modifier = next((m for m in active.modifiers if m.type == "ARMATURE" and m.object), None)
    return modifier.object if modifier else active.find_armature() or (
        active.parent if active.parent and active.parent.type == "ARMATURE" else None)


def meshes_of(armature, layer):
    """Visible meshes that the armature moves: (object, bone). A mesh that hangs on one bone has its name."""
    found = []
    for item in layer.objects:
        if item.type != "MESH" or not item.visible_get(view_layer=layer):
            continue
        if any(m.type == "ARMATURE" and m.object == armature and m.show_viewport for m in item.modifiers):
            found.append((item, None))
        elif item.parent == armature and item.parent_type == "BONE":
            found.append((item, item.parent_bone))
        elif item.parent == armature and item.parent_type == "ARMATURE":
            found.append((item, None))
    return found


def actions_of(armature):
    """Actions that move bones of this armature."""
    bones = {f'pose.bones["{bpy.utils.escape_identifier(bone.name)}"]' for bone in armature.data.bones}
    return [action for action in bpy.data.actions
            if any(curve.data_path.rpartition(".")[0] in bones for curve in action.fcurves)]


def frames_of(armature, scene, action):
    """First and last frame to look at: those of the action, or the scene's where tracks play without one."""
    data = armature.animation_data
    if action:
        first, last = action.frame_range
        return math.floor(first + 1e-3), max(math.ceil(last - 1e-3), math.floor(first + 1e-3))
    if data and any(not track.mute and track.strips for track in data.nla_tracks):
        return scene.frame_start, scene.frame_end
    raise Refused(f"{armature.name} has no action: choose one in the Action Editor")


class Character:
    """The bones and meshes that are exported, and the poses that were sampled."""

    def __init__(self, context):
        armature = armature_of(context)
        if armature is None:
            raise Refused("Select a character: an armature, or a mesh that an armature moves")
        meshes = meshes_of(armature, context.view_layer)
        if not meshes:
            raise Refused(f"{armature.name} moves no visible mesh")
        if context.mode.startswith("EDIT"):
            raise Refused("Leave edit mode first")
        self.name, self.scene_name = armature.name, context.scene.name
        self.fps = self.scene.render.fps / self.scene.render.fps_base
        self.scale = self.scene.unit_settings.scale_length
        self.meshes, self.takes = [], []
        self.use_bones(meshes)
        self.read_meshes(meshes)
        if not self.meshes:
            raise Refused(f"The meshes of {armature.name} have no faces that its bones move")

    @property
    def armature(self):
        """Looked up each time: an undo replaces every object of the file."""
        return found(bpy.data.objects, self.name)

    @property
    def scene(self):
        return found(bpy.data.scenes, self.scene_name)

    def use_bones(self, meshes):
        """Bones that move a vertex, and those above them, parents first."""
        bones = self.armature.data.bones
        used = {bone for _, bone in meshes if bone}
        for item, _ in meshes:
            used.update(group.name for group in item.vertex_groups if group.name in bones and bones[group.name].use_deform)
        for name in list(used):
            used.update(parent.name for parent in bones[name].parent_recursive)
        self.bones = [bone.name for bone in bones if bone.name in used]  # Blender lists parents first
        self.place = {name: at for at, name in enumerate(self.bones)}
        self.parents = [self.place[bones[name].parent.name] if bones[name].parent else -1 for name in self.bones]
        self.rest = np.array([bones[name].matrix_local for name in self.bones])

    def read_meshes(self, meshes):
        with Stage(self.scene) as stage:
            for item, bone in meshes:
                copy = stage.copy(item)  # it shares the mesh; modifiers are taken from the copy alone
                for modifier in list(copy.modifiers):
                    if modifier.type not in SHAPING or not modifier.show_viewport:
                        copy.modifiers.remove(modifier)
            layer = stage.scene.view_layers[0]
            layer.update()
            for (item, bone), copy in zip(meshes, stage.copies):
                shaped = copy.evaluated_get(layer.depsgraph)
                self.read_mesh(item, bone, shaped.to_mesh())
                shaped.to_mesh_clear()

    def read_mesh(self, item, bone, mesh):
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        if count == 0:
            return
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        triangles, materials = np.empty(3 * count, np.int32), np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        mesh.loop_triangles.foreach_get("material_index", materials)
        to_armature = self.armature.matrix_world.inverted_safe() @ item.matrix_world
        if bone:
            now = self.armature.pose.bones[bone]
            to_armature = now.bone.matrix_local @ now.matrix.inverted_safe() @ to_armature
            joints = np.full((len(mesh.vertices), 1), self.place[bone])
            weights = np.ones((len(mesh.vertices), 1))
        else:
            joints, weights = self.read_weights(item, mesh)
        matrix = np.array(to_armature)
        order = np.argsort(materials, kind="stable")  # triangles go primitive by primitive, as in the file
        self.meshes.append({
            "object": item.name,
            "points": points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3],
            "triangles": triangles.reshape(-1, 3)[order],
            "joints": joints,
            "weights": weights,
            "materials": materials[order],
            "own": len(mesh.vertices) == len(item.data.vertices),
            "flipped": np.linalg.det(matrix[:3, :3]) < 0,
        })

    def read_weights(self, item, mesh):
        """Up to eight bones a vertex; a vertex without any is moved by the object, the joint after the last bone."""
        groups = [self.place.get(group.name, -1) for group in item.vertex_groups]
        rows = []
        for vertex in mesh.vertices:
            row = [(entry.weight, groups[entry.group]) for entry in vertex.groups
                   if entry.group < len(groups) and groups[entry.group] >= 0 and entry.weight > 0]
            rows.append(sorted(row, reverse=True)[:8] or [(1.0, len(self.bones))])
        width = 4 if max(map(len, rows)) <= 4 else 8
        joints, weights = np.zeros((len(rows), width), int), np.zeros((len(rows), width))
        for at, row in enumerate(rows):
            for place, (weight, joint) in enumerate(row):
                joints[at, place], weights[at, place] = joint, weight
        return joints, weights / weights.sum(1, keepdims=True)

    def sample(self, other=None):
        """Plays the action that is on, or another. Yields ten times a second, so that the window stays alive."""
        data = self.armature.animation_data
        action = other or (data.action if data else None)
        first, last = frames_of(self.armature, self.scene, action)
        poses, moves, frame = [], [], first
        while frame <= last:
            with Stage(self.scene) as stage:
                armature = stage.playing(self.armature, other)
                layer = stage.scene.view_layers[0]
                until = time.monotonic() + (math.inf if bpy.app.background else 0.1)
                while True:
                    stage.scene.frame_set(frame)
                    posed = armature.evaluated_get(layer.depsgraph)
                    bones = posed.pose.bones
                    poses.append([bones[name].matrix.copy() for name in self.bones])
                    moves.append(posed.matrix_world.copy())
                    frame += 1
                    if frame > last or time.monotonic() > until:
                        break
            yield f"reading frame {frame - 1} of {first}-{last}"
        self.first, self.last = first, last
        self.pose, self.move = np.array(poses), np.array(moves)
        self.takes.append((action.name if action else "tracks", self.pose, self.move))

    def local_pose(self, pose=None):
        """Each bone in its parent's space."""
        pose = self.pose if pose is None else pose
        local = pose.copy()
        for at, parent in enumerate(self.parents):
            if parent >= 0:
                local[:, at] = np.linalg.inv(pose[:, parent]) @ pose[:, at]
        return local

    def to_file(self, move):
        """From the armature's space to the file's."""
        move = np.array(TO_GLTF) @ move
        move[..., :3, :] *= self.scale
        return move

    def write(self, path):
        """The character with the actions that were played, as a .glb."""
        file = glb.Writer()
        bind = self.to_file(self.move[0])  # the skin is written as it stands in the scene: so the tool names places in the scene
        rest = np.concatenate([self.local_pose(self.rest[None])[0], bind[None]])
        nodes = [file.node(name=name, **keys) for name, keys in zip(self.bones + [self.armature.name], placed(rest))]
        children = {}
        for at, parent in enumerate(self.parents):
            children.setdefault(parent if parent >= 0 else len(self.bones), []).append(at)
        for parent, below in children.items():
            file.gltf["nodes"][parent]["children"] = below
        inverse = np.linalg.inv(np.concatenate([bind @ self.rest, bind[None]]))
        file.gltf["skins"] = [{"joints": nodes, "inverseBindMatrices": file.accessor(inverse.transpose(0, 2, 1), 5126, "MAT4")}]
        meshes = [file.mesh(mesh["object"], 0, self.primitives(mesh, bind)) for mesh in self.meshes]
        file.gltf["scenes"] = [{"nodes": [nodes[-1]] + meshes}]
        for name, pose, move in self.takes:
            file.clip(name, nodes, np.concatenate([self.local_pose(pose), self.to_file(move)[:, None]], 1), self.fps)
        file.save(path)

    def primitives(self, mesh, bind):
        """One for each material."""
        points = mesh["points"] @ bind[:3, :3].T + bind[:3, 3]
        flipped = mesh["flipped"] != (np.linalg.det(bind[:3, :3]) < 0)
        slots = bpy.data.objects[mesh["object"]].material_slots
        for number in np.unique(mesh["materials"]):
            triangles = mesh["triangles"][mesh["materials"] == number]
            used, triangles = np.unique(triangles, return_inverse=True)
            triangles = triangles.reshape(-1, 3)
            material = slots[number].material if number < len(slots) else None
            mode = getattr(material, "blend_method", "OPAQUE")
            yield {
                "positions": points[used],
                "joints": padded(mesh["joints"][used]),
                "weights": padded(mesh["weights"][used]),
                "triangles": triangles[:, ::-1] if flipped else triangles,
                "material": (material.name, {"OPAQUE": "OPAQUE", "CLIP": "MASK"}.get(mode, "BLEND")) if material else None,
            }


def found(collection, name):
    if name not in collection:
        raise Refused(f"{name} is gone")
    return collection[name]


def padded(rows):
    return np.pad(rows, ((0, 0), (0, -rows.shape[1] % 4)))


def placed(matrices):
    """Matrices as the keys of glTF nodes."""
    return [{"translation": t.tolist(), "rotation": q.tolist(), "scale": s.tolist()} for t, q, s in zip(*glb.split(matrices))]


class Stage:
    """A scene of its own for some objects, as long as a `with` lasts. Nothing of it is left in the file."""

    def __init__(self, like):
        self.frame, self.copies = like.frame_current, []

    def __enter__(self):
        self.scene = bpy.data.scenes.new("spherechain")
        self.scene.frame_current = self.frame
        return self

    def __exit__(self, *_):
        bpy.data.scenes.remove(self.scene)
        for copy in self.copies:
            bpy.data.objects.remove(copy)

    def copy(self, item):
        self.copies.append(item.copy())
        self.scene.collection.objects.link(self.copies[-1])
        return self.copies[-1]

    def playing(self, armature, other):
        """The armature itself; or, for an action that is not on, a copy that plays it and follows its own bones."""
        if other is None:
            self.scene.collection.objects.link(armature)
            return armature
        double = self.copy(armature)
        double.animation_data_create().action = other
        for track in double.animation_data.nla_tracks:
            track.mute = True
        for bone in double.pose.bones:
            for constraint in bone.constraints:
                if getattr(constraint, "target", None) == armature:
                    constraint.target = double
        return double
