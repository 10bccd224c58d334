# SPDX-License-Identifier: MIT
"""The answers about one pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _native

_POINT = np.dtype([("position", "f4", 3), ("triangle", "u4"), ("weights", "f4", 3)])

#: Two body parts that intersect, as the C library has them: sc_penetration, and from "depth" on its sc_measures. Lengths
#: in the pose's units; a volume, thickness or extent below zero is not known.
PENETRATION = np.dtype([
    ("part", "u4"), ("other", "u4"), ("joint", "u4"), ("kind", "i4"), ("direction", "f4", 3),
    ("fault_depth", "f4"), ("distance", "f4"), ("centre", "f4", 3), ("low", "f4", 3), ("high", "f4", 3),
    ("deepest", _POINT), ("deepest_other", _POINT),
    ("depth", "f4"), ("volume", "f4"), ("contour_length", "f4"), ("visible", "f4"), ("touching", "f4"), ("facing", "f4"),
    ("rest_distance", "f4"), ("thickness", "f4"), ("extent", "f4"), ("height", "f4"), ("metre", "f4"),
    ("relation", "i4"), ("is_one_piece", "i4"), ("swallowed", "f4"), ("through", "i4"), ("reserved", "u4", 8)])

#: Two body parts whose skins intersect (sc_part_contact), and a box around the triangles that do.
PART_CONTACT = np.dtype([("part_a", "u4"), ("part_b", "u4"), ("triangle_pairs", "u4"), ("low", "f4", 3), ("high", "f4", 3)])

#: Two spheres whose triangles intersect; the same twice: within one.
SPHERE_PAIR = np.dtype([("a", "u4"), ("b", "u4")])

#: Two triangles that intersect (sc_triangle_contact), and the segment in which they cross.
TRIANGLE_PAIR = np.dtype([
    ("triangle_a", "u4"), ("triangle_b", "u4"), ("sphere_a", "u4"), ("sphere_b", "u4"), ("part_a", "u4"),
    ("part_b", "u4"), ("from", "f4", 3), ("to", "f4", 3)])

#: Two body parts that touch in a step (sc_step_contact). Times are shares of the step.
STEP = np.dtype([("part_a", "u4"), ("part_b", "u4"), ("at_start", "i4"), ("at_end", "i4"), ("begin", "f4"), ("end", "f4"),
                 ("triangle_a", "u4"), ("triangle_b", "u4"), ("at", "f4", 3)])

#: Where a joint is in its parent's space (sc_transform). The rotation is a quaternion, x, y, z, w, of about unit length;
#: scale 1 keeps the size.
TRANSFORM = np.dtype([("translation", "f4", 3), ("rotation", "f4", 4), ("scale", "f4", 3)])

#: Two spots that are to stay apart (sc_contact_row). If a joint at o turns by the small vector w, the gap grows by
#: w . cross(at - o, normal) if the joint moves `part`, and shrinks by w . cross(at_other - o, normal) if it moves `other`.
#: `body` 0: `other` is a part of the same character; k: of others[k - 1], or 2**32 - 1, the ground.
CONTACT_ROW = np.dtype([("part", "u4"), ("other", "u4"), ("body", "u4"), ("at", "f4", 3), ("at_other", "f4", 3),
                        ("normal", "f4", 3), ("gap", "f4"), ("allowed", "f4")])

assert _native.SIZES == tuple(d.itemsize for d in (
    PENETRATION, PART_CONTACT, SPHERE_PAIR, TRIANGLE_PAIR, STEP, TRANSFORM, CONTACT_ROW))

CLASSES = tuple(_native.CLASSES)
FAULTS = CLASSES[4:]
_NONE = 0xFFFFFFFF  # no joint; the ground in place of a part

#: The limits of classes (sc_rule), with the library's defaults. `Rule(touch_depth=0.003)`.
Rule = NamedTuple("Rule", [(name, float) for name in (  # type: ignore[misc]
    "touch_depth", "touch_metres", "touch_min", "touch_max", "touch_times", "extent", "at_rest", "hidden", "shell", "fold",
    "neighbours", "fold_depth", "loose_depth", "inside")])
Rule.__new__.__defaults__ = tuple(_native.Model.default_rule())


class Penetration(NamedTuple):
    """Two body parts that are in each other. Lengths in the pose's units, but depth_mm."""

    part: str  #: goes into `other`: the more mobile of the two, a hand in a thigh; of two alike the smaller
    other: str  #: "ground" where it is
    kind: str  #: one of CLASSES
    depth: float  #: the shortest way out
    depth_mm: float  #: the same in millimetres, by the model's metres_per_unit
    depth_percent: float  #: the same in % of the height
    fault_depth: float  #: how much deeper than the rule allows, less where little of it is seen; 0: not deeper
    distance: float  #: `part`, moved so far in `direction`, is free of `other`
    direction: NDArray[np.float32]  #: (3,), of unit length
    joint: Optional[int]  #: moves `part`, into Model.joints
    volume: Optional[float]  #: of the one part inside the other; None where it is not known, and without full=True
    visible: float  #: 0 to 1: the share of the line in which they cross that can be seen from outside
    swallowed: float  #: 0 to 1: the share of `part` that is inside `other`; 0 where it was not looked at
    through: bool  #: `part` is inside, and comes out again on the other side
    point: NDArray[np.float32]  #: (3,): the point of `part` that is deepest in `other`
    point_other: NDArray[np.float32]  #: (3,): point_other - point = distance * direction
    centre: NDArray[np.float32]  #: (3,): of the line in which they cross
    low: NDArray[np.float32]  #: (3,), with `high` a box around that line
    high: NDArray[np.float32]

    @property
    def is_fault(self) -> bool:
        """Whether a person would call it one: inside, a penetration or a deep fold."""
        return self.kind in FAULTS


