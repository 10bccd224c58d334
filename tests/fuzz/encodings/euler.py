# SPDX-License-Identifier: GPL-3.0-or-later
"""Euler angles in any order. An order names the axes from the first turn to the last: "xyz" is Rz Ry Rx."""
import numpy as np

AXES = {"x": 0, "y": 1, "z": 2}


def axis_turn(axis, radians):
    m = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    c, s = np.cos(radians), np.sin(radians)
    m[a, a], m[a, b], m[b, a], m[b, b] = c, -s, s, c
    return m


def matrix(order, degrees):
    """`degrees` are about x, y and z."""
    m = np.eye(3)
    for name in order:
        m = axis_turn(AXES[name], np.radians(degrees[AXES[name]])) @ m
    return m


def angles(order, m):
    """Degrees about x, y and z."""
    first, second, third = (AXES[n] for n in order)
    sign = 1 if (first + 1) % 3 == second else -1
    # m = R3 R2 R1; the entry (third, first) is the sine of the second turn.
    sine = np.clip(-sign * m[third, first], -1, 1)
    out = np.zeros(3)
    out[second] = np.arcsin(sine)
    if abs(sine) < 1 - 1e-10:
        out[first] = np.arctan2(sign * m[third, second], m[third, third])
        out[third] = np.arctan2(sign * m[second, first], m[first, first])
    else:
        out[third] = np.arctan2(-sign * m[first, second], m[second, second])
    degrees = np.degrees(out)
    assert np.allclose(matrix(order, degrees), m, atol=1e-6)
    return degrees


def curve(order, matrices):
    """Angles of a motion without jumps by full turns."""
    out = [angles(order, m) for m in matrices]
    for k in range(1, len(out)):
        out[k] = out[k] - 360 * np.round((out[k] - out[k - 1]) / 360)
    return np.array(out)
