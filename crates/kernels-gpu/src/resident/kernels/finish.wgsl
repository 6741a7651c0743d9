// The end of the step for unknowns that nobody moves: u += end_v v + end_a a in two parts, v = keep (v + h a).
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    if (control.done != 0u) {
        for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
            if (mass[i] >= 0.0f) {
                let moved_by = parameters.end_v * v[i] + parameters.end_a * a[i];
                let now = add(vec2<f32>(u[i], u_low[i]), vec2<f32>(moved_by, 0.0f));
                u[i] = now.x;
                u_low[i] = now.y;
                v[i] = parameters.keep * (v[i] + parameters.step * a[i]);
            }
        }
    }
}
