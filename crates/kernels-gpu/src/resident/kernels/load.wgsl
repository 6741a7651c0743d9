// r += factor · load, on the unknowns that the load acts on, each named once.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(num_workgroups) workgroups: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let k = (workgroup.y * workgroups.x + workgroup.x) * WORKGROUP + invocation;
    if (k < arrayLength(&loaded)) {
        r[loaded[k]] += load_factor[0] * load_values[k];
    }
}
