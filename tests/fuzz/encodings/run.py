#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Encodes the box man in legal ways drawn at random, and compares what the tool says with what is right.

    run.py --tool build/release/bin/spherechain --cases 2000 --seed 1 [--format gltf] [--keep FOLDER] [--jobs 2]

Each case has the seed after that of the one before it. A case that fails is printed with the command that repeats it.
An error of the tool that names the file is a skip; so is a wrong answer of which the tool says that it is guessed. Skips
are counted and printed. Ends with 1 where a case fails.
"""
import argparse
import collections
import concurrent.futures
import importlib
import json
import multiprocessing
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import traceback

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import man  # noqa: E402
from draw import Draw  # noqa: E402
from oracle import NEIGHBOURS, Truth  # noqa: E402
from vary import vary  # noqa: E402

FORMATS = {"gltf": 10, "fbx": 6, "collada": 4, "bvh": 3, "ogre": 2, "x": 2}

SPHERES = ["--spheres", "20"]  # contacts are the skin's; few spheres bake fast


class Skip(Exception):
    pass


class Wrong(Exception):
    pass


def check_scene(scene, plain):
    """The variations keep the motion: one map takes the plain man to the varied one, in all frames."""
    maps = []
    for frame in (0, 5, 12):
        a = plain.skinned(plain.animations[0], frame / man.FPS)[0]
        b = scene.skinned(scene.animations[0], frame / man.FPS)
        origin = np.concatenate([m.origin for m in scene.meshes])
        used = origin >= 0
        b = np.vstack(b)[used]
        h = np.column_stack([a[origin[used]], np.ones(used.sum())])
        fit, _, _, _ = np.linalg.lstsq(h, b, rcond=None)
        size = np.linalg.norm(fit[:3]) / np.sqrt(3)
        error = np.abs(h @ fit - b).max() / size
        # Times may be rounded to a ten-thousandth of a second.
        if error > 2e-3:
            raise AssertionError(f"the generator moved the man by {error:.5f} m in frame {frame}")
        maps.append(fit / size)
    if max(np.abs(m - maps[0]).max() for m in maps) > 5e-3:
        raise AssertionError("the generator moved the man")


def tool(arguments, *rest):
    command = [arguments.tool, *map(str, rest)]
    run = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=120)
    if run.returncode == 3 and run.stderr.startswith("spherechain: error: ") and run.stderr.count("\n") == 1:
        raise Skip(run.stderr.strip())
    if run.returncode != 0:
        raise Wrong(f"{rest[0]} ends with {run.returncode}: {run.stderr.strip()[-300:]}")
    return run


def ask(arguments, case, folder):
    """What the tool says about a character that moves: frames, contacts, parts, height."""
    asset, out = folder / "man.sphc", folder / "play.json"
    motion, guess = [], None
    if "motion" in case:
        plain = pathlib.Path(arguments.work)
        case["character"], asset, motion = plain / "man.glb", plain / "man.sphc", ["--motion", case["motion"]]
    else:
        bake = tool(arguments, "bake", case["character"], "-o", asset, *SPHERES)
        guess = next((line for line in bake.stderr.splitlines() if " guessed from " in line), None)
    said = json.loads(tool(arguments, "inspect", asset, "--json").stdout)
    tool(arguments, "play", asset, "--source", case["character"], "--json", out, *motion)
    return said, json.loads(out.read_text()), guess


def compare(truth, case, said, played):
    """Sentences about all that is not as it should be."""
    wrong = []
    parts = sorted(p["name"] for p in said["parts"] if p["triangles"])
    if parts != truth.parts:
        lost, added = sorted(set(truth.parts) - set(parts)), sorted(set(parts) - set(truth.parts))
        wrong.append(f"parts: lost {lost}, added {added}")
    frames = played["frames"]
    if len(frames) != case.get("frames", man.FRAMES):
        wrong.append(f"{len(frames)} frames, should be {case.get('frames', man.FRAMES)}")
    lost, added = collections.Counter(), collections.Counter()
    for frame in range(min(len(frames), man.FRAMES)):
        pairs = frames[frame]["skin"]["parts"]
        found = {frozenset((p["a"], p["b"])): p["triangle_pairs"] for p in pairs}
        found = {pair: n for pair, n in found.items() if len(pair) == 2 and pair not in NEIGHBOURS}
        lost.update(pair for pair in truth.must[frame] if pair not in found)
        added.update(pair for pair in found if pair not in truth.may[frame])
    if parts == truth.parts:
        for name, counter in (("lost", lost), ("added", added)):
            for pair, count in sorted(counter.items(), key=lambda e: sorted(e[0])):
                wrong.append(f"{name} {' + '.join(sorted(pair))} in {count} frames")
    elif sum(lost.values()) + sum(added.values()):
        wrong.append("contacts of other parts")
    height = said["frame"]["height"] * said["source"]["metres_per_unit"]
    if not abs(height / case["height"] - 1) < 0.01:
        wrong.append(f"height {height:.4f} m, should be {case['height']:.4f}")
    return wrong


def case_of(seed, arguments, folder, without):
    draw = Draw(seed, without, arguments.only)
    names = [f for f, weight in FORMATS.items() for _ in range(weight)]
    form = arguments.format or random.Random(f"{seed} format").choice(names)
    writer = importlib.import_module("write_" + form)
    scene = man.man()
    case = {"height": man.HEIGHT}
    if form == "bvh":
        case["motion"] = writer.write(scene, folder, draw)
    else:
        vary(scene, draw, writer.FORM)
        check_scene(scene, man.man())
        case["character"] = writer.write(scene, folder, draw)
        case["height"] *= getattr(scene, "height_factor", 1)
    return form, draw, case


def plain_man(arguments):
    """The character that recordings move: plain glTF, baked once."""
    work = pathlib.Path(arguments.work)
    importlib.import_module("write_gltf").write(man.man(), work, Draw(0, only=()))
    tool(arguments, "bake", work / "man.glb", "-o", work / "man.sphc", *SPHERES)


truth = None  # made before the processes, which inherit it


def run_case(seed, arguments, without=()):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="encoding"))
    form, draw = "", None
    try:
        form, draw, case = case_of(seed, arguments, folder, without)
        said, played, guess = ask(arguments, case, folder)
        wrong = compare(truth, case, said, played)
        outcome, text = ("failed", "; ".join(wrong)) if wrong else ("passed", "")
        if wrong and guess:
            raise Skip(guess)
    except Skip as skip:
        outcome, text = "skipped", str(skip).replace(str(folder) + "/", "")
    except Wrong as wrong:
        outcome, text = "failed", str(wrong).replace(str(folder) + "/", "")
    except subprocess.TimeoutExpired as late:
        outcome, text = "failed", f"does not end in {late.timeout} s"
    except Exception:
        outcome, text = "failed", "generator: " + traceback.format_exc()
    if arguments.keep and outcome != "passed":
        kept = pathlib.Path(arguments.keep) / f"{form}_{seed}"
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(folder, kept)
    shutil.rmtree(folder)
    return seed, form, outcome, text, draw.described() if draw else "", draw.taken if draw else []


def smaller(seed, arguments, taken, outcome, text):
    """The choices without which the case does not fail in the same way."""
    without = set(arguments.without)
    kind = text.split(" ")[0]
    for name in taken:
        again = run_case(seed, arguments, without | {name})
        if again[2] == outcome and again[3].split(" ")[0] == kind:
            without.add(name)
    return run_case(seed, arguments, without), sorted(without)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", required=True)
    parser.add_argument("--cases", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--format", help="one of " + ", ".join(FORMATS))
    parser.add_argument("--keep", help="a folder for the files of cases that fail or are skipped")
    parser.add_argument("--without", default="", help="choices to leave out, with commas between them")
    parser.add_argument("--only", help="choices to take, and no others")
    parser.add_argument("--smaller", action="store_true", help="leave out all choices that do not matter")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    arguments.tool = str(pathlib.Path(arguments.tool).resolve())
    arguments.without = [n for n in arguments.without.split(",") if n]
    global truth
    truth = Truth()
    with tempfile.TemporaryDirectory(prefix="encodings") as arguments.work:
        plain_man(arguments)
        return run(arguments)


def run(arguments):
    arguments.only = arguments.only.split(",") if arguments.only is not None else None
    counted = collections.Counter()
    seeds = range(arguments.seed, arguments.seed + arguments.cases)
    with concurrent.futures.ProcessPoolExecutor(arguments.jobs, multiprocessing.get_context("fork")) as pool:
        for result in pool.map(run_case, seeds, [arguments] * len(seeds), [arguments.without] * len(seeds)):
            seed, form, outcome, text, described, taken = result
            counted[outcome] += 1
            counted[f"{form} {outcome}"] += 1
            if outcome == "passed":
                continue
            without = arguments.without
            if arguments.smaller:
                (_, _, _, text, described, _), without = smaller(seed, arguments, taken, outcome, text)
            said = f" --without '{','.join(without)}'" if without else ""
            said += f" --only '{','.join(arguments.only)}'" if arguments.only is not None else ""
            said += f" --format {arguments.format}" if arguments.format else ""
            print(f"{outcome}: {form}: {text}\n  drawn: {described}\n  again: {sys.argv[0]} --tool {arguments.tool} "
                  f"--cases 1 --seed {seed}{said}", flush=True)
    for form in FORMATS:
        print(f"{form}: " + ", ".join(f"{counted[f'{form} {o}']} {o}" for o in ("passed", "failed", "skipped")))
    print(f"{counted['passed']} passed, {counted['failed']} failed, {counted['skipped']} skipped")
    return 1 if counted["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
