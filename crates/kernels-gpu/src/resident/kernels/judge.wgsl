// Counts numbers that are not positive; `result` holds one number per workgroup.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(num_workgroups) workgroups: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let count = arrayLength(&values);
    let stride = workgroups.x * WORKGROUP;
    var bad = vec2<f32>(0.0f, 0.0f);
    for (var i = workgroup.x * WORKGROUP + invocation; i < count; i += stride) {
        bad.x += select(1.0f, 0.0f, values[i] > 0.0f);
    }
    let total = workgroup_sum(bad, invocation);
    if (invocation == 0u && total > 0.0f) {
        result[workgroup.x] += total;
    }
}
