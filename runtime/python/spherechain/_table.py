# SPDX-License-Identifier: MIT
"""Contacts and penetrations of many frames as columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional

import numpy as np

from ._answers import _NONE, CLASSES, FAULTS, PART_CONTACT, PENETRATION

if TYPE_CHECKING:
    from ._model import Model

_POSES = 64  # at a time; progress is reported after each such batch
# The options that choose which contacts are rows. The others change penetrations alone, or what a table does not show.
_CONTACT_OPTIONS = ("scope", "ignored_spheres", "ignored_parts", "ignored_parts_of_other", "part_pairs", "other")


def table(model: "Model", poses: Any, contacts: bool, progress: Any, threads: int, query: Dict[str, Any]) -> Dict[str, np.ndarray]:
    """Model.table()."""
    from ._model import Posed
    from ._motion import Motion
    motion = poses if isinstance(poses, Motion) else None
    palettes = np.asarray(poses.palettes if motion else poses)
    if palettes.ndim != 4:
        raise ValueError(f"poses has the shape {palettes.shape}: pass (frames, joints, 3, 4), or what load_motion() gave")
    unknown = set(query) - set(_CONTACT_OPTIONS)
    if contacts and unknown:
        raise TypeError(f"{min(unknown)} is no option of a table of contacts: {', '.join(_CONTACT_OPTIONS)}")
    morphs = motion.morph_weights if motion else None
    other = query.get("other")
    ask = model.contacts if contacts else model.penetrations
    found: List[Any] = []
    for start in range(0, len(palettes), _POSES):
        some = slice(start, start + _POSES if start + _POSES < len(palettes) else None)
        if motion and not contacts:
            _follow(model, motion, some, found, query)
        else:
            if isinstance(other, Posed):
                query["other"] = Posed(other.model, *(None if of is None else of[some] for of in other[1:]))
            found += ask(palettes[some], morph_weights=None if morphs is None else morphs[some], threads=threads, **query)
        if progress:
            progress(len(found), len(palettes))
    rows = np.repeat(np.arange(len(found)), [len(of) for of in found])
    entries = np.concatenate([np.zeros(0, PART_CONTACT if contacts else PENETRATION), *(of.array for of in found)])
    out: Dict[str, np.ndarray] = {}
    if motion:
        out["clip"] = np.array(motion.clips)[motion.clip[rows]]
        out["frame"], out["time"] = motion.frame[rows], motion.time[rows]
        if (out["frame"] == np.round(out["frame"])).all():
            out["frame"] = out["frame"].astype(np.int64)
    else:
        out["frame"] = rows
    names = np.array([part.name for part in model.parts], object)
    others = names if other is None else np.array([part.name for part in other.model.parts], object)
    return {**out, **(_contacts if contacts else _penetrations)(model, entries, names, others)}


def _follow(model: "Model", motion: Any, some: slice, found: List[Any], query: Dict[str, Any]) -> None:
    """Appends the penetrations of these frames, each with those of the frame before, as `play` does."""
    for i in range(*some.indices(len(motion.clip))):
        is_next = i > 0 and motion.clip[i] == motion.clip[i - 1]
        morphs = None if motion.morph_weights is None else motion.morph_weights[i]
        found.append(model.penetrations(motion.palettes[i], morph_weights=morphs, previous=found[-1] if is_next else None,
                                        **query))


def _texts(names: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    return names[numbers].astype(str)


def _contacts(model: "Model", entries: np.ndarray, names: np.ndarray, others: np.ndarray) -> Dict[str, np.ndarray]:
    out = {"part": _texts(names, entries["part_a"]), "other": _texts(others, entries["part_b"]),
           "triangle_pairs": entries["triangle_pairs"].astype(np.int64)}
    for name in ("low", "high"):
        _put_vector(out, name, entries[name])
    return out


def _penetrations(model: "Model", entries: np.ndarray, names: np.ndarray, others: np.ndarray) -> Dict[str, np.ndarray]:
    millimetres = model.millimetres(1.0)
    joints = np.array([*model.joints, ""], object)
    volumes = entries["volume"].astype(float)
    out = {"part": _texts(names, entries["part"]), "other": _texts(others, entries["other"]),
           "kind": _texts(np.array(CLASSES, object), entries["kind"]),
           "is_fault": entries["kind"] >= CLASSES.index(FAULTS[0]),
           "depth_mm": millimetres * entries["depth"].astype(float),
           "depth_percent": 100 * (entries["depth"] / entries["height"]).astype(float),
           "fault_depth_mm": millimetres * entries["fault_depth"].astype(float),
           "distance_mm": millimetres * entries["distance"].astype(float)}
    _put_vector(out, "direction", entries["direction"])
    _put_vector(out, "point", entries["deepest"]["position"])
    _put_vector(out, "point_other", entries["deepest_other"]["position"])
    out["joint"] = _texts(joints, np.where(entries["joint"] == _NONE, len(model.joints), entries["joint"]))
    out["volume_ml"] = np.where(volumes < 0, np.nan, volumes * (millimetres / 10) ** 3)
    out["visible"], out["swallowed"] = entries["visible"].astype(float), entries["swallowed"].astype(float)
    out["through"] = entries["through"] != 0
    return out


def _put_vector(out: Dict[str, np.ndarray], name: str, vectors: np.ndarray) -> None:
    for axis, letter in enumerate("xyz"):
        out[f"{name}_{letter}"] = vectors[:, axis].astype(float)
