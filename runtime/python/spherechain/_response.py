# SPDX-License-Identifier: MIT
"""Collision response: joint rotations in, corrected ones out, frame by frame."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._answers import CONTACT_ROW, TRANSFORM, Rule
from ._model import _SINGLE, Model, Posed, _bits

_FLOATS = TRANSFORM.itemsize // 4
_NO_JOINT = 0xFFFFFFFF
_OTHERS_MAX, _ROUNDS_MAX, _AHEAD_MAX = 8, 16, 3


class Ground(NamedTuple):
    """A plane: up . p = height on it."""

    up: Tuple[float, float, float]  #: of unit length
    height: float = 0.0


class Responded(NamedTuple):
    """A corrected frame."""

    joints: np.ndarray  #: a new array, of the type and shape of the one passed. Rotations alone differ
    turned: int  #: how many joints were turned; 0: `joints` is a copy, bit for bit
    at_budget: int  #: how many were not turned as far as wanted
    remaining: float  #: the sum of Penetration.fault_depth that is left, as far as it is known
    rows: np.ndarray  #: dtype CONTACT_ROW, in the corrected pose: for a solver of your own


class ResponseState:
    """A state holds what a response remembers of one character's frames before. A new one remembers nothing.

    It can be copied and pickled. A copy replays the same, bit for bit, on every machine.
    """

    words: NDArray[np.uint64]

    def __init__(self) -> None:
        self.words = np.zeros(_native.RESPONSE_WORDS, np.uint64)

    def reset(self) -> None:
        """Forgets everything: call it where the animation cuts, or the character is moved elsewhere."""
        self.words[:] = 0

    def copy(self) -> "ResponseState":
        out = ResponseState()
        out.words[:] = self.words
        return out

    __copy__ = copy


class Response:
    """Turns upper arms, forearms and hands out of the body, no more than needed, while a motion plays.

        response = spherechain.Response(model, parents)
        state = spherechain.ResponseState()                          # one for each character
        for joints in clip:                                          # dtype TRANSFORM, (joints,)
            corrected = response.respond(state, joints, 1 / 30).joints

    It serves any number of characters of its model in turn, each with a state of its own. Use it from one thread at a time.
    """

    model: Model
    joint_count: int

    def __init__(self, model: Model, parents: Sequence[Optional[int]], *, mobility: Optional[Sequence[float]] = None,
                 budget: Optional[Sequence[float]] = None, hinges: Optional[Sequence[Sequence[float]]] = None,
                 part_pairs: Optional[Sequence[Tuple[int, int]]] = None, rule: Rule = Rule(),
                 largest_other: Optional[Model] = None) -> None:
        """parents: of each joint of Model.joints, before or after it; None or -1: it has none. Joints that the model does
        not have, below a hand say, may follow.
        mobility: how easily each joint turns, from 0, never, to 1; at most 16 may turn. None: the joints of upper arms and
        forearms 1, of hands 0.3, others 0.
        budget: the most that each joint is turned, in radians, up to 2; None: 1.05, 60 degrees.
        hinges: the axis about which each joint bends, in its parent's space; zeros: about all alike. None: elbows' own.
        part_pairs: the pairs of body parts that are kept apart. None: those that a turn can move against each other, unless
        one hangs on the other.
        largest_other: the largest model of those that respond() gets as `others`; None: none is larger than `model`.

        ValueError names the argument that is wrong.
        """
        if not isinstance(model, Model) or not isinstance(largest_other, (Model, type(None))):
            raise TypeError("model, largest_other: pass a spherechain.Model")
        if not isinstance(rule, Rule):
            raise TypeError(f"rule is {rule!r}: pass spherechain.Rule")
        numbers = np.array([-1 if parent is None else parent for parent in parents])
        if numbers.ndim != 1 or numbers.dtype.kind not in "iu":
            raise ValueError("parents: pass the number of a joint, -1 or None for each")
        out_of_range = np.flatnonzero((numbers < -1) | (numbers >= len(numbers)))
        if out_of_range.size:
            at = int(out_of_range[0])
            raise ValueError(f"parents[{at}] is {numbers[at]}: there are {len(numbers)} joints; -1 or None is none")
        self.model = model
        self.joint_count = len(numbers)
        shares = [None if given is None else np.ascontiguousarray(
            model._array(name, np.asarray(given, np.float32), _SINGLE, (len(numbers),), exact=True))
            for name, given in (("mobility", mobility), ("budget", budget))]
        axes = None if hinges is None else np.ascontiguousarray(
            model._array("hinges", np.asarray(hinges, np.float32), _SINGLE, (len(numbers), 3), exact=True))
        self._native = _native.Response(
            model._native, np.where(numbers < 0, _NO_JOINT, numbers).astype(np.uint32), *shares, axes,
            _bits("part_pairs", part_pairs, len(model.parts), len(model.parts)), rule,
            None if largest_other is None else largest_other._native)

    def respond(self, state: ResponseState, joints: np.ndarray, seconds: float, *, place: Optional[np.ndarray] = None,
                morph_weights: Optional[NDArray[np.float32]] = None, weakness: float = 0, rounds: int = 0,
                ahead: Optional[np.ndarray] = None, ahead_frames: int = 0, others: Sequence[Posed] = (),
                ground: Optional[Ground] = None, planted: Sequence[int] = ()) -> Responded:
        """One frame. `state` is changed; `joints` is not.

        joints: where each joint is in its parent's space, as animated: dtype TRANSFORM (joints,), or float32 (joints, 10):
        translation, rotation x, y, z, w, scale. The result has the same form.
        seconds: since the last frame; 0 is a pause, in which nothing turns on.
        place: of the roots in the world, a single TRANSFORM or ten float32; None: the identity.
        weakness: from 0, the full response, to 1, none: to fade it.
        rounds: the most times that contacts are looked for, up to 16; 0: 3.
        ahead: where the joints will be `ahead_frames` later, from 1 to 3: the response then sets in before the contact. Give
        it in every frame of a state, or in none.
        others: characters and props to stay out of, at most 8, always in this order, each with one pose in the world.
        ground: to stay above.
        planted: joints that stay where they are animated, at most 4; those that turn themselves keep their direction, too.

        Where nothing is near and the state is empty, the joints come back bit for bit. Some faults may be left: those of trunk
        and legs stay, and tight places have no way out. docs/response.md has the rest. On an exception the state is as it was.
        """
        if not isinstance(state, ResponseState):
            raise TypeError(f"state is {type(state).__name__}: pass a spherechain.ResponseState")
        flat, is_structured = self._transforms("joints", joints, (self.joint_count,))
        out = flat.copy()
        if (ahead is None) != (ahead_frames == 0):
            raise ValueError("ahead, ahead_frames: pass both, or neither")
        if len(others) > _OTHERS_MAX:
            raise ValueError(f"others has {len(others)} bodies: pass at most {_OTHERS_MAX}")
        morphs = self.model._morphs(morph_weights, ())
        frame = {
            "seconds": _number("seconds", seconds, float("inf")), "weakness": _number("weakness", weakness, 1),
            "rounds": _whole("rounds", rounds, _ROUNDS_MAX), "ahead_frames": _whole("ahead_frames", ahead_frames, _AHEAD_MAX),
            "place": None if place is None else self._transforms("place", place, ())[0].reshape(1, _FLOATS),
            "ahead": None if ahead is None else self._transforms("ahead", ahead, (self.joint_count,))[0],
            "morph_weights": morphs, "others": [_other(i, other) for i, other in enumerate(others)],
            "ground": None if ground is None else _plane(ground),
            "planted": np.array([_whole("planted", joint, self.joint_count - 1) for joint in planted], np.uint32)}
        turned, at_budget, remaining, rows = self._native.respond(state.words, out, frame)
        corrected = out.view(TRANSFORM).reshape(self.joint_count) if is_structured else out
        return Responded(corrected, turned, at_budget, remaining, np.frombuffer(rows, CONTACT_ROW))

    def _transforms(self, name: str, given: Any, shape: Tuple[int, ...]) -> Tuple[np.ndarray, bool]:
        """The transforms as float32 (..., 10) in C order, and whether they came as TRANSFORM."""
        array = np.asarray(given)
        is_structured = array.dtype == TRANSFORM
        if is_structured:
            array = np.ascontiguousarray(array).reshape(array.shape).reshape(*array.shape, 1).view(np.float32)
        return np.ascontiguousarray(self.model._array(name, array, _SINGLE, (*shape, _FLOATS), exact=True)), is_structured


def _number(name: str, value: Any, most: float) -> float:
    if not 0 <= value <= most:
        raise ValueError(f"{name} is {value!r}: pass a number from 0 to {most}")
    return float(value)


def _whole(name: str, value: Any, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 0 <= value <= most:
        raise ValueError(f"{name} is {value!r}: pass a whole number from 0 to {most}")
    return int(value)


def _other(number: int, other: Any) -> Tuple:
    if not isinstance(other, Posed):
        raise TypeError(f"others[{number}] is {type(other).__name__}: pass spherechain.Posed(model, bones)")
    (_, poses), batch = other.model._side("", None, other.bones, other.vertices, other.morph_weights)
    if batch:
        raise ValueError(f"others[{number}] has poses {batch}: pass one")
    return other.model._native, poses


def _plane(ground: Any) -> list:
    up, height = ground
    if np.shape(up) != (3,) or not abs(np.linalg.norm(up) - 1) < 1e-3 or np.ndim(height) != 0:
        raise ValueError("ground: pass spherechain.Ground(up, height), `up` three numbers of length 1")
    return [*map(float, up), float(height)]
