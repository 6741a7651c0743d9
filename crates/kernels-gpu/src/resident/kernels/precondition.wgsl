// z = M⁻¹ r of one unknown: the row of its block times the residuals of its row.
fn preconditioned(i: u32, d: u32) -> f32 {
    let row = i / d;
    var z = 0.0f;
    for (var j = 0u; j < d; j++) {
        z += inverse[i * d + j] * r[row * d + j];
    }
    return z;
}
