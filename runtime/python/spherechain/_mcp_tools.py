# SPDX-License-Identifier: MIT
"""The tools that mcp.py offers to agents. Each runs the command line tool on files in the root folder."""

from __future__ import annotations

import base64
import contextlib
import json
import os
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from ._answers import FAULTS
from ._process import FAULTS_LEFT, LIBRARY_FAILS, TARGET_MISSED

if TYPE_CHECKING:
    from .mcp import Call

_TICKETS_MAX, _PICTURES_MAX, _EVENTS_MAX = 20, 3, 40
Picture = Tuple[str, str]  # its caption, and a PNG in base64
Result = Tuple[Dict[str, Any], List[Picture]]  # the structured content, and pictures


class Refused(Exception):
    """The call of an agent cannot be done; the text says why."""


class Tool(NamedTuple):
    name: str
    description: str
    properties: Dict[str, Dict[str, Any]]
    required: Sequence[str]
    output: Dict[str, Dict[str, Any]]
    run: Callable[["Call", Dict[str, Any]], Result]
    writes: bool

    def listed(self) -> Dict[str, Any]:
        return {"name": self.name, "description": self.description,
                "inputSchema": {"type": "object", "properties": self.properties, "required": list(self.required),
                                "additionalProperties": False},
                "outputSchema": {"type": "object", "properties": self.output, "required": list(self.output)},
                "annotations": {"readOnlyHint": not self.writes, "openWorldHint": False}}


def check_arguments(tool: Tool, arguments: Dict[str, Any]) -> None:
    """Compares with the input schema."""
    missing = [name for name in tool.required if name not in arguments]
    if missing:
        raise Refused(f"{missing[0]} is missing: {tool.properties[missing[0]]['description']}")
    for name, value in arguments.items():
        if name not in tool.properties:
            raise Refused(f"{tool.name} has no argument {name!r}: it has {', '.join(tool.properties)}")
        schema = tool.properties[name]
        items = value if schema["type"] == "array" and isinstance(value, list) else [value]
        kind = schema.get("items", schema)["type"]
        if (schema["type"] == "array") != isinstance(value, list) or not all(_is_of(kind, item) for item in items):
            raise Refused(f"{name} is {value!r}: pass {'a list of texts' if schema['type'] == 'array' else 'a ' + kind}")
        if value not in schema.get("enum", [value]):
            raise Refused(f"{name} is {value!r}: pass one of {', '.join(schema['enum'])}")


def _is_of(kind: str, value: Any) -> bool:
    if kind == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= 1e9
    return isinstance(value, bool if kind == "boolean" else str) and "\0" not in str(value)


def _inside(call: "Call", path: str) -> Path:
    """The path below the root, whatever links are on the way."""
    found = Path(os.path.realpath(call.root / path))
    if found != call.root and call.root not in found.parents:
        raise Refused(f"{path}: lies outside the server's root folder")
    return found


def _input(call: "Call", path: str) -> str:
    found = _inside(call, path)
    if not found.exists():
        raise Refused(f"{path}: there is no such file")
    # A manifest or a list may name files anywhere.
    if found.suffix.lower() in (".json", ".txt") and found.is_file():
        raise Refused(f"{path}: name the characters and recordings themselves")
    return os.fspath(found)


def _library(call: "Call", paths: List[str]) -> List[str]:
    if not paths:
        raise Refused("library: name a character or a folder")
    return [_input(call, path) for path in paths]


def _name(call: "Call", path: str) -> str:
    return Path(path).relative_to(call.root).as_posix()


@contextlib.contextmanager
def _output(call: "Call", arguments: Dict[str, Any]) -> Iterator[Tuple[Path, List[str]]]:
    """A folder to write into, and a list that gets the names of what was written there when it goes to its place."""
    target = _inside(call, arguments["output"])
    if target == call.root:
        raise Refused("output: name a file or a folder below the root folder")
    if not target.parent.is_dir():
        raise Refused(f"{arguments['output']}: there is no folder {target.parent.name}")
    _check_free(call, [target], arguments)
    written: List[str] = []
    with tempfile.TemporaryDirectory(prefix=".spherechain-", dir=target.parent) as folder:
        yield Path(folder, target.name), written
        found = sorted(Path(folder).iterdir())
        places = [target.parent / file.name for file in found]
        _check_free(call, places, arguments)
        if call.is_cancelled:
            raise Refused("cancelled")
        for file, place in zip(found, places):
            os.replace(file, place)
            written.append(_name(call, os.fspath(place)))


