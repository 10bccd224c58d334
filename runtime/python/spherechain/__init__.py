# SPDX-License-Identifier: MIT
"""Self-collision of skinned characters: spheres, exact contacts, penetrations with depth, and losses with gradients.

    model = spherechain.Model("human.sphc")
    faults = model.penetrations(bones)            # bones: float32 (bones, 3, 4)
    energy, gradient = model.sphere_energy(clip)  # clip: float32 (frames, bones, 3, 4)

For PyTorch: spherechain.torch.
"""

from typing import TYPE_CHECKING

from ._native import VERSION as __version__
from ._process import ToolError

__all__ = ["Baked", "Bone", "CLASSES", "CONTACT_ROW", "Contacts", "FAULTS", "Ground", "MatrixWarning", "Model", "Motion",
           "PART_CONTACT", "PENETRATION", "Part", "PartContact", "Penetration", "Penetrations", "Posed", "Query",
           "Responded", "Response", "ResponseState", "Rule", "SPHERE_PAIR", "STEP", "Step", "Steps", "TRANSFORM",
           "TRIANGLE_PAIR", "ToolError", "bake", "check", "load_motion"]

try:
    from ._answers import (CLASSES, CONTACT_ROW, FAULTS, PART_CONTACT, PENETRATION, SPHERE_PAIR, STEP, TRANSFORM,
                           TRIANGLE_PAIR, Contacts, PartContact, Penetration, Penetrations, Rule, Step, Steps)
    from ._model import Bone, MatrixWarning, Model, Part, Posed, Query
    from ._motion import Motion, load_motion
    from ._response import Ground, Responded, Response, ResponseState
    from ._tool import Baked, bake, check
except ModuleNotFoundError as missing:
    if missing.name != "numpy":
        raise
    if not TYPE_CHECKING:
        # `python -m spherechain` imports this file and runs the tool, which needs no numpy.
        def __getattr__(name):
            if name in __all__:
                raise ModuleNotFoundError(f"spherechain.{name} needs numpy: pip install numpy", name="numpy")
            raise AttributeError(f"module 'spherechain' has no attribute '{name}'")
