// From where the body is seen: a point that is looked at, a distance, and two angles about the upward axis.
//
// Vectors are arrays of three numbers; matrices have 16, column by column, as WebGL wants them.

export const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => a.map((x) => x / (length(a) || 1));

/** Half of the vertical angle of view. */
const HALF = Math.tan((35 / 2) * (Math.PI / 180));

/** A camera around a box; the upward axis is the coordinate axis nearest to `up`, or z without. */
export function makeCamera(low, high, up) {
  const axis = up.some((x) => x !== 0) ? up.map(Math.abs).indexOf(Math.max(...up.map(Math.abs))) : 2;
  const vertical = [0, 0, 0];
  vertical[axis] = up[axis] < 0 ? -1 : 1;
  const camera = { up: vertical, azimuth: 0, elevation: 0, target: [0, 0, 0], distance: 1, radius: 1, aspect: 1 };
  // Bodies are longest sideways in the first picture.
  const flat = [0, 1, 2].filter((k) => k !== axis);
  const sides = flat.map((k) => high[k] - low[k]);
  const along = sides[0] >= sides[1] ? flat[0] : flat[1];
  const e = [0, 0, 0];
  e[along] = 1;
  camera.side = e;
  fit(camera, low, high);
  return camera;
}

/** Shows all of a box from the usual side. */
export function fit(camera, low, high) {
  camera.target = low.map((l, k) => 0.5 * (l + high[k]));
  camera.radius = Math.max(0.5 * length(add(high, low, -1)), 1e-9);
  camera.azimuth = 0.45;
  camera.elevation = 0.3;
  camera.distance = (1.02 * camera.radius) / (HALF * Math.min(1, camera.aspect)) + 0.3 * camera.radius;
}

/** Unit vectors to the right, up and backwards in the picture. */
export function axes(camera) {
  const { up, side } = camera;
  const front = cross(side, up);
  const [c, s] = [Math.cos(camera.azimuth), Math.sin(camera.azimuth)];
  const flat = add(front.map((x) => x * c), side, s);
  const back = add(flat.map((x) => x * Math.cos(camera.elevation)), up, Math.sin(camera.elevation));
  const right = unit(cross(up, back));
  return [right, cross(back, right), back];
}

export const eye = (camera) => add(camera.target, axes(camera)[2], camera.distance);

export function turn(camera, across, upwards) {
  camera.azimuth += across;
  camera.elevation = Math.max(-1.55, Math.min(1.55, camera.elevation + upwards));
}

export function zoom(camera, factor) {
  camera.distance = Math.max(0.05 * camera.radius, Math.min(50 * camera.radius, camera.distance * factor));
}

/** Moves the view by a share of the picture's height. */
export function pan(camera, across, upwards) {
  const [right, up] = axes(camera);
  const height = 2 * HALF * camera.distance;
  camera.target = add(add(camera.target, right, -across * height), up, upwards * height);
}

/** Projection times view. */
export function matrix(camera) {
  const [r, u, b] = axes(camera);
  const e = eye(camera);
  const near = Math.max(camera.distance - 4 * camera.radius, 0.01 * camera.distance);
  const far = camera.distance + 6 * camera.radius;
  const [sx, sy] = [1 / (HALF * camera.aspect), 1 / HALF];
  const [p, q] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
  const m = new Float32Array(16);
  for (let k = 0; k < 3; k++) {
    m[4 * k] = sx * r[k];
    m[4 * k + 1] = sy * u[k];
    m[4 * k + 2] = p * b[k];
    m[4 * k + 3] = -b[k];
  }
  m[12] = -sx * dot(r, e);
  m[13] = -sy * dot(u, e);
  m[14] = -p * dot(b, e) + q;
  m[15] = dot(b, e);
  return m;
}

/** The line of sight through a place of the picture, each coordinate from −1 to 1, upwards positive. */
export function sight(camera, x, y) {
  const [r, u, b] = axes(camera);
  const direction = add(add(b.map((v) => -v), r, x * HALF * camera.aspect), u, y * HALF);
  return { origin: eye(camera), direction: unit(direction) };
}

/** Place of a point in the picture, each coordinate from −1 to 1. */
export function place(camera, point) {
  const m = matrix(camera);
  const at = (row) => m[row] * point[0] + m[4 + row] * point[1] + m[8 + row] * point[2] + m[12 + row];
  return [at(0) / at(3), at(1) / at(3)];
}
