import * as THREE from 'three';
import { mergeVertices } from 'three/addons/utils/BufferGeometryUtils.js';

// The spheres: shaded, see-through, drawn from back to front; then their depth, so that skin behind them stays behind.

const vertexShader = `
  attribute vec4 sphere;
  attribute vec4 colour;
  attribute float rim;
  varying vec4 tint;
  varying float rimWidth;
  varying vec3 normalInView;
  varying vec3 toEye;
  void main() {
    vec4 p = modelViewMatrix * vec4(sphere.xyz + sphere.w * position, 1.0);
    tint = colour;
    rimWidth = rim;
    normalInView = normalMatrix * position;
    toEye = -p.xyz;
    gl_Position = projectionMatrix * p;
  }`;

const fragmentShader = `
  uniform float solid;
  uniform vec3 rimColour;
  varying vec4 tint;
  varying float rimWidth;
  varying vec3 normalInView;
  varying vec3 toEye;
  void main() {
    if (tint.a < solid) discard;
    vec3 n = normalize(normalInView);
    vec3 e = normalize(toEye);
    float facing = max(dot(n, e), 0.0);
    vec3 l = normalize(vec3(-0.35, 0.65, 0.7));
    float light = 0.38 + 0.62 * max(dot(n, l), 0.0) + 0.12 * n.y;
    float shine = pow(max(dot(reflect(-l, n), e), 0.0), 40.0);
    vec3 colour = tint.rgb * light + 0.25 * shine;
    float edge = 1.0 - facing;
    float alpha = mix(tint.a, min(1.0, tint.a * 1.5), edge * edge);
    float rim = smoothstep(1.0 - rimWidth, 1.0 - 0.7 * rimWidth, edge) * step(0.001, rimWidth);
    gl_FragColor = vec4(mix(colour, rimColour, rim), max(alpha, rim));
    #include <colorspace_fragment>
  }`;

export class SphereLayer {
  constructor(count) {
    this.count = count;
    this.items = Array.from({ length: count }, () => ({ sphere: [0, 0, 0, 0], colour: new THREE.Color(), alpha: 0, rim: 0 }));
    const geometry = new THREE.InstancedBufferGeometry();
    // Triangles of one size: as round as meridians and parallels of twice as many triangles, which crowd at the poles.
    const ball = mergeVertices(new THREE.IcosahedronGeometry(1, 4).deleteAttribute('normal').deleteAttribute('uv'));
    geometry.setIndex(ball.index);
    geometry.setAttribute('position', ball.attributes.position);
    const attribute = (name, size) => {
      const buffer = new THREE.InstancedBufferAttribute(new Float32Array(size * count), size).setUsage(THREE.DynamicDrawUsage);
      geometry.setAttribute(name, buffer);
      return buffer;
    };
    this.spheres = attribute('sphere', 4);
    this.colours = attribute('colour', 4);
    this.rims = attribute('rim', 1);
    this.geometry = geometry;
    this.rimColour = new THREE.Color();
    const material = (solid, settings) =>
      new THREE.ShaderMaterial({
        vertexShader,
        fragmentShader,
        uniforms: { solid: { value: solid }, rimColour: { value: this.rimColour } },
        transparent: true,
        ...settings,
      });
    const colour = new THREE.Mesh(geometry, material(0.004, { depthWrite: false }));
    // Faded spheres hide nothing.
    const depth = new THREE.Mesh(geometry, material(0.25, { colorWrite: false }));
    colour.renderOrder = 1;
    depth.renderOrder = 2;
    this.group = new THREE.Group().add(colour, depth);
    for (const mesh of this.group.children) mesh.frustumCulled = false;
  }

  // Writes the items that are seen, the farthest from `eye` first.
  upload(eye) {
    const distance = ({ sphere }) => (sphere[0] - eye.x) ** 2 + (sphere[1] - eye.y) ** 2 + (sphere[2] - eye.z) ** 2;
    const seen = this.items.filter(({ alpha }) => alpha > 0);
    const order = seen.map((item) => ({ item, far: distance(item) })).sort((a, b) => b.far - a.far);
    this.geometry.instanceCount = order.length;
    order.forEach(({ item }, i) => {
      this.spheres.array.set(item.sphere, 4 * i);
      this.colours.array.set([item.colour.r, item.colour.g, item.colour.b, item.alpha], 4 * i);
      this.rims.array[i] = item.rim;
    });
    for (const buffer of [this.spheres, this.colours, this.rims]) buffer.needsUpdate = true;
  }
}
