#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints the functions that a 64-bit Windows DLL exports: `exports.py FILE.dll`."""
import struct
import sys

data = open(sys.argv[1], "rb").read()
header = struct.unpack_from("<I", data, 0x3c)[0]
sections, optional_size = struct.unpack_from("<H12xH", data, header + 6)
optional = header + 24
export = struct.unpack_from("<I", data, optional + 112)[0]
table = optional + optional_size


def offset(address):
    for i in range(sections):
        size, start, raw_size, raw = struct.unpack_from("<IIII", data, table + 40 * i + 8)
        if start <= address < start + max(size, raw_size):
            return raw + address - start
    sys.exit("exports: an address is in no section")


count, _, names = struct.unpack_from("<III", data, offset(export) + 24)
for i in range(count):
    at = offset(struct.unpack_from("<I", data, offset(names) + 4 * i)[0])
    print(data[at:data.index(b"\0", at)].decode())
