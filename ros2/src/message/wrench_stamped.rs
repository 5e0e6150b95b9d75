//! `geometry_msgs/msg/WrenchStamped`.

use tribo_files::CdrWriter;
use tribo_robot::Wrench;

/// Its name in DDS.
pub const WRENCH_TYPE: &str = "geometry_msgs::msg::dds_::WrenchStamped_";

/// Header, then force x y z (N) and torque x y z (Nm).
pub fn wrench_stamped(stamp_ns: u64, frame_id: &str, wrench: &Wrench) -> Vec<u8> {
    let mut cdr = CdrWriter::default();
    cdr.header(stamp_ns, frame_id);
    for value in wrench.to_force_moment() {
        cdr.f64(value);
    }
    cdr.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 4 + 8 stamp, 4 + 2 frame, 2 to the next multiple of 8, six numbers.
    #[test]
    fn numbers_stand_at_multiples_of_eight() {
        let bytes = wrench_stamped(3_000_000_004, "b", &Wrench::from_force_moment(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        assert_eq!(&bytes[..20], b"\0\x01\0\0\x03\0\0\0\x04\0\0\0\x02\0\0\0b\0\0\0");
        let numbers: Vec<f64> =
            bytes[20..].chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect();
        assert_eq!(numbers, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }
}
