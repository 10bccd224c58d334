// SPDX-License-Identifier: MIT
// Draws the skin with WebGL 2: flat shaded, from the front; triangles that intersect are red.
const VERTEX = `#version 300 es
in vec3 position;
in float mark;
uniform vec4 view;  // middle, and scale, of x and y
out vec3 place;
out float marked;
void main() {
  place = position;
  marked = mark;
  gl_Position = vec4((position.xy - view.xy) * view.zw, -0.2 * position.z * view.w, 1);
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 place;
in float marked;
out vec4 color;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.35 + 0.65 * max(0.0, dot(normal, normalize(vec3(0.3, 0.5, 0.8))));
  color = vec4(light * (marked > 0.5 ? vec3(0.85, 0.15, 0.1) : vec3(0.8, 0.74, 0.68)), 1);
}`;

export class Painter {
  constructor(canvas, model) {
    const gl = canvas.getContext('webgl2');
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error('the shaders do not link');
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0.957, 0.953, 0.941, 1);
    this.view = gl.getUniformLocation(program, 'view');
    this.corners = model.triangles;
    this.positions = new Float32Array(3 * this.corners.length);
    this.marks = new Float32Array(this.corners.length);
    this.buffers = [['position', 3], ['mark', 1]].map(([name, size]) => {
      const buffer = gl.createBuffer(), place = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
      return buffer;
    });
    this.gl = gl;
    this.model = model;
  }

  draw(vertices, contacts) {
    const { gl, corners, positions, marks, model } = this;
    corners.forEach((vertex, i) => {
      for (let axis = 0; axis < 3; ++axis) positions[3 * i + axis] = vertices[3 * vertex + axis];
    });
    marks.fill(0);
    for (let i = 0; i < contacts.length; i += 12) {
      for (const triangle of [contacts[i], contacts[i + 1]]) marks.fill(1, 3 * triangle, 3 * triangle + 3);
    }
    [positions, marks].forEach((data, i) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[i]);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    });
    const { canvas } = gl;
    canvas.width = canvas.clientWidth * devicePixelRatio;
    canvas.height = canvas.clientHeight * devicePixelRatio;
    gl.viewport(0, 0, canvas.width, canvas.height);
    const scale = 1.7 / model.height;
    this.middle ??= [0, 1].map(axis => middleOf(vertices, axis));
    gl.uniform4f(this.view, ...this.middle, (scale * canvas.height) / canvas.width, scale);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.drawArrays(gl.TRIANGLES, 0, corners.length);
  }
}

function middleOf(vertices, axis) {
  let low = Infinity, high = -Infinity;
  for (let i = axis; i < vertices.length; i += 3) {
    low = Math.min(low, vertices[i]);
    high = Math.max(high, vertices[i]);
  }
  return (low + high) / 2;
}
