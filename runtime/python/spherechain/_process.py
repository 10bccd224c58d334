# SPDX-License-Identifier: MIT
"""The command line tool as a child process, which ends when nobody waits for it any more."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import threading
from pathlib import Path
from typing import Any, Callable, Iterator, List, NamedTuple, Optional, Sequence, Union

PathLike = Union[str, "os.PathLike[str]"]
Progress = Callable[[float, float], Any]  #: called with how much is done, and of how much

# Exit codes with which the tool has done its work.
TARGET_MISSED, FAULTS_LEFT, LIBRARY_FAILS = 5, 5, 6

_STEP = re.compile(r"(\d+) of (\d+)")
_MESSAGES = ("error", "warning", "note")
_TERMINATION = 0.1  # seconds that a process has to end itself, before it is killed


class ToolError(RuntimeError):
    """The tool refused. The text is its own; `code` its exit code: 2 usage, 3 a file, 4 no such body, 1 internal."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


class Ended(NamedTuple):
    code: int
    out: str
    error: str


def program(tool: Optional[PathLike] = None) -> str:
    """The path of the tool, as bake() looks for it."""
    inside = Path(__file__).with_name("tool") / "bin" / "spherechain"
    name = os.environ.get("SPHERECHAIN_TOOL") or (str(inside) if inside.exists() else "spherechain")
    name = name if tool is None else os.fspath(tool)
    found = shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"{name}: no such program. Pass tool=PATH, set SPHERECHAIN_TOOL, or put spherechain "
                                "on the PATH (cmake --build --preset release --target spherechain)")
    return found


def run_tool(arguments: Sequence[str], tool: Optional[PathLike] = None, fine: Sequence[int] = (),
             progress: Optional[Progress] = None, started: Callable[[subprocess.Popen], Any] = lambda process: None) -> Ended:
    """Runs the tool. An exception, Ctrl-C too, ends it at once.

    fine: exit codes besides 0 that are no ToolError. progress: called when the tool says how far it is, every ten seconds.
    started: gets the process, to end it from another thread.
    """
    found = program(tool)
    with _process([found, *arguments]) as process:
        started(process)
        lines: List[str] = []
        reader = threading.Thread(target=_read, args=(process.stderr, lines, progress), daemon=True)
        reader.start()
        out = process.stdout.read()
        process.wait()
        reader.join()
    error = "".join(lines)
    if process.returncode not in (0, *fine):
        message = error.strip() or f"{found} ended with {process.returncode}"
        raise ToolError(message.replace("spherechain: error: ", "", 1), process.returncode)
    return Ended(process.returncode, out, error)


@contextlib.contextmanager
def _process(command: List[str]) -> Iterator[subprocess.Popen]:
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               encoding="utf-8", errors="replace")
    try:
        yield process
    finally:
        end(process)
        process.stdout.close()


def end(process: subprocess.Popen) -> None:
    """Ends a process if it still runs. The tool's own children end with it."""
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.wait(_TERMINATION)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _read(stream: Any, lines: List[str], progress: Optional[Progress]) -> None:
    with stream:
        for line in stream:
            kind = line.split(": ")[1] if line.startswith("spherechain: ") and line.count(": ") > 1 else ""
            if not line.startswith("spherechain: ") or kind in _MESSAGES:
                lines.append(line)
                continue
            steps = [(int(done), int(total)) for done, total in _STEP.findall(line)]  # "0 of 2 clips; frame 22 of 2752"
            if steps and progress:
                done = sum(min(share / max(total, 1), 1) for share, total in steps[1:2])
                progress(steps[0][0] + done, steps[0][1])
