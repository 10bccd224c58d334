# SPDX-License-Identifier: MIT
"""Self-collision of skinned characters: spheres, pairs, exact skin contacts with depth, and losses with gradients.

    asset = spherechain.Asset("human.sphc")
    contacts = asset.contacts(bones)              # bones: float32 (bones, 3, 4)
    energy, gradient = asset.sphere_energy(clip)  # clip: float32 (frames, bones, 3, 4)

For PyTorch: spherechain.torch.
"""

from ._asset import Asset, Bone, Part
from ._contacts import PENETRATION, TRIANGLE_PAIR, Contact, Contacts
from ._tool import Baked, ToolError, bake, check

from ._native import VERSION as __version__

__all__ = ["Asset", "Baked", "Bone", "Contact", "Contacts", "PENETRATION", "Part", "TRIANGLE_PAIR", "ToolError", "bake",
           "check"]
