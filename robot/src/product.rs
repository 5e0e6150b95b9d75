//! Products of small matrices of fixed size.

use nalgebra::{SMatrix, Vector3};

/// `a b + c`, rounded once where the processor that the program is compiled for has an instruction for it (AVX2's time, every ARM64).
///
/// Without one, [`f64::mul_add`] would be a call of the C library that costs more than fifty of the two operations.
#[inline]
pub fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) { a.mul_add(b, c) } else { a * b + c }
}

/// `a × b`: nalgebra's with the products fused, which every tick needs a hundred of.
#[inline]
pub(crate) fn cross(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        multiply_add(a.y, b.z, -(a.z * b.y)),
        multiply_add(a.z, b.x, -(a.x * b.z)),
        multiply_add(a.x, b.y, -(a.y * b.x)),
    )
}

/// `A B`.
///
/// Column by column, `(A B)_c = Σ_k A_k B_kc`, in loops whose lengths the compiler knows. nalgebra's operator is as fast where
/// everything is optimised as one unit; otherwise it calls a routine for any size once per column, which made a whole trial
/// more than twice as slow.
#[inline]
pub fn product<const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<f64, R, K>,
    b: &SMatrix<f64, K, C>,
) -> SMatrix<f64, R, C> {
    let mut product = SMatrix::zeros();
    for c in 0..C {
        let mut column = [0.0; R];
        for k in 0..K {
            let factor = b.data.0[c][k];
            for r in 0..R {
                column[r] = multiply_add(a.data.0[k][r], factor, column[r]);
            }
        }
        product.data.0[c] = column;
    }
    product
}

/// `A Bᵀ`; see [`product`].
#[inline]
pub fn product_transposed<const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<f64, R, K>,
    b: &SMatrix<f64, C, K>,
) -> SMatrix<f64, R, C> {
    let mut product = SMatrix::zeros();
    for c in 0..C {
        let mut column = [0.0; R];
        for k in 0..K {
            let factor = b.data.0[k][c];
            for r in 0..R {
                column[r] = multiply_add(a.data.0[k][r], factor, column[r]);
            }
        }
        product.data.0[c] = column;
    }
    product
}

/// `to ← C − A Bᵀ`; see [`product`].
#[inline]
pub fn minus_product_transposed<const R: usize, const K: usize, const C: usize>(
    to: &mut SMatrix<f64, R, C>,
    from: &SMatrix<f64, R, C>,
    a: &SMatrix<f64, R, K>,
    b: &SMatrix<f64, C, K>,
) {
    for c in 0..C {
        let mut column = from.data.0[c];
        for k in 0..K {
            let factor = b.data.0[k][c];
            for r in 0..R {
                column[r] = multiply_add(-a.data.0[k][r], factor, column[r]);
            }
        }
        to.data.0[c] = column;
    }
}

/// `Aᵀ B`; see [`product`].
#[inline]
pub fn transposed_product<const R: usize, const K: usize, const C: usize>(
    a: &SMatrix<f64, K, R>,
    b: &SMatrix<f64, K, C>,
) -> SMatrix<f64, R, C> {
    SMatrix::from_fn(|r, c| {
        let mut sum = 0.0;
        for k in 0..K {
            sum = multiply_add(a.data.0[r][k], b.data.0[c][k], sum);
        }
        sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second algorithm: nalgebra's.
    #[test]
    fn products_are_nalgebras() {
        let a = SMatrix::<f64, 6, 7>::from_fn(|r, c| ((r * 7 + c) as f64 * 0.7).sin());
        let b = SMatrix::<f64, 7, 3>::from_fn(|r, c| ((r * 3 + c) as f64 * 1.3).cos());
        let c = SMatrix::<f64, 6, 3>::from_fn(|r, c| ((r + 5 * c) as f64).sin());
        assert!((product(&a, &b) - a * b).amax() < 1e-15);
        assert!((product_transposed(&a, &b.transpose()) - a * b).amax() < 1e-15);
        assert!((transposed_product(&a, &c) - a.transpose() * c).amax() < 1e-15);
        let mut less = c;
        minus_product_transposed(&mut less, &c, &a, &b.transpose());
        assert!((less - (c - a * b)).amax() < 1e-15);
    }
}
