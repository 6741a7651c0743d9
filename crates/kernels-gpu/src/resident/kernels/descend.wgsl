// a += α p, r −= α q with α = r·z / p·q, and the parts of r · r and r · M⁻¹ r.
// Entries of r that a block of the preconditioner needs belong to one row: a row is the work of one invocation.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let curvature = collect(CURVATURE, invocation);
    // Written by the end of the last iteration only, so that all workgroups read the same.
    let running = control.done == 0u;
    let sound = curvature > 0.0f && is_finite(curvature);
    let live = running && sound;
    let alpha = select(0.0f, control.product / curvature, live);
    let d = parameters.axes;
    let rows = parameters.unknowns / d;
    let stride = parameters.groups * WORKGROUP;
    var rr = vec2<f32>(0.0f, 0.0f);
    var rz = vec2<f32>(0.0f, 0.0f);
    if (live) {
        for (var row = workgroup.x * WORKGROUP + invocation; row < rows; row += stride) {
            for (var i = row * d; i < row * d + d; i++) {
                a[i] += alpha * p[i];
                r[i] -= alpha * q[i];
            }
            for (var i = row * d; i < row * d + d; i++) {
                let z = preconditioned(i, d);
                rr = add(rr, vec2<f32>(r[i] * r[i], 0.0f));
                rz = add(rz, vec2<f32>(r[i] * z, 0.0f));
            }
        }
    }
    leave(RESIDUAL, rr, invocation, workgroup.x);
    leave(PRODUCT, rz, invocation, workgroup.x);
    if (workgroup.x == 0u && invocation == 0u) {
        control.live = select(0u, 1u, live);
        control.product_before = control.product;
        if (running && !sound) {
            control.curvature = curvature;
            control.status = select(NOT_FINITE, INDEFINITE, is_finite(curvature));
        }
    }
}
