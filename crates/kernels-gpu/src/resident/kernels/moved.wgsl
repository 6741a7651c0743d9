// The same for moved unknowns, whose values at the stage and at the end are given: w = U* − u + β V*.
// Their inertia acts on themselves alone, masses being diagonal, and their part of the right-hand side is not solved for.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let k = workgroup.x * WORKGROUP + invocation;
    if (k < arrayLength(&moved)) {
        let i = moved[k];
        let stage_u = targets[6u * k];
        let stage_u_low = targets[6u * k + 1u];
        let stage_v = targets[6u * k + 2u];
        p[i] = ((stage_u - u[i]) + (stage_u_low - u_low[i])) + parameters.rate * stage_v;
        s[i] = 0.0f;
    }
}
