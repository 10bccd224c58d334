#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the wheel in each Python from 3.9 to 3.13 that this machine has, without a network, and goes from a character to its
# first contacts: `scripts/release/try/wheel.sh OUT`. A Python without numpy gets a stand-in for its arrays, so that at least the
# compiled module is tried there.
set -euo pipefail
cd "$(dirname "$0")/../../.."
. scripts/release/common.sh

model=/usr/share/assimp/models/Collada/human.zae
[[ -e $model ]] || skip "$model is missing (Debian: assimp-testmodels)"
wheel=$(realpath "$1"/spherechain-*manylinux*.whl)
python3 scripts/release/check_wheel.py "$wheel"
try=$(mktemp -d)
trap 'rm -rf "$try"' EXIT
cat >"$try/first.py" <<'END'
import sys
import numpy as np
import spherechain

model = spherechain.bake(sys.argv[1], "human.sphc", force=True).model
bones = np.tile(np.eye(3, 4, dtype=np.float32), (len(model.bones), 1, 1))
arm = [i for i, bone in enumerate(model.bones) if bone.name in ("left_shoulder", "left_elbow", "left_wrist")]
inverse = model.bones[arm[0]].inverse_bind
at = -inverse[:, :3].T @ inverse[:, 3]
c, s = np.cos(np.pi / 3), -np.sin(np.pi / 3)
turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
bones[arm] = np.column_stack([turn, at - turn @ at])
found = model.penetrations(bones, classes=spherechain.CLASSES)
print(model, found, sep="\n")
assert len(model.contacts(bones)) > 0
END
cat >"$try/without_numpy.py" <<'END'
# The module with a stand-in for numpy, which has no more than the module uses: numpy.empty() and __array_struct__.
import ctypes
import math
import sys
import sysconfig
import types
from pathlib import Path


class Interface(ctypes.Structure):
    _fields_ = [("two", ctypes.c_int), ("axes", ctypes.c_int), ("kind", ctypes.c_char), ("item_size", ctypes.c_int),
                ("flags", ctypes.c_int), ("shape", ctypes.c_void_p), ("strides", ctypes.c_void_p), ("data", ctypes.c_void_p),
                ("description", ctypes.c_void_p)]


new_capsule = ctypes.pythonapi.PyCapsule_New
new_capsule.restype, new_capsule.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]


class Array:
    def __init__(self, shape, type="f4"):
        count = math.prod(shape)
        self.numbers = ({"f4": ctypes.c_float, "u4": ctypes.c_uint32}[type] * max(1, count))()
        self.shape = (ctypes.c_ssize_t * len(shape))(*shape)
        self.strides = (ctypes.c_ssize_t * len(shape))(*(4 * math.prod(shape[i + 1:]) for i in range(len(shape))))
        self.interface = Interface(2, len(shape), type[0].encode(), 4, 0x701, ctypes.addressof(self.shape),
                                   ctypes.addressof(self.strides), ctypes.addressof(self.numbers), None)
        self.__array_struct__ = new_capsule(ctypes.addressof(self.interface), None, None)


sys.modules["numpy"] = types.SimpleNamespace(empty=Array)
sys.path.insert(0, str(Path(sysconfig.get_path("platlib"), "spherechain")))
import _native

model = _native.Model(Path("human.sphc").read_bytes(), None)
names = [name for name, _ in model.info()["bones"]]
arm = [names.index(name) for name in ("left_shoulder", "left_elbow", "left_wrist")]
inverse = model.info()["bones"][arm[0]][1].numbers
at = [-sum(inverse[4 * row + k] * inverse[4 * row + 3] for row in range(3)) for k in range(3)]
c, s = math.cos(math.pi / 3), -math.sin(math.pi / 3)
turn = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
bones = Array((1, len(names), 3, 4))
for bone in range(len(names)):
    for row in range(3):
        matrix = turn if bone in arm else [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        shift = at[row] - sum(matrix[row][k] * at[k] for k in range(3))
        bones.numbers[12 * bone + 4 * row:12 * bone + 4 * row + 4] = [*matrix[row], shift]
query = dict.fromkeys(("ignored_parts", "ignored_parts_of_other", "part_pairs", "previous", "ignored_spheres"))
query.update(scope=_native.SCOPES["apart"], full=False, classes=0x7F, limit=0, tolerance=0.0, ground=[0, 0, 0, 0],
             rule=_native.Model.default_rule())
(parts, _, _, _), = model.ask(1, (None, (bones, None, None)), None, (None, None), query, 1)
spheres = model.spheres(bones, _native.RADII["detect"], 1)
print(len(spheres.numbers) // 4, "spheres,", len(parts) // _native.SIZES[1], "contacts of body parts")
assert parts
END

tried=0
cd "$try"
for minor in 9 10 11 12 13; do
  python=
  for place in "/usr/bin/python3.$minor" "$(command -v "python3.$minor" || true)" "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3."$minor".*/bin/python3; do
    if [[ -n $place ]] && "$place" -c 'import venv' 2>/dev/null; then
      python=$place
      break
    fi
  done
  if [[ -z $python ]]; then
    echo "Python 3.$minor: not found"
    continue
  fi
  rm -rf venv human.sphc
  "$python" -m venv --system-site-packages venv
  venv/bin/python -m pip install --quiet --disable-pip-version-check --no-index --no-deps "$wheel"
  env -u SPHERECHAIN_TOOL venv/bin/python -m spherechain --version | head -1
  env -u SPHERECHAIN_TOOL venv/bin/spherechain bake "$model" -o human.sphc >log 2>&1 || { cat log; exit 1; }
  if venv/bin/python -c 'import numpy' 2>/dev/null; then
    env -u SPHERECHAIN_TOOL PATH=/usr/bin:/bin venv/bin/python first.py "$model"
    echo "Python 3.$minor: from the wheel to contacts"
  else
    (venv/bin/python -c 'from spherechain import Model' 2>&1 || true) | grep -Fx "ModuleNotFoundError: spherechain.Model needs numpy: pip install numpy" >/dev/null
    venv/bin/python without_numpy.py
    echo "Python 3.$minor: it has no numpy: the tool and the module go to contacts, with a stand-in for numpy's arrays"
  fi
  tried=$((tried + 1))
done
[[ $tried -gt 0 ]] || skip "no Python from 3.9 to 3.13 was found"
