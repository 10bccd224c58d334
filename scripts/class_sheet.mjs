#!/usr/bin/env node
// SPDX-License-Identifier: MIT
// Draws penetrations, and contacts of the other classes, to be classified by eye:
//   scripts/class_sheet.mjs build/release/bin/spherechain OUT [--seed N] CHARACTER[+MOTION]...
//   scripts/class_sheet.mjs build/release/bin/spherechain OUT --deepest CHARACTER[+MOTION]...
// Writes 50 of each, by the seed (2), evenly over the characters, to OUT: large pictures, mixed and without
// class and depth (judged_1.png ..., three contacts each), table.json, and a sheet of small ones of each group. With --deepest: large pictures of
// the ten pairs of body parts of each character that penetrate deepest. A MOTION that ends in .json is a pose file.
// Pages in OUT/pages are used again: delete them when the tool has changed. Needs Chromium (CHROMIUM names another one).
// A part is blue, the other orange, the line where they cross black. Large pictures: close up, from another side with the
// way out (red, of the orange part), and the whole body.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { deflateSync } from "node:zlib";
import { readModel } from "../baker/page/web/src/model/model.js";
import { CLASSES } from "../baker/page/web/src/model/contacts.js";
import { Skin } from "../baker/page/web/src/model/skin.js";

const kCount = 50, kOfPair = 3, kCameras = 60, kOfSheet = 3, kLarge = 360, kDeepest = 10, kPenetration = 5;
const kBlue = [52, 120, 210], kOrange = [240, 130, 40], kGrey = [190, 190, 190];

const words = process.argv.slice(2);
const deepest = words.includes("--deepest"), seedAt = words.indexOf("--seed"), seed = seedAt < 0 ? 2 : +words.splice(seedAt, 2)[1];
const [tool, out, ...characters] = words.filter((word) => word !== "--deepest");
if (!tool || !out || characters.length === 0 || !Number.isInteger(seed)) {
  console.error("usage: class_sheet.mjs SPHERECHAIN OUT [--deepest | --seed N] CHARACTER[+MOTION]...");
  process.exit(2);
}
mkdirSync(join(out, "pages"), { recursive: true });

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const size = (a) => Math.hypot(...a);
const unit = (a) => { const l = size(a) || 1; return a.map((x) => x / l); };

