#!/usr/bin/env node
// SPDX-License-Identifier: MIT
// `npx spherechain ...` runs the command line tool, a program under the GPL in a package of its own for each platform.
import { spawnSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';

const name = `@spherechain/${process.platform}-${process.arch}`;
let tool;
try {
  tool = join(dirname(createRequire(import.meta.url).resolve(`${name}/package.json`)), 'bin', 'spherechain');
} catch {
  console.error(`spherechain: error: the tool is not installed: it lies in the package ${name}, which exists for linux-x64 alone`);
  process.exit(1);
}
const done = spawnSync(tool, process.argv.slice(2), { stdio: 'inherit' });
if (done.error) {
  console.error(`spherechain: error: ${tool}: ${done.error.message}`);
  process.exit(1);
}
if (done.signal) process.kill(process.pid, done.signal);
process.exit(done.status ?? 1);
