# SPDX-License-Identifier: MIT
"""The command line tool, called. It is a program of its own under the GPL; nothing of it is linked."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional

from ._model import Model
from ._process import LIBRARY_FAILS, TARGET_MISSED, PathLike, run_tool

# bake() hands these over as options; all else is a key of the settings (docs/settings.md).
_BAKE_OPTIONS = ("profile", "preview", "force")


class Baked(NamedTuple):
    model: Model
    report: Dict[str, Any]  #: as docs/json.md has it; `missed_targets` says what was asked for in vain


def bake(path: PathLike, output: Optional[PathLike] = None, *, tool: Optional[PathLike] = None,
         **settings: Any) -> Baked:
    """Turns a character, glTF or anything assimp reads, into an asset.

    output: the .sphc file to write; None: none is kept. settings: keys of docs/settings.md (spheres=40, body="biped",
    extremities=False, roles={...}), or the options profile="paper", preview=FILE (a .glb to write) and force=True (replace
    a file of another kind). tool: path of the tool; else $SPHERECHAIN_TOOL, the one inside the package, or `spherechain` on
    the PATH.

    ToolError: it says why. A target that was missed is no error: it stands in report["missed_targets"].
    """
    options = {key: settings.pop(key) for key in _BAKE_OPTIONS if key in settings}
    with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        asset = Path(folder, "asset.sphc") if output is None else Path(output)
        report, config = Path(folder, "report.json"), Path(folder, "config.json")
        arguments = ["bake", os.fspath(path), "--output", os.fspath(asset), "--report", os.fspath(report)]
        if settings:
            config.write_text(json.dumps(settings))
            options["config"] = config
        run_tool(arguments + _options(options), tool, (TARGET_MISSED,))
        return Baked(Model(asset), json.loads(report.read_text()))


def check(*library: PathLike, output: Optional[PathLike] = None, tool: Optional[PathLike] = None,
          **options: Any) -> Dict[str, Any]:
    """Says which clips of a library are broken: the JSON of `spherechain check` (docs/json.md).

    library: characters: files, folders, or a manifest. output: folder for the report's pages; None: none are kept.
    options: those of the command, with _ for -: max_depth=5, baseline=FILE, folds=True, jobs=4. A library that fails is no
    error: result["summary"]["fails"] says so. tool: as bake() takes it.
    """
    with tempfile.TemporaryDirectory(prefix="spherechain-") as folder:
        result = Path(folder, "check.json")
        report = Path(folder, "report") if output is None else Path(output)
        arguments = ["check", *(os.fspath(path) for path in library), "--output", os.fspath(report), "--json", os.fspath(result)]
        run_tool(arguments + _options(options), tool, (LIBRARY_FAILS,))
        return json.loads(result.read_text())


def _options(options: Dict[str, Any]) -> List[str]:
    """max_depth=5 becomes --max-depth 5; True a flag; False and None nothing."""
    out: List[str] = []
    for key, value in options.items():
        if value is None or value is False:
            continue
        out.append("--" + key.replace("_", "-"))
        if value is not True:
            out.append(os.fspath(value) if isinstance(value, os.PathLike) else str(value))
    return out
