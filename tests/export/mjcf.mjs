// MJCF in MuJoCo: it compiles without a word, poses are ours, overlapping parts are ours, and the figure falls down.
import fs from 'node:fs'
import loadMujoco from 'mujoco-js'
import * as r from './robots.mjs'

const check = r.check, words = []
const mujoco = await loadMujoco({ print: text => words.push(text), printErr: text => words.push(text) })
const one = r.character('capsules', 200)
const { height, bodies, poses } = one.posed
const xml = one.export('mjcf', 'robot.xml')

function load(text) {
  mujoco.FS.writeFile('/robot.xml', text)
  const model = mujoco.MjModel.loadFromXML('/robot.xml')
  return { model, data: new mujoco.MjData(model) }
}
const BODY = 1, JOINT = 3
const ids = (model, type) => one.identifiers.map(name => mujoco.mj_name2id(model, type, name))
const wxyz = ([x, y, z, w]) => [w, x, y, z], xyzw = ([w, x, y, z]) => [x, y, z, w]
const upright = body => ({ position: r.turn(one.upright, body.position), rotation: r.multiply(one.upright, body.rotation) })

function placed({ model, data }, bodyIds) {
  mujoco.mj_forward(model, data)
  return bodyIds.map(id => ({ position: [...data.xpos.slice(3 * id, 3 * id + 3)], rotation: xyzw([...data.xquat.slice(4 * id, 4 * id + 4)]) }))
}
function touching({ model, data }, bodyIds) {
  const index = new Map(bodyIds.map((id, i) => [id, i])), out = new Set()
  const contacts = data.contact
  for (let c = 0; c < data.ncon; c++) {
    const contact = contacts.get(c)
    const [a, b] = [contact.geom1, contact.geom2].map(geom => index.get(model.geom_bodyid[geom]))
    if (a !== undefined && b !== undefined && contact.dist <= 0) out.add(Math.min(a, b) + ' ' + Math.max(a, b))
    contact.delete()
  }
  contacts.delete()
  return out
}

// As written: a free joint at each root, balls below.
const jointed = load(xml)
const jointedBodies = ids(jointed.model, BODY), joints = ids(jointed.model, JOINT).map(id => jointed.model.jnt_qposadr[id])
check(jointed.model.nexclude === one.json.ignored.length, 'every ignored pair is an exclude')
const rest = placed(jointed, jointedBodies)
const worstRest = Math.max(...rest.map((at, i) => {
  const ours = upright(one.json.bodies[i])
  return Math.max(r.distance(at.position, ours.position) / height, r.angleBetween(at.rotation, ours.rotation))
}))
check(worstRest < 1e-5, 'at rest the bodies stand where ours do')

// Each body alone, with a free joint: the same geoms and excludes, and any pose whatever.
const alone = load(freed(xml))
const aloneBodies = ids(alone.model, BODY)
const aloneJoints = aloneBodies.map(id => alone.model.jnt_qposadr[alone.model.body_jntadr[id]])
function freed(text) {
  const lines = text.split('\n'), out = [], open = []
  const flush = body => { if (body) out.push(`<body name="${body.name}"><freejoint/>`, ...body.lines, '</body>') }
  for (const line of lines) {
    const start = /<body name="([^"]*)"/.exec(line)
    if (start) open.push({ name: start[1], lines: [] })
    else if (line.includes('</body>')) flush(open.pop())
    else if (open.length === 0) out.push(line)
    else if (!/joint/.test(line)) open.at(-1).lines.push(line)
  }
  return out.join('\n')
}

// The joint angles that the export writes beside it: for each clip of a character that has some, and for a recording.
for (const walker of new Set([r.withClips(one), one])) {
  const tables = walker.tables('mjcf', 'clips.xml')
  if (tables.length === 0) continue
  const { model, data } = load(fs.readFileSync('clips.xml', 'utf8'))
  const bodyIds = walker.identifiers.map(name => mujoco.mj_name2id(model, BODY, name)), address = name => {
    const free = /^(.*)_([xyz]|q[wxyz])$/.exec(name), slide = mujoco.mj_name2id(model, JOINT, name)
    if (slide >= 0) return model.jnt_qposadr[slide]
    const id = mujoco.mj_name2id(model, JOINT, free[1])
    return model.jnt_qposadr[id] + (free[2].length === 1 ? 'xyz'.indexOf(free[2]) : 'wxyz'.indexOf(free[2][1]) + (model.jnt_type[id] === 0 ? 3 : 0))
  }
  const balls = [...model.jnt_type].flatMap((type, j) => (type === 1 ? [j] : []))
  let farthest = 0, widest = 0, frames = 0, beyond = 0
  for (const { clip, columns, rows } of tables) {
    const at = columns.map(address), played = walker.all_frames().filter(pose => pose.clip === clip)
    check(rows.length === played.length, `the table of ${clip} has a row for each frame`)
    rows.forEach(([seconds, ...values], f) => {
      check(Math.abs(seconds - played[f].seconds) < 1e-4, 'rows have the times of frames')
      values.forEach((value, k) => { data.qpos[at[k]] = value })
      for (const j of balls) beyond += 2 * Math.acos(Math.min(1, Math.abs(data.qpos[model.jnt_qposadr[j]]))) > model.jnt_range[2 * j + 1] ? 1 : 0
      placed({ model, data }, bodyIds).forEach((theirs, i) => {
        const { position, rotation } = played[f].bodies[i]
        const ours = { position: r.turn(walker.upright, position), rotation: r.multiply(walker.upright, rotation) }
        farthest = Math.max(farthest, r.distance(theirs.position, ours.position))
        widest = Math.max(widest, r.angleBetween(theirs.rotation, ours.rotation))
      })
      frames++
    })
  }
  console.log(`joint angles of ${tables.length} clips, ${frames} frames: at worst ${(1000 * farthest).toFixed(3)} mm and ` +
    `${(widest * 180 / Math.PI).toFixed(4)} degrees from the clip`)
  check(beyond === 0, 'joints turn as far as the clips turn them')
  // The figure falls: what slides in its parent is held by a spring.
  mujoco.mj_resetData(model, data)
  const height = walker.posed.height, seconds = 2 * Math.sqrt(Math.max(1, height / 1.7))
  for (let i = 0; i < seconds / model.opt.timestep; i++) mujoco.mj_step(model, data)
  const slid = [...model.jnt_type].map((type, j) => (type === 2 ? Math.abs(data.qpos[model.jnt_qposadr[j]]) : 0))
  console.log(`after ${seconds.toFixed(1)} s of falling parts have slid by up to ${(100 * Math.max(...slid) / height).toFixed(2)} % of the height`)
  check(Math.max(...slid) < 0.03 * height, 'springs hold the parts together')
  check(farthest < 0.001 && widest < 0.1 * Math.PI / 180, 'with their joint angles bodies stand as in the clips')
}

