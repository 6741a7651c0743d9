// r = P (f + constant forces − K w − M s): f is in r, −K w in q. And the parts of r · r; s keeps the result, because r goes
// on to be a residual.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    var own = vec2<f32>(0.0f, 0.0f);
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        let m = mass[i];
        let x = select(0.0f, ((r[i] + constant_force[i]) + q[i]) - m * s[i], m >= 0.0f);
        r[i] = x;
        s[i] = x;
        own = add(own, vec2<f32>(x * x, 0.0f));
    }
    leave(RIGHT, own, invocation, workgroup.x);
}
