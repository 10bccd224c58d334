#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes Spherechain.Native.cs from the C headers, and what the test compares it with.

generate.py HEADERS              print Spherechain.Native.cs
generate.py HEADERS --layout     print a C program that prints the layout of all it declares, with C# names

HEADERS is runtime/include. The C preprocessor (cc, or $CC) reads spherechain.h. What is neither an enum, a struct, a function
nor a number is an error: nothing in the headers can be passed over in silence.
"""
import itertools
import os
import re
import subprocess
import sys

# Constants that C# cannot have, and why.
LEFT_OUT = {
    "SC_WHOLE_SOURCE": "its width depends on the machine: pass new UIntPtr(UIntPtr.Size == 8 ? ulong.MaxValue : uint.MaxValue)",
}
RENAMED = {"sc_transform": "JointTransform"}  # Transform is UnityEngine's
OPAQUE = {"sc_body", "sc_model", "sc_response"}  # handles: IntPtr
NUMBERS = {"void": "void", "char": "byte", "int": "int", "float": "float", "int32_t": "int", "uint32_t": "uint",
           "uint64_t": "ulong", "size_t": "UIntPtr"}
KEYWORDS = {"in", "out", "ref", "params", "object", "string", "lock", "fixed", "base", "this", "is", "as", "event", "checked"}
ARRAY_MAX = 4  # longer arrays stay arrays, which only unsafe code reads


def fail(text):
    sys.exit("generate.py: " + text)


def preprocess(headers, *options):
    command = os.environ.get("CC", "cc").split() + ["-E", "-xc", "-std=c11", "-I", headers, *options, "-"]
    return subprocess.run(command, check=True, input="#include <spherechain/spherechain.h>\n", stdout=subprocess.PIPE,
                          universal_newlines=True).stdout


def own_lines(text):
    """What the public headers themselves say, without the system's."""
    own = False
    for line in text.split("\n"):
        marker = re.match(r'# \d+ "(.*)"', line)
        if marker:
            own = os.path.basename(os.path.dirname(marker.group(1))) == "spherechain"
        elif own:
            yield line


def pascal(name):
    return "".join(word[:1].upper() + word[1:] for word in name.split("_"))


def type_name(name):
    return RENAMED.get(name) or pascal(name[len("sc_"):])


