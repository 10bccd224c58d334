# SPDX-License-Identifier: MIT
"""A baked character, and what can be asked about its poses."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._contacts import FAULTS, KINDS, PENETRATION, TRIANGLE_PAIR, Contacts

_RADII = {"detect": 0, "fit": 1}
_SCOPES = {"apart": 0, "neighbours": 1, "all": 2}
_SIDES = ("", "left", "right")


class Bone(NamedTuple):
    """What moves the character. A matrix of a pose is the bone's world matrix times its inverse bind matrix."""

    name: str  #: empty: no bone, it stands for what none moves; give it the identity, or the character's own matrix
    inverse_bind: NDArray[np.float32]  #: (3, 4): from the rest pose to the bone's space


class Part(NamedTuple):
    """A part of the body as people call it."""

    name: str  #: "right hand"
    side: str  #: "left", "right" or ""
    bone: Optional[int]  #: the bone that it follows, into Asset.bones
    parent: Optional[int]  #: the part that it hangs on, into Asset.parts


class Asset:
    """A character that `bake` made.

    Its methods take one pose or a batch: arrays with any number of axes before those named. `bones` are skinning matrices,
    the world matrix of each bone times its inverse bind matrix, in the order of Asset.bones: (..., bones, 3, 4), or
    (..., bones, 4, 4), whose last rows only check_rest() reads. Lengths are in the pose's units: as in the character's
    file, for glTF metres. Arrays that lie well in memory are not copied. Other threads of Python run in the meantime; `threads` is
    for the batch, 0: as many as cores. Ctrl-C ends a batch after the poses that are being computed.

    Any number of threads may use one asset. It can be pickled.
    """

    def __init__(self, source: Union[str, "os.PathLike[str]", bytes]) -> None:
        """Opens a .sphc file, by its path or its bytes.

        OSError: it cannot be read. ValueError: it is no asset, is damaged, or of another version.
        """
        if isinstance(source, (bytes, bytearray, memoryview)):
            name, data = "asset", bytes(source)
        elif isinstance(source, (str, os.PathLike)):
            name = os.fspath(source)
            with open(source, "rb") as file:
                data = file.read()
        else:
            raise TypeError(f"Asset takes a path or bytes, not {type(source).__name__}")
        try:
            self._native = _native.Asset(data)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
        info = self._native.info()
        self.bones: Tuple[Bone, ...] = tuple(Bone(*bone) for bone in info["bones"])
        self.parts: Tuple[Part, ...] = tuple(
            Part(part, _SIDES[side], None if bone < 0 else bone, None if parent < 0 else parent)
            for part, side, bone, parent in info["parts"])
        self.morphs: Tuple[str, ...] = tuple(info["morphs"])  #: names of the morph targets
        rest = np.array(info["spheres"], np.float32).reshape(-1, 5)
        self.rest_spheres: NDArray[np.float32] = rest[:, [0, 1, 2, 4]]  #: (spheres, 4): at rest, with the detect radius
        self.sphere_count: int = info["sphere_count"]
        self.vertex_count: int = info["vertex_count"]  #: of the source
        self.triangle_count: int = info["triangle_count"]  #: of the source
        self.height: float = info["height"]
        self.metres_per_unit: float = info["metres_per_unit"]
        self.left: Tuple[float, float, float] = info["left"]  #: the character's own axes, of unit length
        self.up: Tuple[float, float, float] = info["up"]
        self.forward: Tuple[float, float, float] = info["forward"]
        self.source_file: str = info["source_file"]
        self.settings: str = info["settings"]  #: of the bake, as JSON
        self._part_names = tuple(part.name for part in self.parts)
        self._is_open = True

    def __setattr__(self, name: str, value: Any) -> None:
        if getattr(self, "_is_open", False):
            raise AttributeError(f"{name} cannot be set: an asset does not change")
        super().__setattr__(name, value)

    def __reduce__(self):
        return Asset, (self._native.bytes(),)

    def __repr__(self) -> str:
        return (f"<Asset of {self.source_file}: {self.sphere_count} spheres, {len(self.bones)} bones, "
                f"{len(self.parts)} parts>")

    def check_rest(self, bones: NDArray[np.float32]) -> None:
        """Checks that your matrices are skinning matrices of this character: for the first run.

        bones: float32 (..., bones, 3, 4), what you have while the character stands in its bind pose. There every bone's
        matrix is the same, the model's own. ValueError names the first bone whose matrix moves the character otherwise, by
        more than a thousandth of its height: inverse bind matrices are missing, or the rest pose is another. Stand the
        character off the origin and pass (..., bones, 4, 4), so that transposed matrices show. A wrong order never shows.
        """
        poses, _ = self._poses(bones)
        rows = np.asarray(bones)[..., 3:, :].reshape(-1, 4)
        for row in rows[(np.abs(rows - (0, 0, 0, 1)) > 1e-3).any(axis=1)][:1]:
            raise ValueError(f"bones: a last row is {row}, not [0 0 0 1]. Are the matrices transposed?")
        self._native.check_rest(poses)

    def spheres(self, bones: NDArray[np.float32], *, radius: str = "detect", threads: int = 1) -> NDArray[np.float32]:
        """Where the spheres are: x, y, z and radius of each.

        bones: float32 (..., bones, 3, 4). Returns float32 (..., spheres, 4). radius: "detect" or "fit".
        """
        poses, batch = self._poses(bones)
        out = self._native.spheres(poses, _choice("radius", radius, _RADII), _count("threads", threads))
        return out.reshape(*batch, self.sphere_count, 4)

    def pairs(self, bones: NDArray[np.float32], *, radius: str = "detect", threads: int = 1) -> Any:
        """Which spheres touch. A cheap alarm: the skin's answer is contacts().

        bones: float32 (..., bones, 3, 4). Returns uint32 (pairs, 2), each row a < b, sorted; of a batch a list of these for
        its axis, lists of lists for several axes.
        """
        poses, batch = self._poses(bones)
        entries, first = self._native.pairs(poses, _choice("radius", radius, _RADII), _count("threads", threads))
        return _nested(_runs(entries.view(np.uint32).reshape(-1, 2), first), batch)

    def contacts(self, bones: Optional[NDArray[np.float32]] = None, *, vertices: Optional[NDArray[np.float32]] = None,
                 morph_weights: Optional[NDArray[np.float32]] = None, scope: str = "apart", quick: bool = False,
                 triangles: bool = False, threads: int = 1) -> Any:
        """Where the skin intersects itself, exactly: body parts, depth, way out and kind.

        bones: float32 (..., bones, 3, 4); or vertices: float32 (..., vertices, 3), the deformed vertices in the order of the
        source's file. morph_weights: float32 (..., morphs), with bones. scope: "apart", or with neighbours on the body
        "all", or those alone "neighbours". quick: measure likely faults alone in full, all else along one direction; no
        volumes; for every frame of a game. triangles: list the pairs of triangles, too.

        Returns Contacts; of a batch a list of these for its axis, lists of lists for several axes.
        """
        arguments, batch = self._contact_arguments(bones, vertices, morph_weights, scope, quick)
        entries, first, pairs, pairs_first = self._native.contacts(*arguments, bool(triangles), _count("threads", threads))
        runs = _runs(entries.view(PENETRATION), first)
        pair_runs = _runs(pairs.view(TRIANGLE_PAIR), pairs_first) if triangles else [None] * len(runs)
        scale = self.metres_per_unit * 1000
        return _nested([Contacts(run, pair_run, self._part_names, scale) for run, pair_run in zip(runs, pair_runs)],
                       batch)

    def sphere_energy(self, bones: np.ndarray, *, radius: str = "detect", threads: int = 1) -> Tuple[Any, np.ndarray]:
        """How much spheres overlap, and the gradient by the bones' matrices: a smooth loss.

        The energy is the sum of (reach - distance)^2 over the pairs that pairs() reports. The reach is the sum of the two
        radii; of a rest pair, which is close at rest, that times the pair's rest_scale. The radii follow the bones, too.

        bones: float32 or float64 (..., bones, 3, 4). Returns the energy (...), in squared units of the pose, and the gradient
        (..., bones, 3, 4), of the type of `bones`. float64 is for checks: slower, all pairs are tested.
        """
        poses, batch = self._poses(bones, _BOTH)
        energy, gradient = self._native.sphere_energy(poses, _choice("radius", radius, _RADII),
                                                      _count("threads", threads))
        return energy.reshape(batch)[()], gradient.reshape(*batch, len(self.bones), 3, 4)

    def pair_scales(self, *, radius: str = "detect") -> NDArray[np.float32]:
        """What a pair's sum of radii is multiplied by before it is compared: for a loss of your own, on a GPU say.

        Returns float32 (spheres, spheres), symmetric: 0 where the pair is ignored, a rest pair's rest_scale, else 1.
        """
        return self._native.pair_scales(_choice("radius", radius, _RADII))

    def pair_energy(self, spheres: np.ndarray, *, radius: str = "detect", threads: int = 1) -> Tuple[Any, np.ndarray]:
        """sphere_energy() of spheres from elsewhere, and its gradient by them.

        spheres: float32 or float64 (..., spheres, 4), x, y, z and radius. Returns the energy (...) and the gradient
        (..., spheres, 4). radius: which of the asset's rest pairs count.
        """
        array = self._array("spheres", spheres, _BOTH, (self.sphere_count, 4))
        flat = np.ascontiguousarray(array.reshape(-1, self.sphere_count, 4))
        energy, gradient = self._native.pair_energy(flat, _choice("radius", radius, _RADII), _count("threads", threads))
        return energy.reshape(array.shape[:-2])[()], gradient.reshape(array.shape)

    def spheres_vjp(self, bones: np.ndarray, gradient: np.ndarray, *, radius: str = "detect",
                    threads: int = 1) -> np.ndarray:
        """The chain rule through spheres(), for a loss of your own: its gradient by the spheres becomes that by the bones.

        bones: float32 or float64 (..., bones, 3, 4). gradient: of the same type, (..., spheres, 4). Returns
        (..., bones, 3, 4).
        """
        poses, batch = self._poses(bones, _BOTH)
        slopes = self._array("gradient", gradient, (poses.dtype,), (*batch, self.sphere_count, 4), exact=True)
        out = self._native.spheres_vjp(poses, np.ascontiguousarray(slopes.reshape(len(poses), self.sphere_count, 4)),
                                       _choice("radius", radius, _RADII), _count("threads", threads))
        return out.reshape(*batch, len(self.bones), 3, 4)

    def skin_energy(self, bones: NDArray[np.float32], *, kinds: Sequence[str] = FAULTS,
                    morph_weights: Optional[NDArray[np.float32]] = None, scope: str = "apart", quick: bool = False,
                    threads: int = 1) -> Tuple[Any, NDArray[np.float32]]:
        """The sum of squared depths of the skin's contacts of these kinds, and its gradient by the bones' matrices.

        bones: float32 (..., bones, 3, 4). Returns float32 (...), in squared units of the pose, and float32
        (..., bones, 3, 4). The gradient is that of the distance of the two deepest points, fixed on the skin. When other
        points become the deepest, it jumps: use sphere_energy() first where parts are far inside each other.
        """
        arguments, batch = self._contact_arguments(bones, None, morph_weights, scope, quick)
        wanted = [_choice("kinds", kind, {name: number for number, name in enumerate(KINDS)}) for kind in kinds]
        entries, first, _, _ = self._native.contacts(*arguments, False, _count("threads", threads))
        runs = entries.view(PENETRATION)
        depths = np.where(np.isin(runs["kind"], wanted), runs["depth"], np.float32(0))
        places = first.view(np.uint64)
        pose_of_run = np.repeat(np.arange(len(places) - 1), np.diff(places).astype(np.int64))
        energy = np.bincount(pose_of_run, np.square(depths, dtype=np.float64), len(places) - 1).astype(np.float32)
        gradient = self._native.depth_gradients(entries, places, np.asarray(2 * depths, np.float32), arguments[2])
        return energy.reshape(batch)[()], gradient.reshape(*batch, len(self.bones), 3, 4)

    def depth_gradients(self, contacts: Contacts,
                        morph_weights: Optional[NDArray[np.float32]] = None) -> NDArray[np.float32]:
        """The gradient of each contact's depth by the bones' matrices, with its deepest points fixed on the skin.

        contacts: of one pose, from contacts(). morph_weights: float32 (morphs,), those of that pose. Returns float32
        (contacts, bones, 3, 4).
        """
        count = len(contacts)
        morphs = self._morphs(morph_weights, ())
        entries = np.ascontiguousarray(contacts.array).view(np.uint8)
        return self._native.depth_gradients(entries, np.arange(count + 1, dtype=np.uint64), np.ones(count, np.float32),
                                            None if morphs is None else np.repeat(morphs, count, 0))

    def points(self, bones: np.ndarray, triangles: NDArray[np.integer], weights: NDArray[np.float32], *,
               morph_weights: Optional[NDArray[np.float32]] = None, threads: int = 1) -> np.ndarray:
        """Where points on the skin are: markers, or a contact's deepest points.

        bones: float32 or float64 (..., bones, 3, 4). triangles: integers (points,), the source's numbers. weights: float32
        (points, 3), of the triangle's corners. Returns (..., points, 3), of the type of `bones`.
        """
        poses, batch = self._poses(bones, _BOTH)
        numbers = np.asarray(triangles)
        if numbers.dtype.kind not in "iu" or numbers.ndim != 1:
            raise ValueError(f"triangles is {numbers.dtype} {numbers.shape}: pass integers (points,)")
        if numbers.size and not (0 <= numbers.min() and numbers.max() < self.triangle_count):
            raise ValueError(f"triangles has numbers that are not below {self.triangle_count}")
        shares = self._array("weights", weights, (np.dtype(np.float32),), (len(numbers), 3), exact=True)
        out = self._native.points(poses, np.ascontiguousarray(numbers, np.uint32), np.ascontiguousarray(shares),
                                  self._morphs(morph_weights, batch), _count("threads", threads))
        return out.reshape(*batch, len(numbers), 3)

    def _contact_arguments(self, bones: Any, vertices: Any, morph_weights: Any, scope: str,
                           quick: bool) -> Tuple[Tuple[Any, Any, Any, int, bool], Tuple[int, ...]]:
        if (bones is None) == (vertices is None):
            raise TypeError("pass bones or vertices, one of the two")
        if bones is not None:
            poses, batch = self._poses(bones)
        else:
            if morph_weights is not None:
                raise TypeError("morph_weights go with bones: vertices are morphed already")
            array = self._array("vertices", vertices, _SINGLE, (self.vertex_count, 3))
            poses, batch = np.ascontiguousarray(array.reshape(-1, self.vertex_count, 3)), array.shape[:-2]
        morphs = self._morphs(morph_weights, batch)
        place = (None, poses) if bones is None else (poses, None)
        return (place[0], place[1], morphs, _choice("scope", scope, _SCOPES), bool(quick)), batch

    def _poses(self, bones: Any, types: Any = None) -> Tuple[np.ndarray, Tuple[int, ...]]:
        count = len(self.bones)
        if count == 0:
            raise ValueError("this asset has no bones: nothing moves its source")
        array = self._array("bones", bones, types or _SINGLE, (count, 3, 4), other=(count, 4, 4))
        array = array[..., :3, :]
        batch, size = array.shape[:-3], array.itemsize
        array = array.reshape(-1, count, 3, 4)
        lies_well = array.strides[2:] == (4 * size, size) and array.strides[1] >= 12 * size and array.strides[0] >= 0
        lies_well = lies_well and array.strides[0] % size == 0 and array.strides[1] % size == 0 and array.flags.aligned
        return (array if lies_well else np.ascontiguousarray(array)), batch

    def _morphs(self, morph_weights: Any, batch: Tuple[int, ...]) -> Optional[np.ndarray]:
        if morph_weights is None:
            return None
        if not self.morphs:
            raise ValueError("morph_weights: this asset has no morph targets")
        array = self._array("morph_weights", morph_weights, _SINGLE, (*batch, len(self.morphs)), exact=True)
        return np.ascontiguousarray(array.reshape(-1, len(self.morphs)))

    def _array(self, name: str, given: Any, types: Any, shape: Tuple[int, ...],
               other: Optional[Tuple[int, ...]] = None, exact: bool = False) -> np.ndarray:
        """The argument as an array of one of these types, whose last axes are `shape` or `other`; or what is wrong."""
        array = np.asarray(given)
        if array.dtype not in types:
            wanted = " or ".join(str(t) for t in types)
            cast = f"to(torch.{types[0]!s})" if type(given).__module__ == "torch" else f"astype({types[0]!s})"
            raise TypeError(f"{name} is {array.dtype}: pass {wanted}, as by {name}.{cast}")
        last = array.shape if exact else array.shape[-len(shape):]
        if last != shape and (other is None or last != other):
            wanted = ", ".join(str(size) for size in shape)
            raise ValueError(f"{name} has the shape {array.shape}: pass ({'' if exact else '..., '}{wanted})")
        if not np.isfinite(array).all():
            place = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
            raise ValueError(f"{name}{list(place)} is {array[place]}")
        if (np.abs(array) > _FAR).any():  # squares would overflow, and such spheres touch nothing
            place = tuple(int(i) for i in np.argwhere(np.abs(array) > _FAR)[0])
            raise ValueError(f"{name}{list(place)} is {array[place]}: more than {_FAR:g}")
        return array


_FAR = 1e15
_SINGLE = (np.dtype(np.float32),)
_BOTH = (np.dtype(np.float32), np.dtype(np.float64))


def _choice(name: str, value: Any, numbers: dict) -> int:
    if not isinstance(value, str) or value not in numbers:
        raise ValueError(f"{name} is {value!r}: pass one of {', '.join(numbers)}")
    return numbers[value]


def _count(name: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 0 <= value <= 1024:
        raise ValueError(f"{name} is {value!r}: pass a number from 0, as many as cores, to 1024")
    return int(value)


def _runs(entries: np.ndarray, first: np.ndarray) -> list:
    places = first.view(np.uint64).tolist()
    return [entries[begin:end] for begin, end in zip(places, places[1:])]


def _nested(entries: list, batch: Tuple[int, ...]) -> Any:
    """A list for each axis of the batch; of one pose its entry itself."""
    if not batch:
        return entries[0]
    for size in reversed(batch[1:]):
        entries = [entries[i:i + size] for i in range(0, len(entries), size)] if size else []
    return entries
