#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The binary interface as a list: functions, structs with the place of each field, enumerators and constants.

abi.py LIBRARY > abi.txt       write the list anew
abi.py LIBRARY --check FILE    compare it with the committed list; exit 1 where they differ, and say what that means

LIBRARY is the built libspherechain.a or .so: it must have all functions, and no others. The headers are runtime/include, read by
runtime/csharp/generate.py and compiled by cc, or $CC. The list is that of x86-64 Linux.
"""
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEADERS = os.path.join(ROOT, "runtime", "include")
sys.path.insert(0, os.path.join(ROOT, "runtime", "csharp"))
sys.dont_write_bytecode = True
import generate  # noqa: E402


class Header(generate.Header):
    """Types as the headers write them."""

    def type(self, text):
        super().type(text)  # an error for a type that nobody knows
        return " ".join(text.replace("*", " * ").split())

    def struct(self, name, body, again):
        super().struct(name, body, again)
        for text, field in re.findall(r"([\w \*]+\(\*(\w+)\)\((?:[^()]|\([^()]*\))*\)) ?;", body):
            self.structs[name] = [(f, text.strip() if f == field else kind, *rest) for f, kind, *rest in self.structs[name]]


def listed(library):
    header = Header(HEADERS)
    lines = ["#include <stdio.h>", "#include <spherechain/spherechain.h>", "int main(void) {"]

    def show(text, *values):
        numbers = "".join(", (unsigned long long)%s" % v for v in values)
        lines.append('  printf("%s\\n"%s);' % (text.replace("{}", "%llu"), numbers))

    for name in [*header.constants, *generate.LEFT_OUT]:
        show("%s = {}" % name, name)
    for name, members in header.enums.items():
        show("%s: {} bytes" % name, "sizeof(%s)" % name)
        for member, _, _ in members:
            show("%s.%s = {}" % (name, member), member)
    for name, fields in header.structs.items():
        show("%s: {} bytes, at multiples of {}" % name, "sizeof(%s)" % name, "_Alignof(%s)" % name)
        for field, kind, length, _ in fields:
            place = "offsetof(%s, %s)" % (name, field)
            show("%s.%s: %s%s at {}, {} bytes" % (name, field, kind, "[%d]" % length if length else ""), place, "sizeof((*(%s*)0).%s)" % (name, field))
    for name, result, parameters in header.functions:
        show("%s(%s) -> %s" % (name, ", ".join(kind for _, kind in parameters) or "void", result))
    lines += ["  return 0;", "}"]
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "abi")
        compiler = os.environ.get("CC", "cc").split()
        subprocess.run([*compiler, "-std=c11", "-I", HEADERS, "-xc", "-", "-o", program], input="\n".join(lines), check=True, universal_newlines=True)
        text = subprocess.run([program], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    symbols = subprocess.run(["nm", "-g", "--defined-only", *(["-D"] if ".so" in library else []), library], check=True, stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, universal_newlines=True).stdout
    exported, declared = set(re.findall(r" T (sc_\w+)", symbols)), {name for name, _, _ in header.functions}
    if exported != declared:
        sys.exit("%s and the headers differ in: %s" % (library, ", ".join(sorted(exported ^ declared))))
    return text.splitlines()


def breaks(old, new):
    """The differences that break a program which was linked to the old library."""
    sized = {line.split(".")[0] for line in old if re.match(r"\w+\.struct_size:", line)}
    names = {re.match(r"\w+", line).group() for line in old}

    def gone_breaks(line):
        size = re.match(r"(\w+): (\d+) bytes", line)
        later = size and [re.match(r"\w+: (\d+) bytes", n) for n in new if n.startswith(size.group(1) + ": ")]
        grows = size and size.group(1) in sized and later and int(later[0].group(1)) > int(size.group(2))
        return not grows and not re.match(r"\w+\.reserved:", line)

    def new_breaks(line):
        field = re.match(r"(\w+)\.\w+: .* at \d+,", line)
        owner = field and field.group(1)
        has_room = any(o.startswith("%s.reserved:" % owner) for o in old)
        return owner in names and owner not in sized and not has_room
    return [line for line in old if line not in new and gone_breaks(line)] + [line for line in new if line not in old and new_breaks(line)]


def check(library, path):
    with open(path) as file:
        old = file.read().splitlines()
    new = listed(library)
    if old == new:
        print("%d lines are those of %s" % (len(new), path))
        return
    for mark, lines, others in (("-", old, new), ("+", new, old)):
        print("\n".join("%s %s" % (mark, line) for line in lines if line not in others))
    broken = breaks(old, new)
    print("\nThe binary interface differs from %s (- was, + is)." % path)
    if broken:
        print("A program that is linked to the last release breaks by:\n  %s\nTake it back, or count up SC_ABI_VERSION (docs/integration.md, \"Versions and"
              " compatibility\")." % "\n  ".join(broken))
    else:
        print("As far as this script sees it is compatible: things are added where there is room. It cannot see what a field or a function means.")
    print("Then write the list anew: tests/package/abi.py LIBRARY > %s" % path)
    sys.exit(1)


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[2] == "--check":
        check(sys.argv[1], sys.argv[3])
    elif len(sys.argv) == 2:
        print("\n".join(listed(sys.argv[1])))
    else:
        sys.exit(__doc__)