def _check_free(call: "Call", places: List[Path], arguments: Dict[str, Any]) -> None:
    for place in places:
        if os.path.lexists(place) and not arguments.get("overwrite", False):
            raise Refused(f"{_name(call, os.fspath(place))}: is there already. Name another file, or pass overwrite=true")
        if place.is_dir():
            raise Refused(f"{_name(call, os.fspath(place))}: is a folder, which is not replaced. Name another")


def _options(arguments: Dict[str, Any], **names: str) -> List[str]:
    """margin_mm="--margin" adds --margin=VALUE where the argument is there."""
    out: List[str] = []
    for name, option in names.items():
        value = arguments.get(name)
        if value is True:
            out.append(option)
        elif value not in (None, False):
            out.append(f"{option}={','.join(value) if isinstance(value, list) else value}")
    return out


def _motion(call: "Call", arguments: Dict[str, Any]) -> List[str]:
    return ["--motion", _input(call, arguments["motion"])] if "motion" in arguments else []


def _caption(row: Dict[str, Any], file: str) -> str:
    """Says what a picture of a clip shows. Only the name of a picture of a fault ends in a number."""
    name, number = f"{row['character']} {row['clip']}", re.search(r"_(\d+)\.png$", file)
    if number is None:
        return f"{name}, the first frame: no fault is marked" if row["events"] else f"{name}, no fault: the first frame"
    fault = next(event for event in row["events"] if event.get("picture") == int(number[1]))
    return f"{name}, frame {fault['deepest']:g}: {fault['text']}, {fault['class']}, {fault['depth_mm']:.1f} mm"


def _pictures(folder: Path, clip: Optional[str] = None) -> List[Picture]:
    """The pictures of a check's worst tickets, or of a clip; without a fault of the first frame."""
    text = (folder / "library.js").read_text(encoding="utf-8")
    report = json.loads(text[text.index("{"):text.rindex("}") + 1])
    rows = [row for row in report["rows"] if "picture" in row and clip in (None, row["clip"])]
    files = [ticket["picture"] for ticket in report["tickets"]] if clip is None else []
    files = list(dict.fromkeys(files or [row["picture"] for row in rows]))
    known = [file for file in files if (folder / file).is_file()][:_PICTURES_MAX]
    return [(_caption(next(row for row in rows if file.startswith(row["data"])), file),
             base64.b64encode((folder / file).read_bytes()).decode()) for file in known]


def _pictures_of(call: "Call", character: str, *options: str, clip: Optional[str] = None) -> List[Picture]:
    """Checks a character, and returns the pictures of that check: none if the character has no clip."""
    with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        call.run("check", character, "-o", folder, *options, fine=(LIBRARY_FAILS,))
        return _pictures(Path(folder), clip)


def _check(call: "Call", arguments: Dict[str, Any]) -> Result:
    library = _library(call, arguments["library"])
    options = _motion(call, arguments) + _options(arguments, max_depth_mm="--max-depth", fps="--fps", continuous="--continuous")

    def run(folder: Path) -> Result:
        with tempfile.TemporaryDirectory(prefix="spherechain-") as other:
            result = Path(other, "check.json")
            call.run("check", *library, *options, "-o", os.fspath(folder), "--json", os.fspath(result), fine=(LIBRARY_FAILS,))
            found = json.loads(result.read_text(encoding="utf-8"))
        tickets = [{**{key: ticket[key] for key in ("title", "character", "parts", "severity", "state")}, **ticket["worst"]}
                   for ticket in found["tickets"][:_TICKETS_MAX]]
        failed = [{"character": clip["character"], "clip": clip["clip"], "error": _without_paths(call, clip["error"])}
                  for clip in found["clips"] if "error" in clip]
        return {"fails": found["summary"]["fails"], "summary": found["summary"], "tickets": tickets,
                "not_checked": failed[:_EVENTS_MAX], "notes": found["notes"], "report": None}, _pictures(folder)

    if "output" not in arguments:
        with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
            return run(Path(folder))
    with _output(call, arguments) as (folder, written):
        structured, pictures = run(folder)
    return {**structured, "report": written[0]}, pictures