class PartContact(NamedTuple):
    """Two body parts whose skins intersect; of one body their order says nothing."""

    part_a: str
    part_b: str
    triangle_pairs: int
    low: NDArray[np.float32]  #: (3,), with `high` a box around the triangles that intersect
    high: NDArray[np.float32]


class Step(NamedTuple):
    """Two body parts that touch on the way from one pose to the next."""

    part_a: str
    part_b: str
    at_start: bool  #: they intersect there
    at_end: bool
    begin: float  #: the first time at which they touch, a share of the step
    end: float  #: the last time; in between they may part and meet again
    at: NDArray[np.float32]  #: (3,): where they touch first; zero with at_start


class _List(Sequence):
    """Entries of one pose. `array` has them as the C library does, a structured array."""

    def __init__(self, array: np.ndarray, names: Tuple[Tuple[str, ...], Tuple[str, ...]]) -> None:
        self.array = array
        self._names = names  # of the parts of both bodies

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        return self._entry(self.array[index])

    def _entry(self, row):
        raise NotImplementedError


class Penetrations(_List):
    """The penetrations of one pose: the worst class first, then the deepest first. `total`: how many there are, where a
    limit lists fewer. `array`: dtype PENETRATION."""

    def __init__(self, array: np.ndarray, names: Tuple, total: int, mm_per_unit: float) -> None:
        super().__init__(array, names)
        self.total = total
        self._mm_per_unit = mm_per_unit

    def _entry(self, row) -> Penetration:
        return Penetration(
            self._names[0][row["part"]], "ground" if row["other"] == _NONE else self._names[1][row["other"]],
            CLASSES[row["kind"]], float(row["depth"]), float(row["depth"]) * self._mm_per_unit,
            100 * float(row["depth"] / row["height"]), float(row["fault_depth"]), float(row["distance"]),
            row["direction"], None if row["joint"] == _NONE else int(row["joint"]), float(row["volume"]) if row["volume"] >= 0 else None,
            float(row["visible"]), float(row["swallowed"]), bool(row["through"]), row["deepest"]["position"],
            row["deepest_other"]["position"], row["centre"], row["low"], row["high"])

    @property
    def is_fault(self) -> NDArray[np.bool_]:
        """Whether each is a fault: bool (penetrations,)."""
        return self.array["kind"] >= CLASSES.index(FAULTS[0])

    @property
    def depth_mm(self) -> float:
        """The deepest fault's depth in millimetres; 0 without one."""
        return float(self.array["depth"][self.is_fault].max(initial=0)) * self._mm_per_unit

    def __repr__(self) -> str:
        shown = ", ".join(f"{p.part} in {p.other} {p.depth_mm:.0f} mm ({p.kind})" for p in self[:3])
        return f"<{self.total} penetrations{': ' if shown else ''}{shown}{' ...' if self.total > 3 else ''}>"


class Contacts(_List):
    """The contacts of one pose, sorted by the parts' numbers. `array`: dtype PART_CONTACT. With full=True `spheres`
    (dtype SPHERE_PAIR) and `triangles` (dtype TRIANGLE_PAIR) list all that intersect; else they are None."""

    def __init__(self, array: np.ndarray, names: Tuple, spheres: Optional[np.ndarray],
                 triangles: Optional[np.ndarray]) -> None:
        super().__init__(array, names)
        self.spheres = spheres
        self.triangles = triangles

    def _entry(self, row) -> PartContact:
        return PartContact(self._names[0][row["part_a"]], self._names[1][row["part_b"]], int(row["triangle_pairs"]),
                           row["low"], row["high"])


class Steps(_List):
    """The touches of one step, sorted by the parts' numbers. `array`: dtype STEP."""

    def _entry(self, row) -> Step:
        return Step(self._names[0][row["part_a"]], self._names[1][row["part_b"]], bool(row["at_start"]),
                    bool(row["at_end"]), float(row["begin"]), float(row["end"]), row["at"])
