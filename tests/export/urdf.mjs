// URDF with SRDF, XRDF and cuRobo's YAML: readable by urdfdom and PyYAML, whole, about the same links, and of our poses.
import Ajv from 'ajv'
import { spawnSync } from 'node:child_process'
import fs from 'node:fs'
import * as files from './robot_files.mjs'
import * as r from './robots.mjs'

if (spawnSync('check_urdf').error || spawnSync('python3', ['-c', 'import yaml']).status !== 0) {
  console.log('SKIPPED: export needs check_urdf (liburdfdom-tools) and python3-yaml, and they are not installed')
  process.exit(77)
}
const check = r.check
const one = r.character('spheres', 200)
const { height, bodies, poses } = one.posed
const upright = body => ({ position: r.turn(one.upright, body.position), rotation: r.multiply(one.upright, body.rotation) })
const text = one.export('urdf', 'robot.urdf'), urdf = files.readUrdf(text)
const same = (a, b) => JSON.stringify([...a].sort()) === JSON.stringify([...b].sort())

// It exits 0 on errors.
const { status, stderr, stdout } = spawnSync('check_urdf', ['robot.urdf'], { encoding: 'utf8' })
check(status === 0 && stderr === '' && stdout.includes('root Link: base_link'), 'check_urdf has nothing to say: ' + stderr)
check(urdf.links.size === urdf.joints.length + 1, 'one root')
check([...urdf.links].every(([name, link]) => link.mass > 0 || name === 'base_link'), 'every link that moves has a mass')

// Poses by joint values.
const worst = { place: 0, turn: 0, rest: 0 }
let alike = 0
const compare = (at, ours) => bodies.forEach((_, i) => {
  const theirs = at.get(one.identifiers[i]), place = r.distance(theirs.position, ours[i].position) / height
  alike += place < 1e-5
  worst.place = Math.max(worst.place, place)
  worst.turn = Math.max(worst.turn, r.angleBetween(theirs.rotation, ours[i].rotation))
})
compare(files.forwardKinematics(urdf, new Map()), one.json.bodies.map(upright))
check(worst.place < 1e-5 && worst.turn < 1e-5, 'at 0 the links stand as at rest')
worst.place = worst.turn = alike = 0
for (const pose of poses) {
  const ours = pose.bodies.map(upright), values = new Map()
  bodies.forEach(({ parent }, i) => {
    const name = one.identifiers[i], before = parent < 0 ? [0, 0, 0, 1] : ours[parent].rotation
    const turned = r.multiply(r.conjugate(r.multiply(before, urdf.joint.get(name + '_rx').origin.rotation)), ours[i].rotation)
    files.anglesXyz(turned).forEach((angle, k) => values.set(name + ['_rx', '_ry', '_rz'][k], angle))
    if (parent >= 0) return
    const start = urdf.joint.get(name + '_tx').origin.position
    r.subtract(ours[i].position, start).forEach((x, k) => values.set(name + ['_tx', '_ty', '_tz'][k], x))
  })
  for (const [name, value] of values) {
    const joint = urdf.joint.get(name)
    if (!(joint.lower <= value && value <= joint.upper)) check(false, `${name} reaches ${value}`)
  }
  compare(files.forwardKinematics(urdf, values), ours)
}
console.log(`${alike} of ${poses.length * bodies.length} links stand within 1e-5 of the height; worst ` +
  `${worst.place.toExponential(1)} of the height, ${worst.turn.toExponential(1)} rad`)
check(worst.turn < 1e-5, 'links turn as our bodies')
check(alike > 0, 'links stand as our bodies')

// SRDF.
const srdf = files.parseXml(fs.readFileSync('robot.srdf', 'utf8'))
check(srdf.attributes.name === urdf.name, 'SRDF and URDF are of one robot')
const reasons = { adjacent: 'Adjacent', rest: 'Default', always: 'Always', never: 'Never' }
check(same(files.all(srdf, 'disable_collisions').map(({ attributes: a }) => `${a.link1} ${a.link2} ${a.reason}`),
  one.json.ignored.map(({ parts, reason }) => `${parts.map(part => one.identifiers[one.json.bodies.findIndex(b => b.part === part)]).join(' ')} ${reasons[reason]}`)),
'SRDF disables what we ignore, for our reasons')
check(files.all(srdf, 'group').every(group => files.all(group, 'joint').every(joint => urdf.joint.has(joint.attributes.name))), 'the joints of the SRDF are of the URDF')
const approximations = new Map(files.all(srdf, 'link_sphere_approximation').map(link => [link.attributes.link, files.all(link, 'sphere').map(({ attributes: a }) => ({
  center: a.center.split(' ').map(Number), radius: Number(a.radius) }))]))

