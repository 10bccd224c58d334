# SPDX-License-Identifier: MIT
# cmake -D SCHEMA=sphere_chains.fbs -D OUT=later.fbs -P later_format.cmake: the schema as a later release may have it, with
# fields at the end of some tables.
cmake_minimum_required(VERSION 3.25)
file(READ ${SCHEMA} schema)
string(REPLACE "namespace spherechain.schema;" "namespace spherechain.later;" schema "${schema}")
string(REPLACE "table Asset {" "table Note { text: string (id: 0); }\n\ntable Asset {\n  notes: [Note] (id: 19);\n  sphere_weights: [float] (id: 20);"
  schema "${schema}")
string(REPLACE "table Part {" "table Part {\n  colour: uint = 7 (id: 5);" schema "${schema}")
file(WRITE ${OUT} "${schema}")
