// Leaves the workgroup's part of a sum.
fn leave(slot: u32, own: vec2<f32>, invocation: u32, workgroup: u32) {
    let total = workgroup_parts(own, invocation);
    if (invocation == 0u) {
        sums[slot * MOST_GROUPS + workgroup] = total;
    }
}