class Header:
    def __init__(self, headers):
        self.enums, self.structs, self.functions, self.constants = {}, {}, [], {}
        self.raw = "".join(open(os.path.join(headers, "spherechain", f)).read()
                           for f in sorted(os.listdir(os.path.join(headers, "spherechain"))))
        self.parse(" ".join(" ".join(own_lines(preprocess(headers))).split()))
        marks = len(re.findall(r"^SPHERECHAIN_API ", self.raw, re.M))
        if marks != len(self.functions):
            fail("the headers mark %d functions, %d were read" % (marks, len(self.functions)))
        for line in sorted(preprocess(headers, "-dM").split("\n")):
            define = re.match(r"#define (SC_\w+) (.+)", line)
            if not define or define.group(1) in ("SC_ZERO", "SC_NOEXCEPT") or define.group(1) in LEFT_OUT:
                continue
            if not re.fullmatch(r"\d+|0x[0-9A-Fa-f]+u", define.group(2)):
                fail("what is %s?" % line)
            self.constants[define.group(1)] = define.group(2)

    def parse(self, text):
        # After the preprocessor SC_ENUM is `typedef int32_t NAME; enum {...};`.
        rules = [
            (r"typedef int32_t (sc_\w+); enum ?\{(.*?)\};", self.enum),
            (r"typedef struct (sc_\w+) \{(.*?)\} (sc_\w+);", self.struct),
            (r"typedef struct (sc_\w+) sc_\w+;", lambda name: name in OPAQUE or fail("what is in %s?" % name)),
            (r"([\w \*]+?)(sc_\w+)\(([^()]*)\) ?;", self.function),
        ]
        while text.strip():
            text = text.strip()
            for pattern, take in rules:
                found = re.match(pattern, text)
                if found:
                    take(*found.groups())
                    text = text[found.end():]
                    break
            else:
                fail("what is this?\n" + text[:200])

    def enum(self, name, body):
        # The members' common beginning goes: SC_FIELD_BONES is Field.Bones.
        members = [re.fullmatch(r"(SC_\w+) ?= ?(\d+)", m.strip()) or fail("%s: what is %s?" % (name, m))
                   for m in body.strip().rstrip(",").split(",")]
        prefixes = ["SC_%s_" % name[3:].upper(), "SC_%s_" % name.split("_")[-1].upper(), "SC_"]
        prefix = next(p for p in prefixes if all(m.group(1).startswith(p) for m in members))
        self.enums[name] = [(m.group(1), self.member(m.group(1)[len(prefix):]), m.group(2)) for m in members]

    @staticmethod
    def member(name):
        words = [w if re.match(r"\d", w) else w.capitalize() for w in name.split("_")]
        return re.sub(r"(\d)X(\d)", r"\1x\2", "".join(words))

    def struct(self, name, body, again):
        fields = []  # name, type, length, and a number that the names of one declaration share
        while body.strip():
            body = body.strip()
            callback = re.match(r"[\w \*]+\(\*(\w+)\)\((?:[^()]|\([^()]*\))*\) ?;", body)
            if callback:
                fields.append((callback.group(1), "IntPtr", 0, len(body)))
                body = body[callback.end():]
                continue
            found = re.match(r"((?:const )?\w+ ?\**(?: const\*)?) ?([\w\[\], ]+?) ?;", body) or fail("%s: what is %s?" % (name, body[:80]))
            for field in found.group(2).split(","):
                array = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", field.strip()) or fail("%s: what is %s?" % (name, field))
                fields.append((array.group(1), self.type(found.group(1)), int(array.group(2) or 0), len(body)))
            body = body[found.end():]
        self.structs[name] = fields

    def function(self, result, name, parameters):
        taken = []
        for parameter in parameters.split(","):
            if parameter.strip() == "void":
                continue
            found = re.fullmatch(r"(.*?[ \*])(\w+)", parameter.strip()) or fail("%s: what is %s?" % (name, parameter))
            taken.append((found.group(2), self.type(found.group(1))))
        self.functions.append((name, self.type(result), taken))

    def type(self, text):
        words = text.replace("const", "").replace("*", " * ").split()
        stars = words.count("*")
        base = next(w for w in words if w != "*")
        if base in OPAQUE:
            return "IntPtr" + "*" * (stars - 1)
        if base in NUMBERS:
            return NUMBERS[base] + "*" * stars
        if base in self.enums or base in self.structs:
            return type_name(base) + "*" * stars
        fail("what type is %s?" % text)

    def is_plain(self, name):
        """Can code that is not `unsafe` use all of it?"""
        for _, kind, length, _ in self.structs[name]:
            inner = [s for s in self.structs if type_name(s) == kind]
            if "*" in kind or kind in ("IntPtr", "UIntPtr") or length > ARRAY_MAX or (inner and not self.is_plain(inner[0])):
                return False
        return True

    def comment(self, owner, name):
        """What the header says behind a field or enumerator, on its lines."""
        start = re.search(r"typedef struct %s \{|SC_ENUM\(%s\)" % (owner, owner), self.raw).start()
        end = re.compile(r"^\} \w+;|\};", re.M).search(self.raw, start).start()
        found = re.search(r"\b%s\b[^;,/{]*[;,]? */\*(.*?)\*/" % name, self.raw[start:end], re.S)
        return " ".join(found.group(1).split()) if found else ""


def doc(text, indent):
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return ["%s/// <summary>%s</summary>" % (indent, text)] if text else []


def struct_lines(header, name, indent):
    """A line for each declaration of the header, as that has them."""
    lines = ["%spublic %sstruct %s  // %s" % (indent, "" if header.is_plain(name) else "unsafe ", type_name(name), name), indent + "{"]
    for _, group in itertools.groupby(header.structs[name], key=lambda field: field[3]):
        names = []
        for field, kind, length, _ in group:
            comment = header.comment(name, field)  # behind the last
            if length > ARRAY_MAX:
                kind, names = "fixed " + kind, ["%s[%d]" % (pascal(field), length)]
            else:
                names += [pascal(field)] if not length else ["%s%d" % (pascal(field), i) for i in range(length)]
        lines += doc(comment, indent + "    ") + ["%s    public %s %s;" % (indent, kind, ", ".join(names))]
    return lines + [indent + "}", ""]


