from typing import Any, Optional, Tuple, TypeVar

import numpy as np
from numpy.typing import NDArray

PENETRATION_BYTES: int
TRIANGLE_BYTES: int
CONTACT_BYTES: int
STEP_BYTES: int
VERSION: str

Number = TypeVar("Number", np.float32, np.float64)
Bytes = NDArray[np.uint8]
Poses = Tuple[Optional[NDArray[np.float32]], Optional[NDArray[np.float32]], Optional[NDArray[np.float32]]]

def class_name(kind: int) -> str: ...
def default_rule() -> list[float]: ...

class Model:
    def __init__(self, data: bytes) -> None: ...
    def bytes(self) -> bytes: ...
    def info(self) -> dict[str, Any]: ...
    def check_rest(self, bones: NDArray[np.float32]) -> None: ...
    def pair_scales(self, radius: int) -> NDArray[np.float32]: ...
    def spheres(self, bones: NDArray[np.float32], radius: int, threads: int) -> NDArray[np.float32]: ...
    def pairs(self, bones: NDArray[np.float32], radius: int, threads: int) -> Tuple[Bytes, Bytes]: ...
    def triangle(self, number: int) -> Optional[Tuple[int, int, int]]: ...
    def ask(
        self,
        question: int,
        poses: Poses,
        query: dict[str, Any],
        other: Optional["Model"],
        others: Optional[Poses],
        before: Optional[Poses],
        others_before: Optional[Poses],
        threads: int,
    ) -> Tuple[list[Tuple[Bytes, Bytes]], Bytes]: ...
    def depth_gradients(
        self,
        penetrations: Bytes,
        first: NDArray[np.uint64],
        slopes: NDArray[np.float32],
        morph_weights: Optional[NDArray[np.float32]],
    ) -> NDArray[np.float32]: ...
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
        self,
        bones: NDArray[Number],
        triangles: NDArray[np.uint32],
        weights: NDArray[np.float32],
        morph_weights: Optional[NDArray[np.float32]],
        threads: int,
    ) -> NDArray[Number]: ...