def _play(call: "Call", arguments: Dict[str, Any]) -> Result:
    character, motion = _input(call, arguments["character"]), _motion(call, arguments)
    fps = arguments.get("fps", 30)
    with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        asset, result = os.path.join(folder, "asset.sphc"), Path(folder, "play.json")
        call.run("bake", character, "-o", asset, fine=(TARGET_MISSED,))
        done = call.run("play", asset, "--source", character, *motion, "--json", os.fspath(result), f"--fps={fps}",
                        *_options(arguments, clip="--clip", respond="--respond", continuous="--continuous"))
        frames = json.loads(result.read_text(encoding="utf-8"))["frames"]
    faults: Dict[Tuple, Dict[str, Any]] = {}
    clips: Dict[str, Dict[str, Any]] = {}
    for frame in frames:
        name = frame.get("clip", Path(arguments.get("motion", "")).name)
        clip = clips.setdefault(name, {"clip": name, "fps": fps, "frames": 0, "faulty_frames": 0})
        found = [entry for entry in frame["penetrations"] if entry["class"] in FAULTS]
        clip["frames"] += 1
        clip["faulty_frames"] += bool(found)
        for entry in found:
            key, number = (name, *entry["parts"]), frame["clip_frame"]
            fault = faults.setdefault(key, {"clip": name, "parts": entry["parts"], "frames": 0, "first": number, "depth_mm": -1.0})
            fault["frames"] += 1
            fault["last"] = number
            if entry["depth_mm"] > fault["depth_mm"]:
                fault.update({"deepest_frame": number, **{key: entry[key] for key in ("class", "depth_mm", "direction", "swallowed")}})
    worst = sorted(faults.values(), key=lambda fault: (-FAULTS.index(fault["class"]), -fault["depth_mm"]))
    structured = {"clips": list(clips.values()), "faults": worst, "text": done.out.split("\n\n")[0]}
    if arguments.get("respond") or not (motion or any(clips)):
        return structured, []
    shown = next(iter(worst or clips.values()), {}).get("clip")
    return structured, _pictures_of(call, character, *motion, f"--fps={fps}", clip=shown)


def _fix(call: "Call", arguments: Dict[str, Any]) -> Result:
    character, motion = _input(call, arguments["character"]), _motion(call, arguments)
    options = _options(arguments, clip="--clip", budget_degrees="--budget", margin_mm="--margin", parts="--parts")
    with _output(call, arguments) as (output, written), tempfile.TemporaryDirectory(prefix="spherechain-") as report:
        done = call.run("fix", character, *motion, "-o", os.fspath(output), "--report", report, *options, fine=(FAULTS_LEFT,))
        found = json.loads(Path(report, "fix.json").read_text(encoding="utf-8"))
        mended = (character, "--motion", os.fspath(output)) if output.suffix.lower() == ".bvh" else (os.fspath(output),)
        pictures = [(f"{when}: {caption}", picture) for when, checked in (("before", (character, *motion)), ("after", mended))
                    for caption, picture in _pictures_of(call, *checked)[:1]]
    clips = [{**{key: clip.get(key) for key in ("clip", "turn_degrees", "new_faults")},
              "events": [{key: event.get(key) for key in ("parts", "from", "to", "deepest", "depth_mm_before", "depth_mm_after",
                                                          "turn_degrees", "outcome", "acting")}
                         for event in clip["events"][:_EVENTS_MAX]]}
             for clip in found["clips"]]
    return {"output": written[0], "is_clean": done.code == 0, "clips": clips}, pictures


