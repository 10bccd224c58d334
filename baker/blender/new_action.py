# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a new action of what `fix` turned. The old one stays as it is."""

from .character import Refused


def refuse_tracks(armature):
    if not (armature.animation_data and armature.animation_data.action):
        raise Refused(f"{armature.name} has no action to mend: choose one in the Action Editor")


def from_mended(character, path):
    raise Refused("not yet")
