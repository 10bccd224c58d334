#!/usr/bin/env node
// Bakes and plays every character without an option, draws its spheres at the first frame into docs/characters/, and
// writes the table of docs/characters.md between its marks:
//   scripts/characters.mjs build/release/bin/spherechain CHARACTER...
// draw_asset (samples/pictures) is expected beside the tool.
// A character is a mesh file, or MESH+MOTION to play it with a motion of another file.
import { spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [tool, ...characters] = process.argv.slice(2);
if (!tool || characters.length === 0) {
  console.error("usage: characters.mjs SPHERECHAIN CHARACTER[+MOTION]...");
  process.exit(2);
}
const docs = join(dirname(fileURLToPath(import.meta.url)), "../docs");
const page = join(docs, "characters.md"), pictures = join(docs, "characters");
mkdirSync(pictures, { recursive: true });
const kBegin = "<!-- table: scripts/characters.mjs -->\n", kEnd = "<!-- end of table -->";
const folder = mkdtempSync(join(tmpdir(), "characters-"));
const asset = join(folder, "asset.sphc"), report = join(folder, "report.json"), played = join(folder, "play.json");
const json = (file) => JSON.parse(readFileSync(file, "utf8"));
const thousands = (n) => n.toLocaleString("en-US");
const framesOf = (contact) => contact.frames.reduce((sum, [first, last]) => sum + last - first + 1, 0);

// Nothing, or the tool's message.
function run(...args) {
  const result = spawnSync(tool, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (result.status === 0) return "";
  const said = (result.stderr ?? "").trim() || `exit ${result.status ?? result.signal}`;
  return said.replace("spherechain: error: ", "").replaceAll("|", "\\|");
}

// The pair of body parts that touches in most frames.
function mostFrequent(clips) {
  const frames = new Map();
  for (const contact of clips.flatMap((clip) => clip.contacts)) {
    const name = contact.a === contact.b ? `${contact.a}, itself` : `${contact.a}, ${contact.b}`;
    frames.set(name, (frames.get(name) ?? 0) + framesOf(contact));
  }
  const [best] = [...frames].sort(([, a], [, b]) => b - a);
  return best ? `${best[0]}: ${thousands(best[1])}` : "none";
}

// Markdown of the picture, once a mesh.
const drawn = new Set();
function picture(mesh) {
  if (drawn.has(mesh)) return "as above";
  drawn.add(mesh);
  const file = `${basename(mesh)}.png`;
  const draw = spawnSync(join(dirname(tool), "draw_asset"),
    [asset, mesh, "-o", join(pictures, file), "--frame", "0", "--height", "180"]);
  return draw.status === 0 ? `![spheres of ${basename(mesh)}](characters/${file})` : "";
}

function bakeAndPlay(character) {
  const [mesh, motion] = character.split("+");
  const name = basename(mesh) + (motion ? ` + ${basename(motion)}` : "");
  const baked = run("bake", mesh, "-o", asset, "--report", report, "--force");
  if (baked) return [name, baked.replace(`${basename(mesh)}: `, "")];
  rmSync(played, { force: true });
  const play = run("play", asset, "--source", mesh, ...(motion ? ["--motion", motion] : []), "--json", played);
  if (play) return [name, play];
  const bake = json(report), { clips } = json(played);
  const inspected = JSON.parse(spawnSync(tool, ["inspect", asset, "--json"], { encoding: "utf8" }).stdout);
  const sum = (pick) => clips.reduce((total, clip) => total + pick(clip), 0);
  const { grade, far_area, protrusion } = bake.bind.quality;
  const percent = (share) => `${(100 * share).toFixed(1)} %`;
  return [name, picture(mesh), thousands(bake.import.source_triangles), thousands(bake.import.components),
    inspected.bones.length, bake.segment.provider + (bake.segment.strategy.endsWith("in part by bones") ? ", bones" : ""), inspected.sphere_count, grade, percent(1 - far_area),
    percent(protrusion), bake.stages.reduce((total, stage) => total + stage.seconds, 0).toFixed(1), clips.length, thousands(sum((c) => c.frame_count)),
    thousands(sum((c) => c.contact_frames)), mostFrequent(clips)];
}

const rows = characters.map(bakeAndPlay);
rmSync(folder, { recursive: true });
const head = ["character", "spheres, first frame", "triangles", "pieces", "bones", "parts found by", "spheres", "fit",
  "skin within 2 % of the height", "spheres stand out", "bake, seconds", "clips", "frames", "with skin contacts",
  "most frequent contact: frames"];
const line = (cells) => `| ${cells.join(" | ")} |`;
const full = rows.filter((row) => row.length === head.length), failed = rows.filter((row) => row.length < head.length);
let table = `\`\`\`
scripts/characters.mjs build/release/bin/spherechain CHARACTER[+MOTION]...     # rewrites this section
\`\`\`

Each character is baked without an option and plays all its clips, or the motion after the \`+\`, at 30 frames a second. Bones are those that move the
skin; a character without bones gets an automatic rig.

${[line(head), line(head.map(() => "---")), ...full.map(line)].join("\n")}
`;
if (failed.length > 0) {
  table += `\nThese are refused:\n\n${[line(["character", "message"]), line(["---", "---"]), ...failed.map(line)].join("\n")}\n`;
}

const text = readFileSync(page, "utf8");
const begin = text.indexOf(kBegin), end = text.indexOf(kEnd);
if (begin < 0 || end < begin) {
  console.error(`characters.mjs: ${page}: lacks its marks ${kBegin.trim()} and ${kEnd}`);
  process.exit(1);
}
writeFileSync(page, text.slice(0, begin + kBegin.length) + table + text.slice(end));
console.log(table);
process.exit(failed.length > 0 ? 1 : 0);
