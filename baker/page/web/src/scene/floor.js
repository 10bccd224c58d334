import * as THREE from 'three';

// A grid with cells of a tenth of `unit`, and a shadow. It slides where the character is held in place.
export function createFloor(unit) {
  const geometry = new THREE.PlaneGeometry(3 * unit, 3 * unit).rotateX(-Math.PI / 2);
  const uniforms = { ink: { value: new THREE.Color() }, slide: { value: new THREE.Vector2() }, unit: { value: unit } };
  const material = new THREE.ShaderMaterial({
    uniforms,
    vertexShader: `
      uniform float unit;
      varying vec2 at;
      void main() { at = position.xz / unit; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `
      uniform vec3 ink;
      uniform vec2 slide;
      uniform float unit;
      varying vec2 at;
      void main() {
        vec2 on = (at + slide / unit) * 10.0;
        vec2 cell = abs(fract(on - 0.5) - 0.5) / fwidth(on);
        float line = 1.0 - min(min(cell.x, cell.y), 1.0);
        float fade = smoothstep(0.75, 0.1, length(at));
        float shadow = 0.22 * smoothstep(0.3, 0.0, length(at * vec2(1.0, 1.5)));
        float grid = 0.25 * fade * line;
        gl_FragColor = vec4(ink * grid / max(grid + shadow, 0.001), grid + shadow);
        #include <colorspace_fragment>
      }`,
    transparent: true,
    depthWrite: false,
    side: THREE.DoubleSide,
  });
  const mesh = new THREE.Mesh(geometry, material);
  return { mesh, uniforms };
}
