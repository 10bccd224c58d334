# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's plain Python, without Blender: `python3 tests/blender/plain.py`."""

import json
import os
import sys
import tempfile
import time
import types
import unittest
from pathlib import Path

package = types.ModuleType("spherechain_blender")  # without its __init__.py, which needs Blender
package.__path__ = [str(Path(__file__).resolve().parents[2] / "baker/blender")]
sys.modules["spherechain_blender"] = package
from spherechain_blender import results  # noqa: E402
from spherechain_blender.job import Job  # noqa: E402


def written(folder, content):
    path = os.path.join(folder, "file.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file)
    return path


class Results(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def test_events_count_from_the_first_frame_of_the_action(self):
        event = {"parts": ["left hand", "head"], "class": "penetration", "from": 1, "to": 10, "deepest": 6.4, "depth_mm": 51.2}
        touch = dict(event, **{"class": "touch"})
        path = written(self.folder, {"clips": [{"events": [event, touch]}], "notes": []})
        events, others, _ = results.events(path, 101)
        self.assertEqual([(e["text"], e["size"], e["from"], e["to"], e["worst"]) for e in events],
                         [("left hand in head", "51 mm", 102, 111, 107)])
        self.assertEqual(others, 1)

    def test_the_last_error_is_shown_with_the_artists_names(self):
        text = "spherechain: note: x\nspherechain: error: /tmp/a/character.glb: no skin (bind it)\n"
        self.assertEqual(results.error_line(text, {"/tmp/a/character.glb": "Käthe"}), "Käthe: no skin (bind it)")

    def test_a_vertex_is_hidden_where_all_its_triangles_are(self):
        self.assertEqual(results.hidden_vertices([(0, 1, 2), (1, 2, 3), (4, 5, 6)], [0], 8), [0])
        self.assertEqual(results.hidden_vertices([(0, 1, 2), (1, 2, 3), (4, 5, 6)], [0, 1], 8), [0, 1, 2, 3])

    def test_a_bone_without_a_part_belongs_to_that_above(self):
        self.assertEqual(results.parts_of_bones(["root", "arm", "twist"], [-1, 0, 1], {"arm": "left arm"}),
                         [None, "left arm", "left arm", None])

    def test_a_long_name_keeps_its_suffix(self):
        name = results.suffixed("ä" * 40, " fixed")
        self.assertLessEqual(len(name.encode()), 63)
        self.assertTrue(name.startswith("ää") and name.endswith(" fixed"))

    def test_skin_inside_ends_where_skins_touch(self):
        strip = [(at, at + 1, at + 2) for at in range(20)]  # each triangle shares an edge with the next
        found = {"pairs": [(5, 19)], "faults": [{"triangles": [2, 19], "swallowed": 0.3}]}
        self.assertEqual(results.swallowed_triangles(results.Surface(strip), ["hand"] * 10 + ["hip"] * 10, found), {0, 1, 2, 3, 4})
        open_line = {"pairs": [], "faults": [{"triangles": [2, 19], "swallowed": 0.1}]}
        self.assertEqual(results.swallowed_triangles(results.Surface(strip), ["hand"] * 10 + ["hip"] * 10, open_line), set())


class Jobs(unittest.TestCase):
    def test_a_cancelled_job_ends_the_tool_and_its_children(self):
        mark = f"30.{os.getpid()}"
        job = Job(lambda job: job.tool(["sh", "-c", f"echo working >&2; sleep {mark} & wait"]), {})
        job.start()
        while job.progress != "working":
            time.sleep(0.01)
        began = time.monotonic()
        job.cancel()
        self.assertLess(time.monotonic() - began, 2)
        self.assertEqual(job.error, "cancelled")
        running = [Path(f"/proc/{entry}/cmdline") for entry in os.listdir("/proc") if entry.isdigit()]
        self.assertFalse([path for path in running if path.exists() and f"sleep\0{mark}" in path.read_text(errors="replace")])

    def test_a_tool_that_fails_says_why(self):
        job = Job(lambda job: job.tool(["sh", "-c", "echo 'spherechain: error: x.glb: no bones' >&2; exit 3"]), {"x.glb": "Hero"})
        job.run()
        self.assertEqual(job.error, "Hero: no bones")

    def test_a_program_that_cannot_start_is_named(self):
        job = Job(lambda job: job.tool(["/nowhere/spherechain"]), {})
        job.run()
        self.assertEqual(job.error, "/nowhere/spherechain cannot be started: No such file or directory")


if __name__ == "__main__":
    unittest.main()
