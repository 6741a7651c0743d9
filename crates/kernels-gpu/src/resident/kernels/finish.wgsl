// The end of the step for unknowns that nobody moves: u += end_v v + end_a a in two parts, v = keep (v + h a).
//
// A solve whose first direction has no positive curvature has found nothing: the acceleration is then the preconditioned
// right-hand side, a = M⁻¹ b with b in s, which is a direction of descent of ½ aᵀAa − bᵀa; where the solve started from is
// none.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    let d = parameters.axes;
    let nothing_found = control.status == INDEFINITE && control.iterations == 0u;
    if (control.done != 0u) {
        for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
            if (mass[i] >= 0.0f) {
                if (nothing_found) {
                    let first = i - i % d;
                    var z = 0.0f;
                    for (var j = 0u; j < d; j++) {
                        z += inverse[i * d + j] * s[first + j];
                    }
                    a[i] = z;
                }
                let moved_by = parameters.end_v * v[i] + parameters.end_a * a[i];
                let now = add(vec2<f32>(u[i], u_low[i]), vec2<f32>(moved_by, 0.0f));
                u[i] = now.x;
                u_low[i] = now.y;
                v[i] = parameters.keep * (v[i] + parameters.step * a[i]);
            }
        }
    }
}
