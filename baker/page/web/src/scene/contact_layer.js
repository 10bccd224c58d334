import * as THREE from 'three';
import { isFault } from '../model/contacts.js';
import { CONTACT } from '../base/palette.js';
import { LIGHT } from './skin_layer.js';

// The triangles that touch, over the skin: striped where they are seen, faint where something hides them, and with edges, so
// that small ones show too. Where a contact is chosen, all others are paler.

const ARROW_MATERIAL = new THREE.MeshBasicMaterial({ color: 0x0b3fd1, depthTest: false, transparent: true });
const HALO_MATERIAL = new THREE.MeshBasicMaterial({ color: 0xffffff, depthTest: false, transparent: true }); // over any texture
const SHAFT = new THREE.CylinderGeometry(1, 1, 1, 12); // one wide and high: scaled
const HEAD = new THREE.ConeGeometry(1, 1, 16);

const vertexShader = `
  attribute float side;
  varying vec3 normalInView;
  varying vec3 toEye;
  varying float chosen;
  void main() {
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    normalInView = normalMatrix * normal;
    toEye = -p.xyz;
    chosen = side;
    gl_Position = projectionMatrix * p;
  }`;

const fragmentShader = `
  uniform vec3 colour;
  uniform float alpha;
  uniform float ratio;
  uniform float anyChosen;
  varying vec3 normalInView;
  varying vec3 toEye;
  varying float chosen;
  ${LIGHT}
  void main() {
    vec3 n = normalize(normalInView);
    vec3 e = normalize(toEye);
    if (dot(n, e) < 0.0) n = -n;
    float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / (7.0 * ratio)));
    float strong = anyChosen < 0.5 || chosen > 0.5 ? 1.0 : 0.35;
    gl_FragColor = vec4(colour * (0.35 + lightOn(n, e)) * mix(0.78, 1.15, stripe), alpha * strong);
    #include <colorspace_fragment>
  }`;

// Which side of the chosen contact a pixel is of, where its outside is seen.
const probeShader = `
  uniform float winding;
  varying float chosen;
  void main() {
    if (chosen < 0.5 || gl_FrontFacing != (winding > 0.0)) discard;
    gl_FragColor = vec4(chosen < 1.5 ? 1.0 : 0.0, chosen < 1.5 ? 0.0 : 1.0, 0.0, 1.0);
  }`;

export class ContactLayer {
  // `most` triangles in a frame; there may be more in a pose that no frame has.
  constructor(skin, most) {
    this.skin = skin;
    const geometry = new THREE.BufferGeometry();
    this.geometry = geometry;
    this.makeRoom(most);
    this.shared = { colour: { value: new THREE.Color(CONTACT) }, ratio: { value: 1 }, anyChosen: { value: 0 } };
    const mesh = (alpha, order, settings) => {
      const material = new THREE.ShaderMaterial({
        vertexShader,
        fragmentShader,
        uniforms: { ...this.shared, alpha: { value: alpha } },
        side: THREE.DoubleSide,
        transparent: true,
        depthWrite: false,
        polygonOffset: true,
        polygonOffsetFactor: -1,
        polygonOffsetUnits: -4,
        ...settings,
      });
      const made = new THREE.Mesh(geometry, material);
      made.renderOrder = order;
      made.frustumCulled = false;
      return made;
    };
    this.hidden = mesh(0.3, 5, { depthFunc: THREE.GreaterDepth });
    this.group = new THREE.Group().add(this.hidden, mesh(1, 6, {}), mesh(0.9, 7, { wireframe: true }));
    this.arrows = new THREE.Group();
    this.group.add(this.arrows);
    this.probe = mesh(1, 6, { fragmentShader: probeShader, uniforms: { winding: { value: 1 } } });
  }

  // For so many triangles.
  makeRoom(most) {
    this.most = Math.max(most, 1);
    this.geometry.dispose(); // of what was there
    const attribute = (name, size) => {
      const buffer = new THREE.BufferAttribute(new Float32Array(3 * size * this.most), size);
      this.geometry.setAttribute(name, buffer.setUsage(THREE.DynamicDrawUsage));
      return buffer;
    };
    this.buffers = { position: attribute('position', 3), normal: attribute('normal', 3), side: attribute('side', 1) };
  }

  // Shows what touches in the pose that the skin has; `chosen` is a contact's key or null.
  fill(contacts, chosen, hiddenParts) {
    const { index, positions, normals } = this.skin;
    const most = contacts.reduce((sum, { triangles }) => sum + triangles.length, 0);
    if (most > this.most) this.makeRoom(2 * most);
    const { position, normal, side } = this.buffers;
    let corner = 0;
    for (const { key, triangles, sides } of contacts) {
      triangles.forEach((t, i) => {
        if (hiddenParts.has(this.skin.mesh.partOf[t])) return;
        for (let k = 0; k < 3; ++k, ++corner) {
          const r = 3 * index[3 * t + k];
          for (let axis = 0; axis < 3; ++axis) {
            position.array[3 * corner + axis] = positions[r + axis];
            normal.array[3 * corner + axis] = normals[r + axis];
          }
          side.array[corner] = key === chosen ? sides[i] : 0;
        }
      });
    }
    const own = contacts.find(({ key }) => key === chosen);
    this.way = own ? new THREE.Vector3(...own.direction) : null; // out of the chosen contact
    this.point(contacts.filter((contact) => isFault(contact) || contact.key === chosen));
    this.geometry.setDrawRange(0, corner);
    this.shared.anyChosen.value = contacts.some(({ key }) => key === chosen) ? 1 : 0;
    for (const buffer of Object.values(this.buffers)) buffer.needsUpdate = true;
  }

  // The way out of each: from the first part's deepest point to where that is free. It is seen through the skin.
  point(contacts) {
    this.arrows.clear();
    const { unitsPerMm, height } = this.skin.mesh;
    for (const { at, direction, depth, triangles } of contacts) {
      const shift = this.skin.shiftOf(triangles[0]);
      const length = depth * unitsPerMm;
      const head = Math.max(0.35 * length, 0.016 * height);
      const shaft = Math.max(length - head, 0.004 * height);
      const arrow = new THREE.Group();
      const rim = 0.0011 * height;
      const part = (geometry, width, from, size) => {
        for (const [material, order, wider] of [[HALO_MATERIAL, 9, rim], [ARROW_MATERIAL, 10, 0]]) {
          const made = new THREE.Mesh(geometry, material);
          made.scale.set(width + wider, size + 2 * wider, width + wider);
          made.position.y = from + size / 2;
          made.renderOrder = order;
          arrow.add(made);
        }
      };
      part(SHAFT, 0.14 * head, 0, shaft);
      part(HEAD, 0.35 * head, shaft, head);
      arrow.position.set(...at.map((x, k) => x + shift[k]));
      arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...direction));
      this.arrows.add(arrow);
    }
  }
}
