#!/usr/bin/env node
// Bakes and plays every character it is given without an option, and prints the table of docs/characters.md:
//   scripts/characters.mjs build/release/bin/spherechain CHARACTER... > docs/characters.md
// A character is a mesh file, or MESH+MOTION for one that is played with a motion of another file.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";

const [tool, ...characters] = process.argv.slice(2);
if (!tool || characters.length === 0) {
  console.error("usage: characters.mjs SPHERECHAIN CHARACTER[+MOTION]...");
  process.exit(2);
}
const folder = mkdtempSync(join(tmpdir(), "characters-"));
const asset = join(folder, "asset.sphc"), report = join(folder, "report.json"), played = join(folder, "play.json");
const json = (file) => JSON.parse(readFileSync(file, "utf8"));
const thousands = (n) => n.toLocaleString("en-US");
const mean = (numbers) => numbers.reduce((sum, n) => sum + n, 0) / numbers.length;

let failures = 0;
function run(...args) {
  const start = process.hrtime.bigint();
  const result = spawnSync(tool, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (result.status === 0) return Number(process.hrtime.bigint() - start) / 1e9;
  ++failures;
  return (result.stderr ?? "").trim() || `exit ${result.status ?? result.signal}`;
}

const rows = [];
for (const character of characters) {
  const [mesh, motion] = character.split("+");
  const name = basename(mesh) + (motion ? ` + ${basename(motion)}` : "");
  const baked = run("bake", mesh, "-o", asset, "--report", report, "--force");
  if (typeof baked === "string") {
    rows.push([name, baked]);
    continue;
  }
  const play = run("play", asset, "--source", mesh, ...(motion ? ["--motion", motion] : []), "--json", played);
  if (typeof play === "string") {
    rows.push([name, play]);
    continue;
  }
  const bake = json(report), inspected = JSON.parse(spawnSync(tool, ["inspect", asset, "--json"], { encoding: "utf8" }).stdout);
  const frames = json(played).frames;
  const regions = inspected.regions.map((r) => `${r.name.replaceAll("_", " ")} ${r.spheres}`).join(", ");
  const seconds = frames.length > 1 ? (frames.at(-1).time - frames[0].time) : 0;
  const clips = new Set(frames.map((frame) => frame.clip).filter(Boolean));
  const pairs = frames.map((frame) => frame.pairs.length);
  rows.push([
    name, thousands(bake.import.source_triangles), thousands(bake.import.components), inspected.bones.length,
    bake.segment.provider, inspected.sphere_count, regions, baked.toFixed(1), clips.size || (motion ? 1 : 0),
    thousands(frames.length), seconds ? seconds.toFixed(1) : "", play.toFixed(2),
    mean(pairs).toFixed(1), Math.max(...pairs),
  ]);
}
rmSync(folder, { recursive: true });

const head = ["character", "triangles", "pieces", "bones", "segmented by", "spheres", "of each region", "bake s", "clips",
  "frames", "of s", "played in s", "pairs a frame", "most"];
const line = (cells) => `| ${cells.join(" | ")} |`;
console.log(`# Characters: what a bake without an option makes of them

Made by one command, of Debian's \`assimp-testmodels\` and of glTF characters that are not part of the product:

\`\`\`
scripts/characters.mjs build/release/bin/spherechain CHARACTER[+MOTION]... > docs/characters.md
\`\`\`

Every character is baked with the profile \`balanced\` and plays all its clips, or the motion after the \`+\`, at 30 frames a
second; pairs are those reported at the detect radius (M2). Bones: those that move the skin; where a character brings none,
those of the automatic rig and one for what stays at rest. Bake and play are wall time of the whole command, reading the
files included.
`);
console.log(line(head));
console.log(line(head.map(() => "---")));
for (const row of rows) console.log(line(row));
process.exit(failures > 0 ? 1 : 0);
