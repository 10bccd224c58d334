# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tool in the background. A thread waits for it and reads what it prints; it never touches Blender."""

import os
import signal
import subprocess
import threading

from . import results


class Failed(Exception):
    """One line for the panel."""


class Job(threading.Thread):
    """Calls `work(job)` in a thread. The caller polls `is_alive()`, then reads `result` or `error`."""

    def __init__(self, work, names):
        super().__init__(daemon=True)
        self.work, self.names = work, names
        self.progress, self.result, self.error = "", None, ""
        self.cancelled, self.process, self.lock = False, None, threading.Lock()

    def run(self):
        try:
            self.result = self.work(self)
        except Failed as problem:
            self.error = str(problem)
        except (OSError, ValueError, KeyError, IndexError) as problem:
            self.error = results.renamed(f"the tool's answer cannot be read: {problem}".splitlines()[0], self.names)

    def tool(self, command, good=(0,)):
        """Runs one command of the tool to its end. Another exit code than `good` fails the job with the tool's error."""
        with self.lock:
            if self.cancelled:
                raise Failed("cancelled")
            try:
                self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                                stderr=subprocess.PIPE, text=True, encoding="utf-8", errors="replace",
                                                start_new_session=True)
            except OSError as problem:
                raise Failed(f"{command[0]} cannot be started: {problem.strerror}") from problem
        printed = []
        for line in self.process.stderr:
            printed.append(line)
            self.progress = results.progress_line(line, self.names) or self.progress
        code = self.process.wait()
        self.process.stderr.close()
        if self.cancelled:
            raise Failed("cancelled")
        if code not in good:
            raise Failed(results.error_line("".join(printed), self.names))
        return "".join(printed)

    def cancel(self):
        """Ends the tool and all that it started."""
        with self.lock:
            self.cancelled = True
            if self.process and self.process.poll() is None:
                kill_group(self.process)
        self.join(5)


def kill_group(process):
    if not hasattr(os, "killpg"):  # Windows
        process.kill()
        return
    try:
        os.killpg(process.pid, signal.SIGTERM)
        process.wait(2)
    except (ProcessLookupError, subprocess.TimeoutExpired):
        pass
    try:
        os.killpg(process.pid, signal.SIGKILL)  # processes that the tool started and did not end
    except ProcessLookupError:
        pass
