#!/usr/bin/env node
// How good the spheres are as an alarm: bakes each character, validates 60 frames of its clips, and prints a row each.
//   scripts/alarms.mjs build/release/bin/spherechain [--config SETTINGS.json] CHARACTER...
// A character is a mesh file, or MESH+MOTION to move it with a motion of another file.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";

const [tool, ...rest] = process.argv.slice(2);
const config = rest[0] === "--config" ? rest.splice(0, 2) : [];
if (!tool || rest.length === 0) {
  console.error("usage: alarms.mjs SPHERECHAIN [--config SETTINGS.json] CHARACTER[+MOTION]...");
  process.exit(2);
}
const kFrames = 60;
const folder = mkdtempSync(join(tmpdir(), "alarms-"));
const asset = join(folder, "asset.sphc"), found = join(folder, "found.json");
const json = (file) => JSON.parse(readFileSync(file, "utf8"));

function run(...args) {
  const result = spawnSync(tool, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (result.status === 0) return "";
  return (result.stderr ?? "").trim() || `exit ${result.status ?? result.signal}`;
}

const share = (x) => (x === null ? "-" : x.toFixed(3));
const row = (cells) => console.log(`| ${cells.join(" | ")} |`);
row(["character", "spheres", "true pairs", "recall", "precision", "far recall", "apart precision", "pairs a frame"]);
row(Array(8).fill("---"));
for (const character of rest) {
  const [mesh, motion] = character.split("+");
  const name = basename(mesh) + (motion ? ` + ${basename(motion)}` : "");
  rmSync(found, { force: true });
  const failed = run("bake", mesh, "-o", asset, "--force", ...config) ||
    run("validate", asset, "--source", mesh, ...(motion ? ["--motion", motion] : []), "--frames", String(kFrames), "--json", found);
  if (failed) {
    row([name, failed]);
    continue;
  }
  const all = json(found), spheres = all.all_pairs;
  row([name, JSON.parse(spawnSync(tool, ["inspect", asset, "--json"], { encoding: "utf8", maxBuffer: 1 << 28 }).stdout).sphere_count,
    all.truth_pairs, share(spheres.pair_recall), share(spheres.precision), share(spheres.far_recall),
    share(spheres.apart_precision), spheres.reported_per_frame.toFixed(1)]);
}
rmSync(folder, { recursive: true });
