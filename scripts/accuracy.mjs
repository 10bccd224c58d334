#!/usr/bin/env node
// Bakes and validates, and prints docs/accuracy.md:
//   scripts/accuracy.mjs build/release/bin/spherechain [CHARACTER.glb]... > docs/accuracy.md
// The MakeHuman body of assimp-testmodels with its three recordings and the poses of samples/poses; each further character
// with its own clips.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [tool, ...characters] = process.argv.slice(2);
if (!tool) {
  console.error("usage: accuracy.mjs SPHERECHAIN [CHARACTER]...");
  process.exit(2);
}
const kFrames = 60;
const models = "/usr/share/assimp/models", human = `${models}/Collada/human.zae`;
const poses = join(dirname(fileURLToPath(import.meta.url)), "../samples/poses");
const folder = mkdtempSync(join(tmpdir(), "accuracy-"));

function run(...args) {
  const result = spawnSync(tool, args, { encoding: "utf8", maxBuffer: 1 << 28 });
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

// Scores of several runs as one: each has counts, so that shares can be taken of the sums.
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

// A row of the tables: a mesh with one motion, or with several that count as one.
function validate(row, profile, radius) {
  return row.motions.map((motion) => {
    const json = join(folder, "found.json");
    run("validate", asset(row.mesh, profile), "--source", row.mesh, ...motion, "--frames", String(kFrames),
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
rmSync(folder, { recursive: true });

const line = (cells) => `| ${cells.join(" | ")} |`;
function table(head, body) {
  return [line(head), line(head.map(() => "---")), ...body.map(line)].join("\n");
}
const percent = (x) => (100 * x).toFixed(1);
const scored = (s) => [percent(recall(s)), percent(precision(s)), (s.reported / s.frames).toFixed(1)];
const of = (list, pick) => sum(list.map((found) => counted(found, pick(found))));

// Of a ragdoll: the quantile with the greatest harmonic mean of recall and precision on this motion.
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
    ["the skin", row.detect, (f) => f],
    ["spheres, detect radius", row.detect, (f) => f.all_pairs],
    ["the same, chains alone", row.detect, (f) => f.chains],
    ["spheres, fit radius", row.fit, (f) => f.all_pairs],
    ["profile `paper`, fit radius", row.paper, (f) => f.all_pairs],
  ];
  if (hasCapsules(row)) {
    const best = bestQuantile(row);
    variants.push([`a capsule a bone, its best quantile (${best.quantile})`, row.detect, (f) => f.capsules.curve[best.i]]);
  }
  return variants.map(([name, list, pick]) => {
    const s = of(list, pick);
    const depths = list.map((f) => pick(f).missed_overlap);
    const depth = depths[0] === undefined ? "" : percent(Math.max(...depths));
    return [row.name, name, s.truth, ...scored(s), percent(share(s.any, s.trueFrames)), percent(share(s.all, s.trueFrames)), depth];
  });
}

function scope(row) {
  const total = (pick) => row.detect.reduce((n, f) => n + pick(f), 0);
  const raw = total((f) => f.raw_pairs), truth = total((f) => f.truth_pairs);
  const posed = raw - total((f) => f.out_of_scope.rest);  // those that the motion makes
  return [row.name, total((f) => f.frames), raw, total((f) => f.out_of_scope.rest), total((f) => f.out_of_scope.same_sphere),
    total((f) => f.out_of_scope.ignored), truth, percent(share(posed - truth, posed))];
}

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

function groups(kind) {
  const totals = new Map();
  for (const found of rows.flatMap((row) => row.detect)) {
    for (const group of found[kind]) {
      const t = totals.get(group.name) ?? { truth: 0, found: 0, reported: 0 };
      totals.set(group.name, { truth: t.truth + group.truth_pairs, found: t.found + group.found_pairs, reported: t.reported + group.reported });
    }
  }
  return table(["", "true triangle pairs", "found %", "sphere pairs reported"],
    [...totals].map(([name, t]) => [name, t.truth, percent(share(t.found, t.truth)), t.reported]));
}

const everything = (pick, list = (row) => row.detect) => sum(rows.map((row) => of(list(row), pick)));
const skin = everything((f) => f), chains = everything((f) => f.chains), all = everything((f) => f.all_pairs);
const fit = everything((f) => f.all_pairs, (row) => row.fit), paper = everything((f) => f.all_pairs, (row) => row.paper);
const contacts = rows.flatMap((row) => row.detect).reduce((t, f) =>
  ({ frames: t.frames + f.frames, missing: t.missing + f.contacts_missing, extra: t.extra + f.contacts_extra }), { frames: 0, missing: 0, extra: 0 });
const missedByChains = all.found - chains.found;

console.log(`# Accuracy: what is found, what is missed

Made by one command, with \`spherechain validate\`:

\`\`\`
scripts/accuracy.mjs build/release/bin/spherechain [CHARACTER.glb]... > docs/accuracy.md
\`\`\`

${kFrames} frames of each motion, evenly spread; of \`samples/poses\` each file, all together. The truth are the pairs of triangles that
intersect in the deformed mesh, decided exactly (CGAL). **Recall**: the part of the true triangle pairs whose spheres are reported.
**Reported**: pairs of spheres that touch; or pairs of spheres whose **skins** intersect, a triangle of the one's region one of the
other's, whether the spheres touch or not. **Precision**: the part of the reported sphere pairs that have a true pair, or whose regions are nearer than 0.3 % of the height.
**Any**, **all**: frames with a true pair in which one, in which each of them is found. **Missed depth**: how deep the worst contact
goes that is not reported, in % of the height: the farthest that a vertex of one sphere's region lies behind the other's. Shares in
%.

## Skin, spheres, chains and capsules

Profile \`balanced\` puts ${counts.balanced} spheres into the human, \`paper\` ${counts.paper}, none of them in head, hands and feet. A capsule a bone is what
games have instead: fitted to the triangles its bone moves most, along their principal axis, its radius a quantile of their distances by
area; neighbours on the skeleton are ignored, and others must, as spheres must, have come nearer than 0.9 of their distance at rest. It
is measured on the spheres' truth: pairs within one capsule or between neighbours it cannot find. Its quantile is here the one with the best
harmonic mean of recall and precision on that very motion; the spheres have one default for all.

${table(["motion", "method", "true pairs", "recall", "precision", "pairs a frame", "any", "all", "missed depth"], rows.flatMap(methods))}

What chains alone miss of the true triangle pairs that all spheres find: ${Math.round(missedByChains)} of ${Math.round(all.found)} (${percent(share(missedByChains, all.found))} %).

## Which to choose

- **Everything that must not be missed**: the exact triangle contacts (\`TriangleContactJob\`). They do not go through the spheres' radii:
  of the ${all.truth} true pairs below they miss ${contacts.missing}, and report ${contacts.extra} others (\`validate --contacts\`, ${contacts.frames} frames).
- **What to act on**: the pairs of spheres whose skins intersect (\`DetectSkinJob\`): recall ${percent(recall(skin))} %, precision
  ${percent(precision(skin))} %, ${(skin.reported / skin.frames).toFixed(1)} pairs a frame over all motions below, and the same on every other character of
  tests/quality/gates, for it goes by covers of the skin and not by radii; what it costs is in docs/performance.md (P6).
- **What has to cost no more than a microsecond or two**: spheres that touch, at the detect radius; which of them are true, \`ConfirmJob\` tells. Of
  other bodies than humans spheres may miss half (\`all_pairs.pair_recall\` in tests/quality/gates: a fox .48, toys .59 to .72, and of Testwuson, whose
  spheres lie far from its skin, all).
- **A cheap alarm, or what to look at first**: profile \`balanced\` and the detect radius: recall ${percent(recall(all))} %, precision
  ${percent(precision(all))} % over all motions below.
- **Fewer false alarms**: the fit radius, recall ${percent(recall(fit))} %, precision ${percent(precision(fit))} %. It leaves the waists between spheres open and misses
  what goes in there.
- **The paper's figures**: profile \`paper\`. Recall ${percent(recall(paper))} %, precision ${percent(precision(paper))} %: hands, feet and head belong to wrists, ankles and chest, and
  most of their contacts are missed.
- M1 is for those who have the chains already; M2 costs less on a CPU and misses nothing that M1 finds.

## What is out of scope

Before anything is compared, three classes are left out, in this order: what intersects in the rest pose too (eyes in their sockets, a mouth), what is
within one sphere's region (a fold of one sphere), and what is between ignored spheres, neighbours on the body (elbow, knee, armpit,
fingers). The last column is what that leaves out of those that motion makes. The last two are a class of their own for the exact
contacts (\`ContactScope::kNeighbours\`); \`validate --contacts\` compares them with CGAL's too, and the gates of tests/quality keep what is missing
and what is extra of both classes at 0.

${table(["motion", "frames", "intersecting pairs", "at rest too", "one sphere", "ignored spheres", "true", "left out %"], rows.map(scope))}

## Over the radius

Recall / precision / pairs a frame when every detect radius is scaled; pairs must have come nearer than the same part of their distance
at rest.

${curve("radius_curve", (p) => `x ${p.scale.toFixed(1)}`)}

## Over the rest-distance rule

The same when pairs must have come nearer than this part of their distance at rest.

${curve("rest_curve", (p) => p.rest_fraction.toFixed(1))}

## Capsules over their quantile

The number of capsules is behind the motion's name. In brackets the recall on what a ragdoll could find at all: without the true pairs
within one capsule or between neighbours, with those within one sphere.

${capsuleCurve()}

## Where

All motions together, the pairs whose skins intersect.

${groups("by_region")}

A pair is in each chain that holds both of its spheres.

${groups("by_chain")}`);