// mulberry32
function randomFrom(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function run(program, ...args) {
  const result = spawnSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (result.status !== 0) throw new Error(`${program} ${args.join(" ")}: ${result.stderr || result.signal}`);
}

// The character as its page has it.
function load(character) {
  const [mesh, motion] = character.split("+");
  const name = basename(mesh) + (motion ? `+${basename(motion)}` : "");
  const asset = join(out, "pages", `${name}.sphc`), page = join(out, "pages", `${name}.html`);
  if (!existsSync(page)) {
    run(tool, "bake", mesh, "-o", asset);
    const moves = motion ? [motion.endsWith(".json") ? "--poses" : "--motion", motion] : [];
    run(tool, "view", asset, "--source", mesh, ...moves, "-o", page);
  }
  const html = readFileSync(page, "utf8");
  const model = readModel(JSON.parse(html.match(/<script id="spherechain-data" type="application\/json">([^<]*)</)[1]));
  return { name: name.replace(/\.(glb|gltf|fbx|vrm|zae|mesh\.xml)/, "").replace(/\.(bvh|json)$/, ""), model, skin: new Skin(model.mesh, model.motion) };
}

// One of each pair of body parts in turn, in a random frame, until there are enough; of a pair at most kOfPair.
function choose(loaded, count, random, isWanted) {
  const take = (list) => list.splice(Math.floor(random() * list.length), 1)[0];
  const lists = loaded.map(({ model }) => {
    const pairs = new Map();
    for (let frame = 0; frame < model.frameCount; ++frame) {
      for (const contact of model.contacts.of(frame).filter((c) => isWanted(c.kind))) {
        if (!pairs.has(contact.key)) pairs.set(contact.key, []);
        pairs.get(contact.key).push({ frame, contact });
      }
    }
    return [...pairs.values()].map((of) => [...Array(Math.min(kOfPair, of.length))].map(() => take(of)));
  });
  const rounds = lists.map(() => []), chosen = lists.map(() => []);
  for (let left = count; left > 0 && lists.some((pairs) => pairs.some((of) => of.length > 0));) {
    for (let i = 0; i < lists.length && left > 0; ++i) {
      if (rounds[i].length === 0) rounds[i] = lists[i].filter((of) => of.length > 0);
      if (rounds[i].length === 0) continue;
      chosen[i].push(take(take(rounds[i])));
      --left;
    }
  }
  return chosen.flatMap((list, i) => list.map((one) => ({ ...one, ...loaded[i] })));
}

function chooseDeepest({ model, ...rest }) {
  const found = new Map();
  for (let frame = 0; frame < model.frameCount; ++frame) {
    for (const contact of model.contacts.of(frame)) {
      if (contact.kind >= kPenetration && !(contact.depth <= found.get(contact.key)?.contact.depth)) {
        found.set(contact.key, { frame, contact });
      }
    }
  }
  const sorted = [...found.values()].sort((p, q) => q.contact.depth - p.contact.depth);
  return sorted.slice(0, kDeepest).map((one) => ({ ...one, model, ...rest }));
}

// Where an edge of one triangle goes through the other.
function crossings(p, q, points) {
  const normal = cross(add(q[1], q[0], -1), add(q[2], q[0], -1));
  for (let k = 0; k < 3; ++k) {
    const a = p[k], b = p[(k + 1) % 3], da = dot(normal, add(a, q[0], -1)), db = dot(normal, add(b, q[0], -1));
    if (da * db > 0 || da === db) continue;
    const x = add(a, add(b, a, -1), da / (da - db));
    if ([0, 1, 2].every((i) => dot(normal, cross(add(q[(i + 1) % 3], q[i], -1), add(x, q[i], -1))) >= 0)) points.push(x);
  }
  return unit(normal);
}

// Points of the line where the two parts cross, a pixel apart, each with the normals of both.
function contourOf({ model, skin, frame, contact }) {
  const list = model.contacts.lists.of(frame), points = [];
  for (let i = 0; i < list.length; i += 2) {
    const parts = [list[i], list[i + 1]].map((t) => model.mesh.partOf[t]).sort((a, b) => a - b);
    if (parts.join("-") !== contact.key) continue;
    const p = skin.triangle(list[i]).corners, q = skin.triangle(list[i + 1]).corners, ends = [];
    const normals = [crossings(p, q, ends), crossings(q, p, ends)];
    if (ends.length < 2) continue;
    const line = add(ends.at(-1), ends[0], -1), steps = Math.ceil(size(line) / (0.0004 * model.height)) + 1;
    for (let k = 0; k <= steps; ++k) points.push(Object.assign(add(ends[0], line, k / steps), { normals }));
  }
  return points.length > 0 ? points : [Object.assign([...contact.at], { normals: [contact.direction, contact.direction] })];
}

// Orthographic: `toward` leads from the body to the camera.
const cameraOf = (toward, up, center, half) => {
  const right = unit(cross(Math.abs(dot(up, toward)) > 0.95 ? [up[1], up[2], up[0]] : up, toward));
  return { toward, right, up: cross(toward, right), center, half };
};
const project = ({ toward, right, up, center, half }, p, pixels) => {
  const from = add(p, center, -1), scale = pixels / (2 * half);
  return [pixels / 2 + scale * dot(from, right), pixels / 2 - scale * dot(from, up), dot(from, toward)];
};

// Which triangle is nearest in each pixel, and how near.
function rasterise(skin, camera, pixels) {
  const depth = new Float32Array(pixels * pixels).fill(-Infinity), triangle = new Int32Array(pixels * pixels).fill(-1);
  const { positions: p, index } = skin, count = p.length / 3, at = new Float32Array(3 * count);
  const { toward, right, up, center, half } = camera, scale = pixels / (2 * half);
  for (let i = 0; i < 3 * count; i += 3) {
    const x = p[i] - center[0], y = p[i + 1] - center[1], z = p[i + 2] - center[2];
    at[i] = pixels / 2 + scale * (x * right[0] + y * right[1] + z * right[2]);
    at[i + 1] = pixels / 2 - scale * (x * up[0] + y * up[1] + z * up[2]);
    at[i + 2] = x * toward[0] + y * toward[1] + z * toward[2];
  }
  for (let t = 0; t < index.length; t += 3) {
    const a = 3 * index[t], b = 3 * index[t + 1], c = 3 * index[t + 2];
    const ax = at[a], ay = at[a + 1], bx = at[b] - ax, by = at[b + 1] - ay, cx = at[c] - ax, cy = at[c + 1] - ay;
    const area = bx * cy - by * cx;
    if (area === 0) continue;
    const x0 = Math.max(0, Math.ceil(ax + Math.min(0, bx, cx) - 0.5)), x1 = Math.min(pixels - 1, Math.floor(ax + Math.max(0, bx, cx) - 0.5));
    const y0 = Math.max(0, Math.ceil(ay + Math.min(0, by, cy) - 0.5)), y1 = Math.min(pixels - 1, Math.floor(ay + Math.max(0, by, cy) - 0.5));
    for (let y = y0; y <= y1; ++y) {
      for (let x = x0; x <= x1; ++x) {
        const dx = x + 0.5 - ax, dy = y + 0.5 - ay, u = (dx * cy - dy * cx) / area, v = (bx * dy - by * dx) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const z = (1 - u - v) * at[a + 2] + u * at[b + 2] + v * at[c + 2], i = y * pixels + x;
        if (z > depth[i]) {
          depth[i] = z;
          triangle[i] = t / 3;
        }
      }
    }
  }
  return { depth, triangle };
}

const isSeen = ({ depth }, [x, y, z], pixels, near) => {
  const px = Math.floor(x), py = Math.floor(y);
  return px >= 0 && py >= 0 && px < pixels && py < pixels && z >= depth[py * pixels + px] - near;
};

// The cameras, the best first: they face both parts along much of the contour, from the side of the way out.
function cameras({ model, skin, contact }, contour, ball) {
  const up = Object.values(model.axes.up), pixels = 64, found = [];
  for (let i = 0; i < kCameras; ++i) {
    const z = 1 - (2 * i + 1) / kCameras, r = Math.sqrt(1 - z * z), turn = i * 2.399963;
    const camera = cameraOf([r * Math.cos(turn), r * Math.sin(turn), z], up, ball.center, ball.half);
    const image = rasterise(skin, camera, pixels);
    const parts = [0, 0], step = Math.ceil(contour.length / 400), samples = contour.filter((_, k) => k % step === 0);
    let seen = 0;
    for (const p of samples) {
      if (!isSeen(image, project(camera, p, pixels), pixels, 0.003 * model.height + (2 * ball.half) / pixels)) continue;
      seen += Math.max(0, Math.min(0.7, ...p.normals.map((n) => dot(n, camera.toward)))) / samples.length;
    }
    for (const t of image.triangle) contact.parts.forEach((part, k) => (parts[k] += t >= 0 && model.mesh.partOf[t] === part ? 1 : 0));
    const both = Math.min(1, (6 * Math.min(...parts)) / (pixels * pixels));
    const side = 1 - Math.abs(dot(camera.toward, contact.direction)), level = 1 - Math.abs(dot(camera.toward, up));
    found.push({ camera, seen, score: 4 * seen + 0.4 * both + 0.3 * side + 0.2 * level });
  }
  return found.sort((p, q) => q.score - p.score);
}

function png(rgb, width, height) {
  const table = Int32Array.from({ length: 256 }, (_, n) => { for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1; return n; });
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]), whole = Buffer.alloc(body.length + 8);
    whole.writeUInt32BE(data.length);
    body.copy(whole, 4);
    let crc = -1;
    for (const byte of body) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
    whole.writeInt32BE(~crc, body.length + 4);
    return whole;
  };
  const head = Buffer.alloc(13), rows = Buffer.alloc((3 * width + 1) * height);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head.set([8, 2], 8);
  for (let y = 0; y < height; ++y) rows.set(rgb.subarray(3 * width * y, 3 * width * (y + 1)), (3 * width + 1) * y + 1);
  return Buffer.concat([Buffer.from("89504e470d0a1a0a", "hex"), chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

// A picture with `pixels` a side, drawn twice as large and made smaller.
function draw({ model, skin, contact }, contour, camera, pixels, way) {
  const wide = 2 * pixels, { depth, triangle } = rasterise(skin, camera, wide), big = new Float32Array(3 * wide * wide).fill(255);
  const light = unit(add(add(camera.toward, camera.up, 0.5), camera.right, -0.4));
  const lit = new Map();
  const colourOf = (t) => {
    if (lit.has(t)) return lit.get(t);
    const n = [0, 1, 2].reduce((sum, k) => { const v = 3 * skin.index[3 * t + k]; return add(sum, skin.normals.subarray(v, v + 3)); }, [0, 0, 0]);
    const [p, q, r] = skin.triangle(t).corners, flat = unit(cross(add(q, p, -1), add(r, p, -1)));
    const side = dot(flat, camera.toward) < 0 ? -1 : 1;
    const shade = (0.35 + 0.65 * Math.max(0, side * dot(unit(add(unit(n), flat, 0.5)), light))) * (side < 0 ? 0.6 : 1);
    const part = model.mesh.partOf[t], colour = part === contact.parts[0] ? kBlue : part === contact.parts[1] ? kOrange : kGrey;
    lit.set(t, colour.map((x) => x * shade));
    return lit.get(t);
  };
  for (let i = 0; i < wide * wide; ++i) {
    if (triangle[i] < 0) continue;
    const edge = [1, wide].some((s) => Math.abs(depth[i] - (depth[i + s] ?? depth[i])) > 0.006 * model.height) ? 0.6 : 1;
    const colour = colourOf(triangle[i]);
    for (let k = 0; k < 3; ++k) big[3 * i + k] = edge * colour[k];
  }
  const dab = (p, colour, isOnTop) => {
    const at = project(camera, p, wide);
    if (!isOnTop && !isSeen({ depth }, at, wide, 0.0015 * model.height + (2 * camera.half) / wide)) return;
    for (let k = 0; k < 4; ++k) {
      const x = Math.floor(at[0]) + (k & 1), y = Math.floor(at[1]) + (k >> 1);
      if (x >= 0 && y >= 0 && x < wide && y < wide) big.set(colour, 3 * (y * wide + x));
    }
  };
  for (const p of contour) dab(p, [0, 0, 0], false);
  if (way) {
    const reach = contact.depth * model.mesh.unitsPerMm, tip = add(contact.at, contact.direction, reach);
    for (let k = 0; k <= 400; ++k) dab(add(contact.at, contact.direction, (reach * k) / 400), [230, 0, 60], true);
    for (const turn of [camera.right, camera.up, camera.right.map((x) => -x), camera.up.map((x) => -x)]) {
      for (let k = 0; k <= 20; ++k) dab(add(tip, turn, (0.02 * camera.half * k) / 20), [230, 0, 60], true);
    }
  }
  const rgb = new Uint8Array(3 * pixels * pixels);
  for (let i = 0; i < rgb.length; ++i) {
    const k = i % 3, x = 2 * (Math.floor(i / 3) % pixels), y = 2 * Math.floor(i / (3 * pixels));
    const of = (px, py) => big[3 * (py * wide + px) + k];
    rgb[i] = (of(x, y) + of(x + 1, y) + of(x, y + 1) + of(x + 1, y + 1)) / 4;
  }
  return `data:image/png;base64,${png(rgb, pixels, pixels).toString("base64")}`;
}

function pictures(sample) {
  const { model, skin, frame, contact } = sample;
  skin.pose(frame);
  const contour = contourOf(sample);
  const low = [0, 1, 2].map((k) => contour.reduce((m, p) => Math.min(m, p[k]), Infinity)), high = [0, 1, 2].map((k) => contour.reduce((m, p) => Math.max(m, p[k]), -Infinity));
  const reach = Math.max(size(add(high, low, -1)), contact.depth * model.mesh.unitsPerMm);
  const ball = { center: add(low, high).map((x) => x / 2), half: Math.max(1.6 * reach, 0.06 * model.height) };
  const found = cameras(sample, contour, ball), [best] = found;
  const other = found.find(({ camera }) => Math.abs(dot(camera.toward, best.camera.toward)) < 0.6) ?? found[1];
  const bounds = [0, 1, 2].map((k) => { let l = Infinity, h = -Infinity; for (let i = k; i < skin.positions.length; i += 3) { l = Math.min(l, skin.positions[i]); h = Math.max(h, skin.positions[i]); } return [l, h]; });
  const whole = { ...best.camera, center: bounds.map(([l, h]) => (l + h) / 2), half: 0.52 * Math.max(...bounds.map(([l, h]) => h - l)) };
  return { seen: best.seen, small: draw(sample, contour, best.camera, 160),
    large: [draw(sample, contour, best.camera, kLarge), draw(sample, contour, other.camera, kLarge, true), draw(sample, contour, whole, kLarge, true)] };
}

// Writes tiles with a label each as one PNG.
function sheet(file, tiles, columns, width) {
  const folder = mkdtempSync(join(tmpdir(), "sheet-")), page = join(folder, "sheet.html"), rows = Math.ceil(tiles.length / columns);
  const height = tiles[0].height + 36 + (tiles[0].images.length > 1 ? 11 : 0);
  const cells = tiles.map(({ images, label }) => `<div>${images.map((source) => `<img src="${source}">`).join("")}<p>${label}</p></div>`);
  writeFileSync(page, `<meta charset="utf-8"><style>body{margin:0;width:${columns * width}px;font:9px/11px sans-serif;display:flex;flex-wrap:wrap}div{width:${width}px;height:${height}px;overflow:hidden}p{margin:1px 3px;white-space:nowrap}img{display:block;float:left}p{clear:left}</style>${cells.join("")}`);
  run(process.env.CHROMIUM ?? "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", `--window-size=${columns * width},${rows * height}`, `--screenshot=${resolve(file)}`, page);
  rmSync(folder, { recursive: true });
}

const loaded = characters.map(load);
const random = randomFrom(seed);
const shuffled = (list) => list.map((x) => [random(), x]).sort((p, q) => p[0] - q[0]).map((p) => p[1]);
const groups = deepest
  ? loaded.map((one) => [`deepest_${one.name}`, chooseDeepest(one)])
  : [["judged", shuffled([...choose(loaded, kCount, random, (kind) => kind >= kPenetration), ...choose(loaded, kCount, random, (kind) => kind < kPenetration)])]];
const table = [];
for (const [name, samples] of groups.filter(([, list]) => list.length > 0)) {
  const drawn = samples.map((sample, i) => {
    const { model, frame, contact } = sample, clip = model.clips[model.clipAt(frame)], images = pictures(sample);
    const parts = contact.parts.map((part) => model.parts.find((p) => p.part === part)?.name ?? part);
    const row = { group: name, number: i + 1, character: sample.name, clip: clip.name, frame: model.number(frame), index: frame, parts, class: CLASSES[contact.kind],
      depth_mm: +contact.depth.toFixed(1), height_share: +(contact.depth * model.mesh.unitsPerMm / model.height).toFixed(4), visible: +contact.visible.toFixed(3), seen: +images.seen.toFixed(2) };
    table.push(row);
    const who = `<b>${row.number}</b> ${row.character} ${row.frame}<br>${parts.join(" / ")}`, figures = `${row.depth_mm} mm, ${(100 * row.height_share).toFixed(1)} %, ${clip.name}`;
    return { kind: contact.kind, small: { images: [images.small], label: `${who}<br>${contact.kind >= kPenetration ? "" : `${row.class}, `}${figures}`, height: 160 },
      large: { images: images.large, label: deepest ? `${who}<br>${figures}<br>visible ${row.visible}, volume ${contact.volume.toFixed(1)} ml` : who, height: kLarge } };
  });
  if (!deepest) {
    for (const [group, ofPenetrations] of [["penetrations", true], ["others", false]]) {
      sheet(join(out, `${group}.png`), drawn.filter(({ kind }) => (kind >= kPenetration) === ofPenetrations).map(({ small }) => small), 10, 162);
    }
  }
  for (let i = 0; i < drawn.length; i += kOfSheet) {
    sheet(join(out, `${name}_${i / kOfSheet + 1}.png`), drawn.slice(i, i + kOfSheet).map(({ large }) => large), 1, 3 * kLarge);
  }
  console.log(`${name}: ${drawn.length}`);
}
writeFileSync(join(out, "table.json"), `[\n${table.map((row) => JSON.stringify(row)).join(",\n")}\n]\n`);
