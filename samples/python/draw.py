# SPDX-License-Identifier: MIT
"""Pictures without a library: triangles to a .png, a curve to an .svg."""

import struct
import zlib

import numpy as np


def render(vertices, triangles, colors, center, axes, span, size):
    """Looks against axes[2] at `center`; axes are right, up and towards the eye. `span` units fill `size` pixels."""
    fine = 2 * size  # halved in the end, for smooth edges
    seen = (vertices - center) @ np.asarray(axes).T * [fine / span, -fine / span, 1] + [fine / 2, fine / 2, 0]
    corners = seen[triangles]
    world = vertices[triangles]
    normals = np.cross(world[:, 1] - world[:, 0], world[:, 2] - world[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    light = np.asarray(axes).T @ np.array([0.35, 0.5, 0.79])
    shades = np.asarray(colors) * (0.35 + 0.65 * np.abs(normals @ light))[:, None]
    width = np.ceil(np.abs(np.diff(corners[:, [0, 1, 2, 0], :2], axis=1)).max((1, 2)))
    image, depth = np.ones((fine * fine, 3)), np.full(fine * fine, -np.inf)
    for steps in 2 ** np.arange(1, 10):  # points on a grid, finer in large triangles
        own = np.flatnonzero((width * 1.2 <= steps) & (width * 1.2 > (0 if steps == 2 else steps / 2)))
        u, v = np.mgrid[0:steps + 1, 0:steps + 1].reshape(2, -1) / steps
        weights = np.stack([1 - u - v, u, v], 1)[u + v <= 1 + 1e-9]
        for some in np.array_split(own, max(1, len(own) * len(weights) // 2_000_000)):
            points = (weights @ corners[some]).reshape(-1, 3)
            x, y = np.floor(points[:, :2]).astype(int).T
            inside = (x >= 0) & (x < fine) & (y >= 0) & (y < fine)
            pixel, height = (y * fine + x)[inside], points[inside, 2]
            np.maximum.at(depth, pixel, height)
            front = height >= depth[pixel]
            image[pixel[front]] = np.repeat(shades[some], len(weights), 0)[inside][front]
    return image.reshape(size, 2, size, 2, 3).mean((1, 3))


def write_png(path, image):
    rows = (np.clip(image, 0, 1) * 255).astype(np.uint8)
    height, width, _ = rows.shape

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + row.tobytes() for row in rows)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def write_curves(path, curves, fps, mark):
    """`curves`: name -> (color, values a frame), in mm; a line down at the frame `mark`."""
    width, height, left, top, bottom = 800, 300, 50, 40, 40
    count = max(len(values) for _, values in curves.values())
    greatest = max(max(values) for _, values in curves.values()) or 1
    tick = next(step for step in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1e9) if greatest / step <= 6)

    def x(frame):
        return left + (width - left - 20) * frame / max(1, count - 1)

    def y(value):
        return height - bottom - (height - top - bottom) * value / greatest

    def text(at_x, at_y, words, anchor="middle", color="#444"):
        return f'<text x="{at_x:.0f}" y="{at_y:.0f}" text-anchor="{anchor}" fill="{color}">{words}</text>'

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
           '<rect width="100%" height="100%" fill="white"/>']
    for k in range(int(greatest // tick) + 1):
        out.append(f'<path d="M{left} {y(k * tick):.1f}H{width - 20}" stroke="#ddd"/>')
        out.append(text(left - 6, y(k * tick) + 4, f"{k * tick}", "end"))
    for second in range(int((count - 1) / fps) + 1):
        out.append(text(x(second * fps), height - bottom + 18, f"{second} s"))
    out.append(f'<path d="M{x(mark):.1f} {top}V{height - bottom}" stroke="#888" stroke-dasharray="4 3"/>')
    out.append(text(x(mark), top - 6, f"frame {mark}"))
    for k, (name, (color, values)) in enumerate(curves.items()):
        points = " ".join(f"{x(i):.1f},{y(v):.1f}" for i, v in enumerate(values))
        out.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="2"/>')
        out.append(text(left + 170 * k, 16, name, "start", color))
    path.write_text("\n".join(out + ["</svg>\n"]))
