import * as THREE from 'three';

// The skin: front-most surface only. Each vertex knows its zone; a texture with one texel a zone says how that zone looks, so
// that a hover costs a few bytes.

const vertexShader = `
  attribute float zone;
  attribute vec4 heat;
  attribute vec4 picture; // u, v, which (-1: none), and the alpha below which nothing is there
  uniform sampler2D looks;
  varying vec4 look;
  varying vec4 painted;
  varying vec4 place;
  varying vec3 normalInView;
  varying vec3 toEye;
  void main() {
    int i = int(zone);
    look = texelFetch(looks, ivec2(i % 1024, i / 1024), 0);
    painted = vec4(heat.rgb * heat.a, heat.a);
    place = picture;
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    normalInView = normalMatrix * normal;
    toEye = -p.xyz;
    gl_Position = projectionMatrix * p;
  }`;

// How much light falls on a surface; n and e are unit vectors in view space, to the eye's side.
export const LIGHT = `
  float lightOn(vec3 n, vec3 e) {
    float key = max(dot(n, normalize(vec3(-0.45, 0.7, 0.65))), 0.0);
    float fill = max(dot(n, normalize(vec3(0.8, 0.1, 0.35))), 0.0);
    float sky = 0.5 + 0.5 * n.y;
    float grazing = pow(1.0 - max(dot(n, e), 0.0), 3.0);
    return 0.2 + 0.78 * key + 0.2 * fill + 0.18 * sky - 0.1 * grazing;
  }`;

// A look is a colour and, in alpha, a kind: 0 hidden, 1/4 a ghost, 1/2 plain, 1 pointed at. Ghosts are drawn apart.
const fragmentShader = `
  uniform float opacity;
  uniform float ghosts;
  uniform float pictured;
  uniform highp sampler2DArray pictures;
  varying vec4 look;
  varying vec4 painted;
  varying vec4 place;
  varying vec3 normalInView;
  varying vec3 toEye;
  ${LIGHT}
  void main() {
    vec3 colour = look.rgb;
    vec4 texel = texture(pictures, vec3(place.xy, max(round(place.z), 0.0)));
    if (pictured > 0.5 && place.z > -0.5) {
      if (texel.a < place.w) discard;
      colour *= texel.rgb;
    }
    // A little paler than they are, and never black: nothing is as red as a contact, and shapes can be seen.
    if (pictured > 0.5) colour = 0.025 + 0.975 * mix(vec3(dot(colour, vec3(0.2126, 0.7152, 0.0722))), colour, 0.75);
    if (look.a < 0.1 || (look.a < 0.4) != (ghosts > 0.5)) discard;
    vec3 n = normalize(normalInView);
    vec3 e = normalize(toEye);
    if (dot(n, e) < 0.0) n = -n;
    float edge = pow(1.0 - dot(n, e), 3.0);
    float alpha = opacity + (1.0 - opacity) * 0.55 * edge * smoothstep(0.0, 0.15, opacity);
    if (look.a > 0.9) alpha = max(alpha, 0.62);
    if (ghosts > 0.5) alpha = painted.a * opacity * (0.2 + 0.6 * pow(1.0 - dot(n, e), 2.0));
    if (alpha < 0.004) discard;
    gl_FragColor = vec4((ghosts > 0.5 ? colour : colour * (1.0 - painted.a) + painted.rgb) * lightOn(n, e), alpha);
    #include <colorspace_fragment>
  }`;

export const looks = { HIDDEN: 0, GHOST: 64, PLAIN: 128, POINTED: 255 };

function placesOnPictures({ source, zone, zones }, look) {
  const out = new Float32Array(4 * zone.length).fill(-1);
  if (look === null) return out;
  zone.forEach((z, r) => {
    const { picture = -1, cut = 0 } = zones[z].material ?? {};
    if (picture >= 0) out.set([look.uvs[2 * source[r]], look.uvs[2 * source[r] + 1], picture, cut], 4 * r);
  });
  return out;
}

