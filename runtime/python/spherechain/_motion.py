# SPDX-License-Identifier: MIT
"""Motions as palettes."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, List, NamedTuple, Optional, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from ._model import Model
from ._process import PathLike, Progress, run_tool

_BIND_TOLERANCE = 1e-3  # of the height


class Motion(NamedTuple):
    """The frames of one clip, or of all clips of a file one after another."""

    palettes: NDArray[np.float32]  #: (frames, joints, 3, 4): skinning matrices, in the order of Model.joints
    morph_weights: Optional[NDArray[np.float32]]  #: (frames, morphs); None where the model has no morph targets
    joints: Tuple[str, ...]  #: the names of Model.joints
    clips: Tuple[str, ...]  #: names of the clips; of a recording its file's name
    fps: float  #: frames a second, of the first clip
    clip: NDArray[np.int32]  #: (frames,): the number of the frame's clip, into `clips`
    frame: NDArray[np.float64]  #: (frames,): its number in its clip
    time: NDArray[np.float64]  #: (frames,): seconds from the start of its clip


def load_motion(model: Union[Model, PathLike], path: PathLike, clip: Optional[str] = None, *,
                source: Optional[PathLike] = None, fps: float = 30, respond: bool = False,
                tool: Optional[PathLike] = None, progress: Optional[Progress] = None) -> Motion:
    """Reads the palettes of a motion, carried over to the character. The tool does the work.

    model: a Model, or the path of a .sphc file. path: the character itself (its clips), a recording that `play --motion`
    takes (BVH, AMASS' .npz, another glTF), a pose file, or palettes that `play --palettes` wrote, which need no tool.
    clip: the name or number of one clip of the character; None: all. source: the character's file; None: `path` if that is
    it, else the file of the name Model.source_file beside the asset or beside `path`. fps: frames a second; near a clip's
    own rate, its own frames. respond: as the collision response corrects them. tool: as bake() takes it. progress: called
    with frames done and all frames, every ten seconds.

    ToolError: it says why. ValueError: the palettes are of another character.
    """
    asset = None if isinstance(model, Model) else Path(model)
    opened = model if isinstance(model, Model) else Model(model)
    if _is_palettes(path):
        return _read(opened, path, clip)
    if asset is None and opened._file is not None:
        asset = Path(opened._file)
    found = _source(opened, asset, Path(path)) if source is None else Path(source)
    with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        baked, palettes = Path(folder, "asset.sphc"), Path(folder, "palettes.npz")
        baked.write_bytes(opened._arguments[0])
        arguments = ["play", os.fspath(baked), "--source", os.fspath(found), "--palettes", os.fspath(palettes),
                     "--fps", repr(float(fps))]
        if os.path.exists(path) and os.path.samefile(path, found):
            arguments += [] if clip is None else ["--clip", clip]
        elif clip is not None:
            raise ValueError(f"clip: of the character's own clips alone, and {os.fspath(path)} is not {found}")
        else:
            arguments += ["--poses" if os.fspath(path).endswith(".json") else "--motion", os.fspath(path)]
        run_tool(arguments + ["--respond"] * respond, tool, progress=progress)
        motion = _read(opened, palettes, None)
        return motion if any(motion.clips) else motion._replace(clips=(Path(path).name,))


def _source(model: Model, asset: Optional[Path], path: Path) -> Path:
    name = model.source_file
    if path.name == name:
        return path
    for folder in ([] if asset is None else [asset.parent]) + [path.parent]:
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"{name}, which the asset was baked from, lies neither beside it nor beside {path}: "
                            "pass source=, the character's file")


def _is_palettes(path: PathLike) -> bool:
    if not os.fspath(path).endswith(".npz"):
        return False
    with np.load(path) as tables:
        return "palettes" in tables.files and "joints" in tables.files


def _read(model: Model, path: PathLike, clip: Optional[str]) -> Motion:
    with np.load(path) as file:
        tables = {name: file[name] for name in file.files}
    name, bones = os.fspath(path), len(model.bones)
    palettes = tables["palettes"]
    joints, binds = [str(joint) for joint in tables["joints"]], tables.get("inverse_bind")
    if joints != [bone.name for bone in model.bones] or palettes.ndim != 4 or palettes.shape[1] != bones:
        raise ValueError(f"{name}: has the palettes of {len(joints)} joints, {', '.join(joints[:3])} ..., which are not the "
                         f"bones of {model.source_file}")
    own = np.array([bone.inverse_bind for bone in model.bones])
    if binds is not None and not np.allclose(binds, own, atol=_BIND_TOLERANCE * model.height):
        raise ValueError(f"{name}: has the palettes of another character than {model.source_file}: its joints have these "
                         "names, but other inverse bind matrices")
    clips, number = [str(text) for text in tables["clips"]], tables["clip"]
    keep: Any = slice(None)
    if clip is not None:
        chosen = clips.index(clip) if clip in clips else int(clip) if clip.isdigit() and int(clip) < len(clips) else None
        if chosen is None:
            raise ValueError(f"{name}: has no clip {clip!r}: it has {', '.join(clips)}")
        keep, clips, number = number == chosen, [clips[chosen]], np.zeros_like(number)
    fps = tables["fps"][0 if clip is None else chosen]
    moved = np.ascontiguousarray(palettes[keep][:, :, :3], np.float32)
    if model._joint_of_bone is not None:
        by_bone = moved
        moved = np.tile(np.eye(3, 4, dtype=np.float32), (len(by_bone), len(model.joints) + 1, 1, 1))
        moved[:, model._joint_of_bone] = by_bone
        moved = np.ascontiguousarray(moved[:, :-1])
    return Motion(moved, tables["morph_weights"][keep] if model.morphs else None, model.joints, tuple(clips), float(fps),
                  number[keep], tables["frame"][keep], tables["time"][keep])
