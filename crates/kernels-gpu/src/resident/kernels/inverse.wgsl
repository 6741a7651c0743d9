// inverse(row) = (m M + k K(row, row))⁻¹ with the axes of held unknowns apart, so that it acts on the free ones as the
// inverse of the free part; K(row, row) is in `blocks`. What it is depends on segment[0]: 0 the identity, 1 the diagonal
// alone, 2 the block. A block that is not positive definite is replaced by its diagonal, made positive.
fn positive_reciprocal(x: f32) -> f32 {
    return select(1.0f / abs(x), 1.0f, x == 0.0f);
}

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) workgroup: vec3<u32>, @builtin(local_invocation_index) invocation: u32) {
    let d = parameters.axes;
    let rows = parameters.unknowns / d;
    let stride = parameters.groups * WORKGROUP;
    for (var row = workgroup.x * WORKGROUP + invocation; row < rows; row += stride) {
        var a = array<f32, 9>(1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f);
        if (segment[0] != 0u) {
            for (var i = 0u; i < d; i++) {
                let free_i = mass[row * d + i] >= 0.0f;
                for (var j = 0u; j < d; j++) {
                    let free = free_i && mass[row * d + j] >= 0.0f && (i == j || segment[0] == 2u);
                    var entry = select(0.0f, parameters.second * blocks[(row * d + i) * d + j], free);
                    if (i == j) {
                        entry = select(1.0f, entry + parameters.mass * mass[row * d + i], free_i);
                    }
                    a[3u * i + j] = entry;
                }
            }
        }
        // By cofactors: a block has at most three rows, and those that are missing are those of the identity.
        let c0 = a[4] * a[8] - a[5] * a[7];
        let c1 = a[5] * a[6] - a[3] * a[8];
        let c2 = a[3] * a[7] - a[4] * a[6];
        let minor = a[0] * a[4] - a[1] * a[3];
        // Scaled, so that nothing overflows: entries of stiff blocks are large.
        let determinant = a[0] * c0 + a[1] * c1 + a[2] * c2;
        let positive = a[0] > 0.0f && minor > 0.0f && determinant > 0.0f && is_finite(determinant);
        var b = array<f32, 9>(
            positive_reciprocal(a[0]), 0.0f, 0.0f,
            0.0f, positive_reciprocal(a[4]), 0.0f,
            0.0f, 0.0f, positive_reciprocal(a[8]),
        );
        if (positive) {
            let f = 1.0f / determinant;
            let off01 = f * (a[2] * a[7] - a[1] * a[8]);
            let off02 = f * (a[1] * a[5] - a[2] * a[4]);
            let off12 = f * (a[2] * a[3] - a[0] * a[5]);
            b = array<f32, 9>(
                f * c0, off01, off02,
                off01, f * (a[0] * a[8] - a[2] * a[6]), off12,
                off02, off12, f * minor,
            );
        }
        for (var i = 0u; i < d; i++) {
            for (var j = 0u; j < d; j++) {
                inverse[(row * d + i) * d + j] = b[3u * i + j];
            }
        }
    }
}
