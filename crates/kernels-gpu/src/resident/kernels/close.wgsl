// Sums up what the host reads. One workgroup.
@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) invocation: u32) {
    let energy = collect(ENERGY, invocation);
    let bad = collect(BAD, invocation);
    var own = vec2<f32>(0.0f, 0.0f);
    if (invocation < arrayLength(&judged)) {
        own = vec2<f32>(judged[invocation], 0.0f);
        judged[invocation] = 0.0f;
    }
    let inverted = workgroup_sum(own, invocation);
    if (invocation == 0u) {
        control.energy = 0.5f * energy;
        control.bad = bad;
        control.judged = inverted;
    }
}
