from typing import Any, Dict, Optional, Sequence, Tuple, TypeVar

import numpy as np
from numpy.typing import NDArray

VERSION: str
RESPONSE_WORDS: int
SIZES: Tuple[int, ...]

RADII: Dict[str, int]
SCOPES: Dict[str, int]
CLASSES: Dict[str, int]

Number = TypeVar("Number", np.float32, np.float64)
Floats = NDArray[np.float32]
Numbers = NDArray[np.uint32]
Poses = Tuple[Optional[Floats], Optional[Floats], Optional[Floats]]  # bones, vertices, morph weights
Side = Tuple[Optional[Poses], Optional[Poses]]  # the poses before, and now

class Model:
    def __init__(self, data: bytes, joints: Optional[Sequence[Tuple[str, Optional[Floats]]]]) -> None: ...
    @staticmethod
    def default_rule() -> list[float]: ...
    def info(self) -> dict[str, Any]: ...
    def triangle(self, number: int) -> Optional[Tuple[int, int, int]]: ...
    def check_rest(self, bones: Floats) -> None: ...
    def ask(
        self, question: int, side: Side, other: Optional["Model"], other_side: Side, query: dict[str, Any], threads: int
    ) -> list[Tuple[bytes, bytes, bytes, int]]: ...
    def spheres(self, bones: NDArray[Number], radius: int, threads: int) -> NDArray[Number]: ...
    def pairs(self, spheres: Floats, radius: int, threads: int) -> list[Numbers]: ...
    def pair_scales(self, radius: int) -> Floats: ...
    def pair_energy(
        self, spheres: NDArray[Number], radius: int, threads: int
    ) -> Tuple[NDArray[Number], NDArray[Number]]: ...
    def sphere_energy(
        self, bones: NDArray[Number], radius: int, threads: int
    ) -> Tuple[NDArray[Number], NDArray[Number]]: ...
    def spheres_vjp(
        self, bones: NDArray[Number], gradient: NDArray[Number], radius: int, threads: int
    ) -> NDArray[Number]: ...
    def points(
        self, bones: NDArray[Number], triangles: Numbers, weights: Floats, morph_weights: Optional[Floats], threads: int
    ) -> NDArray[Number]: ...
    def points_vjp(
        self, count: int, rows: Numbers, triangles: Numbers, weights: Floats, slopes: Floats, morph_weights: Optional[Floats]
    ) -> Floats: ...

class Response:
    def __init__(
        self,
        model: Model,
        parents: Numbers,
        mobility: Optional[Floats],
        budget: Optional[Floats],
        part_pairs: Optional[NDArray[np.uint64]],
        rule: Sequence[float],
        largest_other: Optional[Model],
    ) -> None: ...
    def respond(
        self, state: NDArray[np.uint64], joints: Floats, frame: dict[str, Any]
    ) -> Tuple[int, int, float, bytes]: ...
