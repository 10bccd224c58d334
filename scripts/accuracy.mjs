#!/usr/bin/env node
// Bakes and validates characters. Writes docs/accuracy-sweeps.md, and the marked sections of docs/accuracy.md:
//   scripts/accuracy.mjs build/release/bin/spherechain [CHARACTER]... [--depth CHARACTER[+MOTION]...]
// Characters: the MakeHuman body of assimp-testmodels with three recordings and samples/poses; then each CHARACTER with
// its own clips. Characters after --depth are evaluated by depth_study; without them its table stays. Expected beside
// the tool, and built by name:
//   cmake --build --preset release --target accuracy_study depth_study volume_study
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { answerSection, replaceSection, sweepsPage } from "./accuracy_pages.mjs";

const [tool, ...given] = process.argv.slice(2);
if (!tool) {
  console.error("usage: accuracy.mjs SPHERECHAIN [CHARACTER]... [--depth CHARACTER[+MOTION]...]");
  process.exit(2);
}
const end = given.includes("--depth") ? given.indexOf("--depth") : given.length;
const characters = given.slice(0, end), posed = given.slice(end + 1);
const kFrames = 60, kJudged = 30, kDirections = 40;
const models = "/usr/share/assimp/models", human = `${models}/Collada/human.zae`;
const root = join(dirname(fileURLToPath(import.meta.url)), ".."), poses = join(root, "samples/poses");
const folder = mkdtempSync(join(tmpdir(), "accuracy-"));
process.on("exit", () => rmSync(folder, { recursive: true }));

const run = (...args) => runs(tool, ...args);
function runs(program, ...args) {
  const result = spawnSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (result.status === 0) return result.stdout;
  console.error((result.stderr ?? "").trim() || `exit ${result.status ?? result.signal}`);
  process.exit(1);
}

const assets = new Map();
function asset(mesh, profile) {
  const key = mesh + profile;
  if (!assets.has(key)) {
    const file = join(folder, `${assets.size}.sphc`);
    run("bake", mesh, "-o", file, "--profile", profile);
    assets.set(key, file);
  }
  return assets.get(key);
}

// Adds up several runs: counts, so that shares are shares of the sums.
const counted = (found, score) => ({
  frames: found.frames,
  truth: found.truth_pairs,
  found: found.truth_pairs * score.pair_recall,
  trueFrames: found.truth_frames,
  any: found.truth_frames * score.frame_any_recall,
  all: found.truth_frames * score.frame_all_recall,
  reported: found.frames * score.reported_per_frame,
  right: found.frames * score.reported_per_frame * score.precision,
});
const sum = (list) => list.reduce((total, one) => {
  for (const [key, value] of Object.entries(one)) total[key] = (total[key] ?? 0) + value;
  return total;
}, {});
const share = (part, whole) => (whole > 0 ? part / whole : 1);
const recall = (s) => share(s.found, s.truth), precision = (s) => share(s.right, s.reported);

// One row of the tables: a mesh and one motion, or several motions taken together.
function validate(row, profile, radius) {
  return row.motions.map((motion) => {
    const json = join(folder, "found.json");
    runs(join(dirname(tool), "accuracy_study"), asset(row.mesh, profile), "--source", row.mesh, ...motion, "--frames", String(kFrames),
      "--radius", radius, ...(radius === "detect" ? ["--contacts"] : []), "--json", json);
    return JSON.parse(readFileSync(json, "utf8"));
  });
}

const rows = ["Boxing_Toes", "01_01", "01_03"].map((name) => ({
  name: `human.zae + ${name}.bvh`, mesh: human, motions: [["--motion", `${models}/BVH/${name}.bvh`]],
}));
rows.push({
  name: "human.zae, samples/poses", mesh: human,
  motions: readdirSync(poses).filter((f) => f.endsWith(".json")).sort().map((f) => ["--poses", join(poses, f)]),
});
for (const file of characters) rows.push({ name: basename(file), mesh: file, motions: [[]] });
for (const row of rows) {
  row.detect = validate(row, "balanced", "detect");
  row.fit = validate(row, "balanced", "fit");
  row.paper = validate(row, "paper", "fit");
}
const spheres = (mesh, profile) => JSON.parse(run("inspect", asset(mesh, profile), "--json")).sphere_count;
const counts = { balanced: spheres(human, "balanced"), paper: spheres(human, "paper") };