function pictureTexture({ pixels, size, count }) {
  const texture = new THREE.DataArrayTexture(pixels, size, size, count);
  return Object.assign(texture, {
    colorSpace: THREE.SRGBColorSpace,
    wrapS: THREE.RepeatWrapping,
    wrapT: THREE.RepeatWrapping,
    magFilter: THREE.LinearFilter,
    minFilter: THREE.LinearMipmapLinearFilter,
    generateMipmaps: true,
    anisotropy: 4,
    needsUpdate: true,
  });
}

export class SkinLayer {
  // `isGhost`: all of it is a ghost, which is seen through other skin.
  constructor(skin, look = null, isGhost = false) {
    this.skin = skin;
    const geometry = new THREE.BufferGeometry();
    this.position = new THREE.BufferAttribute(skin.positions, 3).setUsage(THREE.DynamicDrawUsage);
    this.normal = new THREE.BufferAttribute(skin.normals, 3).setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute('position', this.position);
    geometry.setAttribute('normal', this.normal);
    geometry.setAttribute('zone', new THREE.BufferAttribute(skin.zone, 1));
    this.heat = new THREE.BufferAttribute(new Uint8Array(4 * skin.zone.length), 4, true);
    geometry.setAttribute('heat', this.heat);
    geometry.setAttribute('picture', new THREE.BufferAttribute(placesOnPictures(skin, look), 4));
    geometry.setIndex(new THREE.BufferAttribute(skin.index, 1));

    const rows = Math.ceil(Math.max(skin.zones.length, 1) / 1024);
    this.texels = new Uint8Array(4 * 1024 * rows);
    this.texture = new THREE.DataTexture(this.texels, 1024, rows);
    this.texture.colorSpace = THREE.SRGBColorSpace;
    this.uniforms = {
      looks: { value: this.texture },
      opacity: { value: 1 },
      pictured: { value: 0 },
      pictures: { value: pictureTexture(look?.array ?? { pixels: new Uint8Array([255, 255, 255, 255]), size: 1, count: 1 }) },
    };
    const mesh = (order, ghosts, settings) => {
      const uniforms = { ...this.uniforms, ghosts: { value: ghosts } };
      const material = new THREE.ShaderMaterial({ vertexShader, fragmentShader, uniforms, side: THREE.DoubleSide, transparent: true, ...settings });
      return Object.assign(new THREE.Mesh(geometry, material), { renderOrder: order });
    };
    this.depth = mesh(3, 0, { colorWrite: false });
    this.surface = mesh(4, 0, {});
    this.group = new THREE.Group().add(this.depth, this.surface, ...(isGhost || skin.mesh.changed ? [mesh(8, 1, { depthTest: false, depthWrite: false })] : []));
    for (const mesh of this.group.children) mesh.frustumCulled = false;
  }

  // Skin that is seen through shows its front alone: depths come before colours.
  setOpacity(opacity) {
    this.uniforms.opacity.value = opacity;
    this.depth.visible = opacity < 1;
    this.surface.material.depthWrite = opacity === 1;
  }

  setLook(zone, colour, kind) {
    const rgb = parseInt(colour.slice(1), 16);
    this.texels.set([rgb >> 16, (rgb >> 8) & 255, rgb & 255, kind], 4 * zone);
    this.texture.needsUpdate = true;
  }

  // Paints triangles: `colourOf(t)` is [r, g, b, how much] of 255, linear, or null. A corner takes the strongest.
  paint(colourOf) {
    const { index } = this.skin;
    const paint = this.heat.array.fill(0);
    for (let t = 0; t < index.length / 3; ++t) {
      const colour = colourOf(t);
      if (colour === null) continue;
      for (let k = 3 * t; k < 3 * t + 3; ++k) if (colour[3] >= paint[4 * index[k] + 3]) paint.set(colour, 4 * index[k]);
    }
    this.heat.needsUpdate = true;
  }

  // How much of a ghost is seen: `shareOf(i)` of the vertex whose place begins at `i`.
  show(shareOf) {
    for (let i = 0; i < this.skin.positions.length; i += 3) this.heat.array[(4 * i) / 3 + 3] = 255 * Math.min(shareOf(i), 1);
    this.heat.needsUpdate = true;
  }

  pose(frame) {
    if (!this.skin.pose(frame)) return;
    this.position.needsUpdate = true;
    this.normal.needsUpdate = true;
  }
}
