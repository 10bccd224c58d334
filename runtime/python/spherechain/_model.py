# SPDX-License-Identifier: MIT
"""A baked character, and what can be asked about its poses."""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _native, _pose_check, _table
from ._answers import (CLASSES, FAULTS, PART_CONTACT, PENETRATION, SPHERE_PAIR, STEP, TRIANGLE_PAIR, Contacts, Penetrations,
                       Rule, Steps)

_PENETRATIONS, _CONTACTS, _STEPS, _GROUND, _BOUNDS = range(5)  # questions of the native module
_RADII, _SCOPES = _native.RADII, _native.SCOPES
_SIDES = ("", "left", "right")
_TWO_BODIES = 4  # sc_relation
_FAR = 1e15
_SINGLE = (np.dtype(np.float32),)
_BOTH = (np.dtype(np.float32), np.dtype(np.float64))


class Bone(NamedTuple):
    """A bone moves the skin. A matrix of a pose is the bone's world matrix times its inverse bind matrix."""

    name: str  #: empty: no bone, it stands for what none moves; give it the identity, or the character's own matrix
    inverse_bind: NDArray[np.float32]  #: (3, 4): from the rest pose to the bone's space


class Part(NamedTuple):
    """A part of the body as people call it."""

    name: str  #: "right hand"
    side: str  #: "left", "right" or ""
    bone: Optional[int]  #: the bone that it follows, into Model.bones
    parent: Optional[int]  #: the part that it hangs on, into Model.parts
    joint: Optional[int]  #: the joint that moves it, into Model.joints


class Query(NamedTuple):
    """The options of a question, keywords of Model's methods. The defaults ask what `play` and `check` ask."""

    scope: str = "apart"  #: "layers": with garments on the body; "all": with neighbours, too, the folds of elbows and knees; "neighbours": these alone
    full: bool = False  #: True: penetrations that are no faults in full, too; contacts of spheres and triangles
    classes: Sequence[str] = FAULTS  #: which penetrations are listed, of CLASSES
    limit: int = 0  #: the worst so many; 0: all
    rule: Rule = Rule()  #: the limits of classes
    ignored_spheres: Optional[Sequence[Tuple[int, int]]] = None  #: more pairs that do not meet, of one body
    ignored_parts: Optional[Sequence[int]] = None  #: parts that meet nothing, of two bodies and the ground
    ignored_parts_of_other: Optional[Sequence[int]] = None
    part_pairs: Optional[Sequence[Tuple[int, int]]] = None  #: the pairs of parts that are asked about; None: all
    previous: Optional[Penetrations] = None  #: of the frame before, for one pose: directions of faults then stay steady
    tolerance: float = 0.0  #: of steps, a share of the height; 0: 0.0001


class Posed(NamedTuple):
    """Another body of a question: a model and its poses, as many as the question has."""

    model: "Model"
    bones: Optional[NDArray[np.float32]] = None  #: (..., joints, 3, 4), in the same space as the other's
    bones_before: Optional[NDArray[np.float32]] = None  #: of steps: where it comes from
    vertices: Optional[NDArray[np.float32]] = None  #: in place of bones
    morph_weights: Optional[NDArray[np.float32]] = None


class MatrixWarning(UserWarning):
    """The first poses that a model got are no skinning matrices of it: its answers mean nothing."""