def native(header):
    lines = """// SPDX-License-Identifier: MIT
// Written by runtime/csharp/generate.py from the C headers; the test csharp.native fails where it is not what they say now.
// Types without pointers are public for all code. Structs with pointers, and functions, are in the class Native, for unsafe code.
// The headers (runtime/include/spherechain) say what each function promises; size_t is UIntPtr, a function pointer an IntPtr.
using System;
using System.Runtime.InteropServices;

namespace Spherechain
{""".split("\n")
    for name, members in header.enums.items():
        lines += ["    public enum %s : int  // %s" % (type_name(name), name), "    {"]
        for c_name, cs_name, value in members:
            lines += doc(header.comment(name, c_name), "        ")
            lines.append("        %s = %s," % (cs_name, value))
        lines += ["    }", ""]
    for name in header.structs:
        if header.is_plain(name):
            lines += struct_lines(header, name, "    ")
    lines += """    public static unsafe class Native
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        public const string Library = "__Internal";  // linked into the program
#else
        public const string Library = "spherechain";  // spherechain.dll, libspherechain.so, libspherechain.dylib
#endif
        const CallingConvention Cdecl = CallingConvention.Cdecl;
""".split("\n")
    for name, value in header.constants.items():
        lines.append("        public const uint %s = %s;" % (header.member(name[3:]), value))
    for name, reason in LEFT_OUT.items():
        lines.append("        // Left out: %s: %s." % (name, reason))
    lines.append("")
    for name in header.structs:
        if not header.is_plain(name):
            lines += struct_lines(header, name, "        ")
    for name, result, parameters in header.functions:
        listed = ", ".join("%s %s%s" % (kind, "@" if p in KEYWORDS else "", p) for p, kind in parameters)
        lines.append("        [DllImport(Library, CallingConvention = Cdecl)] public static extern %s %s(%s);" % (result, name, listed))
    lines.append("    }")
    return "\n".join(lines + ["}"])


def layout(header):
    lines = ["#include <stdio.h>", "#include <spherechain/spherechain.h>",
             '#define KIND(x) _Generic((x), float: "float", int32_t: "signed", uint32_t: "unsigned", uint64_t: "unsigned", '
             'char: "char", default: "other")', "int main(void) {"]
    for name, members in header.enums.items():
        for c_name, cs_name, _ in members:
            lines.append('  printf("enum %s.%s %%d\\n", (int)%s);' % (type_name(name), cs_name, c_name))
        lines.append('  printf("enum %s: %%d bytes\\n", (int)sizeof(%s));' % (type_name(name), name))
    for name in header.constants:
        lines.append('  printf("constant %s %%u\\n", (unsigned)%s);' % (header.member(name[3:]), name))
    for name, fields in header.structs.items():
        lines.append('  printf("struct %s: %%d bytes\\n", (int)sizeof(%s));' % (type_name(name), name))
        for field, kind, length, _ in fields:
            names = [(pascal(field), field)]
            if 0 < length <= ARRAY_MAX:
                names = [("%s%d" % (pascal(field), i), "%s[%d]" % (field, i)) for i in range(length)]
            for cs_name, c_name in names:
                one = "((%s*)0)->%s" % (name, c_name)
                kind_of = '"array"' if length > ARRAY_MAX else "KIND(%s)" % one
                lines.append('  printf("field %s.%s at %%d, %%d bytes, %%s\\n", (int)offsetof(%s, %s), (int)sizeof(%s), %s);' %
                             (type_name(name), cs_name, name, c_name, one, kind_of))
    for name, result, parameters in header.functions:
        lines.append('  puts("function %s %s(%s)");' % (result, name, ", ".join(kind for _, kind in parameters)))
    return "\n".join(lines + ["  return 0;", "}"])


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--layout"]):
        sys.exit(__doc__)
    print((layout if "--layout" in sys.argv else native)(Header(sys.argv[1])))
