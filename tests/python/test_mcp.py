# SPDX-License-Identifier: MIT
"""The server for agents, by a client of its own: both kinds of revisions, real characters, bad paths, cancelled calls."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from pathlib import Path


TOOL = os.environ.get("SPHERECHAIN_TOOL") or shutil.which("spherechain")
# A base, a lower arm and an upper arm, which folds onto the base.
ARM = """<robot name="arm">
  <link name="base"><visual><geometry><box size="0.3 0.3 0.1"/></geometry></visual></link>
  <link name="lower"><visual><origin xyz="0 0 0.25"/><geometry><box size="0.1 0.1 0.5"/></geometry></visual></link>
  <link name="upper"><visual><origin xyz="0 0 0.3"/><geometry><box size="0.1 0.1 0.6"/></geometry></visual></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="lower"/><origin xyz="0 0 0.06"/><axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="continuous"><parent link="lower"/><child link="upper"/><origin xyz="0 0.12 0.45"/><axis xyz="0 1 0"/></joint>
</robot>"""
FOLD = "elbow\n" + "".join(f"{0.05 * frame}\n" for frame in range(61))
MODERN = {"io.modelcontextprotocol/protocolVersion": "2026-07-28", "io.modelcontextprotocol/clientCapabilities": {}}


@unittest.skipUnless(TOOL, "skipped: the tool is missing (SPHERECHAIN_TOOL)")
class Server(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name, "root")
        self.root.mkdir()
        (self.root / "arm.urdf").write_text(ARM)
        (self.root / "fold.csv").write_text(FOLD)
        (self.root / "out").symlink_to("/tmp")
        self.number, self.said = 0, []
        self.start(TOOL)

    def start(self, tool):
        self.server = subprocess.Popen([sys.executable, "-m", "spherechain.mcp", "--root", self.root, "--tool", tool],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.addCleanup(self.close, self.server)

    def close(self, server):
        server.stdin.close()
        self.assertEqual(server.wait(20), 0)
        server.stdout.close()

    def send(self, line):
        self.server.stdin.write((line if isinstance(line, bytes) else json.dumps(line).encode()) + b"\n")
        self.server.stdin.flush()

    def answer(self):
        while True:
            message = json.loads(self.server.stdout.readline())
            self.assertEqual(message["jsonrpc"], "2.0")
            if "id" in message:
                return message
            self.said.append(message)

    def ask(self, method, **params):
        self.number += 1
        self.send({"jsonrpc": "2.0", "id": self.number, "method": method, "params": params})
        message = self.answer()
        self.assertEqual(message["id"], self.number)
        return message.get("result", message.get("error"))

    def call(self, name, **arguments):
        return self.ask("tools/call", name=name, arguments=arguments, _meta={**MODERN, "progressToken": 7})

    def refused(self, text, name, **arguments):
        result = self.call(name, **arguments)
        self.assertTrue(result["isError"], result)
        self.assertIn(text, result["content"][0]["text"])

    def test_begins_as_each_revision_does(self):
        self.assertEqual(self.ask("tools/list")["code"], -32602)
        about = self.ask("server/discover", _meta=MODERN)
        self.assertEqual((about["resultType"], about["supportedVersions"][0]), ("complete", "2026-07-28"))
        old = self.ask("tools/list", _meta={**MODERN, "io.modelcontextprotocol/protocolVersion": "1999-01-01"})
        self.assertEqual((old["code"], old["data"]["requested"]), (-32022, "1999-01-01"))
        for asked, given in (("2025-06-18", "2025-06-18"), ("1999-01-01", "2025-11-25")):
            hello = self.ask("initialize", protocolVersion=asked, capabilities={}, clientInfo={"name": "test", "version": "1"})
            self.assertEqual((hello["protocolVersion"], hello["serverInfo"]["name"]), (given, "spherechain"))
        self.send({"jsonrpc": "2.0", "method": "notifications/initialized"})
        self.assertEqual(self.ask("ping"), {})
        tools = {tool["name"]: tool for tool in self.ask("tools/list")["tools"]}
        self.assertLessEqual({"check", "play", "fix", "mask", "export", "score"}, set(tools))
        for tool in tools.values():
            self.assertLessEqual(set(tool["inputSchema"]["required"]), set(tool["inputSchema"]["properties"]))
            self.assertEqual(tool["outputSchema"]["type"], "object")

    def test_lines_that_are_no_messages_stop_nothing(self):
        for line, code in ((b"{", -32700), (b"\xff\xfe", -32700), (b"[" * 100000, -32700), (b"[]", -32600), (b'"x"', -32600),
                           (b'{"id": 1, "method": "ping"}', -32600), (b'{"jsonrpc": "2.0", "id": null, "method": "ping"}', -32600),
                           (b'{"jsonrpc": "2.0", "id": 1, "method": "ping", "params": [1]}', -32600),
                           (b'{"jsonrpc": "2.0", "id": 1, "method": "ping", "params": {"_meta": 3}}', -32602),
                           (b"x" * (2 << 20), -32600)):
            self.send(line)
            self.assertEqual(self.answer()["error"]["code"], code, line[:60])
        for line in (b"", b'{"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": [1]}}',
                     b'{"jsonrpc": "2.0", "id": 5, "result": {}}'):
            self.send(line)
        self.assertEqual(self.ask("ping"), {})
        self.assertEqual(self.ask("teleport", _meta=MODERN)["code"], -32601)
        self.assertEqual(self.ask("tools/call", name="rm", _meta=MODERN)["code"], -32602)

    def test_checks_a_character_and_shows_its_worst_fault(self):
        result = self.call("check", library=["arm.urdf"], motion="fold.csv", output="report")
        self.assertFalse(result["isError"], result)
        found = result["structuredContent"]
        self.assertEqual(json.loads(result["content"][0]["text"]), found)
        self.assertTrue(found["fails"])
        worst = found["tickets"][0]
        self.assertEqual((worst["character"], worst["clip"], worst["parts"]), ("arm.urdf", "fold.csv", ["upper", "base"]))
        play = self.call("play", character="arm.urdf", motion="fold.csv")
        caption = f"arm.urdf fold.csv, frame {worst['frame']}: upper in base, penetration, {worst['depth_mm']:.1f} mm"
        for content in (result["content"], play["content"]):
            self.assertEqual([part["type"] for part in content], ["text", "text", "image"])
            self.assertEqual(content[1]["text"], caption)
        played = play["structuredContent"]["faults"][0]
        self.assertEqual((played["parts"], played["deepest_frame"]), (worst["parts"], worst["frame"]))
        self.assertAlmostEqual(played["depth_mm"], worst["depth_mm"], 1)
        self.assertTrue((self.root / found["report"] / "library.js").is_file())
        picture = base64.b64decode(result["content"][2]["data"])
        self.assertTrue(picture.startswith(b"\x89PNG\r\n\x1a\n") and len(zlib.decompress(picture_data(picture))) > 1000)
        self.refused("report: is there already", "check", library=["arm.urdf"], output="report")
        for folder in ("report", "."):
            self.refused("folder", "check", library=["arm.urdf"], output=folder, overwrite=True)
        self.assertFalse([name for name in os.listdir(self.root) if name.startswith(".")])

    def test_names_what_a_picture_shows_and_what_it_could_not_check(self):
        (self.root / "broken.glb").write_text("no mesh")
        (self.root / "twice.csv").write_text("elbow\n" + "".join(f"{angle}\n" for angle in (0, 2.85, *[0] * 8, 2.9, *[0] * 8)))
        (self.root / "still.csv").write_text("elbow\n0\n0\n")
        result = self.call("check", library=["arm.urdf", "broken.glb"], motion="twice.csv")
        found = result["structuredContent"]
        self.assertEqual([(row["character"], row["clip"]) for row in found["not_checked"]], [("broken.glb", "")])
        self.assertIn("broken.glb: not a mesh", found["not_checked"][0]["error"])
        self.assertNotIn(str(self.root), found["not_checked"][0]["error"])
        self.assertEqual(found["summary"]["penetrations"], 2)
        self.assertIn("arm.urdf twice.csv, frame 10: upper in base", result["content"][1]["text"])
        still = self.call("check", library=["arm.urdf", "broken.glb"], motion="still.csv")
        self.assertEqual(still["content"][1]["text"], "arm.urdf still.csv, no fault: the first frame")
        result = self.call("export", character="arm.urdf", motion="still.csv", to="mjcf", output="arm.xml")
        self.assertEqual(result["structuredContent"]["files"], ["arm.still.mjcf.csv", "arm.xml"])

    def test_says_how_far_each_mended_event_changes_the_pose(self):
        acting = {"from": 50, "to": 60, "verdict": "changes_pose", "moves_mm": {"upper": 80.0}, "step_percent": 0.1}
        event = {"parts": ["upper", "base"], "from": 55, "to": 60, "outcome": "cleared", "acting": acting}
        (self.root / "fix.json").write_text(json.dumps({"clips": [{"clip": "fold.csv", "events": [event]}]}))
        mends = self.root / "mends"  # in place of fix, which mends no robot
        mends.write_text(f"""#!/bin/sh
            [ "$1" = fix ] || exec {TOOL} "$@"
            cd {self.root}
            while [ $# -gt 1 ]; do
              case "$1" in -o) cp arm.urdf "$2" ;; --report) cp fix.json "$2" ;; esac
              shift
            done""")
        mends.chmod(0o755)
        self.start(mends)
        result = self.call("fix", character="arm.urdf", motion="fold.csv", output="mended.urdf")
        self.assertEqual(result["structuredContent"]["clips"][0]["events"][0]["acting"], acting)
        self.assertIn("before: arm.urdf fold.csv, frame 58: upper in base", result["content"][1]["text"])

    def test_writes_files_below_its_root_alone_and_replaces_none_unasked(self):
        self.refused("outside", "export", character="../secret.glb", to="unity", output="x.json")
        for path in ("/etc/passwd", "out/x.obj"):
            self.refused("outside", "play", character=path)
            self.refused("outside", "export", character="arm.urdf", to="unity", output=path)
        self.refused("no such file", "play", character="nowhere.glb")
        for name in ("list.json", "list.txt"):
            (self.root / name).write_text('{"characters": ["../secret.glb"]}')
            self.refused("name the characters and recordings", "check", library=[name])
            self.refused("name the characters and recordings", "play", character="arm.urdf", motion=name)
        self.refused("fps is '30': pass a number", "play", character="arm.urdf", fps="30")
        self.refused("to is 'doom'", "export", character="arm.urdf", to="doom", output="x.json")
        self.refused("library is 'arm.urdf': pass a list", "check", library="arm.urdf")
        self.refused("no argument 'rm'", "check", library=["arm.urdf"], rm=True)
        result = self.call("export", character="arm.urdf", to="unity", output="arm.json", volumes="spheres")
        self.assertEqual(result["structuredContent"]["files"], ["SpherechainColliders.cs", "arm.json"])
        before = (self.root / "arm.json").read_bytes()
        (self.root / "SpherechainColliders.cs").write_text("mine")
        self.refused("is there already", "export", character="arm.urdf", to="unity", output="arm.json")
        (self.root / "arm.json").rename(self.root / "other.json")
        self.refused("SpherechainColliders.cs: is there already", "export", character="arm.urdf", to="unity", output="arm.json")
        self.assertEqual((self.root / "SpherechainColliders.cs").read_text(), "mine")
        self.call("export", character="arm.urdf", to="unity", output="arm.json", volumes="spheres", overwrite=True)
        self.assertEqual((self.root / "arm.json").read_bytes(), before)

    def test_a_cancelled_call_ends_its_process_and_is_not_answered(self):
        slow = self.root / "slow"
        slow.write_text(f"#!/bin/sh\necho $$ > {self.root}/new && mv {self.root}/new {self.root}/number\nexec sleep 60\n")
        slow.chmod(0o755)
        self.start(slow)
        self.send({"jsonrpc": "2.0", "id": "slow", "method": "tools/call",
                   "params": {"name": "play", "arguments": {"character": "arm.urdf"}, "_meta": MODERN}})
        self.wait_for((self.root / "number").exists)
        process = Path("/proc", (self.root / "number").read_text().strip())
        self.send({"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": "slow"}})
        self.wait_for(lambda: not process.exists())
        self.assertEqual(self.ask("server/discover", _meta=MODERN)["resultType"], "complete")

    def wait_for(self, is_there):
        end = time.monotonic() + 20
        while not is_there():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)


def picture_data(png):
    """The bytes of a PNG's IDAT chunks."""
    at, out = 8, b""
    while at < len(png):
        size = int.from_bytes(png[at:at + 4], "big")
        if png[at + 4:at + 8] == b"IDAT":
            out += png[at + 8:at + 8 + size]
        at += size + 12
    return out


if __name__ == "__main__":
    unittest.main()
