// p = M⁻¹ r + β p with β the ratio of the last two r · z; the first workgroup keeps the record.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let rr = collect(RESIDUAL, invocation);
    let rz = collect(PRODUCT, invocation);
    // Written by `descend` only, so that all workgroups read the same.
    let live = control.live != 0u;
    let beta = select(0.0f, rz / control.product_before, live);
    let stride = parameters.groups * WORKGROUP;
    if (live) {
        for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
            p[i] = preconditioned(i, parameters.axes) + beta * p[i];
        }
    }
    if (workgroup.x == 0u && invocation == 0u) {
        if (live) {
            control.iterations = control.iterations + 1u;
            control.residual_squared = rr;
            control.product = rz;
            if (!is_finite(rr)) {
                control.status = NOT_FINITE;
                control.done = 1u;
            } else if (rr <= control.tolerance_squared) {
                control.status = CONVERGED;
                control.done = 1u;
            } else if (control.iterations >= parameters.most_iterations) {
                control.status = EXHAUSTED;
                control.done = 1u;
            }
        } else {
            // A solve that met a direction without curvature ends here.
            control.done = 1u;
        }
    }
}
