//! The mean ratio of an element's corner: how far it is from the ideal one, whatever its size and direction.

use crate::geometry::{cross, dot, triple};

/// q = d (det T)^(2/d) / ‖T‖², T = A W⁻¹, with the edge vectors at a corner as columns of A and the ideal ones as
/// columns of W. For surfaces `up` orients the determinant; 0 when it is not positive.
pub(super) fn mean_ratio(vectors: &[[f64; 3]], ideal: &[[f64; 3]], up: [f64; 3]) -> f64 {
    let dimension = vectors.len();
    let (determinant, ideal_determinant) = match dimension {
        1 => return 1.0,
        2 => (dot(cross(vectors[0], vectors[1]), up), cross(ideal[0], ideal[1])[2]),
        _ => (triple(vectors[0], vectors[1], vectors[2]), triple(ideal[0], ideal[1], ideal[2])),
    };
    if determinant <= 0.0 {
        return 0.0;
    }
    // ‖T‖² = tr(AᵀA (WᵀW)⁻¹): needs the two Gram matrices only, which also covers surfaces in space.
    let gram = |v: &[[f64; 3]], i: usize, j: usize| dot(v[i], v[j]);
    let inverse = inverse_gram(ideal);
    let mut square = 0.0;
    for i in 0..dimension {
        for j in 0..dimension {
            square += gram(vectors, i, j) * inverse[j][i];
        }
    }
    let d = dimension as f64;
    d * (determinant / ideal_determinant).powf(2.0 / d) / square
}

/// Inverse of the Gram matrix of two or three independent vectors; unused entries are 0.
fn inverse_gram(v: &[[f64; 3]]) -> [[f64; 3]; 3] {
    // Rows of the dual basis: dᵢ · vⱼ = δᵢⱼ; the inverse Gram matrix holds their products.
    let dual: Vec<[f64; 3]> = match v {
        [a, b] => {
            let n = cross(*a, *b);
            let s = 1.0 / dot(n, n);
            [cross(*b, n), cross(n, *a)].map(|c| c.map(|x| x * s)).to_vec()
        }
        [a, b, c] => {
            let s = 1.0 / triple(*a, *b, *c);
            [cross(*b, *c), cross(*c, *a), cross(*a, *b)].map(|c| c.map(|x| x * s)).to_vec()
        }
        _ => Vec::new(),
    };
    let mut inverse = [[0.0; 3]; 3];
    for (i, p) in dual.iter().enumerate() {
        for (j, q) in dual.iter().enumerate() {
            inverse[i][j] = dot(*p, *q);
        }
    }
    inverse
}
