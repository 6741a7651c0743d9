// Sets the tolerance and says whether anything is left to solve. One workgroup.
@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) invocation: u32) {
    let right = collect(RIGHT, invocation);
    let rr = collect(RESIDUAL, invocation);
    let rz = collect(PRODUCT, invocation);
    if (invocation == 0u) {
        // Without a right-hand side the first residual sets the scale.
        let reference = select(right, rr, right == 0.0f);
        let relative = parameters.relative * parameters.relative * reference;
        let tolerance = max(parameters.absolute * parameters.absolute, relative);
        control.right_squared = right;
        control.initial_squared = rr;
        control.residual_squared = rr;
        control.tolerance_squared = tolerance;
        control.product = rz;
        control.product_before = rz;
        control.iterations = 0u;
        control.live = 0u;
        control.curvature = 0.0f;
        control.status = RUNNING;
        control.done = 0u;
        if (!is_finite(rr) || !is_finite(rz)) {
            control.status = NOT_FINITE;
            control.done = 1u;
        } else if (rr <= tolerance) {
            control.status = CONVERGED;
            control.done = 1u;
        }
    }
}
