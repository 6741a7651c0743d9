// The direction of the stage, w = û − u + β v̂, into p, and what drags on the masses into s; nothing for held unknowns.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        let held = mass[i] < 0.0f;
        p[i] = select(parameters.ahead * v[i], 0.0f, held);
        s[i] = select(parameters.drag * v[i], 0.0f, held);
    }
}
