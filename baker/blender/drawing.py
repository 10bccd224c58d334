# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the contacts of the current frame over the character in the 3D view."""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from . import results

FAULT, INSIDE, TOUCH, DEPTH = (1.0, 0.1, 0.05), (0.75, 0.1, 0.9), (1.0, 0.8, 0.1), (1.0, 1.0, 1.0)
shown = {}  # by the armature's name


class Contacts:
    """The contacts of a checked action: triangles of the exported meshes, and the poses in which they touch."""

    def __init__(self, character, frames, parts):
        self.name, self.first, self.bones = character.name, character.first, character.bones
        self.pose, self.move, self.scale = character.pose, character.move, character.scale
        self.inverse = np.linalg.inv(character.rest)
        meshes = character.meshes
        starts = np.cumsum([0] + [len(mesh["points"]) for mesh in meshes])
        self.points = np.concatenate([mesh["points"] for mesh in meshes])
        self.triangles = np.concatenate([mesh["triangles"] + start for mesh, start in zip(meshes, starts)])
        width = max(mesh["joints"].shape[1] for mesh in meshes)
        pad = lambda rows: np.pad(rows, ((0, 0), (0, width - rows.shape[1])))
        self.joints = np.concatenate([pad(mesh["joints"]) for mesh in meshes])
        self.weights = np.concatenate([pad(mesh["weights"]) for mesh in meshes])
        part = results.parts_of_bones(self.bones, character.parents, parts)
        main = self.joints[np.arange(len(self.joints)), np.argmax(self.weights, 1)]
        self.part = [part[main[corner]] for corner in self.triangles[:, 0]]
        _, weld = np.unique(np.round(self.points / np.ptp(self.points) * 1e5), axis=0, return_inverse=True)
        self.surface = results.Surface(weld.reshape(-1)[self.triangles].tolist())
        self.found, self.sorted = frames, {}

    def at(self, frame):
        """A frame with contacts: triangles that are inside, of faults, and of touches and folds; the faults' deepest points."""
        if frame not in self.sorted:
            found = self.found[frame]
            faults = {frozenset(fault["parts"]) for fault in found["faults"]}
            groups = {True: set(), False: set()}
            for one, other in found["pairs"]:
                groups[frozenset((self.part[one], self.part[other])) in faults].update((one, other))
            inside = results.swallowed_triangles(self.surface, self.part, found)
            points = np.array([fault["points"] for fault in found["faults"]]).reshape(-1, 3) / self.scale
            self.sorted[frame] = (sorted(inside), sorted(groups[True]), sorted(groups[False] - groups[True]), points)
        return self.sorted[frame]

    def corners(self, triangles, frame):
        """Corners of triangles (n, 3, 3) in the armature's space, as its bones stood when it was checked."""
        vertices = self.triangles[triangles].reshape(-1)
        turns = np.concatenate([self.pose[frame - self.first] @ self.inverse, np.eye(4)[None]])
        points = np.concatenate([self.points[vertices], np.ones((len(vertices), 1))], 1)
        moved = np.einsum("vj,vjrc,vc->vr", self.weights[vertices], turns[self.joints[vertices]], points)
        return moved[:, :3].reshape(-1, 3, 3)

    def holds(self, armature, frame):
        """Whether the character stands as it did when this frame was checked."""
        bones = armature.pose.bones
        if not 0 <= frame - self.first < len(self.pose) or any(name not in bones for name in self.bones):
            return False
        now = np.array([bones[name].matrix for name in self.bones])
        return close(now, self.pose[frame - self.first]) and close(np.array(armature.matrix_world), self.move[frame - self.first])


def close(one, other):
    return np.abs(one - other).max() < 1e-3 * np.abs(other).max()


def show(contacts):
    shown[contacts.name] = contacts


def forget():
    shown.clear()


def state(armature, frame):
    """The line that the panel shows below the list."""
    contacts = shown.get(armature.name)
    if contacts is None:
        return ""
    if not contacts.holds(armature, frame):
        return "The pose has changed: check again to see contacts" if 0 <= frame - contacts.first < len(contacts.pose) else ""
    return "" if frame in contacts.found else "No contact in this frame"


def draw():
    context = bpy.context
    frame, region = context.scene.frame_current, context.region_data
    for name, contacts in shown.items():
        armature = context.view_layer.objects.get(name)
        if armature is None or frame not in contacts.found or not armature.spherechain.draw or not contacts.holds(armature, frame):
            continue
        world = np.array(armature.matrix_world)
        eye = np.array(region.view_matrix.inverted())
        gpu.state.blend_set("ALPHA")
        gpu.state.face_culling_set("NONE")
        inside, faults, touches, depths = contacts.at(frame)
        for triangles, colour in ((touches, TOUCH), (inside, INSIDE), (faults, FAULT)):
            if not triangles:
                continue
            points = contacts.corners(triangles, frame).reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
            points = nearer(points, eye, region.is_perspective)
            fill(points, colour, "NONE", 0.3)
            fill(points, colour, "LESS_EQUAL", 0.85)
        if len(depths):
            gpu.state.depth_test_set("NONE")
            gpu.state.line_width_set(3)
            paint("LINES", depths, (*DEPTH, 1.0))
            gpu.state.point_size_set(7)
            paint("POINTS", depths, (*DEPTH, 1.0))
        gpu.state.depth_test_set("NONE")
        gpu.state.blend_set("NONE")
        gpu.state.line_width_set(1)


def nearer(points, eye, perspective):
    """A little towards the eye, so that a triangle is not hidden by the skin that it lies on."""
    if perspective:
        return points + 0.002 * (eye[:3, 3] - points)
    return points + 0.002 * np.linalg.norm(np.ptp(points, axis=0)) * eye[:3, 2]


def fill(points, colour, depth, alpha):
    gpu.state.depth_test_set(depth)
    paint("TRIS", points, (*colour, alpha))


def paint(kind, points, colour):
    shader = gpu.shader.from_builtin("UNIFORM_COLOR" if bpy.app.version >= (4, 0) else "3D_UNIFORM_COLOR")
    batch = batch_for_shader(shader, kind, {"pos": points.astype(np.float32).tolist()})
    shader.bind()
    shader.uniform_float("color", colour)
    batch.draw(shader)
