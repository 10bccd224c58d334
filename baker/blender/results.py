# SPDX-License-Identifier: GPL-3.0-or-later
"""The tool's JSON and messages, as the panel shows them. Plain Python, without Blender."""

import json
import os
import shutil

PREFIX = "sc: "  # timeline markers that begin so are ours
FAULTS = ("inside", "penetration", "deep_fold")


def find_tool(path):
    """The program that the preferences name, or the one on PATH; None where there is none."""
    if not path:
        return shutil.which("spherechain")
    path = os.path.expanduser(path)
    return path if os.path.isfile(path) and os.access(path, os.X_OK) else None


def missing(path):
    """Says what to do where `find_tool` finds nothing."""
    if path:
        return f"{path} is no program: correct the path in the add-on's preferences"
    return "spherechain is not on PATH: install its package, or set its path in the add-on's preferences"


def error_line(text, names):
    """The last error in what the tool printed, in one line, with the artist's names in place of temporary files."""
    lines = [line for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("spherechain: error: ")]
    line = (errors or lines or ["the tool ended without a word"])[-1].replace("spherechain: error: ", "")
    return renamed(line, names)


def renamed(line, names):
    for path, name in names.items():
        line = line.replace(path, name)
    return line


def progress_line(line, names):
    return renamed(line.strip(), names).replace("spherechain: ", "", 1)


def events(path, first):
    """Reads `check --json`: faults and poke-through, the number of other events, notes. The clip begins at the frame `first`."""
    with open(path, encoding="utf-8") as file:
        checked = json.load(file)
    clip = checked["clips"][0]
    if clip.get("error"):
        raise ValueError(clip["error"])
    found, others = [], 0
    for event in clip["events"]:
        if event["class"] not in FAULTS + ("poke",):
            others += 1
            continue
        if event["class"] == "poke":
            text = f"{event['pieces'][0]} through {event['pieces'][1]}"
            size = f"{event['area_cm2']:.0f} cm2"
        else:
            one, other = event["parts"]
            text = f"{one} in itself" if one == other else f"{one} in {other}"
            size = f"{event['depth_mm']:.0f} mm"
        found.append({
            "text": text,
            "size": size,
            "class": event["class"].replace("_", " "),
            "from": first + round(event["from"]),
            "to": first + round(event["to"]),
            "worst": first + round(event["deepest"]),
        })
    return found, others, checked["notes"]


def marker_name(event):
    return f"{PREFIX}{event['text']} {event['size']}"


def contacts(path, first):
    """Reads `play --contacts --json`: for each frame of the scene the triangles that touch and the faults' deepest points."""
    with open(path, encoding="utf-8") as file:
        played = json.load(file)
    frames = {}
    for frame in played["frames"]:
        triangles = frame["skin"].get("triangles", [])
        faults = [fault for fault in frame["penetrations"] if fault["class"] in FAULTS]
        if not triangles and not faults:
            continue
        frames[first + round(frame["clip_frame"])] = {
            "pairs": triangles,
            "faults": [{"parts": fault["parts"], "swallowed": fault["swallowed"],
                        "triangles": [point["triangle"] for point in fault["deepest"]],
                        "points": [blender_axes(point["position"]) for point in fault["deepest"]]} for fault in faults],
        }
    return frames, {part["bone"]: part["name"] for part in played["parts"] if part["bone"]}


def blender_axes(point):
    """From glTF, whose y points up, to Blender, whose z does."""
    return (point[0], -point[2], point[1])


def hidden_triangles(path):
    """Reads `mask --as json`: numbers of the hidden triangles by mesh name."""
    with open(path, encoding="utf-8") as file:
        return {mesh["mesh"]: mesh["hidden"] for mesh in json.load(file)["meshes"]}


def hidden_vertices(triangles, hidden, count):
    """Vertices whose triangles are all hidden. `triangles` holds three vertices a row."""
    hidden = set(hidden)
    seen, gone = [False] * count, [False] * count
    for at, corners in enumerate(triangles):
        for vertex in corners:
            (gone if at in hidden else seen)[vertex] = True
    return [vertex for vertex in range(count) if gone[vertex] and not seen[vertex]]


def suffixed(name, suffix, limit=63):
    """A name that Blender can hold: at most 63 bytes, the suffix whole."""
    room = limit - len(suffix.encode())
    return name.encode()[:room].decode(errors="ignore") + suffix


def parts_of_bones(bones, parents, parts):
    """The body part of each bone: its own, or that of the nearest bone above it. The armature comes last and has no part."""
    found = []
    for bone, parent in zip(bones, parents):
        found.append(parts.get(bone, found[parent] if parent >= 0 else None))
    return found + [None]


def outcomes(path):
    """Reads `fix.json`: how many events came to which outcome, in words."""
    with open(path, encoding="utf-8") as file:
        events = [event["outcome"] for clip in json.load(file)["clips"] for event in clip["events"]]
    counts = [f"{events.count(outcome)} {outcome.replace('_', ' ')}" for outcome in dict.fromkeys(events)]
    return ", ".join(counts) or "no fault"


class Surface:
    """Which triangles share an edge. `triangles` holds three corners a row; corners at one place have one number."""

    def __init__(self, triangles):
        self.triangles, self.sharing = triangles, {}
        for at, corners in enumerate(triangles):
            for edge in edges(corners):
                self.sharing.setdefault(edge, []).append(at)

    def flood(self, start, inside, most):
        """Triangles that are joined with `start` over those that are `inside`; none if there are more than `most`."""
        found, ahead = {start}, [start]
        while ahead and len(found) <= most:
            for edge in edges(self.triangles[ahead.pop()]):
                for other in self.sharing[edge]:
                    if other not in found and inside(other):
                        found.add(other)
                        ahead.append(other)
        return found if len(found) <= most else set()


def edges(corners):
    a, b, c = corners
    return [(min(a, b), max(a, b)), (min(b, c), max(b, c)), (min(c, a), max(c, a))]


def swallowed_triangles(surface, part, found):
    """The skin that is inside: from the deepest points of each fault to the triangles that touch. `part` is by triangle.

    Where the line in which two parts cross does not close, the flood would run over the whole part, and is left out.
    """
    touching = {triangle for pair in found["pairs"] for triangle in pair}
    skin = set()
    for fault in found["faults"]:
        for place, start in enumerate(fault["triangles"]):
            own = sum(1 for name in part if name == part[start])
            share = min(1.0, 2 * fault["swallowed"] + 0.05) if place == 0 else 0.25
            skin |= surface.flood(start, lambda other: part[other] == part[start] and other not in touching, share * own)
    return skin - touching
