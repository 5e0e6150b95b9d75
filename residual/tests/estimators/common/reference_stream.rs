//! The random stream of the benchmark inputs: a 64-bit congruential generator with a mixed output.

/// State of the stream.
#[derive(Clone, Debug)]
pub struct ReferenceStream(u64);

impl ReferenceStream {
    /// The stream of seed k.
    pub fn new(k: u64) -> Self {
        Self(k.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0xD1B5_4A32_D192_ED03))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in 0..1.
    pub fn u(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in a..b.
    pub fn range(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.u()
    }

    /// Nearly normal: twelve uniforms less six.
    pub fn normal(&mut self) -> f64 {
        (0..12).fold(0.0, |sum, _| sum + self.u()) - 6.0
    }
}

#[test]
fn the_stream_is_the_published_one() {
    let mut stream = ReferenceStream::new(1);
    assert_eq!(stream.next(), 0xf7ba_a88f_167e_de71);
    assert_eq!(ReferenceStream::new(1).normal(), 1.202_108_723_500_380_4);
}
