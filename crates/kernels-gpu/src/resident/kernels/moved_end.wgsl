// Moved unknowns at the end of the step.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let k = workgroup.x * WORKGROUP + invocation;
    if (k < arrayLength(&moved) && control.done != 0u) {
        let i = moved[k];
        u[i] = targets[6u * k + 3u];
        u_low[i] = targets[6u * k + 4u];
        v[i] = targets[6u * k + 5u];
    }
}
