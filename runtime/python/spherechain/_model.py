# SPDX-License-Identifier: MIT
"""A baked character, and what can be asked about its poses."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._answers import (CLASSES, FAULTS, PART_CONTACT, PENETRATION, SPHERE_PAIR, STEP, TRIANGLE_PAIR, Contacts, Penetrations,
                       Rule, Steps)

_RADII = {"detect": 0, "fit": 1}
_SCOPES = {"apart": 0, "neighbours": 1, "all": 2}
_DETAILS = {"quick": 0, "full": 1}
_PENETRATIONS, _CONTACTS, _STEPS, _GROUND, _BOUNDS = range(5)  # questions of the native module
_SIDES = ("", "left", "right")
_TWO_BODIES = 4  # sc_relation


class Bone(NamedTuple):
    """What moves the character. A matrix of a pose is the bone's world matrix times its inverse bind matrix."""

    name: str  #: empty: no bone, it stands for what none moves; give it the identity, or the character's own matrix
    inverse_bind: NDArray[np.float32]  #: (3, 4): from the rest pose to the bone's space


class Part(NamedTuple):
    """A part of the body as people call it."""

    name: str  #: "right hand"
    side: str  #: "left", "right" or ""
    bone: Optional[int]  #: the bone that it follows, into Model.bones
    parent: Optional[int]  #: the part that it hangs on, into Model.parts


class Query(NamedTuple):
    """The options of a question, keywords of Model's methods. The defaults ask what `play` and `check` ask."""

    scope: str = "apart"  #: "all": with neighbours on the body, the folds of elbows and knees; "neighbours": these alone
    detail: str = "quick"  #: "full": penetrations that are no faults in full, too; contacts of spheres and triangles
    classes: Sequence[str] = FAULTS  #: which penetrations are listed, of CLASSES
    limit: int = 0  #: the worst so many; 0: all
    rule: Optional[Rule] = None  #: the limits of classes; None: Rule()
    ignored_spheres: Optional[Sequence[Tuple[int, int]]] = None  #: more pairs that do not meet, of one body
    ignored_parts: Optional[Sequence[int]] = None  #: parts that meet nothing, of two bodies and the ground
    ignored_parts_of_other: Optional[Sequence[int]] = None
    part_pairs: Optional[Sequence[Tuple[int, int]]] = None  #: the pairs of parts that are asked about; None: all
    tolerance: float = 0.0  #: of steps, a share of the height; 0: 0.0001


class Posed(NamedTuple):
    """Another body of a question: a model and its poses, as many as the question has."""

    model: "Model"
    bones: NDArray[np.float32]  #: (..., bones, 3, 4), in the same space as the other's
    bones_before: Optional[NDArray[np.float32]] = None  #: of steps: where it comes from


