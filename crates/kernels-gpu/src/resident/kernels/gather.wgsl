// out(row) = Σ contributions of its items, in their order; added to what is there when the segment is not the first.
// One invocation per entry of a row: neighbours write neighbours.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(num_workgroups) workgroups: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let width = segment[0];
    let count = segment[1] * width;
    let stride = workgroups.x * workgroups.y * WORKGROUP;
    for (var i = (workgroup.y * workgroups.x + workgroup.x) * WORKGROUP + invocation; i < count; i += stride) {
        let row = i / width;
        let shift = (i % width) * LANES;
        var sum = 0.0f;
        if (segment[2] != 0u) {
            sum = result[i];
        }
        for (var k = starts[row]; k < starts[row + 1u]; k++) {
            sum += contributions[places[k] + shift];
        }
        result[i] = sum;
    }
}
