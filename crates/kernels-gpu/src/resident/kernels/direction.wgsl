// p = M⁻¹ r, and the parts of r · r and r · p: the first direction.
@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let stride = parameters.groups * WORKGROUP;
    var rr = vec2<f32>(0.0f, 0.0f);
    var rz = vec2<f32>(0.0f, 0.0f);
    for (var i = workgroup.x * WORKGROUP + invocation; i < parameters.unknowns; i += stride) {
        let z = preconditioned(i, parameters.axes);
        p[i] = z;
        rr = add(rr, vec2<f32>(r[i] * r[i], 0.0f));
        rz = add(rz, vec2<f32>(r[i] * z, 0.0f));
    }
    leave(RESIDUAL, rr, invocation, workgroup.x);
    leave(PRODUCT, rz, invocation, workgroup.x);
}
