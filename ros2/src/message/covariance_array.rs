//! The covariance of a wrench as `std_msgs/msg/Float64MultiArray`, since no message of ROS 2 has a wrench with its covariance.

use nalgebra::Matrix6;
use tribo_files::CdrWriter;

/// Its name in DDS.
pub const COVARIANCE_TYPE: &str = "std_msgs::msg::dds_::Float64MultiArray_";

/// The covariance with rows and columns in the order of the wrench message, row by row.
///
/// ```text
/// dim[0] = (label "fx fy fz tx ty tz, stamp 12.000000345", size 6, stride 36)     dim[1] = (label "fx fy fz tx ty tz", size 6, stride 6)
/// data   = 36 numbers [N², N·Nm, Nm²]
/// ```
///
/// The message has no header: the stamp is that of the wrench it belongs to, in the label (s). `moment_first` has the order of
/// [`WrenchEstimate`](tribo_robot::WrenchEstimate).
pub fn covariance_array(stamp_ns: u64, moment_first: &Matrix6<f64>) -> Vec<u8> {
    const AXES: &str = "fx fy fz tx ty tz";
    let mut cdr = CdrWriter::default();
    let (seconds, nanoseconds) = (stamp_ns / 1_000_000_000, stamp_ns % 1_000_000_000);
    cdr.count(2).text(&format!("{AXES}, stamp {seconds}.{nanoseconds:09}")).u32(6).u32(36);
    cdr.text(AXES).u32(6).u32(6).u32(0).count(36);
    for row in 0..6 {
        for column in 0..6 {
            cdr.f64(moment_first[((row + 3) % 6, (column + 3) % 6)]);
        }
    }
    cdr.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row i, column j of the estimator holds 10 i + j: the first numbers that go out are those of force with force, then with moment.
    #[test]
    fn force_comes_first() {
        let bytes = covariance_array(12_000_000_345, &Matrix6::from_fn(|i, j| (10 * i + j) as f64));
        let data = &bytes[bytes.len() - 36 * 8..];
        let numbers: Vec<f64> = data.chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect();
        assert_eq!(numbers[..6], [33.0, 34.0, 35.0, 30.0, 31.0, 32.0]);
        assert_eq!(numbers[18..24], [3.0, 4.0, 5.0, 0.0, 1.0, 2.0]);
        assert_eq!(&bytes[12..49], b"fx fy fz tx ty tz, stamp 12.000000345");
    }
}
