// A sum whose parts an earlier kernel left.
fn collect(slot: u32, invocation: u32) -> f32 {
    var own = vec2<f32>(0.0f, 0.0f);
    for (var k = invocation; k < parameters.groups; k += WORKGROUP) {
        own = add(own, sums[slot * MOST_GROUPS + k]);
    }
    return workgroup_sum(own, invocation);
}

