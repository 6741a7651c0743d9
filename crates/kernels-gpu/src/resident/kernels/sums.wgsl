// Leaves the workgroup's part of a sum.
fn leave(slot: u32, own: vec2<f32>, invocation: u32, workgroup: u32) {
    let total = workgroup_sum(own, invocation);
    if (invocation == 0u) {
        sums[slot * MOST_GROUPS + workgroup] = tree[0];
    }
}

// A sum whose parts an earlier kernel left.
fn collect(slot: u32, invocation: u32) -> f32 {
    var own = vec2<f32>(0.0f, 0.0f);
    if (invocation < parameters.groups) {
        own = sums[slot * MOST_GROUPS + invocation];
    }
    return workgroup_sum(own, invocation);
}
