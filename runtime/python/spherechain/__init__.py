# SPDX-License-Identifier: MIT
"""Self-collision of skinned characters: spheres, exact contacts, penetrations with depth, and losses with gradients.

    model = spherechain.Model("human.sphc")
    faults = model.penetrations(bones)            # bones: float32 (bones, 3, 4)
    energy, gradient = model.sphere_energy(clip)  # clip: float32 (frames, bones, 3, 4)

For PyTorch: spherechain.torch.
"""

from ._answers import (CLASSES, CONTACT_ROW, FAULTS, PART_CONTACT, PENETRATION, SPHERE_PAIR, STEP, TRANSFORM, TRIANGLE_PAIR,
                       Contacts, PartContact, Penetration, Penetrations, Rule, Step, Steps)
from ._model import Bone, MatrixWarning, Model, Part, Posed, Query
from ._motion import Motion, load_motion
from ._response import Ground, Responded, Response, ResponseState
from ._process import ToolError
from ._tool import Baked, bake, check

from ._native import VERSION as __version__

__all__ = ["Baked", "Bone", "CLASSES", "CONTACT_ROW", "Contacts", "FAULTS", "Ground", "MatrixWarning", "Model", "Motion",
           "PART_CONTACT", "PENETRATION", "Part", "PartContact", "Penetration", "Penetrations", "Posed", "Query",
           "Responded", "Response", "ResponseState", "Rule", "SPHERE_PAIR", "STEP", "Step", "Steps", "TRANSFORM",
           "TRIANGLE_PAIR", "ToolError", "bake", "check", "load_motion"]
