// q = P (m M p + k K p), with K p as minus the sum of contributions, and the parts of p · q: the last segment of a product.
// One invocation per row: what its places are is read once for all axes.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let d = parameters.axes;
    let rows = segment[1];
    let stride = parameters.groups * WORKGROUP;
    var own = vec2<f32>(0.0f, 0.0f);
    for (var row = workgroup.x * WORKGROUP + invocation; row < rows; row += stride) {
        let i = row * d;
        var sum = vec3<f32>(0.0f, 0.0f, 0.0f);
        if (segment[2] != 0u) {
            // What earlier segments gave comes first, so that the order of a sum does not depend on where it was cut.
            for (var axis = 0u; axis < d; axis++) {
                sum[axis] = q[i + axis];
            }
        }
        let end = starts[row + 1u];
        for (var k = starts[row]; k < end; k++) {
            let place = places[k];
            sum.x += contributions[place];
            if (d > 1u) {
                sum.y += contributions[place + LANES];
            }
            if (d > 2u) {
                sum.z += contributions[place + 2u * LANES];
            }
        }
        for (var axis = 0u; axis < d; axis++) {
            let total = sum[axis];
            let m = mass[i + axis];
            let x = p[i + axis];
            // Held unknowns have their masses with the sign changed: they take no part.
            let y = select(0.0f, parameters.mass * m * x - parameters.second * total, m >= 0.0f);
            q[i + axis] = y;
            own = add(own, vec2<f32>(x * y, 0.0f));
        }
    }
    leave(CURVATURE, own, invocation, workgroup.x);
}
