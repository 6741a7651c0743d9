// The numbers of some rows side by side: [row, axis]. What is written depends on segment[1]: 0 the sum of the two parts in
// one number, 1 all first parts and then all second ones, 2 the first parts alone. One invocation per entry.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(num_workgroups) workgroups: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let axes = segment[0];
    let count = arrayLength(&places) * axes;
    let i = (workgroup.y * workgroups.x + workgroup.x) * WORKGROUP + invocation;
    if (i < count) {
        let taken = places[i / axes] * axes + i % axes;
        if (segment[1] == 0u) {
            result[i] = u[taken] + u_low[taken];
        } else {
            result[i] = u[taken];
            if (segment[1] == 1u) {
                result[count + i] = u_low[taken];
            }
        }
    }
}