class Model:
    """A character that `bake` made.

    Its methods take one pose or a batch: arrays with any number of axes before those named. `bones` are skinning matrices,
    the world matrix of each bone times its inverse bind matrix, in the order of Model.bones: (..., bones, 3, 4), or
    (..., bones, 4, 4), whose last rows only check_rest() reads. `vertices` in their place: float32 (..., vertices, 3), the
    deformed vertices in the order of the source's file. `morph_weights`: float32 (..., morphs), with bones. Lengths are in
    the pose's units: as in the character's file, for glTF metres. Arrays that lie well in memory are not copied. Other
    threads of Python run in the meantime; `threads` is for the batch, 0: as many as cores. Ctrl-C ends a batch after the
    poses that are being computed. Of a batch each answer is a list for its axis, lists of lists for several axes.
    `query`: keywords of Query.

    Any number of threads may use one model. It can be pickled.
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
            raise TypeError(f"Model takes a path or bytes, not {type(source).__name__}")
        try:
            self._native = _native.Model(data)
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
            raise AttributeError(f"{name} cannot be set: a model does not change")
        super().__setattr__(name, value)

    def __reduce__(self):
        return Model, (self._native.bytes(),)

    def __repr__(self) -> str:
        return (f"<Model of {self.source_file}: {self.sphere_count} spheres, {len(self.bones)} bones, "
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

    def triangle(self, number: int) -> Optional[Tuple[int, int, int]]:
        """Body part, region and sphere of a triangle of the source; None: the skin leaves it out, as degenerate ones are."""
        return self._native.triangle(number)

    def spheres(self, bones: NDArray[np.float32], *, radius: str = "detect", threads: int = 1) -> NDArray[np.float32]:
        """Where the spheres are: x, y, z and radius of each.

        bones: float32 (..., bones, 3, 4). Returns float32 (..., spheres, 4). radius: "detect" or "fit".
        """
        poses, batch = self._poses(bones)
        out = self._native.spheres(poses, _choice("radius", radius, _RADII), _count("threads", threads))
        return out.reshape(*batch, self.sphere_count, 4)

    def sphere_pairs(self, bones: NDArray[np.float32], *, radius: str = "detect", threads: int = 1) -> Any:
        """Which spheres touch. A cheap alarm: the skin's answers are contacts() and penetrations().

        bones: float32 (..., bones, 3, 4). Returns uint32 (pairs, 2), each row a < b, sorted; of a batch a list of these for
        its axis, lists of lists for several axes.
        """
        poses, batch = self._poses(bones)
        entries, first = self._native.pairs(poses, _choice("radius", radius, _RADII), _count("threads", threads))
        return _nested(_runs(entries.view(np.uint32).reshape(-1, 2), first), batch)

    def penetrations(self, bones: Any = None, *, vertices: Any = None, morph_weights: Any = None,
                     other: Optional[Posed] = None, threads: int = 1, **query: Any) -> Any:
        """Which body parts penetrate each other, how deep and which way out; by default the faults that `play` finds.

        other: another body; then `part` is of this one. Returns Penetrations, the worst first.
        """
        return self._penetrations(_PENETRATIONS, bones, vertices, morph_weights, other, threads, query)

    def below(self, up: Sequence[float], height: float, bones: Any = None, *, vertices: Any = None,
              morph_weights: Any = None, threads: int = 1, **query: Any) -> Any:
        """The body parts below the ground: the plane up . p = height, `up` of unit length. Returns Penetrations."""
        if np.shape(up) != (3,) or not abs(np.linalg.norm(up) - 1) < 1e-3 or np.ndim(height) != 0:
            raise ValueError("pass up, three numbers of length 1, then a height, then bones")
        ground = {"up": [float(x) for x in up], "height": float(height)}
        return self._penetrations(_GROUND, bones, vertices, morph_weights, None, threads, query, ground)

    def contacts(self, bones: Any = None, *, vertices: Any = None, morph_weights: Any = None,
                 other: Optional[Posed] = None, threads: int = 1, **query: Any) -> Any:
        """Where skins intersect, exactly. Returns Contacts: of body parts; with detail="full" of spheres and triangles."""
        lists, _, batch = self._ask(_CONTACTS, bones, vertices, morph_weights, other, threads, query)
        is_full = Query(**query).detail == "full"
        kinds = (PART_CONTACT, SPHERE_PAIR if is_full else None, TRIANGLE_PAIR if is_full else None)
        names = self._part_names, other.model._part_names if other else self._part_names
        runs = [[None] * len(lists[0]) if kind is None else [run.view(kind) for run in of] for of, kind in zip(lists, kinds)]
        return _nested([Contacts(*of_pose, *names) for of_pose in zip(*runs)], batch)

    def steps(self, bones_before: Any, bones: Any, *, other: Optional[Posed] = None, threads: int = 1, **query: Any) -> Any:
        """Which body parts touch on the way from one pose to the next, each number of the matrices blended on its own.

        Returns Steps, sorted by parts. Times are shares of the step.
        """
        before, batch = self._poses(bones_before)
        lists, _, batch = self._ask(_STEPS, bones, None, None, other, threads, query, before=(before, None, None))
        names = self._part_names, other.model._part_names if other else self._part_names
        return _nested([Steps(run.view(STEP), *names) for run in lists[0]], batch)

    def bounds(self, bones: Any = None, *, vertices: Any = None, morph_weights: Any = None, threads: int = 1) -> np.ndarray:
        """A box that holds all of the skin for certain: float32 (..., 2, 3), its low corner and its high one."""
        lists, _, batch = self._ask(_BOUNDS, bones, vertices, morph_weights, None, threads, {})
        return np.array([run.view(np.float32) for run in lists[0]], np.float32).reshape(*batch, 2, 3)

    def sphere_energy(self, bones: np.ndarray, *, radius: str = "detect", threads: int = 1) -> Tuple[Any, np.ndarray]:
        """How much spheres overlap, and the gradient by the bones' matrices: a smooth loss.

        The energy is the sum of (reach - distance)^2 over the pairs that sphere_pairs() reports. The reach is the sum of the two
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

    def skin_energy(self, bones: NDArray[np.float32], *, morph_weights: Optional[NDArray[np.float32]] = None,
                    threads: int = 1, **query: Any) -> Tuple[Any, NDArray[np.float32]]:
        """The sum of squared depths of penetrations, by default of faults, and its gradient by the bones' matrices.

        bones: float32 (..., bones, 3, 4). Returns float32 (...), in squared units of the pose, and float32
        (..., bones, 3, 4). The gradient is that of the distance of the two deepest points, fixed on the skin. When other
        points become the deepest, it jumps: use sphere_energy() first where parts are far inside each other.
        """
        lists, _, batch = self._ask(_PENETRATIONS, bones, None, morph_weights, None, threads, query)
        runs = [run.view(PENETRATION) for run in lists[0]]
        energy = np.array([np.square(run["depth"], dtype=np.float64).sum() for run in runs], np.float32)
        entries = np.concatenate(runs) if runs else np.zeros(0, PENETRATION)
        first = np.cumsum([0] + [len(run) for run in runs], dtype=np.uint64)
        gradient = self._native.depth_gradients(entries.view(np.uint8), first, np.asarray(2 * entries["depth"], np.float32),
                                                self._morphs(morph_weights, batch))
        return energy.reshape(batch)[()], gradient.reshape(*batch, len(self.bones), 3, 4)

    def depth_gradients(self, found: Penetrations,
                        morph_weights: Optional[NDArray[np.float32]] = None) -> NDArray[np.float32]:
        """The gradient of each penetration's depth by the bones' matrices, with its deepest points fixed on the skin.

        found: of one pose, from penetrations() of this body alone. morph_weights: float32 (morphs,), those of that pose.
        Returns float32 (penetrations, bones, 3, 4).
        """
        if not isinstance(found, Penetrations):
            raise TypeError(f"found is {type(found).__name__}: pass the Penetrations of one pose")
        if (found.array["relation"] == _TWO_BODIES).any():
            raise ValueError("found is of two bodies: its points are not all on this one")
        count = len(found)
        morphs = self._morphs(morph_weights, ())
        entries = np.ascontiguousarray(found.array).view(np.uint8)
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

    def _penetrations(self, question: int, bones: Any, vertices: Any, morph_weights: Any, other: Optional[Posed],
                      threads: int, query: dict, ground: Optional[dict] = None) -> Any:
        lists, totals, batch = self._ask(question, bones, vertices, morph_weights, other, threads, query, ground)
        names = self._part_names, other.model._part_names if other else self._part_names
        scale = self.metres_per_unit * 1000
        return _nested([Penetrations(run.view(PENETRATION), total, *names, scale) for run, total in zip(lists[0], totals)],
                       batch)

    def _ask(self, question: int, bones: Any, vertices: Any, morph_weights: Any, other: Optional[Posed], threads: int,
             query: dict, ground: Optional[dict] = None, before: Any = None) -> Tuple[list, list, Tuple[int, ...]]:
        """The lists of each pose as bytes, how many entries there are in all, and the batch."""
        if (bones is None) == (vertices is None):
            raise TypeError("pass bones or vertices, one of the two")
        if other is not None and not isinstance(other, Posed):
            raise TypeError(f"other is {type(other).__name__}: pass spherechain.Posed(model, bones)")
        if bones is not None:
            poses, batch = self._poses(bones)
        else:
            if morph_weights is not None:
                raise TypeError("morph_weights go with bones: vertices are morphed already")
            array = self._array("vertices", vertices, _SINGLE, (self.vertex_count, 3))
            poses, batch = np.ascontiguousarray(array.reshape(-1, self.vertex_count, 3)), array.shape[:-2]
        morphs = self._morphs(morph_weights, batch)
        place = (None, poses, None) if bones is None else (poses, None, morphs)
        others = others_before = None
        if other is not None:
            others = (other.model._poses(other.bones)[0], None, None)
            if other.bones_before is not None:
                others_before = (other.model._poses(other.bones_before)[0], None, None)
            for of in (others, others_before) if question == _STEPS else (others,):
                if of is None or len(of[0]) != len(poses):
                    raise ValueError(f"other has not {len(poses)} poses" + (", and as many before" if question == _STEPS else ""))
        if before is not None and len(before[0]) != len(poses):
            raise ValueError(f"bones_before has {len(before[0])} poses, bones {len(poses)}")
        lists, totals = self._native.ask(question, place, self._query(query, other, ground),
                                         None if other is None else other.model._native, others, before, others_before,
                                         _count("threads", threads))
        return [_runs(*run) for run in lists], totals.view(np.uint64).tolist(), batch

    def _query(self, given: dict, other: Optional[Posed], ground: Optional[dict]) -> dict:
        unknown = set(given) - set(Query._fields)
        if unknown:
            raise TypeError(f"{min(unknown)} is no option: {', '.join(Query._fields)}")
        query = Query(**given)
        if isinstance(query.classes, str):
            raise TypeError(f"classes is {query.classes!r}: pass a list of names")
        if query.rule is not None and not isinstance(query.rule, Rule):
            raise TypeError(f"rule is {query.rule!r}: pass a spherechain.Rule")
        if other is None and ground is None and (query.ignored_parts is not None or query.ignored_parts_of_other is not None):
            raise ValueError("ignored_parts: of two bodies and the ground alone (ignored_spheres, or part_pairs)")
        if other is not None and query.ignored_spheres is not None:
            raise ValueError("ignored_spheres: of one body alone (ignored_parts)")
        if query.limit < 0:
            raise ValueError(f"limit is {query.limit}: pass 0, all, or more")
        parts, others = len(self.parts), len((other.model if other else self).parts)
        if not query.classes:
            raise ValueError(f"classes is empty: pass some of {', '.join(CLASSES)}")
        classes = [_choice("classes", name, {known: k for k, known in enumerate(CLASSES)}) for name in query.classes]
        pairs = query.part_pairs
        return {
            "scope": _choice("scope", query.scope, _SCOPES), "detail": _choice("detail", query.detail, _DETAILS),
            "classes": sum(1 << k for k in set(classes)), "limit": int(query.limit),
            "tolerance": float(query.tolerance), "ignored_spheres": query.ignored_spheres,
            "ignored_parts": _bits("ignored_parts", query.ignored_parts, parts),
            "ignored_parts_of_other": _bits("ignored_parts_of_other", query.ignored_parts_of_other, others),
            "part_pairs": _bits("part_pairs", pairs and [_place(pair, parts, others) for pair in pairs], parts * others),
            "rule": None if query.rule is None else list(query.rule), **(ground or {"up": [0, 0, 0], "height": 0}),
        }

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


def _place(pair: Sequence[int], parts: int, others: int) -> int:
    if len(np.shape(pair)) != 1 or len(pair) != 2 or not all(isinstance(part, (int, np.integer)) for part in pair):
        raise TypeError(f"part_pairs has {pair!r}: pass pairs of numbers of parts")
    a, b = pair
    if not (0 <= a < parts and 0 <= b < others):
        raise ValueError(f"part_pairs has ({a}, {b}): there are {parts} parts and {others}")
    return a * others + b


def _bits(name: str, numbers: Optional[Sequence[int]], count: int) -> Optional[NDArray[np.uint64]]:
    if numbers is None:
        return None
    out = np.zeros(count // 64 + 1, np.uint64)
    for number in numbers:
        if not 0 <= number < count:
            raise ValueError(f"{name} has {number}: pass numbers below {count}")
        out[number // 64] |= np.uint64(1 << number % 64)
    return out


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
