// What is under the pointer: the nearest triangle of the surface that a line of sight meets.

/**
 * The nearest hit, with its surface nodes, their weights, its point and distance; `null` beside the body. `visible(point)`
 * tells which side of a cut is shown.
 */
export function pick(positions, triangles, { origin, direction }, visible) {
  let best = null;
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ax, ay, az] = [positions[a], positions[a + 1], positions[a + 2]];
    const [ux, uy, uz] = [positions[b] - ax, positions[b + 1] - ay, positions[b + 2] - az];
    const [vx, vy, vz] = [positions[c] - ax, positions[c + 1] - ay, positions[c + 2] - az];
    // Möller and Trumbore, J. Graphics Tools 2 (1997).
    const [px, py, pz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
    const determinant = ux * px + uy * py + uz * pz;
    if (determinant === 0) continue;
    const [sx, sy, sz] = [ox - ax, oy - ay, oz - az];
    const v = (sx * px + sy * py + sz * pz) / determinant;
    if (v < 0 || v > 1) continue;
    const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const w = (dx * qx + dy * qy + dz * qz) / determinant;
    if (w < 0 || v + w > 1) continue;
    const distance = (vx * qx + vy * qy + vz * qz) / determinant;
    if (distance <= 0 || (best && distance >= best.distance)) continue;
    const point = [ox + distance * dx, oy + distance * dy, oz + distance * dz];
    if (!visible(point)) continue;
    best = { nodes: [a / 3, b / 3, c / 3], weights: [1 - v - w, v, w], point, distance };
  }
  return best;
}
