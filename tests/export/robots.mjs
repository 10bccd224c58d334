// Common code for checking the robotics formats: a character, its poses, and turning them upright.
import { execFileSync } from 'node:child_process'
import fs from 'node:fs'
import path from 'node:path'

const models = '/usr/share/assimp/models'

// Arguments of each script: TOOL POSED_COLLIDERS [ASSET SOURCE [SHAPE AT_MOST [MOTION]]]. Without an asset the human of
// assimp's models, as the tool's own preview writes it, boxing.
export function character(shapeOfFormat, poses, args = process.argv.slice(2)) {
  const [tool, posedColliders, asset, source, shape, atMost, motion] = args
  const run = (...args) => execFileSync(args[0], args.slice(1), { encoding: 'utf8', maxBuffer: 1 << 30 })
  const one = { tool, run, asset, source, shape: shape ?? shapeOfFormat, atMost: atMost ?? '0', motion }
  if (!asset) {
    Object.assign(one, { source: 'human.glb', asset: 'human.sphc', motion: models + '/BVH/Boxing_Toes.bvh' })
    const time = file => fs.statSync(file, { throwIfNoEntry: false })?.mtimeMs ?? 0
    if (time(one.asset) < time(tool)) {
      run(tool, 'bake', models + '/Collada/human.zae', '-o', 'first.sphc', '--preview', one.source)
      run(tool, 'bake', one.source, '-o', one.asset)
    }
  }
  const words = [posedColliders, one.asset, one.source, one.shape, one.atMost, String(poses)]
  one.posed = JSON.parse(run(...words, ...(one.motion ? [one.motion] : [])))
  one.export = (format, file) => {
    const out = run(tool, 'export', one.asset, '--to', format, '-o', file, '--volumes', one.shape, '--force',
      ...(one.atMost === '0' ? [] : ['--at-most', one.atMost]))
    for (const line of out.split('\n')) if (line.startsWith('note:')) console.log(line)
    return fs.readFileSync(file, 'utf8')
  }
  const recording = one.motion ? path.basename(one.motion).replace(/\.[^.]*$/, '') : ''
  // The CSVs that an export writes of the source's clips, or of the recording.
  one.tables = (format, file) => {
    const stem = file.replace(/\.[^.]*$/, '.')
    for (const old of fs.readdirSync('.')) if (old.startsWith(stem)) fs.rmSync(old)
    run(tool, 'export', one.asset, '--to', format, '-o', file, '--source', one.source, '--volumes', one.shape,
      ...(one.motion ? ['--motion', one.motion] : []))
    const clips = [...new Set(one.all_frames().map(pose => pose.clip))]
    return fs.readdirSync('.').filter(name => name.startsWith(stem) && name.endsWith(`.${format}.csv`)).map(name => {
      const [header, ...lines] = fs.readFileSync(name, 'utf8').trim().split('\n')
      const clip = clips.find(clip => (clip || recording).replace(/[^A-Za-z0-9-]/g, '_') === name.slice(stem.length, -5 - format.length))
      return { clip, columns: header.split(',').slice(1), rows: lines.map(line => line.split(',').map(Number)) }
    })
  }
  one.all_frames = () => one.every ??= JSON.parse(run(posedColliders, one.asset, one.source, one.shape, one.atMost, '0',
    ...(one.motion ? [one.motion] : []))).poses
  one.json = JSON.parse(one.export('capsules.json', 'robot.capsules.json'))
  one.identifiers = one.json.bodies.map(body => body.part.replace(/[^A-Za-z0-9]/g, '_'))
  // Rows: where forward, left and up of the character go to X, Y and Z.
  one.upright = quaternionOf([one.json.forward, one.json.left, one.json.up])
  const ignored = new Set(one.json.ignored.map(({ parts }) => parts.join('|')))
  one.pairs = []
  one.json.bodies.forEach((a, i) => one.json.bodies.forEach((b, j) => {
    if (i < j && !ignored.has(a.part + '|' + b.part)) one.pairs.push([i, j])
  }))
  return one
}

// The character whose clips are played: that of the arguments, else one of assimp's models that has a clip.
export function withClips(one) {
  if (process.argv[4]) return one
  const [tool, posedColliders] = process.argv.slice(2), source = models + '/X/Testwuson.X'
  one.run(tool, 'bake', source, '-o', 'walker.sphc')
  return character('spheres', 1, [tool, posedColliders, 'walker.sphc', source])
}

// Quaternions x y z w.
export const multiply = ([ax, ay, az, aw], [bx, by, bz, bw]) => [
  aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
  aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]
export const conjugate = ([x, y, z, w]) => [-x, -y, -z, w]
export const turn = (q, v) => multiply(multiply(q, [...v, 0]), conjugate(q)).slice(0, 3)
export const about = (axis, angle) => [...axis.map(a => a * Math.sin(angle / 2)), Math.cos(angle / 2)]
export const add = (a, b) => a.map((x, k) => x + b[k])
export const subtract = (a, b) => a.map((x, k) => x - b[k])
export const distance = (a, b) => Math.hypot(...subtract(a, b))
export const angleBetween = (a, b) => 2 * Math.hypot(...multiply(conjugate(a), b).slice(0, 3))
// Applies `first`, then `then`.
export const compose = (then, first) => ({
  position: add(then.position, turn(then.rotation, first.position)), rotation: multiply(then.rotation, first.rotation) })
export const inverse = ({ position, rotation }) => ({
  position: turn(conjugate(rotation), position.map(x => -x)), rotation: conjugate(rotation) })

export function matrixOf([x, y, z, w]) {
  return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
}
export function quaternionOf(m) {
  const candidates = [
    [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 1 + m[0][0] + m[1][1] + m[2][2]],
    [1 + m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[0][2] + m[2][0], m[2][1] - m[1][2]],
    [m[0][1] + m[1][0], 1 - m[0][0] + m[1][1] - m[2][2], m[1][2] + m[2][1], m[0][2] - m[2][0]],
    [m[0][2] + m[2][0], m[1][2] + m[2][1], 1 - m[0][0] - m[1][1] + m[2][2], m[1][0] - m[0][1]]]
  const norm = q => Math.hypot(...q)
  const best = candidates.reduce((a, b) => (norm(a) > norm(b) ? a : b))
  return best.map(x => x / norm(best))
}

export function check(is, what) {
  if (is) return
  console.error('FAILED: ' + what)
  process.exitCode = 1
}

// Counts pairs of parts, pose by pose, for which a foreign engine and we agree.
export class Verdicts {
  constructor(title) { Object.assign(this, { title, all: 0, alike: 0, ours: 0, theirs: 0, parts: new Map() }) }
  add(name, ours, theirs) {
    this.all++
    this.ours += ours
    this.theirs += theirs
    if (ours === theirs) this.alike++
    else this.parts.set(name, (this.parts.get(name) ?? 0) + 1)
  }
  get percent() { return 100 * this.alike / Math.max(1, this.all) }
  toString() {
    const worst = [...this.parts].sort((a, b) => b[1] - a[1]).slice(0, 3).map(([name, count]) => `${name} ${count}`)
    return `${this.title}: ${this.percent.toFixed(3)} % of ${this.all} verdicts agree; overlaps: ours ${this.ours}, theirs ` +
      `${this.theirs}${worst.length ? '; apart: ' + worst.join(', ') : ''}`
  }
}
