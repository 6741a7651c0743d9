// The parts of Σ m v² and of the number of unknowns that are out of reach or no numbers.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    var energy = vec2<f32>(0.0f, 0.0f);
    var bad = vec2<f32>(0.0f, 0.0f);
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        energy = add(energy, vec2<f32>(abs(mass[i]) * v[i] * v[i], 0.0f));
        let fine = is_finite(u[i]) && is_finite(v[i]) && abs(u[i]) <= parameters.reach;
        bad.x += select(1.0f, 0.0f, fine);
    }
    leave(ENERGY, energy, invocation, workgroup.x);
    leave(BAD, bad, invocation, workgroup.x);
}
