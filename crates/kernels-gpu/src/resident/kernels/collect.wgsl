// A sum whose parts an earlier kernel left.
fn collect(slot: u32, invocation: u32) -> f32 {
    var own = vec2<f32>(0.0f, 0.0f);
    if (invocation < parameters.groups) {
        own = sums[slot * MOST_GROUPS + invocation];
    }
    return workgroup_sum(own, invocation);
}