const line = (cells) => `| ${cells.join(" | ")} |`;
function table(head, body) {
  return [line(head), line(head.map(() => "---")), ...body.map(line)].join("\n");
}
const percent = (x) => (100 * x).toFixed(1);
const scored = (s) => [percent(recall(s)), percent(precision(s)), (s.reported / s.frames).toFixed(1)];
const of = (list, pick) => sum(list.map((found) => counted(found, pick(found))));

// The ragdoll's quantile with the greatest harmonic mean of recall and precision on this motion.
const hasCapsules = (row) => row.detect.every((f) => f.capsules);
function bestQuantile(row) {
  const points = row.detect[0].capsules.curve.map((point, i) => {
    const s = of(row.detect, (f) => f.capsules.curve[i]);
    return { i, quantile: point.quantile, value: share(2 * recall(s) * precision(s), recall(s) + precision(s)) };
  });
  return points.reduce((best, point) => (point.value > best.value ? point : best));
}

function methods(row) {
  const variants = [
    ["the skin", row.detect, (f) => f.skin],
    ["spheres, detect radius", row.detect, (f) => f.all_pairs],
    ["the same, along chains alone", row.detect, (f) => f.chains],
    ["spheres, fit radius", row.fit, (f) => f.all_pairs],
    ["profile `paper`, fit radius", row.paper, (f) => f.all_pairs],
  ];
  if (hasCapsules(row)) {
    const best = bestQuantile(row);
    variants.push([`a capsule a bone, its best quantile (${best.quantile})`, row.detect, (f) => f.capsules.curve[best.i]]);
  }
  return variants.map(([name, list, pick]) => {
    const s = of(list, pick);
    const depths = list.map((f) => pick(f).missed_depth_mm);
    const depth = depths[0] === undefined ? "" : Math.max(...depths).toFixed(0);
    return [row.name, name, s.truth, ...scored(s), percent(share(s.any, s.trueFrames)), percent(share(s.all, s.trueFrames)), depth];
  });
}

// Far recall and apart precision are of one motion: several are not added up.
function alarm(row) {
  const spheres = row.detect.length === 1 ? row.detect[0].all_pairs : {};
  const shown = (x) => (x === null || x === undefined ? "" : percent(x));
  const s = of(row.detect, (f) => f.all_pairs);
  return [row.name, s.truth, percent(recall(s)), shown(spheres.far_recall), percent(precision(s)), shown(spheres.apart_precision),
    (s.reported / s.frames).toFixed(1)];
}

function scope(row) {
  const total = (pick) => row.detect.reduce((n, f) => n + pick(f), 0);
  const raw = total((f) => f.raw_pairs), truth = total((f) => f.truth_pairs);
  const posed = raw - total((f) => f.out_of_scope.rest);  // made by the motion
  return [row.name, total((f) => f.frames), raw, total((f) => f.out_of_scope.rest), total((f) => f.out_of_scope.same_sphere),
    total((f) => f.out_of_scope.ignored), truth, percent(share(posed - truth, posed))];
}

// Volumes of the characters and two recordings, all together.
const volumes = () => runs(join(dirname(tool), "volume_study"), String(kFrames), ...[`${human}+${models}/BVH/Boxing_Toes.bvh`, `${human}+${models}/BVH/01_01.bvh`, ...characters]
  .flatMap((source) => [asset(source.split("+")[0], "balanced"), source]));