def _mask(call: "Call", arguments: Dict[str, Any]) -> Result:
    character = _input(call, arguments["character"])
    motions = [text for path in arguments.get("motions", []) for text in ("--motion", _input(call, path))]
    options = _options(arguments, form="--as", margin_percent="--margin", random_poses="--random-poses")
    with _output(call, arguments) as (output, written):
        done = call.run("mask", character, "-o", os.fspath(output), *motions, *options)
        is_character = output.suffix.lower() in (".glb", ".vrm")
        pictures = _pictures_of(call, os.fspath(output) if is_character else character)[:1]
    hidden = re.search(r"hidden +(\d+) of (\d+) triangles .*?([\d.]+) % of the area", done.out)
    if hidden is None:
        raise Refused(done.out)
    return {"output": written[0], "hidden_triangles": int(hidden[1]), "triangles": int(hidden[2]),
            "hidden_area_percent": float(hidden[3]), "text": _without_paths(call, done.out)}, pictures


def _export(call: "Call", arguments: Dict[str, Any]) -> Result:
    character, motion = _input(call, arguments["character"]), _motion(call, arguments)
    with _output(call, arguments) as (output, written), tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        asset = os.path.join(folder, "asset.sphc")
        call.run("bake", character, "-o", asset, fine=(TARGET_MISSED,))
        done = call.run("export", asset, "--source", character, *motion, "--to", arguments["to"], "-o", os.fspath(output),
                        *_options(arguments, volumes="--volumes", at_most="--at-most"))
    return {"files": written, "text": _without_paths(call, done.out)}, []


def _score(call: "Call", arguments: Dict[str, Any]) -> Result:
    library = _library(call, arguments["library"])
    options = _motion(call, arguments) + _options(arguments, metrics="--metrics", fps="--fps", clip="--clip")
    with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        call.run("score", *library, *options, "-o", folder)
        found = json.loads(Path(folder, "score.json").read_text(encoding="utf-8"))
    pictures = [] if "clip" in arguments else _pictures_of(call, library[0], *library[1:], *_motion(call, arguments))
    clips = [{key: clip[key] for key in ("character", "clip", "frames", "fps", "metrics")} for clip in found["clips"]]
    return {"clips": clips, "failed": found["failed"]}, pictures


def _bake(call: "Call", arguments: Dict[str, Any]) -> Result:
    character = _input(call, arguments["character"])
    with _output(call, arguments) as (output, written), tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        report = Path(folder, "report.json")
        call.run("bake", character, "-o", os.fspath(output), "--report", os.fspath(report),
                 *_options(arguments, spheres="--spheres", body="--body"), fine=(TARGET_MISSED,))
        found = json.loads(report.read_text(encoding="utf-8"))
    return {"output": written[0], "spheres": found["counts"]["spheres"], "missed_targets": found["missed_targets"]}, []


def _without_paths(call: "Call", text: str) -> str:
    return "\n".join(line for line in text.splitlines() if not line.startswith("wrote ")).replace(f"{call.root}{os.sep}", "")


_TEXT, _NUMBER, _BOOLEAN, _OBJECT = ({"type": kind} for kind in ("string", "number", "boolean", "object"))
_TEXTS, _OBJECTS = ({"type": "array", "items": kind} for kind in (_TEXT, _OBJECT))
_CHARACTER = {"character": {**_TEXT, "description": "a rigged character: glTF, FBX, Collada ..."}}
_LIBRARY = {"library": {**_TEXTS, "description": "characters: files and folders"}}
_MOTION = {"motion": {**_TEXT, "description": "a recording (BVH, FBX, glTF, AMASS .npz) in place of the character's own clips"}}
_CLIP = {"clip": {**_TEXT, "description": "one of the character's clips: its name or number"}}
_FPS = {"fps": {**_NUMBER, "description": "frames a second"}}
_CONTINUOUS = {"continuous": {**_BOOLEAN, "description": "look between frames, too"}}


def _output_of(description: str) -> Dict[str, Dict[str, Any]]:
    return {"output": {**_TEXT, "description": description},
            "overwrite": {**_BOOLEAN, "description": "replace what is there (default: refuse)"}}


