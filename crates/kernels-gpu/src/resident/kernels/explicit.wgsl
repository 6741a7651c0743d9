// a = P M⁻¹ r: the acceleration where nothing is solved for.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        let m = mass[i];
        a[i] = select(0.0f, r[i] / m, m > 0.0f);
    }
    if (workgroup.x == 0u && invocation == 0u) {
        control.done = 1u;
        control.status = CONVERGED;
        control.iterations = 0u;
    }
}