// The two YAML files: each against its schema and the URDF beside it, then as the spheres that a planner has.
const ajv = new Ajv()
function compareOverlaps(title, linkSpheres, ignores) {
  const verdicts = new r.Verdicts(title)
  const disabled = new Set(Object.entries(ignores).flatMap(([a, others]) => others.flatMap(b => [`${a} ${b}`, `${b} ${a}`])))
  check([...linkSpheres.keys(), ...Object.keys(ignores), ...Object.values(ignores).flat()].every(link => urdf.links.has(link)), title + ': links are of the URDF')
  check(one.json.bodies.every((body, i) => linkSpheres.has(one.identifiers[i]) === body.volumes.length > 0), title + ': every part with volumes is there')
  for (const pose of poses) {
    const overlaps = new Set(pose.overlaps.map(pair => pair.join(' ')))
    const placed = pose.bodies.map((at, i) => (linkSpheres.get(one.identifiers[i]) ?? []).map(({ center, radius }) => ({
      center: r.add(at.position, r.turn(at.rotation, center)), radius })))
    bodies.forEach((a, i) => bodies.forEach((b, j) => {
      if (i >= j || disabled.has(`${one.identifiers[i]} ${one.identifiers[j]}`)) return
      const theirs = placed[i].some(x => placed[j].some(y => r.distance(x.center, y.center) <= x.radius + y.radius))
      verdicts.add(`${a.part} - ${b.part}`, overlaps.has(`${i} ${j}`), theirs)
    }))
  }
  console.log(`${verdicts}`)
  check(verdicts.ours > 0, title + ': something overlaps')
  if (one.shape === 'spheres') check(verdicts.percent >= 99.9, title + ': links overlap as our bodies')
}
function conforms(schema, file) {
  const data = files.readYaml(file), is = ajv.compile(schema)
  check(is(data), `${file}: ${ajv.errorsText(is.errors)}`)
  return data
}
const movable = urdf.joints.map(joint => joint.name)
const ours = {}
for (const { parts: [a, b] } of one.json.ignored) {
  const [i, j] = [a, b].map(part => one.identifiers[one.json.bodies.findIndex(body => body.part === part)])
  ;(ours[i] ??= []).push(j)
}
compareOverlaps('URDF', new Map([...urdf.links].filter(([, link]) => link.spheres.length).map(([name, link]) => [name, link.spheres])), ours)
compareOverlaps('SRDF', approximations, ours)

one.export('xrdf', 'planner.xrdf')
check(fs.readFileSync('planner.urdf', 'utf8') === text || one.shape !== 'spheres', 'XRDF: the URDF is that of --to urdf')
const xrdf = conforms(files.xrdfSchema, 'planner.xrdf')
check(xrdf.collision.geometry in xrdf.geometry && xrdf.self_collision.geometry === xrdf.collision.geometry, 'XRDF: its geometry is there')
check(same(xrdf.cspace.joint_names, movable) && xrdf.cspace.acceleration_limits.length === movable.length && xrdf.cspace.jerk_limits.length === movable.length, 'XRDF: cspace is the joints')
check(xrdf.tool_frames.every(link => urdf.links.has(link)), 'XRDF: tool frames are links')
compareOverlaps('XRDF', new Map(Object.entries(xrdf.geometry[xrdf.collision.geometry].spheres)), xrdf.self_collision.ignore)

one.export('curobo', 'planner.yml')
const { kinematics } = conforms(files.curoboSchema, 'planner.yml').robot_cfg
check(fs.existsSync(kinematics.urdf_path), 'cuRobo: the URDF is beside it')
check([kinematics.ee_link, kinematics.base_link, ...kinematics.link_names].every(link => urdf.links.has(link)), 'cuRobo: links are of the URDF')
check(same(kinematics.collision_link_names, Object.keys(kinematics.collision_spheres)), 'cuRobo: a link has spheres')
check(same(kinematics.cspace.joint_names, movable) && ['retract_config', 'null_space_weight', 'cspace_distance_weight'].every(key => kinematics.cspace[key].length === movable.length), 'cuRobo: cspace is the joints')
compareOverlaps('cuRobo', new Map(Object.entries(kinematics.collision_spheres)), kinematics.self_collision_ignore)