TOOLS = {tool.name: tool for tool in (
    Tool("check", "Says which clips of characters are broken: body parts inside each other, the worst first, with pictures "
         "of the worst.",
         {**_LIBRARY, **_MOTION, **_FPS, **_CONTINUOUS,
          "max_depth_mm": {**_NUMBER, "description": "up to this depth any fault is fine"},
          **_output_of("folder for a report to open in a browser")},
         ("library",), {"fails": _BOOLEAN, "summary": _OBJECT, "tickets": _OBJECTS, "not_checked": _OBJECTS,
                        "notes": {"type": "array"}, "report": {"type": ["string", "null"]}}, _check, True),
    Tool("play", "Says which body parts penetrate in a motion, in which frames, how deep and which way out, with a picture "
         "of the worst.",
         {**_CHARACTER, **_MOTION, **_CLIP, **_FPS, **_CONTINUOUS,
          "respond": {**_BOOLEAN, "description": "play through the collision response of a game"}},
         ("character",), {"clips": _OBJECTS, "faults": _OBJECTS, "text": _TEXT}, _play, False),
    Tool("fix", "Writes a mended copy of a character, or of a recording: joints turn until body parts leave each other. "
         "Pictures: before, after.",
         {**_CHARACTER, **_MOTION, **_CLIP, "budget_degrees": {**_NUMBER, "description": "turn no joint farther (25)"},
          "margin_mm": {**_NUMBER, "description": "distance between parts that were pushed apart (1.5)"},
          "parts": {**_TEXTS, "description": "mend only faults of these body parts"},
          **_output_of("file to write: .glb, .fbx of an FBX, .bvh of a BVH")},
         ("character", "output"), {"output": _TEXT, "is_clean": _BOOLEAN, "clips": _OBJECTS}, _fix, True),
    Tool("mask", "Hides the skin below clothes that no clip shows, and writes the character without it.",
         {**_CHARACTER, "motions": {**_TEXTS, "description": "recordings to look at, too"},
          "form": {**_TEXT, "enum": ["triangles", "vertex-colour", "attribute", "json"], "description": "what is written (triangles)"},
          "margin_percent": {**_NUMBER, "description": "keep skin so near to skin that is seen, % of the height (0.3)"},
          "random_poses": {**_NUMBER, "description": "look at so many random poses, too"},
          **_output_of("file to write: .glb, .vrm; with form json .json")},
         ("character", "output"), {"output": _TEXT, "hidden_triangles": _NUMBER, "triangles": _NUMBER,
                                   "hidden_area_percent": _NUMBER, "text": _TEXT}, _mask, True),
    Tool("export", "Writes a character's body parts as colliders for an engine or a simulator. MJCF and URDF get a CSV file with the "
         "joint angles of each clip.",
         {**_CHARACTER, **_MOTION, "to": {**_TEXT, "description": "format", "enum": [
             "capsules.json", "vrm", "khr", "omi", "mjcf", "urdf", "xrdf", "curobo", "usd", "godot", "unity", "unreal"]},
          "volumes": {**_TEXT, "description": "shape (the best that the format holds)",
                      "enum": ["spheres", "cones", "capsules", "ellipsoids", "boxes"]},
          "at_most": {**_NUMBER, "description": "volumes in all"}, **_output_of("file to write, with an ending of the format")},
         ("character", "to", "output"), {"files": _TEXTS, "text": _TEXT}, _export, True),
    Tool("score", "Measures clips: exact shares of faulty frames, depths and volumes, and the numbers that papers print.",
         {**_LIBRARY, **_MOTION, **_CLIP, **_FPS, "metrics": {**_TEXTS, "description": "measure these alone"}},
         ("library",), {"clips": _OBJECTS, "failed": {"type": "array"}}, _score, False),
    Tool("bake", "Turns a character into an asset for the runtime.",
         {**_CHARACTER, "spheres": {**_NUMBER, "description": "at most so many spheres"},
          "body": {**_TEXT, "enum": ["biped", "quadruped", "auto"], "description": "what to look for"},
          **_output_of("asset to write (.sphc)")},
         ("character", "output"), {"output": _TEXT, "spheres": _NUMBER, "missed_targets": {"type": "array"}}, _bake, True))}
