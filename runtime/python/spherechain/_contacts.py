# SPDX-License-Identifier: MIT
"""What the skin's contacts of one pose are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _native

_POINT = np.dtype([("position", "f4", 3), ("triangle", "u4"), ("weights", "f4", 3)])

#: Two body parts that intersect, as the C library has them: sc_penetration, and from "depth" on its sc_measures. Lengths
#: in the pose's units; a volume, thickness or swallowed below zero is not known.
PENETRATION = np.dtype([
    ("part", "u4"), ("other", "u4"), ("bone", "i4"), ("kind", "i4"), ("direction", "f4", 3), ("distance", "f4"),
    ("centre", "f4", 3), ("low", "f4", 3), ("high", "f4", 3), ("deepest", _POINT), ("deepest_other", _POINT),
    ("depth", "f4"), ("volume", "f4"), ("contour_length", "f4"), ("visible", "f4"), ("touching", "f4"), ("facing", "f4"),
    ("rest_distance", "f4"), ("thickness", "f4"), ("swallowed", "f4"), ("height", "f4"), ("metre", "f4"),
    ("relation", "i4"), ("is_one_piece", "i4")])

#: Two triangles that intersect, as the C library has them (sc_triangle_contact), and the segment in which they cross.
TRIANGLE_PAIR = np.dtype([
    ("triangle_a", "u4"), ("triangle_b", "u4"), ("sphere_a", "u4"), ("sphere_b", "u4"), ("part_a", "u4"),
    ("part_b", "u4"), ("from", "f4", 3), ("to", "f4", 3)])

assert PENETRATION.itemsize == _native.PENETRATION_BYTES and TRIANGLE_PAIR.itemsize == _native.TRIANGLE_BYTES

KINDS = tuple(_native.class_name(kind) for kind in range(6))
FAULTS = KINDS[4:]


class Contact(NamedTuple):
    """Two body parts whose skins intersect. Lengths in the pose's units, but depth_mm."""

    part: str  #: goes into `other`: the more mobile of the two, a hand in a thigh; of two alike the smaller
    other: str
    kind: str  #: "rest", "shell", "touch", "fold", "deep_fold" or "penetration"
    depth: float  #: the shortest way out
    depth_mm: float  #: the same in millimetres, by the asset's metres_per_unit
    distance: float  #: `part`, moved so far in `direction`, is free of `other`
    direction: NDArray[np.float32]  #: (3,), of unit length
    volume: Optional[float]  #: of the one part inside the other; None where it is not known, and with quick=True
    visible: float  #: 0 to 1: the share of the line in which they cross that can be seen from outside
    point: NDArray[np.float32]  #: (3,): the point of `part` that is deepest in `other`
    point_other: NDArray[np.float32]  #: (3,): point_other - point = distance * direction
    centre: NDArray[np.float32]  #: (3,): of the line in which they cross
    low: NDArray[np.float32]  #: (3,), with `high` a box around that line
    high: NDArray[np.float32]

    @property
    def is_fault(self) -> bool:
        """Whether a person would call it one: a penetration or a deep fold."""
        return self.kind in FAULTS


class Contacts(Sequence):
    """The skin's contacts of one pose, a Contact for each two body parts; sorted by their places in Asset.parts.

    `array` has the same as a structured array of dtype PENETRATION. `triangles` has the pairs of triangles, dtype
    TRIANGLE_PAIR, where they were asked for; else None.
    """

    def __init__(self, array: np.ndarray, triangles: Optional[np.ndarray], part_names: Tuple[str, ...],
                 mm_per_unit: float) -> None:
        self.array = array
        self.triangles = triangles
        self._part_names = part_names
        self._mm_per_unit = mm_per_unit

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        row = self.array[index]
        return Contact(
            self._part_names[row["part"]], self._part_names[row["other"]], KINDS[row["kind"]], float(row["depth"]),
            float(row["depth"]) * self._mm_per_unit, float(row["distance"]), row["direction"],
            float(row["volume"]) if row["volume"] >= 0 else None, float(row["visible"]), row["deepest"]["position"],
            row["deepest_other"]["position"], row["centre"], row["low"], row["high"])

    @property
    def is_fault(self) -> NDArray[np.bool_]:
        """Of each contact: whether it is a penetration or a deep fold. (contacts,)"""
        return self.array["kind"] >= KINDS.index(FAULTS[0])

    @property
    def depth_mm(self) -> float:
        """The deepest fault's depth in millimetres; 0 without one."""
        return float(self.array["depth"][self.is_fault].max(initial=0)) * self._mm_per_unit

    def __repr__(self) -> str:
        deepest = sorted(self, key=lambda contact: -contact.depth)[:3]
        shown = ", ".join(f"{c.part} in {c.other} {c.depth_mm:.0f} mm ({c.kind})" for c in deepest)
        return f"<{len(self)} contacts{': ' if deepest else ''}{shown}{' ...' if len(self) > 3 else ''}>"
