// The pages of scripts/accuracy.mjs: docs/accuracy-sweeps.md as a whole, and the marked sections of docs/accuracy.md.

// `tables` are Markdown. counts: spheres of the human by profile.
export function sweepsPage({ commit, frames, counts, tables }) {
  return `# Accuracy: all tables

For an engineer who checks a claim of [accuracy.md](accuracy.md): every motion, every radius. \`scripts/accuracy.mjs\` writes this page
([how](accuracy.md#repeat-it)); do not edit. Commit ${commit}, ${frames} frames of each motion. Shares are in %.

## Skin, spheres, chains and capsules

**Recall** is the share of true pairs that are reported. **Precision** is the share of reports that are true, or whose triangles are closer than 0.3 % of
the height. **Any** and **all** are frames with a true pair in which one, or each, is found. **Missed, mm** is the depth of the deepest fault of which
nothing is reported. Profile \`balanced\` has ${counts.balanced} spheres on the human, profile \`paper\` ${counts.paper}.

A capsule a bone is the usual ragdoll of a game. It is fitted to the triangles that its bone moves most; its radius is a quantile of their distances, the best
one for each motion. Spheres have one default for all motions.

${tables.methods}

## Left out before comparing

Three kinds of pairs are left out, in this order: pairs that intersect at rest, too (eyes in their sockets), pairs of one sphere's triangles, and pairs
of neighbouring spheres (elbow, knee, armpit). The last column is the share of the pairs made by motion that is left out. \`validate --contacts\` compares
the last two kinds with CGAL, too, and the gates of [tests/quality](../tests/quality/README.md) keep the differences at 0.

${tables.scope}

## Other volumes

[Colliders](exporting.md) of each shape, rigid with one bone a body part, over all characters together. The truth is here which body parts touch, by the exact skin
contacts; parts that hang on each other are left out. Rows without a number have as many volumes as \`export\` makes by default.

| column | meaning |
| --- | --- |
| recall, precision | of pairs of parts that are tested |
| precision at 95 | precision with the least padding of all volumes that finds 95 %, and that padding in % of the height |
| not tested | touching pairs that are ignored: volumes overlap at rest, or one volume stands for both |
| inside | the share of the skin inside the volumes at rest |
| distance, its 95th | from the skin to the volumes' surface: mean, and 95th percentile, in % of the height |
| beyond, 95th | how far volumes stand beyond the skin, 95th percentile, in % of the height |
| volume | in % of the body's |

At equal numbers ellipsoids lie nearest to the skin. Few programs have them, so \`export\` writes cones or capsules by default; for MuJoCo and USD try
\`--volumes ellipsoids\`.

${tables.volumes}

## Over the radius

Recall / precision / pairs a frame if every detect radius is scaled.

${tables.radius}

## Over the rest rule

Recall / precision / pairs a frame if every rest pair is reported below one share of its distance at rest, in place of the calibrated distance.

${tables.rest}

## Capsules over their quantile

Recall / precision / pairs a frame (recall of the pairs that a ragdoll can find). The number of capsules follows the motion's name. A ragdoll cannot find
pairs within one capsule or between neighbouring ones; pairs within one sphere are added.

${tables.capsules}
`;
}

// Replaces the section between <!-- NAME: scripts/accuracy.mjs --> and <!-- end of NAME -->.
export function replaceSection(page, name, text) {
  const first = `<!-- ${name}: scripts/accuracy.mjs -->\n`, last = `<!-- end of ${name} -->`;
  const begin = page.indexOf(first), end = page.indexOf(last);
  if (begin < 0 || end < begin) throw new Error(`the page lacks its marks ${first.trim()} and ${last}`);
  return page.slice(0, begin + first.length) + text.trim() + "\n" + page.slice(end);
}

// The answer in two tables: each method over all motions, and the spheres motion by motion.
export function answerSection({ commit, rows, contacts, truth, missedByChains, foundByAll, share }) {
  return `
| you need | take | recall, % | precision, % |
|---|---|---|---|
${rows.map((cells) => `| ${cells.join(" | ")} |`).join("\n")}

The exact contacts miss ${contacts.missing} of ${truth} true pairs of triangles and report ${contacts.extra} others, in ${contacts.frames} frames (commit ${commit}).
Tests along chains alone miss ${missedByChains} of the ${foundByAll} true pairs that all pairs of spheres find (${share} %).
`;
}