const free = new r.Verdicts('bodies free'), tree = new r.Verdicts('bodies jointed')
const standing = new r.Verdicts('bodies jointed that stand as ours')
let placedAlike = 0, worstPlace = 0, worstTurn = 0
for (const pose of poses) {
  const ours = pose.bodies.map(upright)
  const overlaps = new Set(pose.overlaps.map(([a, b]) => `${a} ${b}`))
  const freeQpos = alone.data.qpos, qpos = jointed.data.qpos
  ours.forEach((at, i) => {
    const q = [...at.position, ...wxyz(at.rotation)]
    q.forEach((x, k) => { freeQpos[aloneJoints[i] + k] = x })
    const parent = bodies[i].parent
    if (parent < 0) return q.forEach((x, k) => { qpos[joints[i] + k] = x })
    const id = jointedBodies[i], inParent = xyzw([...jointed.model.body_quat.slice(4 * id, 4 * id + 4)])
    const ball = r.multiply(r.conjugate(r.multiply(ours[parent].rotation, inParent)), at.rotation)
    wxyz(ball).forEach((x, k) => { qpos[joints[i] + k] = x })
  })
  placed(alone, aloneBodies)
  const freeTouching = touching(alone, aloneBodies)
  const at = placed(jointed, jointedBodies)
  const alike = at.map((theirs, i) => r.distance(theirs.position, ours[i].position) < 1e-5 * height)
  at.forEach((theirs, i) => {
    placedAlike += alike[i]
    worstPlace = Math.max(worstPlace, r.distance(theirs.position, ours[i].position) / height)
    worstTurn = Math.max(worstTurn, r.angleBetween(theirs.rotation, ours[i].rotation))
  })
  const treeTouching = touching(jointed, jointedBodies)
  for (const [a, b] of one.pairs) {
    const name = `${bodies[a].part} - ${bodies[b].part}`, key = `${a} ${b}`
    free.add(name, overlaps.has(key), freeTouching.has(key))
    tree.add(name, overlaps.has(key), treeTouching.has(key))
    if (alike[a] && alike[b]) standing.add(name, overlaps.has(key), treeTouching.has(key))
  }
}
console.log(`${free}`)
console.log(`${tree}`)
console.log(`${standing}`)
console.log(`${placedAlike} of ${poses.length * bodies.length} jointed bodies stand within 1e-5 of the height; worst ` +
  `${worstPlace.toExponential(1)} of the height, ${worstTurn.toExponential(1)} rad`)
check(free.percent >= 99.9, 'free bodies overlap as ours')
check(free.ours > 0, 'something overlaps')
check(standing.all === 0 || standing.percent >= 99.9, 'jointed bodies overlap as ours where they stand as ours')
check(worstTurn < 1e-5, 'jointed bodies turn as ours')

// Five seconds of falling, stretched to its size.
mujoco.mj_resetData(jointed.model, jointed.data)
const seconds = 5 * Math.sqrt(Math.max(1, height / 1.7))
placed(jointed, jointedBodies)
const steps = Math.round(seconds / jointed.model.opt.timestep)
const heightOfMass = () => jointed.data.subtree_com[2] - jointed.model.geom_pos[2]  // the first geom is the floor
const top = heightOfMass()
for (let i = 0; i < steps; i++) mujoco.mj_step(jointed.model, jointed.data)
const after = placed(jointed, jointedBodies), fallen = heightOfMass() / top
const speed = Math.max(...jointed.data.qvel.map(Math.abs)), floor = jointed.model.geom_pos[2]
console.log(`after ${seconds.toFixed(1)} s the centre of mass is at ${fallen.toFixed(2)} of its height; ` +
  `mass ${jointed.model.body_mass.reduce((a, b) => a + b, 0).toFixed(1)} kg, fastest ${speed.toFixed(2)} m/s or rad/s`)
check(after.every(at => at.position.every(Number.isFinite)), 'the figure stays finite')
check(fallen < 0.75, 'the figure falls')
check(after.every(at => at.position[2] > floor), 'the figure stays on the floor')
check(after.every(at => Math.hypot(...at.position) < 3 * height), 'the figure stays near')
check(words.length === 0, 'MuJoCo has nothing to say: ' + words.join(' '))
