// Readers of URDF, SRDF and the two YAML files that know nothing of who wrote them.
import { execFileSync } from 'node:child_process'
import * as r from './robots.mjs'

// An element: {tag, attributes, children}.
export function parseXml(text) {
  const root = { tag: '', attributes: {}, children: [] }, open = [root]
  for (const [, close, tag, attributes, empty] of text.replace(/<!--.*?-->|<\?.*?\?>/gs, '')
    .matchAll(/<(\/?)([\w:]+)((?:\s+[\w:]+="[^"]*")*)\s*(\/?)>/g)) {
    if (close) {
      if (open.pop().tag !== tag) throw new Error(`</${tag}> closes nothing`)
      continue
    }
    const one = { tag, attributes: Object.fromEntries([...attributes.matchAll(/([\w:]+)="([^"]*)"/g)].map(a => [a[1], a[2]])), children: [] }
    open.at(-1).children.push(one)
    if (!empty) open.push(one)
  }
  if (open.length !== 1) throw new Error(`<${open.at(-1).tag}> stays open`)
  return root.children[0]
}
export const all = (element, tag) => element.children.filter(child => child.tag === tag)
export const first = (element, tag) => all(element, tag)[0]
const vector = text => (text ?? '0 0 0').trim().split(/\s+/).map(Number)

function origin(element) {
  const at = first(element, 'origin')?.attributes ?? {}, [roll, pitch, yaw] = vector(at.rpy)
  const rotation = r.multiply(r.about([0, 0, 1], yaw), r.multiply(r.about([0, 1, 0], pitch), r.about([1, 0, 0], roll)))
  return { position: vector(at.xyz), rotation }
}

export function readUrdf(text) {
  const robot = parseXml(text), joints = all(robot, 'joint').map(joint => ({
    name: joint.attributes.name, type: joint.attributes.type, origin: origin(joint),
    parent: first(joint, 'parent').attributes.link, child: first(joint, 'child').attributes.link,
    axis: vector(first(joint, 'axis').attributes.xyz),
    lower: Number(first(joint, 'limit').attributes.lower), upper: Number(first(joint, 'limit').attributes.upper) }))
  const links = new Map(all(robot, 'link').map(link => [link.attributes.name, {
    mass: Number(first(first(link, 'inertial') ?? { children: [] }, 'mass')?.attributes.value ?? 0),
    spheres: all(link, 'collision').filter(one => first(first(one, 'geometry'), 'sphere')).map(one => ({
      center: origin(one).position, radius: Number(first(first(one, 'geometry'), 'sphere').attributes.radius) })) }]))
  return { name: robot.attributes.name, joints, links, joint: new Map(joints.map(joint => [joint.name, joint])) }
}

// Where each link stands for joint values by name; the root at the origin.
export function forwardKinematics(urdf, values) {
  const children = new Set(urdf.joints.map(joint => joint.child)), at = new Map()
  for (const link of urdf.links.keys()) if (!children.has(link)) at.set(link, { position: [0, 0, 0], rotation: [0, 0, 0, 1] })
  for (let left = urdf.joints; left.length;) {
    const ready = left.filter(joint => at.has(joint.parent))
    if (!ready.length) throw new Error('the joints are no tree')
    for (const joint of ready) {
      const value = values.get(joint.name) ?? 0
      const motion = joint.type === 'prismatic'
        ? { position: joint.axis.map(x => x * value), rotation: [0, 0, 0, 1] }
        : { position: [0, 0, 0], rotation: r.about(joint.axis, value) }
      at.set(joint.child, r.compose(r.compose(at.get(joint.parent), joint.origin), motion))
    }
    left = left.filter(joint => !ready.includes(joint))
  }
  return at
}

// Angles a, b, c of a rotation X(a) Y(b) Z(c).
export function anglesXyz(q) {
  const m = r.matrixOf(q), cosine = Math.hypot(m[0][0], m[0][1]), b = Math.atan2(m[0][2], cosine)
  if (cosine < 1e-9) return [Math.atan2(m[2][1], m[1][1]), b, 0]
  return [Math.atan2(-m[1][2], m[2][2]), b, Math.atan2(-m[0][1], m[0][0])]
}

// By PyYAML, which cuRobo uses too: its YAML 1.1 takes 1e-05 for a text.
export const readYaml = file => JSON.parse(execFileSync('python3',
  ['-c', 'import json, sys, yaml; print(json.dumps(yaml.safe_load(open(sys.argv[1]))))', file], { encoding: 'utf8' }))

const names = { type: 'array', items: { type: 'string', minLength: 1 }, minItems: 1, uniqueItems: true }
const numbers = { type: 'array', items: { type: 'number' }, minItems: 1 }
const byName = items => ({ type: 'object', additionalProperties: items })
const spheres = byName({ type: 'array', minItems: 1, items: { type: 'object', required: ['center', 'radius'], additionalProperties: false,
  properties: { center: { ...numbers, minItems: 3, maxItems: 3 }, radius: { type: 'number', exclusiveMinimum: 0 } } } })
const object = properties => ({ type: 'object', required: Object.keys(properties), properties, additionalProperties: false })
// Keys that Isaac's page on XRDF 1.0 requires, and keys whose absence cuRobo's converter reports.
export const xrdfSchema = object({
  format: { const: 'xrdf' }, format_version: { const: 1 }, default_joint_positions: byName({ type: 'number' }),
  cspace: object({ joint_names: names, acceleration_limits: numbers, jerk_limits: numbers }), tool_frames: names,
  collision: object({ geometry: { type: 'string' }, buffer_distance: byName({ type: 'number' }) }),
  self_collision: object({ geometry: { type: 'string' }, buffer_distance: byName({ type: 'number' }), ignore: byName(names) }),
  geometry: byName(object({ spheres })) })
export const curoboSchema = object({ robot_cfg: object({ kinematics: object({
  urdf_path: { type: 'string' }, asset_root_path: { type: 'string' }, base_link: { type: 'string' }, ee_link: { type: 'string' },
  link_names: names, lock_joints: { type: 'null' }, extra_links: { type: 'null' }, collision_link_names: names,
  collision_sphere_buffer: { type: 'number' }, collision_spheres: spheres, self_collision_ignore: byName(names),
  self_collision_buffer: byName({ type: 'number' }), use_global_cumul: { type: 'boolean' }, mesh_link_names: { type: 'null' },
  cspace: object({ joint_names: names, retract_config: numbers, null_space_weight: numbers, cspace_distance_weight: numbers,
    max_jerk: { type: 'number' }, max_acceleration: { type: 'number' } }) }) }) })