class Model:
    """A character that `bake` made.

    Its methods take one pose or a batch: arrays with any number of axes before those named. `bones` are skinning matrices,
    the world matrix of each joint times its inverse bind matrix, in the order of Model.joints: (..., joints, 3, 4), or
    (..., joints, 4, 4), whose last rows only check_rest() reads. `vertices` in their place: float32 (..., vertices, 3), the
    deformed vertices in the order of the source's file. `morph_weights`: float32 (..., morphs), with bones. Lengths are in
    the pose's units: as in the character's file, for glTF metres. Arrays that lie well in memory are not copied. Other
    threads of Python run in the meantime; `threads` is for the batch, 0: as many as cores. Ctrl-C ends a batch after the
    poses that are being computed. Of a batch each answer is a list for its axis, lists of lists for several axes.
    `query`: keywords of Query.

    Any number of threads may use one model. It can be pickled.
    """

    bones: Tuple[Bone, ...]
    joints: Tuple[str, ...]  #: names, in the order of palettes
    parts: Tuple[Part, ...]
    regions: Tuple[str, ...]
    morphs: Tuple[str, ...]  #: names of the morph targets
    rest_spheres: NDArray[np.float32]  #: (spheres, 4): at rest, with the detect radius
    sphere_count: int
    vertex_count: int  #: of the source
    triangle_count: int  #: of the source
    height: float
    metres_per_unit: float
    left: Tuple[float, float, float]  #: the character's own axes, of unit length
    up: Tuple[float, float, float]
    forward: Tuple[float, float, float]
    source_file: str
    settings: str  #: of the bake, as JSON

    def __init__(self, source: Union[str, "os.PathLike[str]", bytes],
                 joints: Optional[Sequence[Union[str, Tuple[str, Optional[np.ndarray]]]]] = None) -> None:
        """Opens a .sphc file, by its path or its bytes.

        joints: those of your engine, in the order of its palettes: names, or pairs of a name and an inverse bind matrix,
        (3, 4) or (4, 4), which is compared with the asset's. None: palettes come in the order of Model.bones.

        OSError: it cannot be read. ValueError: it is no asset, is damaged, or of another version; or the joints lack a bone.
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
            self._native = _native.Model(data, None if joints is None else [_joint(joint) for joint in joints])
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
        self._arguments = data, joints
        self._is_looked_at: list = []
        self._file = name if isinstance(source, (str, os.PathLike)) else None
        info = self._native.info()
        places = info.pop("joint_of_bone")
        self._joint_of_bone = np.array(places) if joints is not None else None
        self.bones = tuple(Bone(*bone) for bone in info.pop("bones"))
        self.joints = tuple(bone.name for bone in self.bones) if joints is None else tuple(_joint(j)[0] for j in joints)
        self.parts = tuple(
            Part(part, _SIDES[side], _index(bone), _index(parent), _index(places[bone] if places and bone >= 0 else bone))
            for part, side, bone, parent in info.pop("parts"))
        self.rest_spheres = np.array(info.pop("rest_spheres"), np.float32)
        for name, value in info.items():
            setattr(self, name, tuple(value) if isinstance(value, list) else value)
        self._part_names = tuple(part.name for part in self.parts)
        self._plain_query = self._query({}, None, None)
        self._is_open = True

    def __setattr__(self, name: str, value: Any) -> None:
        if getattr(self, "_is_open", False):
            raise AttributeError(f"{name} cannot be set: a model does not change")
        super().__setattr__(name, value)

    def __reduce__(self):
        return Model, self._arguments

    def __repr__(self) -> str:
        return (f"<Model of {self.source_file}: {self.sphere_count} spheres, {len(self.bones)} bones, "
                f"{len(self.parts)} parts>")

    def check_rest(self, bones: NDArray[np.float32]) -> None:
        """Checks that your matrices are skinning matrices of this character: for the first run.

        bones: float32 (..., joints, 3, 4), what you have while the character stands in its bind pose. There every bone's
        matrix is the same, the model's own. ValueError names the first bone whose matrix moves the character otherwise, by
        more than a thousandth of its height: inverse bind matrices are missing, or the rest pose is another. Stand the
        character off the origin and pass (..., joints, 4, 4), so that transposed matrices show. A wrong order never shows.
        """
        poses, _ = self._poses(bones)
        rows = np.asarray(bones)[..., 3:, :].reshape(-1, 4)
        for row in rows[(np.abs(rows - (0, 0, 0, 1)) > 1e-3).any(axis=1)][:1]:
            raise ValueError(f"bones: a last row is {row}, not [0 0 0 1]. Are the matrices transposed?")
        try:
            self._native.check_rest(poses)
        except ValueError as error:
            mistake = _pose_check.find_mistake(self, poses)
            raise ValueError(f"{error}; {mistake}" if mistake else str(error)) from None

    def check_pose(self, bones: NDArray[np.float32]) -> None:
        """Checks in any poses that your matrices are skinning matrices of this character.

        bones: float32 (..., joints, 3, 4) or (..., joints, 4, 4). ValueError says what they are instead: world matrices,
        transposed, in other units, in another order. It is known by bones that are torn apart, so a single wrong bone does
        not show, nor does a body of fewer than four parts. The first poses that a model gets are checked by themselves,
        with a MatrixWarning.
        """
        array = np.asarray(bones)
        if array.shape[-2:] == (4, 4) and (array[..., 3, :3] != 0).any() and not (array[..., :3, 3] != 0).any():
            raise ValueError("bones: they are transposed: a translation is the last column, not the last row")
        mistake = _pose_check.find_mistake(self, self._poses(bones)[0])
        if mistake:
            raise ValueError(f"bones: {mistake}")

    def triangle(self, number: int) -> Optional[Tuple[int, int, int]]:
        """Body part, region and sphere of a triangle of the source; None: the skin leaves it out, as degenerate ones are."""
        return self._native.triangle(number)

    def millimetres(self, length: Any) -> Any:
        """A length in the units of a pose that has the asset's scale."""
        return 1000 * length * self.metres_per_unit

    def spheres(self, bones: np.ndarray, *, radius: str = "detect", threads: int = 1) -> np.ndarray:
        """Where the spheres are: x, y, z and radius of each, (..., spheres, 4). radius: "detect" or "fit"."""
        poses, batch = self._asset_poses(bones, _SINGLE)
        out = self._native.spheres(poses, _choice("radius", radius, _RADII), _count("threads", threads))
        return out.reshape(*batch, self.sphere_count, 4)

    def sphere_pairs(self, bones: NDArray[np.float32], *, radius: str = "detect", threads: int = 1) -> Any:
        """Which spheres touch: uint32 (pairs, 2), each row a < b, sorted. A cheap alarm: the skin's answers are contacts()
        and penetrations()."""
        poses, batch = self._asset_poses(bones, _SINGLE)
        options = _choice("radius", radius, _RADII), _count("threads", threads)
        return _nested(self._native.pairs(self._native.spheres(poses, *options), *options), batch)

    def penetrations(self, bones: Any = None, *, vertices: Any = None, morph_weights: Any = None,
                     other: Optional[Posed] = None, threads: int = 1, **query: Any) -> Any:
        """Which body parts penetrate each other, how deep and which way out; by default the faults that `play` finds.

        other: another body; then `part` is of this one. Returns Penetrations, the worst first.
        """
        return _nested(*self._penetrations(_PENETRATIONS, (bones, vertices, morph_weights), other, threads, query))

    def below(self, up: Sequence[float], height: float, bones: Any = None, *, vertices: Any = None,
              morph_weights: Any = None, threads: int = 1, **query: Any) -> Any:
        """The body parts below the ground: the plane up . p = height, `up` of unit length. Returns Penetrations."""
        if np.shape(up) != (3,) or not abs(np.linalg.norm(up) - 1) < 1e-3 or np.ndim(height) != 0:
            raise ValueError("pass up, three numbers of length 1, then a height, then bones")
        return _nested(*self._penetrations(_GROUND, (bones, vertices, morph_weights), None, threads, query,
                                           ground=[*map(float, up), float(height)]))

    def contacts(self, bones: Any = None, *, vertices: Any = None, morph_weights: Any = None,
                 other: Optional[Posed] = None, threads: int = 1, **query: Any) -> Any:
        """Where skins intersect, exactly. Returns Contacts: of body parts; with full=True of spheres and triangles."""
        found, batch, names = self._ask(_CONTACTS, (bones, vertices, morph_weights), other, threads, query)
        is_full = query.get("full", False)
        return _nested([Contacts(np.frombuffer(parts, PART_CONTACT), names,
                                 np.frombuffer(spheres, SPHERE_PAIR) if is_full else None,
                                 np.frombuffer(triangles, TRIANGLE_PAIR) if is_full else None)
                        for parts, spheres, triangles, _ in found], batch)

    def steps(self, bones_before: Any, bones: Any, *, other: Optional[Posed] = None, threads: int = 1, **query: Any) -> Any:
        """Which body parts touch on the way from one pose to the next, each number of the matrices blended on its own.

        Returns Steps, sorted by parts. Times are shares of the step.
        """
        found, batch, names = self._ask(_STEPS, (bones, None, None), other, threads, query, before=bones_before)
        return _nested([Steps(np.frombuffer(of[0], STEP), names) for of in found], batch)

    def table(self, poses: Any, *, contacts: bool = False, progress: Optional[Callable[[int, int], Any]] = None,
              threads: int = 0, **query: Any) -> Dict[str, np.ndarray]:
        """One row for each penetration in each frame, as columns by name: for CSV, Parquet or pandas.

        poses: what load_motion() gave, in which a fault stays one until it is clearly none, as in `play`; or an array
        (frames, joints, 3, 4), of which each pose is measured alone. contacts: rows are contacts, not penetrations.
        progress: called with frames done and all frames. threads: of an array and of contacts. query: keywords of Query,
        of contacts `scope` and those that choose pairs; and `other` where poses are an array. Lengths that end in _mm are in millimetres, others in the pose's units; a
        volume that is not known is NaN.
        """
        return _table.table(self, poses, contacts, progress, threads, query)

    def bounds(self, bones: Any = None, *, vertices: Any = None, morph_weights: Any = None, threads: int = 1) -> np.ndarray:
        """A box that holds all of the skin for certain: float32 (..., 2, 3), its low corner and its high one."""
        found, batch, _ = self._ask(_BOUNDS, (bones, vertices, morph_weights), None, threads, {})
        return np.array([np.frombuffer(of[0], np.float32) for of in found], np.float32).reshape(*batch, 2, 3)

    def sphere_energy(self, bones: np.ndarray, *, radius: str = "detect", threads: int = 1) -> Tuple[Any, np.ndarray]:
        """How much spheres overlap, and the gradient by the bones' matrices: a smooth loss.

        The energy is the sum of (reach - distance)^2 over the pairs that sphere_pairs() reports. The reach is the sum of the
        two radii, times pair_scales(). The radii follow the bones, too.

        bones: float32 or float64. Returns the energy (...), in squared units of the pose, and the gradient
        (..., joints, 3, 4), of the type of `bones`. float64 is for checks: slower, all pairs are tested.
        """
        poses, batch = self._asset_poses(bones, _BOTH)
        energy, gradient = self._native.sphere_energy(poses, _choice("radius", radius, _RADII), _count("threads", threads))
        return energy.reshape(batch)[()], self._by_joint(gradient, batch)

    def pair_scales(self, *, radius: str = "detect") -> NDArray[np.float32]:
        """By what a pair's sum of radii is multiplied before it is compared: for a loss of your own, on a GPU say.

        Returns float32 (spheres, spheres), symmetric: 0 where the pair is ignored; of a rest pair, which is close at rest,
        its rest_scale; else 1.
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

        bones: float32 or float64. gradient: of the same type, (..., spheres, 4). Returns (..., joints, 3, 4).
        """
        poses, batch = self._asset_poses(bones, _BOTH)
        slopes = self._array("gradient", gradient, (poses.dtype,), (*batch, self.sphere_count, 4), exact=True)
        slopes = np.ascontiguousarray(slopes.reshape(len(poses), self.sphere_count, 4))
        return self._by_joint(self._native.spheres_vjp(poses, slopes, _choice("radius", radius, _RADII),
                                                       _count("threads", threads)), batch)

    def skin_energy(self, bones: NDArray[np.float32], *, morph_weights: Optional[NDArray[np.float32]] = None,
                    threads: int = 1, **query: Any) -> Tuple[Any, NDArray[np.float32]]:
        """The sum of the squared depths of penetrations beyond what the rule allows, and its gradient by the bones' matrices.

        That is Penetration.fault_depth, which grows from zero: what the response keeps apart. With `classes` it is the sum
        of the squared depths of these classes. Returns float32 (...), in squared units of the pose, and float32 (...,
        joints, 3, 4). The gradient is that of the distance of the two deepest points, fixed on the skin; what the rule allows
        counts as constant. When other points become the deepest, it jumps: use sphere_energy() first where parts are far
        inside each other.
        """
        depth = "depth" if "classes" in query else "fault_depth"
        found, batch = self._penetrations(_PENETRATIONS, (bones, None, morph_weights), None, threads, query)
        energy = np.array([np.square(of.array[depth], dtype=np.float64).sum() for of in found], np.float32)
        entries = np.concatenate([np.zeros(0, PENETRATION), *(of.array for of in found)])
        rows = np.repeat(np.arange(len(found)), [len(of) for of in found])
        gradient = self._depth_gradients(entries, 2 * entries[depth], rows, len(found), self._morphs(morph_weights, batch))
        return energy.reshape(batch)[()], self._by_joint(gradient, batch)

    def depth_gradients(self, found: Penetrations,
                        morph_weights: Optional[NDArray[np.float32]] = None) -> NDArray[np.float32]:
        """The gradient of each penetration's depth by the bones' matrices, with its deepest points fixed on the skin.

        found: of one pose, from penetrations() of this body alone. morph_weights: float32 (morphs,), those of that pose.
        Returns float32 (penetrations, joints, 3, 4).
        """
        if not isinstance(found, Penetrations):
            raise TypeError(f"found is {type(found).__name__}: pass the Penetrations of one pose")
        if (found.array["relation"] == _TWO_BODIES).any():
            raise ValueError("found is of two bodies: its points are not all on this one")
        count, morphs = len(found), self._morphs(morph_weights, ())
        morphs = None if morphs is None else np.repeat(morphs, count, 0)
        return self._by_joint(self._depth_gradients(found.array, np.ones(count), np.arange(count), count, morphs), (count,))

    def points(self, bones: np.ndarray, triangles: NDArray[np.integer], weights: NDArray[np.float32], *,
               morph_weights: Optional[NDArray[np.float32]] = None, threads: int = 1) -> np.ndarray:
        """Where points on the skin are: markers, or a contact's deepest points.

        bones: float32 or float64. triangles: integers (points,), the source's numbers. weights: float32 (points, 3), of the
        triangle's corners. Returns (..., points, 3), of the type of `bones`.
        """
        poses, batch = self._asset_poses(bones, _BOTH)
        numbers = np.asarray(triangles)
        if numbers.dtype.kind not in "iu" or numbers.ndim != 1:
            raise ValueError(f"triangles is {numbers.dtype} {numbers.shape}: pass integers (points,)")
        if numbers.size and not (0 <= numbers.min() and numbers.max() < self.triangle_count):
            raise ValueError(f"triangles has numbers that are not below {self.triangle_count}")
        shares = self._array("weights", weights, _SINGLE, (len(numbers), 3), exact=True)
        out = self._native.points(poses, np.ascontiguousarray(numbers, np.uint32), np.ascontiguousarray(shares),
                                  self._morphs(morph_weights, batch), _count("threads", threads))
        return out.reshape(*batch, len(numbers), 3)

    def _depth_gradients(self, entries: np.ndarray, slopes: np.ndarray, rows: np.ndarray, count: int,
                         morphs: Optional[np.ndarray]) -> NDArray[np.float32]:
        """The gradient of slope * direction . (deepest_other - deepest), added up in rows: (count, bones, 3, 4)."""
        ends = np.stack([entries["deepest_other"], entries["deepest"]], 1).reshape(-1)
        signed = np.stack([slopes, -slopes], 1).reshape(-1, 1) * np.repeat(entries["direction"], 2, 0)
        return self._native.points_vjp(count, np.repeat(rows, 2).astype(np.uint32), np.ascontiguousarray(ends["triangle"]),
                                       np.ascontiguousarray(ends["weights"]), signed.astype(np.float32), morphs)

    def _penetrations(self, question: int, poses: Tuple, other: Optional[Posed], threads: int, query: dict,
                      **options: Any) -> Tuple[list, Tuple[int, ...]]:
        found, batch, names = self._ask(question, poses, other, threads, query, **options)
        scale = self.millimetres(1)
        return [Penetrations(np.frombuffer(of[0], PENETRATION), names, of[3], scale) for of in found], batch

    def _ask(self, question: int, poses: Tuple, other: Optional[Posed], threads: int, query: dict, before: Any = None,
             ground: Optional[list] = None) -> Tuple[list, Tuple[int, ...], Tuple]:
        """Three lists as bytes and a total for each pose; the batch; the names of both bodies' parts."""
        if other is not None and not isinstance(other, Posed):
            raise TypeError(f"other is {type(other).__name__}: pass spherechain.Posed(model, bones)")
        side, batch = self._side("bones_before", before, *poses)
        other_side: Tuple = (None, None)
        if other is not None:
            other_side, batch_of_other = other.model._side("other's bones_before", other.bones_before, other.bones,
                                                           other.vertices, other.morph_weights)
            if batch_of_other != batch or (question == _STEPS and other.bones_before is None):
                raise ValueError(f"other has poses {batch_of_other}: pass {batch}"
                                 + (", and as many bones_before" if question == _STEPS else ""))
        is_plain = not query and other is None and ground is None
        native = self._plain_query if is_plain else self._query(query, other, ground)
        if native["previous"] is not None and batch:
            raise ValueError("previous: of one pose alone, not of a batch")
        found = self._native.ask(question, side, None if other is None else other.model._native, other_side, native,
                                 _count("threads", threads))
        return found, batch, (self._part_names, (other.model if other else self)._part_names)

    def _side(self, name: str, before: Any, bones: Any, vertices: Any, morph_weights: Any) -> Tuple[Tuple, Tuple[int, ...]]:
        """(poses before or None, poses) as the native module takes them, and the batch."""
        if (bones is None) == (vertices is None):
            raise TypeError("pass bones or vertices, one of the two")
        if vertices is not None and morph_weights is not None:
            raise TypeError("morph_weights go with bones: vertices are morphed already")
        if bones is None:
            array = self._array("vertices", vertices, _SINGLE, (self.vertex_count, 3))
            return (None, (None, np.ascontiguousarray(array.reshape(-1, self.vertex_count, 3)), None)), array.shape[:-2]
        poses, batch = self._poses(bones)
        self._look_once(poses)
        now = poses, None, self._morphs(morph_weights, batch)
        if before is None:
            return (None, now), batch
        first, batch_before = self._poses(before)
        if batch_before != batch:
            raise ValueError(f"{name} has poses {batch_before}, bones {batch}: pass as many")
        return ((first, None, None), now), batch

    def _query(self, given: dict, other: Optional[Posed], ground: Optional[list]) -> dict:
        """The options as the native module takes them."""
        unknown = set(given) - set(Query._fields)
        if unknown:
            raise TypeError(f"{min(unknown)} is no option: {', '.join(Query._fields)}")
        query = Query(**given)
        for name, kind in (("rule", Rule), ("previous", (Penetrations, type(None)))):
            if not isinstance(getattr(query, name), kind):
                raise TypeError(f"{name} is {getattr(query, name)!r}: pass spherechain.{name.capitalize()}")
        if not isinstance(query.full, bool):
            raise TypeError(f"full is {query.full!r}: pass True or False")
        if isinstance(query.classes, str) or not query.classes:
            raise ValueError(f"classes is {query.classes!r}: pass a list of names, some of {', '.join(CLASSES)}")
        if other is None and ground is None and (query.ignored_parts is not None or query.ignored_parts_of_other is not None):
            raise ValueError("ignored_parts: of two bodies and the ground alone (ignored_spheres, or part_pairs)")
        if other is not None and query.ignored_spheres is not None:
            raise ValueError("ignored_spheres: of one body alone (ignored_parts)")
        if query.limit < 0:
            raise ValueError(f"limit is {query.limit}: pass 0, all, or more")
        parts, others = len(self.parts), len((other.model if other else self).parts)
        classes = {_choice("classes", name, _native.CLASSES) for name in query.classes}
        previous = query.previous
        return {**query._asdict(), "scope": _choice("scope", query.scope, _SCOPES), "ground": ground or [0, 0, 0, 0],
                "classes": sum(1 << int(kind) for kind in classes),
                "ignored_parts": _bits("ignored_parts", query.ignored_parts, parts),
                "ignored_parts_of_other": _bits("ignored_parts_of_other", query.ignored_parts_of_other, others),
                "part_pairs": _bits("part_pairs", query.part_pairs, parts, others),
                "previous": None if previous is None else np.ascontiguousarray(previous.array).view(np.uint8)}

    def _poses(self, bones: Any, types: Any = _SINGLE) -> Tuple[np.ndarray, Tuple[int, ...]]:
        """(poses, joints, 3, 4), which lie as the native module reads them, and the batch."""
        count = len(self.joints)
        if not self.bones:
            raise ValueError("this asset has no bones: nothing moves its source")
        array = self._array("bones", bones, types, (count, 3, 4), other=(count, 4, 4))[..., :3, :]
        batch, size = array.shape[:-3], array.itemsize
        array = array.reshape(-1, count, 3, 4)
        pose, bone, row, column = array.strides
        lies_well = (row, column) == (4 * size, size) and bone >= 12 * size and pose >= 0 and array.flags.aligned
        return (array if lies_well and pose % size == bone % size == 0 else np.ascontiguousarray(array)), batch

    def _asset_poses(self, bones: Any, types: Any) -> Tuple[np.ndarray, Tuple[int, ...]]:
        """The same in the order of Model.bones. A bone without a joint has the identity."""
        poses, batch = self._poses(bones, types)
        self._look_once(poses)
        return self._by_bone(poses), batch

    def _by_bone(self, poses: np.ndarray) -> np.ndarray:
        if self._joint_of_bone is None:
            return poses
        rest = np.broadcast_to(np.eye(3, 4, dtype=poses.dtype), (len(poses), 1, 3, 4))
        return np.ascontiguousarray(np.concatenate([poses, rest], 1)[:, self._joint_of_bone])

    def _look_once(self, poses: np.ndarray) -> None:
        """Warns of the first poses if they are no skinning matrices."""
        if self._is_looked_at or not len(poses):
            return
        self._is_looked_at.append(True)
        mistake = _pose_check.find_mistake(self, poses)
        if mistake:
            warnings.warn(f"bones of {self.source_file}: {mistake}", MatrixWarning, stacklevel=_level_of_caller())

    def _by_joint(self, gradient: np.ndarray, batch: Tuple[int, ...]) -> np.ndarray:
        """From (poses, bones, 3, 4) to (..., joints, 3, 4)."""
        if self._joint_of_bone is not None:
            by_bone, gradient = gradient, np.zeros((len(gradient), len(self.joints) + 1, 3, 4), gradient.dtype)
            np.add.at(gradient, (slice(None), self._joint_of_bone), by_bone)
            gradient = gradient[:, :-1]
        return gradient.reshape(*batch, len(self.joints), 3, 4)

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
        # Squares of more would overflow, and such spheres touch nothing. A NaN makes minimum and maximum one.
        if array.size and not (-_FAR <= array.min() and array.max() <= _FAR):
            place = tuple(int(i) for i in np.argwhere(~(np.abs(array) <= _FAR))[0])
            raise ValueError(f"{name}{list(place)} is {array[place]}: pass numbers up to {_FAR:g}")
        return array


