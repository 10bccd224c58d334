# SPDX-License-Identifier: MIT
"""A server of the Model Context Protocol over standard input and output: agents check, play, fix, mask and export characters.

    python -m spherechain.mcp --root characters/

It speaks revision 2026-07-28, in which each request names its revision, and those before it, which begin with `initialize`.
docs/agents.md has the tools. It uses the standard library alone, beside the package itself.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Dict, List, Optional

from . import __version__
from ._mcp_tools import TOOLS, Refused, check_arguments
from ._process import Ended, ToolError, end, run_tool

MODERN = "2026-07-28"
LEGACY = ("2025-11-25", "2025-06-18", "2024-11-05")
_META = "io.modelcontextprotocol/"
_PARSE_ERROR, _INVALID_REQUEST, _NO_METHOD, _INVALID_PARAMS, _INTERNAL, _NO_VERSION = -32700, -32600, -32601, -32602, -32603, -32022
_ABOUT = {"name": "spherechain", "version": __version__}
_CALLS_AT_ONCE = 2
_LINE_MAX = 1 << 20  # bytes
_INSTRUCTIONS = ("Paths are relative to the server's root folder. Check a character first; play says which body parts "
                 "penetrate in one motion; fix writes a mended copy.")


class _Error(Exception):
    def __init__(self, code: int, message: str, data: Any = None) -> None:
        super().__init__(message)
        self.code, self.data = code, data


class Call:
    """A call of a tool, which can be cancelled at any time."""

    def __init__(self, server: "Server", token: Any) -> None:
        self.root, self.tool = server.root, server.tool
        self.is_cancelled = False
        self._server, self._token, self._said = server, token, 0.0
        self._process: Optional[subprocess.Popen] = None
        self._lock = threading.Lock()

    def run(self, *arguments: str, fine: Any = ()) -> Ended:
        """Runs the command line tool."""
        done = run_tool(arguments, self.tool, fine, None if self._token is None else self._progress, self._started)
        if self.is_cancelled:
            raise Refused("cancelled")
        return done

    def cancel(self) -> None:
        with self._lock:
            self.is_cancelled = True
            if self._process is not None:
                end(self._process)

    def _started(self, process: subprocess.Popen) -> None:
        with self._lock:
            self._process = process
            if self.is_cancelled:
                end(process)

    def _progress(self, done: float, total: float) -> None:
        if done <= self._said or self.is_cancelled:
            return
        self._said = done
        self._server.send({"method": "notifications/progress",
                           "params": {"progressToken": self._token, "progress": done, "total": total}})


class Server:
    def __init__(self, root: Path, tool: Optional[str], output: Any) -> None:
        self.root, self.tool = root, tool
        self._output, self._lock = output, threading.Lock()
        self._calls: Dict[Any, Call] = {}
        self._is_open = False  # an older client has said initialize
        self._pool = ThreadPoolExecutor(_CALLS_AT_ONCE)

    def serve(self, lines: Any) -> None:
        """Answers until the input ends. Then whatever runs is ended."""
        try:
            while line := lines.readline(_LINE_MAX + 1):
                if len(line) > _LINE_MAX:
                    while not line.endswith(b"\n") and (line := lines.readline(_LINE_MAX)):
                        pass
                    self._fail(None, _Error(_INVALID_REQUEST, f"a line has more than {_LINE_MAX} bytes"))
                elif line.strip():
                    self._take(line)
        finally:
            for call in list(self._calls.values()):
                call.cancel()
            self._pool.shutdown(cancel_futures=True)

    def send(self, message: Dict[str, Any]) -> None:
        text = json.dumps({"jsonrpc": "2.0", **message}) + "\n"
        with self._lock:
            try:
                self._output.write(text.encode())
                self._output.flush()
            except (BrokenPipeError, ValueError):
                pass  # the client is gone: the input ends, too

    def _fail(self, number: Any, error: _Error) -> None:
        data = {} if error.data is None else {"data": error.data}
        self.send({"id": number, "error": {"code": error.code, "message": str(error), **data}})

    def _take(self, line: bytes) -> None:
        try:
            message = json.loads(line)
        except (ValueError, RecursionError) as error:
            return self._fail(None, _Error(_PARSE_ERROR, f"no JSON: {error}"))
        number = message.get("id") if isinstance(message, dict) else None
        has_number = isinstance(number, (str, int)) and not isinstance(number, bool)
        if not isinstance(message, dict) or message.get("jsonrpc") != "2.0":
            return self._fail(number if has_number else None, _Error(_INVALID_REQUEST, "no JSON-RPC 2.0 message"))
        method, params = message.get("method"), message.get("params", {})
        if "id" not in message:
            return self._notified(method, params)
        if method is None and ("result" in message or "error" in message):
            return None  # an answer to nothing that was asked
        try:
            if not has_number:
                number = None
                raise _Error(_INVALID_REQUEST, "id: a text or a whole number")
            if not isinstance(method, str) or not isinstance(params, dict):
                raise _Error(_INVALID_REQUEST, "method: a text; params: an object")
            self._asked(number, method, params)
        except _Error as error:
            self._fail(number, error)
        return None

    def _notified(self, method: Any, params: Any) -> None:
        if method == "notifications/cancelled" and isinstance(params, dict):
            number = params.get("requestId")
            call = self._calls.get(number) if isinstance(number, (str, int)) else None
            if call is not None:
                call.cancel()

    def _asked(self, number: Any, method: str, params: Dict[str, Any]) -> None:
        meta = params.get("_meta", {})
        if not isinstance(meta, dict):
            raise _Error(_INVALID_PARAMS, "_meta: an object")
        version = meta.get(_META + "protocolVersion")
        is_modern = version is not None
        if is_modern and version != MODERN:
            raise _Error(_NO_VERSION, "Unsupported protocol version", {"supported": [MODERN, *LEGACY], "requested": version})
        if is_modern and not isinstance(meta.get(_META + "clientCapabilities"), dict):
            raise _Error(_INVALID_PARAMS, f"_meta has no {_META}clientCapabilities")
        common = {"capabilities": {"tools": {}}, "instructions": _INSTRUCTIONS}
        lasts = {"ttlMs": 3600000, "cacheScope": "public"} if is_modern else {}
        if method == "initialize" and not is_modern:
            self._is_open = True
            asked = params.get("protocolVersion")
            self._answer(number, False, {"protocolVersion": asked if asked in LEGACY else LEGACY[0], "serverInfo": _ABOUT, **common})
        elif method == "ping" and not is_modern:
            self._answer(number, False, {})
        elif method == "server/discover" and is_modern:
            self._answer(number, True, {"supportedVersions": [MODERN, *LEGACY], "serverInfo": _ABOUT, **common, **lasts})
        elif not is_modern and not self._is_open:
            raise _Error(_INVALID_PARAMS, f"send initialize first, or _meta with {_META}protocolVersion")
        elif method == "tools/list":
            self._answer(number, is_modern, {"tools": [tool.listed() for tool in TOOLS.values()], **lasts})
        elif method == "tools/call":
            self._call(number, is_modern, params, meta)
        else:
            raise _Error(_NO_METHOD, f"there is no method {method}")

    def _answer(self, number: Any, is_modern: bool, result: Dict[str, Any]) -> None:
        if is_modern:
            result = {"resultType": "complete", **result, "_meta": {_META + "serverInfo": _ABOUT}}
        self.send({"id": number, "result": result})

    def _call(self, number: Any, is_modern: bool, params: Dict[str, Any], meta: Dict[str, Any]) -> None:
        name, arguments = params.get("name"), params.get("arguments", {})
        if not isinstance(name, str) or name not in TOOLS:
            raise _Error(_INVALID_PARAMS, f"Unknown tool: {name}")
        if not isinstance(arguments, dict):
            raise _Error(_INVALID_PARAMS, "arguments: an object")
        if number in self._calls:
            raise _Error(_INVALID_REQUEST, f"id {number} is of a call that still runs")
        token = meta.get("progressToken")
        call = self._calls[number] = Call(self, token if isinstance(token, (str, int)) else None)
        self._pool.submit(self._work, number, is_modern, name, arguments, call)

    def _work(self, number: Any, is_modern: bool, name: str, arguments: Dict[str, Any], call: Call) -> None:
        try:
            if call.is_cancelled:
                return
            check_arguments(TOOLS[name], arguments)
            structured, pictures = TOOLS[name].run(call, arguments)
            content: List[Dict[str, Any]] = [{"type": "text", "text": json.dumps(structured, indent=1)}]
            for caption, picture in pictures:
                content += [{"type": "text", "text": caption}, {"type": "image", "data": picture, "mimeType": "image/png"}]
            result = {"content": content, "structuredContent": structured, "isError": False}
        except (Refused, ToolError, OSError) as error:
            result = {"content": [{"type": "text", "text": str(error)}], "isError": True}
        except Exception as error:  # pylint: disable=broad-except
            if not call.is_cancelled:
                self._calls.pop(number, None)
                self._fail(number, _Error(_INTERNAL, f"{type(error).__name__}: {error}"))
            return
        finally:
            self._calls.pop(number, None)
        if not call.is_cancelled:
            self._answer(number, is_modern, result)


def main(arguments: Optional[List[str]] = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m spherechain.mcp", description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=".", help="folder that all paths must lie in (default: the current one)")
    parser.add_argument("--tool", help="path of the command line tool (default: $SPHERECHAIN_TOOL, inside the wheel, or on the PATH)")
    options = parser.parse_args(arguments)
    root = Path(options.root).resolve()
    if not root.is_dir():
        parser.error(f"--root {options.root}: there is no such folder")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    output, sys.stdout = sys.stdout.buffer, sys.stderr  # nothing but messages goes to standard output
    try:
        Server(root, options.tool, output).serve(sys.stdin.buffer)
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
