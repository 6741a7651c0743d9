// Draws the surface with WebGL 2.
//
// Positions are one texture, four numbers per node: x, y, z and the value that colours show. Triangles and edges name
// their nodes, which never changes; so a frame costs one upload of the surface's nodes, and the graphics device does the
// rest. Normals come from the derivatives of positions in the picture: faces are flat, as their elements are.

import { matrix, axes, add } from "./camera.js";

/** Nodes in a row of the texture. */
const WIDTH = 1024;

const FETCH = `
uniform highp sampler2D nodes;
vec4 node(uint n) { return texelFetch(nodes, ivec2(int(n) % ${WIDTH}, int(n) / ${WIDTH}), 0); }
`;

const SURFACE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in uint number;
layout(location = 1) in vec3 colour;
uniform mat4 view;
out vec3 position;
out vec3 paint;
out float value;
${FETCH}
void main() {
  vec4 n = node(number);
  position = n.xyz;
  value = n.w;
  paint = colour;
  gl_Position = view * vec4(n.xyz, 1.0);
}`;

const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 position;
in vec3 paint;
in float value;
uniform vec4 cut;
uniform vec3 towards;
uniform vec3 above;
uniform vec2 range;
uniform bool numbers;
uniform vec3 map[11];
out vec4 colour;
void main() {
  if (dot(cut.xyz, position) > cut.w) discard;
  vec3 base = paint;
  if (numbers) {
    float x = clamp((value - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0) * 10.0;
    int k = min(int(x), 9);
    base = mix(map[k], map[k + 1], x - float(k));
  }
  vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
  if (dot(normal, towards) < 0.0) normal = -normal;
  float light = 0.6 + 0.32 * max(dot(normal, towards), 0.0) + 0.16 * dot(normal, above);
  // What is seen from behind is the inside of a body that was cut open.
  colour = vec4(base * clamp(light, 0.4, 1.05) * (gl_FrontFacing ? 1.0 : 0.7), 1.0);
}`;

const EDGE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in uint number;
uniform mat4 view;
out vec3 position;
${FETCH}
void main() {
  position = node(number).xyz;
  gl_Position = view * vec4(position, 1.0);
}`;

const EDGE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 position;
uniform vec4 cut;
out vec4 colour;
void main() {
  if (dot(cut.xyz, position) > cut.w) discard;
  colour = vec4(0.2, 0.19, 0.18, 0.55);
}`;

// Lines with a width: two triangles per piece, spread in the picture.
const LINE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec2 corner;
layout(location = 3) in vec3 colour;
uniform mat4 view;
uniform vec2 size;
uniform float width;
out vec3 position;
out vec3 paint;
void main() {
  vec4 a = view * vec4(from, 1.0);
  vec4 b = view * vec4(to, 1.0);
  vec2 along = (b.xy / b.w - a.xy / a.w) * size;
  vec2 across = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(1.0, 0.0);
  vec4 end = mix(a, b, corner.x);
  end.xy += across * corner.y * width / size * end.w;
  position = mix(from, to, corner.x);
  paint = colour;
  gl_Position = end;
}`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 position;
in vec3 paint;
uniform vec4 cut;
out vec4 colour;
void main() {
  if (dot(cut.xyz, position) > cut.w) discard;
  colour = vec4(paint, 1.0);
}`;