def _level_of_caller() -> int:
    """The stacklevel with which a warning of the function that asks names the line outside this package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        level, frame = level + 1, frame.f_back
    return level


def _joint(joint: Any) -> Tuple[str, Optional[np.ndarray]]:
    name, inverse_bind = (joint, None) if isinstance(joint, str) else joint
    return name, None if inverse_bind is None else np.ascontiguousarray(np.asarray(inverse_bind, np.float32)[:3])


def _index(number: int) -> Optional[int]:
    return None if number < 0 else number


def _choice(name: str, value: Any, numbers: Any) -> Any:
    if not isinstance(value, str) or value not in numbers:
        raise ValueError(f"{name} is {value!r}: pass one of {', '.join(numbers)}")
    return numbers[value]


def _bits(name: str, numbers: Optional[Sequence], *shape: int) -> Optional[NDArray[np.uint64]]:
    """Words with a bit for each number below shape[0], or for each pair of numbers below both of `shape`."""
    if numbers is None:
        return None
    places = np.array(list(numbers))
    places = places.reshape(len(places), -1) if places.size else np.zeros((0, len(shape)), int)
    if places.size and (places.dtype.kind not in "iu" or places.shape[1] != len(shape)):
        raise TypeError(f"{name} is {numbers!r}: pass a list of {'pairs of ' * (len(shape) > 1)}numbers of parts")
    bits = np.zeros(-(-np.prod(shape) // 64) * 64, np.uint8)
    for place in places.tolist():
        if not all(0 <= number < count for number, count in zip(place, shape)):
            raise ValueError(f"{name} has {', '.join(map(str, place))}: there are {' and '.join(map(str, shape))} parts")
        bits[np.ravel_multi_index(place, shape)] = 1
    return np.packbits(bits, bitorder="little").view(np.uint64)


def _count(name: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 0 <= value <= 1024:
        raise ValueError(f"{name} is {value!r}: pass a number from 0, as many as cores, to 1024")
    return int(value)


def _nested(entries: list, batch: Tuple[int, ...]) -> Any:
    """A list for each axis of the batch; of one pose its entry itself."""
    if not batch:
        return entries[0]
    for size in reversed(batch[1:]):
        entries = [entries[i:i + size] for i in range(0, len(entries), size)] if size else []
    return entries
