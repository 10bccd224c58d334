// SPDX-License-Identifier: GPL-3.0-or-later
// Compiles the importer that `export --to unity` wrote with mono, against stubs of Unity, runs it on a character whose
// bones are mirrored as Unity's importers do and have scales of their own, and reads what stands there then.
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { Quaternion, Vector3 } from 'three';

export const ending = 'json', shapes = ['spheres', 'cones', 'capsules', 'boxes'];

const mirrored = ([x, ...rest]) => [-x, ...rest];
const mirroredRotation = ([x, y, z, w]) => [x, -y, -z, w];

export function rebuild(path, file) {
  const folder = dirname(path), program = join(folder, 'importer.exe'), skeleton = join(folder, 'skeleton.txt');
  execFileSync('mcs', ['-warnaserror', '-define:UNITY_EDITOR', `-out:${program}`,
    join(folder, 'SpherechainColliders.cs'), new URL('unity_stubs.cs', import.meta.url).pathname]);
  const bones = new Map(file.bodies.map((body) => [body.bone, body]));
  writeFileSync(skeleton, [...bones].map(([bone, { position, rotation }], i) =>
    [bone, ...mirrored(position), ...mirroredRotation(rotation), [1, 0.01, 100][i % 3]].join('\t')).join('\n'));
  const { colliders, ignored, cloth } = JSON.parse(execFileSync('mono', [program, path, skeleton], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] }));

  // From the world, which is mirrored, into the frame of the body.
  const bodies = file.bodies.map(({ part, position, rotation }) => {
    const origin = new Vector3(...position), back = new Quaternion(...rotation).normalize().invert();
    const place = (point) => new Vector3(...mirrored(point)).sub(origin).applyQuaternion(back).toArray();
    const turn = (q) => back.clone().multiply(new Quaternion(...mirroredRotation(q))).toArray();
    const volumes = [];
    let cone = null;
    for (const one of colliders.filter(({ body }) => body === `collider ${part}`)) {
      const center = place(one.position);
      if (one.name === 'cloth') {  // the two balls of the cone before
        const [a, b] = [cone.a, cone.b].map((end) => new Vector3(...end).distanceTo(new Vector3(...center)));
        cone[a < b ? 'radius_a' : 'radius_b'] = one.radius;
        if (!(Math.min(a, b) < 1e-4)) throw new Error(`${part}: a ball of a cone is elsewhere`);
      } else if (one.type === 'SphereCollider') {
        volumes.push({ type: 'sphere', center, radius: one.radius });
      } else if (one.type === 'BoxCollider') {
        volumes.push({ type: 'box', center, rotation: turn(one.rotation), half: one.size.map((s) => s / 2) });
      } else {
        if (one.direction !== 1) throw new Error(`${part}: a capsule along ${one.direction}`);
        const half = new Vector3(0, one.height / 2 - one.radius, 0).applyQuaternion(new Quaternion(...turn(one.rotation)));
        const middle = new Vector3(...center);
        const ends = { a: middle.clone().sub(half).toArray(), b: middle.clone().add(half).toArray() };
        cone = one.name === 'cone' ? { type: 'cone', ...ends, mean: one.radius } : { type: 'capsule', ...ends, radius: one.radius };
        volumes.push(cone);
      }
    }
    for (const { mean, radius_a: a, radius_b: b } of volumes) {
      if (mean !== undefined && !(Math.abs(mean - (a + b) / 2) <= 1e-5 * mean)) throw new Error(`${part}: a capsule is not of its cone's mean radius`);
    }
    return { part, volumes };
  });
  if (!(cloth.spheres <= 32 && cloth.capsules <= 32 && cloth.spheres + cloth.capsules > 0)) throw new Error(`a Cloth got ${JSON.stringify(cloth)}`);
  return { bodies, ignored: ignored.map((pair) => pair.map((name) => name.replace('collider ', ''))) };
}
