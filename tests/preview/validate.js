// Validates glTF files by the Khronos validator: fails on any error or warning.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

// The validator is installed where this is run, in the build tree.
const validator = createRequire(`${process.cwd()}/`)("gltf-validator");

for (const file of process.argv.slice(2)) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)), { uri: file });
  console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ` +
              `${issues.numInfos} infos, ${issues.numHints} hints`);
  for (const { code, message, pointer } of issues.messages) console.log(`  ${code} at ${pointer}: ${message}`);
  if (issues.numErrors + issues.numWarnings > 0) process.exitCode = 1;
}
