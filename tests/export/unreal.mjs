// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the script that `export --to unreal` wrote in Python, against a stub of Unreal's module, with both conventions
// of its importers, and reads the bodies that it left in the physics asset.
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { Matrix4, Quaternion, Vector3 } from 'three';

export const ending = 'json', shapes = ['spheres', 'cones', 'capsules', 'boxes'];

const back = {  // from a bone's space in Unreal to ours, in metres; each is its own inverse but for the unit
  gltf: ({ x, y, z }) => new Vector3(x, z, y).divideScalar(100),
  fbx: ({ x, y, z }) => new Vector3(x, -y, z).divideScalar(100),
};

// The axes of an FRotator.
function axesOf({ roll, pitch, yaw }) {
  const [sr, sp, sy] = [roll, pitch, yaw].map((a) => Math.sin((a * Math.PI) / 180));
  const [cr, cp, cy] = [roll, pitch, yaw].map((a) => Math.cos((a * Math.PI) / 180));
  return [
    new Vector3(cp * cy, cp * sy, sp),
    new Vector3(sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, -sr * cp),
    new Vector3(-(cr * sp * cy + sr * sy), cy * sr - cr * sp * sy, cr * cp),
  ];
}

function bodiesOf(setups, file, axes) {
  const ours = back[axes];
  return file.bodies.map(({ part, bone }) => {
    const { sphere_elems: balls, sphyl_elems: capsules, box_elems: boxes, tapered_capsule_elems: cones } = setups[bone].agg_geom;
    const ends = ({ center, rotation, length }) => {
      const up = axesOf(rotation)[2].multiplyScalar(length / 2), middle = new Vector3(center.x, center.y, center.z);
      return [ours(middle.clone().sub(up)).toArray(), ours(middle.clone().add(up)).toArray()];
    };
    // Each cone has a capsule beside it, of the same axis and the mean radius.
    const beside = (cone) => capsules.findIndex((capsule) => JSON.stringify(ends(capsule)) === JSON.stringify(ends(cone)) &&
      Math.abs(capsule.radius - (cone.radius0 + cone.radius1) / 2) < 1e-6 * capsule.radius);
    for (const cone of cones) {
      if (beside(cone) < 0) throw new Error(`${part}: a cone without its capsule`);
      capsules.splice(beside(cone), 1);
    }
    const volumes = [
      ...balls.map(({ center, radius }) => ({ type: 'sphere', center: ours(center).toArray(), radius: radius / 100 })),
      ...capsules.map((one) => { const [a, b] = ends(one); return { type: 'capsule', a, b, radius: one.radius / 100 }; }),
      ...cones.map((one) => {
        const [a, b] = ends(one);
        return { type: 'cone', a, b, radius_a: one.radius1 / 100, radius_b: one.radius0 / 100 };
      }),
      ...boxes.map((one) => {
        // The box's own axes, as ours; the third completes a right-handed frame, for a box is the same on both sides.
        const [x, y] = axesOf(one.rotation).map((axis) => ours(axis).multiplyScalar(100));
        const basis = new Matrix4().makeBasis(x, y, new Vector3().crossVectors(x, y));
        return { type: 'box', center: ours(one.center).toArray(), rotation: new Quaternion().setFromRotationMatrix(basis).toArray(),
          half: [one.x, one.y, one.z].map((size) => size / 200) };
      }),
    ];
    return { part, volumes };
  });
}

export function rebuild(path, file) {
  const bones = join(dirname(path), 'bones.json');
  writeFileSync(bones, JSON.stringify(file.bodies.map(({ bone }) => bone)));
  const run = (axes) => JSON.parse(execFileSync('python3',
    [new URL('unreal_stub.py', import.meta.url).pathname, dirname(path), path, bones, axes], { encoding: 'utf8' }));
  const partOf = new Map(file.bodies.map(({ part, bone }) => [bone, part]));
  const [gltf, fbx] = ['gltf', 'fbx'].map((axes) => ({ axes, ...run(axes) }));
  const [bodies, others] = [gltf, fbx].map(({ axes, setups }) => bodiesOf(setups, file, axes));
  // Both conventions have to come to the same bodies of ours.
  for (const [i, { part, volumes }] of bodies.entries()) {
    volumes.forEach((volume, k) => {
      for (const key of ['center', 'a', 'b']) {
        if (volume[key] && !(new Vector3(...volume[key]).distanceTo(new Vector3(...others[i].volumes[k][key])) < 1e-6 * file.height)) {
          throw new Error(`${part}: FBX and glTF differ`);
        }
      }
    });
  }
  return { bodies, ignored: gltf.pairs.map((pair) => pair.map((bone) => partOf.get(bone))) };
}
