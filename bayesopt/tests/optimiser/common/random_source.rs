//! The random source of `docs/optimiser_problems.md`.

/// `s ← a·s + c (mod 2^64)`, output mixed by xor-shift-multiply.
pub struct RandomSource {
    state: u64,
}

impl RandomSource {
    pub fn seed(k: u64) -> Self {
        Self { state: k.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0xD1B5_4A32_D192_ED03) }
    }

    pub fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let z = self.state;
        let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn u(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    pub fn range(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.u()
    }

    /// Irwin–Hall: the sum of twelve uniforms minus six.
    pub fn normal(&mut self) -> f64 {
        let mut sum = 0.0;
        for _ in 0..12 {
            sum += self.u();
        }
        sum - 6.0
    }

    #[allow(dead_code)] // not every test draws points
    pub fn point(&mut self, dimension: usize) -> Vec<f64> {
        (0..dimension).map(|_| self.u()).collect()
    }
}
