#!/usr/bin/env node
// Bakes, validates and prints docs/accuracy.md:
//   scripts/accuracy.mjs build/release/bin/spherechain [CHARACTER]... [--depth CHARACTER[+MOTION]...] > docs/accuracy.md
// Characters: the MakeHuman body of assimp-testmodels with three recordings and samples/poses; then each CHARACTER with
// its own clips. Those after --depth are evaluated by depth_study. Expected beside the tool, and built by name:
//   cmake --build --preset release --target depth_study volume_study
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [tool, ...given] = process.argv.slice(2);
if (!tool) {
  console.error("usage: accuracy.mjs SPHERECHAIN [CHARACTER]... [--depth CHARACTER[+MOTION]...]");
  process.exit(2);
}
const end = given.includes("--depth") ? given.indexOf("--depth") : given.length;
const characters = given.slice(0, end), posed = given.slice(end + 1);
const kFrames = 60, kJudged = 30, kDirections = 40;
const models = "/usr/share/assimp/models", human = `${models}/Collada/human.zae`;
const poses = join(dirname(fileURLToPath(import.meta.url)), "../samples/poses");
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

function far(row) {
  const spheres = row.detect[0].all_pairs;
  const shown = (x) => (x === null ? "" : percent(x));
  return [row.name, shown(spheres.far_recall), shown(spheres.apart_precision), spheres.reported_per_frame.toFixed(1)];
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
const depth = () => runs(join(dirname(tool), "depth_study"), "--judged", String(kJudged), ...posed);

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

console.log(`# Accuracy

How many of the true contacts each method finds, and how many of its reports are right. Written by one command; do not edit:

\`\`\`
scripts/accuracy.mjs build/release/bin/spherechain [CHARACTER]... [--depth CHARACTER[+MOTION]...] > docs/accuracy.md
\`\`\`

## Method

1. The truth is every pair of triangles that intersects in the deformed mesh, decided exactly by CGAL (\`spherechain validate\`).
2. ${kFrames} frames of each motion, evenly spread. \`samples/poses\` is eight files, taken together.
3. **Recall** is the part of the true pairs whose spheres are reported. **Precision** is the part of the reported pairs of spheres that have a true
   pair, or whose triangles are closer than 0.3 % of the height. **Any** and **all** are frames with a true pair in which one, or each, is found.
4. **Missed, mm** is the [depth](concepts.md#how-deep-which-way) of the deepest fault (penetration or deep fold) of which nothing is reported.
5. Profile \`balanced\` puts ${counts.balanced} spheres into the human. Profile \`paper\` puts ${counts.paper}, with none in head, hands and feet.
6. A capsule a bone is what games have instead. It is fitted to the triangles that its bone moves most; its radius is a quantile of their distances.
   Neighbours on the skeleton are ignored, and others follow the rest rule of spheres. Its quantile is the best for that motion (harmonic mean of recall and
   precision); the spheres have one default for all.
7. Shares are in %.

## Which to choose

| you need | take | recall | precision |
|---|---|---|---|
| nothing missed, nothing wrong | skin contacts (\`body.contacts()\`) | ${percent(recall(skin))} | ${percent(precision(skin))} |
| an alarm for a microsecond | spheres, detect radius | ${percent(recall(all))} | ${percent(precision(all))} |
| fewer false alarms for a microsecond | spheres, fit radius | ${percent(recall(fit))} | ${percent(precision(fit))} |
| the paper's figures | profile \`paper\`, fit radius | ${percent(recall(paper))} | ${percent(precision(paper))} |

The exact triangle contacts miss ${contacts.missing} of the ${all.truth} true pairs below and report ${contacts.extra} others (\`validate --contacts\`, ${contacts.frames} frames).
Tests along chains alone miss ${Math.round(missedByChains)} of the ${Math.round(all.found)} true pairs that all pairs of spheres find (${percent(share(missedByChains, all.found))} %).
How spheres do on bodies other than humans, \`scripts/alarms.mjs\` prints. Skin contacts are exact on all of them.

## Skin, spheres, chains and capsules

${table(["motion", "method", "true pairs", "recall", "precision", "pairs a frame", "any", "all", "missed, mm"], rows.flatMap(methods))}

## Spheres and tapered capsules

We tried capsules between neighbouring spheres of a region (the hull of both, following the refit) in place of the spheres, on five characters, with the same
calibration. Half as many capsules as spheres found as much (99 % of far contacts on all five), and stood out of the body less on the fox alone. Their apart precision was
as good on the barbarian and CesiumMan and lower on the humans and the fox (human.zae: 26 % with 36 capsules, 48 % with 73 spheres). Half as many spheres find as much
too, and a test of two capsules costs 4.6 times one of two spheres. So spheres stay; the capsules' code is no longer in the tree (it was last in 0a93137).

## Other volumes

[Colliders](exporting.md) of each shape, fitted anew, rigid with one bone a body part, over all these characters together. The truth here is which body parts touch,
by the exact skin contacts; parts that hang on each other are left out. **Recall** and **precision** are of pairs of parts that are tested. **Precision at 95** is what is
left with the least padding of all volumes that finds 95 % (padding in % of the height). **Not tested** is the share of touching pairs that are ignored, because the
volumes overlap at rest or one volume stands for both. Then the fit at rest: the share of the skin **inside**, the skin's mean **distance** from the volumes' surface and its
95th of 100, how far volumes stand **beyond** the skin, 95th of 100, in % of the height; the **volume** in % of the body's.

At equal numbers ellipsoids lie nearest to the skin, and they and capsules are right most often. Engines have no ellipsoids, so exports take cones or capsules;
for MuJoCo and USD try \`--volumes ellipsoids\`. Rows without a number are as many as \`export\` makes of them unasked.

${volumes()}
## Depth against brute force

[Depth and direction](concepts.md#how-deep-which-way) of penetrations and deep folds of at least 3 mm (of files without a unit, 0.1 % of the height), ${kJudged} a character, judged by
\`depth_study\`, which shares no code of theirs: brute force tries ${kDirections} directions and refines the best.

| column | what it says | goal |
|---|---|---|
| frees | the first part, moved out and 0.5 mm more, is clear of the second by the exact triangle test | 97 % |
| 0.9 frees | so it is after nine tenths of the way: the depth was too long | at most 10 % |
| ≤ 1.25 | the depth is at most 1.25 times the shortest way that brute force finds | 90 % |
| turns | from one frame to the next the direction turns by more than 90 degrees | at most 2 % |
| volume | is within 25 % of CGAL's corefinement, where the contour is closed and CGAL has an answer | 90 % |
| quick | the quick form's depth over the full one's, median and 90th of 100 | |
| ms | a pair's time, median and 95th of 100, let nothing else run | 0.5, 5 |

${posed.length > 0 ? depth() : ""}
## Spheres between parts that are far from each other

Recall leaves out what the asset ignores, and spheres whose skins nearly touch at rest are nearly always right. **Far recall** counts only contacts between
body parts that do not hang on each other or on the same third part, and are 0.3 % of the height apart at rest. Pairs that the asset ignores count, too.
**Apart precision** leaves out pairs of spheres whose skins are nearer than that at rest. Motions without such a contact have no far recall.

${table(["motion", "far recall", "apart precision", "pairs a frame"], rows.filter((row) => row.detect.length === 1).map(far))}

## What is out of scope

Three classes are left out before anything is compared, in this order: pairs that intersect at rest too (eyes in their sockets), pairs of one sphere's
triangles, and pairs of neighbouring spheres (elbow, knee, armpit). The last column is the part of the pairs made by motion that this leaves out.
The exact contacts offer the last two classes as a scope of their own. \`validate --contacts\` compares them with CGAL's too, and the gates of
tests/quality keep the differences at 0.

${table(["motion", "frames", "intersecting pairs", "at rest too", "one sphere", "neighbours", "true", "left out %"], rows.map(scope))}

## Over the radius

Recall / precision / pairs a frame if every detect radius is scaled.

${curve("radius_curve", (p) => `x ${p.scale.toFixed(1)}`)}

## Over the rest rule

The same if every rest pair is reported below one part of its distance at rest, in place of the calibrated distance.

${curve("rest_curve", (p) => p.rest_scale.toFixed(1))}

## Capsules over their quantile

The number of capsules stands behind the motion's name. The recall in brackets counts only what a ragdoll could find: it leaves out true pairs
within one capsule or between neighbouring ones, and adds those within one sphere.

${capsuleCurve()}
`);
