# SPDX-License-Identifier: GPL-3.0-or-later
"""Check, fix and mask: from the active character to the tool and back. Each is a generator that yields a line of progress."""

import os
import tempfile

import bpy

from . import drawing, new_action, results
from .character import Character, Refused, actions_of
from .job import Failed, Job


def follow(job):
    """Yields the tool's progress until it has ended; a task that is closed meanwhile ends the tool."""
    job.start()
    try:
        while job.is_alive():
            yield job.progress
    finally:
        if job.is_alive():
            job.cancel()
    if job.error:
        raise Failed(job.error)
    return job.result


def exported(character, actions=(None,)):
    """Plays the action that is on, or others, and writes the character. Returns the file's path, and the character's name for
    each way in which the tool names that file. Blender removes its folder when it ends."""
    for action in actions:
        yield from character.sample(action)
    folder = tempfile.mkdtemp(prefix="spherechain-", dir=bpy.app.tempdir)
    path = os.path.join(folder, "character.glb")
    character.write(path)
    return path, {path: character.name, os.path.basename(path): character.name}


def check(context, tool):
    character = Character(context)
    source, names = yield from exported(character)
    folder, rate = os.path.dirname(source), f"{character.fps:.9g}"

    def look(job):
        found = os.path.join(folder, "check.json")
        job.tool([tool, "check", source, "-o", os.path.join(folder, "report"), "--fps", rate, "--json", found], good=(0, 6))
        return results.events(found, character.first)

    show_events(character, *(yield from follow(Job(look, names))))

    def places(job):
        asset, played = os.path.join(folder, "character.sphc"), os.path.join(folder, "play.json")
        job.tool([tool, "bake", source, "-o", asset], good=(0, 5))
        job.tool([tool, "play", asset, "--source", source, "--fps", rate, "--contacts", "--json", played])
        return drawing.Contacts(character, *results.contacts(played, character.first))

    drawing.show((yield from follow(Job(places, names))))


def show_events(character, events, others, notes):
    """Replaces the list, and the timeline markers that are ours."""
    shown = character.armature.spherechain
    shown.events.clear()
    for event in events:
        row = shown.events.add()
        row.name, row.size, row.kind = event["text"], event["size"], event["class"]
        row.first, row.last, row.worst = event["from"], event["to"], event["worst"]
    shown.checked = (f"{character.takes[0][0]}, frames {character.first}-{character.last}: {len(events)} faults, "
                     f"{others} touches")
    shown.note = " ".join(notes)
    markers = character.scene.timeline_markers
    for marker in [marker for marker in markers if marker.name.startswith(results.PREFIX)]:
        markers.remove(marker)
    for event in events:
        markers.new(results.marker_name(event), frame=event["worst"])
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            area.tag_redraw()


def fix(context, tool):
    character = Character(context)
    new_action.refuse_tracks(character.armature)
    source, names = yield from exported(character)
    mended = os.path.join(os.path.dirname(source), "mended.glb")
    report = os.path.join(os.path.dirname(source), "report")
    job = Job(lambda job: job.tool([tool, "fix", source, "-o", mended, "--report", report], good=(0, 5)), names)
    yield from follow(job)
    yield "making the new action"
    said = yield from new_action.from_mended(character, mended)
    outcomes = results.outcomes(os.path.join(report, "fix.json"))
    character.armature.spherechain.checked = f"{said}; {outcomes}"


def mask(context, tool):
    character = Character(context)
    actions = actions_of(character.armature)
    source, names = yield from exported(character, actions or (None,))
    hidden = os.path.join(os.path.dirname(source), "mask.json")
    job = Job(lambda job: job.tool([tool, "mask", source, "--as", "json", "-o", hidden]), names)
    yield from follow(job)
    total = 0
    for mesh, triangles in results.hidden_triangles(hidden).items():
        entry = next((entry for entry in character.meshes if entry["object"] == mesh), None)
        item = bpy.data.objects.get(mesh)
        if not triangles or entry is None or item is None:
            continue
        if not entry["own"] or len(item.data.vertices) != len(entry["points"]):
            raise Failed(f"{mesh}: a modifier makes other vertices; apply it, then mask again")
        vertices = results.hidden_vertices(entry["triangles"].tolist(), triangles, len(entry["points"]))
        old = item.vertex_groups.get(GROUP)
        if old:
            item.vertex_groups.remove(old)
        item.vertex_groups.new(name=GROUP).add(vertices, 1.0, "REPLACE")
        total += len(vertices)
    character.armature.spherechain.checked = f"Vertex group '{GROUP}': {total} vertices, by {len(character.takes)} actions"


GROUP = "spherechain hidden"
TASKS = {"check": check, "fix": fix, "mask": mask}


class Runner:
    """The one task that runs, its progress, and the last error."""

    def __init__(self):
        self.task, self.kind, self.progress, self.error = None, "", "", ""

    def start(self, kind, context, tool):
        self.kind, self.error, self.progress = kind, "", "reading the character"
        self.task = TASKS[kind](context, tool)

    def step(self):
        """One moment of the task; whether there are more."""
        if self.task is None:
            return False
        try:
            self.progress = next(self.task) or self.progress
            return True
        except StopIteration:
            self.done()
        except (Refused, Failed) as problem:
            self.error = str(problem)
        except Exception as problem:  # a fault of ours; the panel must not go on saying that it runs
            self.error = f"internal error: {problem}"
            self.task = None
            raise
        self.task = None
        return False

    def done(self):
        """Makes the change one step of Blender's undo."""
        if not bpy.app.background:
            windows = bpy.context.window_manager.windows
            with bpy.context.temp_override(window=windows[0]):
                bpy.ops.ed.undo_push(message=f"Spherechain {self.kind}")

    def cancel(self):
        if self.task:
            self.task.close()
            self.task, self.error = None, "cancelled"


runner = Runner()
