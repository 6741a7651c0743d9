// r = r − A a, in r; q is A a.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        r[i] = r[i] - q[i];
    }
}