function curve(kind, label) {
  const points = rows[0].detect[0][kind].map((point, i) => {
    const at = (row) => of(row.detect, (f) => f[kind][i].all_pairs);
    return [label(point), ...rows.flatMap((row) => [`${percent(recall(at(row)))} / ${percent(precision(at(row)))} / ${(at(row).reported / at(row).frames).toFixed(1)}`])];
  });
  return table(["", ...rows.map((row) => row.name)], points);
}

function capsuleCurve() {
  const with_ = rows.filter(hasCapsules);
  const points = with_[0].detect[0].capsules.curve.map((point, i) => [point.quantile, ...with_.map((row) => {
    const s = of(row.detect, (f) => f.capsules.curve[i]);
    const own = sum(row.detect.map((f) => f.capsules.curve[i]).map((p) => ({ truth: p.own_truth_pairs, found: p.own_truth_pairs * p.own_pair_recall })));
    return `${percent(recall(s))} / ${percent(precision(s))} / ${(s.reported / s.frames).toFixed(1)} (${percent(recall(own))})`;
  })]);
  return table(["", ...with_.map((row) => `${row.name}, ${row.detect[0].capsules.count}`)], points);
}

const everything = (pick, list = (row) => row.detect) => sum(rows.map((row) => of(list(row), pick)));
const skin = everything((f) => f.skin), chains = everything((f) => f.chains), all = everything((f) => f.all_pairs);
const fit = everything((f) => f.all_pairs, (row) => row.fit), paper = everything((f) => f.all_pairs, (row) => row.paper);
const contacts = rows.flatMap((row) => row.detect).reduce((t, f) =>
  ({ frames: t.frames + f.frames, missing: t.missing + f.contacts_missing, extra: t.extra + f.contacts_extra }), { frames: 0, missing: 0, extra: 0 });
const missedByChains = all.found - chains.found;

const commit = runs("git", "-C", root, "rev-parse", "--short", "HEAD").trim();
writeFileSync(join(root, "docs/accuracy-sweeps.md"), sweepsPage({ commit, frames: kFrames, counts, tables: {
  methods: table(["motion", "method", "true pairs", "recall", "precision", "pairs a frame", "any", "all", "missed, mm"], rows.flatMap(methods)),
  scope: table(["motion", "frames", "intersecting pairs", "at rest too", "one sphere", "neighbours", "true", "left out %"], rows.map(scope)),
  volumes: volumes().trim(),
  radius: curve("radius_curve", (p) => `x ${p.scale.toFixed(1)}`),
  rest: curve("rest_curve", (p) => p.rest_scale.toFixed(1)),
  capsules: capsuleCurve(),
} }));

const page = join(root, "docs/accuracy.md");
let text = readFileSync(page, "utf8");
const scores = (s) => [percent(recall(s)), percent(precision(s))];
text = replaceSection(text, "answer", answerSection({ commit, contacts, truth: all.truth,
  missedByChains: Math.round(missedByChains), foundByAll: Math.round(all.found), share: percent(share(missedByChains, all.found)),
  rows: [
    ["nothing missed, nothing wrong", "skin contacts (`body.contacts()`)", ...scores(skin)],
    ["an alarm for a microsecond", "spheres, detect radius", ...scores(all)],
    ["fewer false alarms for a microsecond", "spheres, fit radius", ...scores(fit)],
    ["the paper's figures", "profile `paper`, fit radius", ...scores(paper)],
  ] }));
text = replaceSection(text, "alarm", table(["motion", "true pairs", "recall", "far recall", "precision", "apart precision", "pairs a frame"], rows.map(alarm)));
if (posed.length > 0) {
  const depth = runs(join(dirname(tool), "depth_study"), "--judged", String(kJudged), ...posed);
  text = replaceSection(text, "depth", `Commit ${commit}, ${cpus()[0].model}, ${kJudged} contacts a character, brute force over ${kDirections} directions.\n\n${depth}`);
}
writeFileSync(page, text);
