// q = P (m M p + k K p), with K p as minus the sum of contributions, and the parts of p · q: the last segment of a product.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let width = segment[0];
    let stride = parameters.groups * WORKGROUP;
    var own = vec2<f32>(0.0f, 0.0f);
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        let row = i / width;
        let shift = (i % width) * LANES;
        var sum = 0.0f;
        if (segment[2] != 0u) {
            sum = q[i];
        }
        for (var k = starts[row]; k < starts[row + 1u]; k++) {
            sum += contributions[places[k] + shift];
        }
        let m = mass[i];
        let x = p[i];
        // Held unknowns have their masses with the sign changed: they take no part.
        let y = select(0.0f, parameters.mass * m * x - parameters.second * sum, m >= 0.0f);
        q[i] = y;
        own = add(own, vec2<f32>(x * y, 0.0f));
    }
    leave(CURVATURE, own, invocation, workgroup.x);
}