const CAP_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 corner;
uniform mat4 view;
void main() { gl_Position = view * vec4(corner, 1.0); }`;

const CAP_FRAGMENT = `#version 300 es
precision highp float;
out vec4 colour;
void main() {
  // Hatched, as sections are drawn.
  float stripe = step(0.8, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
  colour = vec4(mix(vec3(0.88, 0.82, 0.74), vec3(0.55, 0.5, 0.44), stripe), 1.0);
}`;

const HAND = [0.7, 0.075, 0.3];
const CORNERS = [[0, -1], [1, -1], [1, 1], [0, -1], [1, 1], [0, 1]];

export const rgb = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
    throw new Error(gl.getProgramInfoLog(made) || "this browser refuses a shader");
  }
  const places = {};
  const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS);
  for (let k = 0; k < count; k++) {
    const name = gl.getActiveUniform(made, k).name.replace("[0]", "");
    places[name] = gl.getUniformLocation(made, name);
  }
  return { made, places };
}

function fill(gl, values, usage = gl.STATIC_DRAW) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, values, usage);
  return buffer;
}

/** What a canvas shows; throws when the browser has no WebGL 2. */
export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: false });
    if (!gl) throw new Error("this browser has no WebGL 2, which draws the picture");
    this.gl = gl;
    this.surface = program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT);
    this.edge = program(gl, EDGE_VERTEX, EDGE_FRAGMENT);
    this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.cap = program(gl, CAP_VERTEX, CAP_FRAGMENT);
    this.texture = gl.createTexture();
    this.lines = gl.createVertexArray();
    this.lineBuffer = gl.createBuffer();
    this.capArray = gl.createVertexArray();
    this.capBuffer = gl.createBuffer();
    this.buffers = [];
  }

  /** Takes what never changes: nodes, triangles, edges, cables. */
  setScene({ header, arrays }) {
    const { gl } = this;
    for (const buffer of this.buffers) gl.deleteBuffer(buffer);
    this.scene = header;
    this.arrays = arrays;
    this.count = header.nodes;
    this.rows = Math.max(1, Math.ceil(this.count / WIDTH));
    this.packed = new Float32Array(4 * WIDTH * this.rows);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, WIDTH, this.rows, 0, gl.RGBA, gl.FLOAT, null);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    const numbers = fill(gl, arrays.triangles);
    this.colours = gl.createBuffer();
    const edges = fill(gl, arrays.edges);
    this.buffers = [numbers, this.colours, edges];
    this.faces = gl.createVertexArray();
    gl.bindVertexArray(this.faces);
    gl.bindBuffer(gl.ARRAY_BUFFER, numbers);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_INT, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colours);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 3, gl.UNSIGNED_BYTE, true, 4, 0);
    this.rims = gl.createVertexArray();
    gl.bindVertexArray(this.rims);
    gl.bindBuffer(gl.ARRAY_BUFFER, edges);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_INT, 0, 0);
    gl.bindVertexArray(null);
    const size = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (this.rows > size) throw new Error(`${this.count} surface nodes are more than this browser draws`);
    this.setPositions(arrays.rest, null);
    this.setGroups(0);
  }

  /** Colours of the groups of one grouping. */
  setGroups(grouping) {
    const { gl, scene, arrays } = this;
    const groups = scene.legends[scene.groupings[grouping]].map((g) => rgb(g.colour));
    const stride = scene.groupings.length;
    const triangles = arrays.triangles.length / 3;
    const colours = new Uint8Array(12 * triangles);
    const colour = (piece) => groups[Math.min(arrays.groups[stride * piece + grouping], groups.length - 1)];
    for (let t = 0; t < triangles; t++) {
      const c = colour(t);
      for (let corner = 0; corner < 3; corner++) colours.set(c, 12 * t + 4 * corner);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colours);
    gl.bufferData(gl.ARRAY_BUFFER, colours, gl.STATIC_DRAW);
    this.cableColours = Array.from({ length: arrays.cables.length / 2 }, (_, k) => colour(triangles + k).map((x) => x / 255));
  }

  /** Takes positions and, if there are any, values, one per node. */
  setPositions(positions, values) {
    const { gl, packed } = this;
    this.positions = positions;
    for (let n = 0; n < this.count; n++) {
      packed[4 * n] = positions[3 * n];
      packed[4 * n + 1] = positions[3 * n + 1];
      packed[4 * n + 2] = positions[3 * n + 2];
      packed[4 * n + 3] = values ? values[n] : 0;
    }
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDTH, this.rows, gl.RGBA, gl.FLOAT, packed);
  }

  /** The box around all nodes. */
  bounds() {
    const low = [Infinity, Infinity, Infinity];
    const high = low.map((x) => -x);
    for (let k = 0; k < this.positions.length; k++) {
      low[k % 3] = Math.min(low[k % 3], this.positions[k]);
      high[k % 3] = Math.max(high[k % 3], this.positions[k]);
    }
    return [low, high];
  }

  /** Width over height, after the canvas has taken its size on the screen. */
  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((s) => Math.max(1, Math.round(s * ratio)));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    return width / height;
  }

  /**
   * Draws. `look`: `plane` (normal and offset of what is hidden, or `null`), `edges`, `range` (ends of the map, or `null`
   * for the colours of groups), `pulls`.
   */
  draw(camera, look) {
    const { gl, scene } = this;
    const view = matrix(camera);
    const cut = look.plane ? [...look.plane.normal, look.plane.offset] : [0, 0, 0, 1];
    const use = ({ made, places }) => {
      gl.useProgram(made);
      gl.uniformMatrix4fv(places.view, false, view);
      if (places.cut) gl.uniform4fv(places.cut, cut);
      return places;
    };
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0xf1 / 255, 0xf3 / 255, 0xf5 / 255, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);

    let places = use(this.surface);
    const [, up, back] = axes(camera);
    gl.uniform3fv(places.towards, back);
    gl.uniform3fv(places.above, up);
    gl.uniform1i(places.numbers, look.range ? 1 : 0);
    gl.uniform2fv(places.range, look.range || [0, 1]);
    gl.uniform3fv(places.map, scene.map.flatMap((c) => rgb(c).map((x) => x / 255)));
    gl.bindVertexArray(this.faces);
    const corners = this.arrays.triangles.length;
    if (look.plane && scene.closed) {
      this.countLayers(corners);
      use(this.cap);
      this.drawCap(camera, look.plane);
      use(this.surface);
      gl.bindVertexArray(this.faces);
    }
    // Edges lie on faces: these step back a little.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.drawArrays(gl.TRIANGLES, 0, corners);
    gl.disable(gl.POLYGON_OFFSET_FILL);

    if (look.edges) {
      use(this.edge);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.bindVertexArray(this.rims);
      gl.drawArrays(gl.LINES, 0, this.arrays.edges.length);
      gl.disable(gl.BLEND);
    }
    const point = (n) => Array.from(this.positions.subarray(3 * n, 3 * n + 3));
    const cables = this.cableColours.map((colour, k) => {
      const [a, b] = this.arrays.cables.subarray(2 * k, 2 * k + 2);
      return { from: point(a), to: point(b), colour };
    });
    if (cables.length) this.drawLines(cables, use(this.line), 3);
    if (look.pulls.length) {
      // Hands are seen through the body.
      gl.disable(gl.DEPTH_TEST);
      this.drawLines(look.pulls.map((p) => ({ from: p.point, to: p.target, colour: HAND })), use(this.line), 2.5);
    }
    gl.bindVertexArray(null);
  }

  /** Leaves a number in the stencil where a line of sight enters a closed surface through the cut. */
  countLayers(corners) {
    const { gl } = this;
    gl.colorMask(false, false, false, false);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.ALWAYS, 0, 0xff);
    gl.stencilOpSeparate(gl.BACK, gl.KEEP, gl.KEEP, gl.INCR_WRAP);
    gl.stencilOpSeparate(gl.FRONT, gl.KEEP, gl.KEEP, gl.DECR_WRAP);
    gl.drawArrays(gl.TRIANGLES, 0, corners);
    gl.colorMask(true, true, true, true);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.STENCIL_TEST);
  }

  /** The plane of the cut, where the body is. */
  drawCap(camera, plane) {
    const { gl } = this;
    const axis = plane.normal.findIndex((x) => x !== 0);
    const reach = 4 * camera.radius;
    const corner = (a, b) => {
      const at = add(camera.target, [0, 0, 0]);
      at[axis] = plane.offset / plane.normal[axis];
      at[(axis + 1) % 3] += a * reach;
      at[(axis + 2) % 3] += b * reach;
      return at;
    };
    const strip = [corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1)].flat();
    gl.bindVertexArray(this.capArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.capBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(strip), gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.NOTEQUAL, 0, 0xff);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.disable(gl.STENCIL_TEST);
  }

  drawLines(lines, places, width) {
    const { gl } = this;
    const values = lines.flatMap(({ from, to, colour }) => CORNERS.flatMap((corner) => [...from, ...to, ...corner, ...colour]));
    gl.bindVertexArray(this.lines);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lineBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.DYNAMIC_DRAW);
    let at = 0;
    for (const [place, size] of [[0, 3], [1, 3], [2, 2], [3, 3]]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 44, 4 * at);
      at += size;
    }
    gl.uniform2f(places.size, this.canvas.width, this.canvas.height);
    gl.uniform1f(places.width, width * Math.min(window.devicePixelRatio || 1, 2));
    gl.drawArrays(gl.TRIANGLES, 0, 6 * lines.length);
  }
}
