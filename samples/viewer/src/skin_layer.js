import * as THREE from 'three';

// The skin: front-most surface only, see-through. Each vertex knows the sphere whose surrounding region it is in; a texture with
// one texel a sphere says how that region looks, so that a hover or a contact costs a few bytes.

const vertexShader = `
  attribute float owner;
  uniform sampler2D looks;
  varying vec4 look;
  varying vec3 normalInView;
  varying vec3 toEye;
  void main() {
    look = texelFetch(looks, ivec2(int(owner), 0), 0);
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    normalInView = normalMatrix * normal;
    toEye = -p.xyz;
    gl_Position = projectionMatrix * p;
  }`;

// A look is a colour and, in alpha, a kind: 0 hidden, 1/3 plain, 2/3 pointed at, 1 in contact.
const fragmentShader = `
  uniform float opacity;
  uniform float ratio;
  varying vec4 look;
  varying vec3 normalInView;
  varying vec3 toEye;
  void main() {
    if (look.a < 0.1) discard;
    vec3 n = normalize(normalInView);
    vec3 e = normalize(toEye);
    if (dot(n, e) < 0.0) n = -n;
    float facing = dot(n, e);
    float light = 0.42 + 0.48 * max(dot(n, normalize(vec3(-0.35, 0.65, 0.7))), 0.0) + 0.16 * (0.5 + 0.5 * n.y);
    vec3 colour = look.rgb * light;
    float edge = pow(1.0 - facing, 3.0);
    float alpha = opacity + (1.0 - opacity) * 0.55 * edge * smoothstep(0.0, 0.15, opacity);
    if (look.a > 0.5) alpha = max(alpha, 0.62);
    if (look.a > 0.9) {  // stripes: a contact is not told by its colour alone
      float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / (9.0 * ratio)));
      colour *= mix(0.72, 1.12, stripe);
    }
    if (alpha < 0.004) discard;
    gl_FragColor = vec4(colour, alpha);
    #include <colorspace_fragment>
  }`;

const HIDDEN = 0;
const PLAIN = 85;
const POINTED = 170;
const TOUCHING = 255;
export const looks = { HIDDEN, PLAIN, POINTED, TOUCHING };

export class SkinLayer {
  constructor(skin, sphereCount) {
    this.skin = skin;
    const geometry = new THREE.BufferGeometry();
    this.position = new THREE.BufferAttribute(skin.positions, 3).setUsage(THREE.DynamicDrawUsage);
    this.normal = new THREE.BufferAttribute(skin.normals, 3).setUsage(THREE.DynamicDrawUsage);
    const owner = Float32Array.from(skin.owner, (sphere) => Math.min(sphere, sphereCount));
    geometry.setAttribute('position', this.position);
    geometry.setAttribute('normal', this.normal);
    geometry.setAttribute('owner', new THREE.BufferAttribute(owner, 1));
    geometry.setIndex(new THREE.BufferAttribute(skin.index, 1));

    // The last texel is for triangles that no sphere owns.
    this.texels = new Uint8Array(4 * (sphereCount + 1));
    this.texture = new THREE.DataTexture(this.texels, sphereCount + 1, 1);
    this.texture.colorSpace = THREE.SRGBColorSpace;
    this.uniforms = { looks: { value: this.texture }, opacity: { value: 1 }, ratio: { value: 1 } };
    const material = (settings) =>
      new THREE.ShaderMaterial({ vertexShader, fragmentShader, uniforms: this.uniforms, side: THREE.DoubleSide, ...settings });
    const depth = new THREE.Mesh(geometry, material({ colorWrite: false, transparent: true }));
    const colour = new THREE.Mesh(geometry, material({ transparent: true, depthWrite: false }));
    depth.renderOrder = 3;
    colour.renderOrder = 4;
    this.group = new THREE.Group().add(depth, colour);
    for (const mesh of this.group.children) mesh.frustumCulled = false;
  }

  setLook(sphere, colour, kind) {
    const rgb = parseInt(colour.slice(1), 16);
    this.texels.set([rgb >> 16, (rgb >> 8) & 255, rgb & 255, kind], 4 * sphere);
    this.texture.needsUpdate = true;
  }

  pose(frame) {
    if (!this.skin.pose(frame)) return;
    this.position.needsUpdate = true;
    this.normal.needsUpdate = true;
  }
}
