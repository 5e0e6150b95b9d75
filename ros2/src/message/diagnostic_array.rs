//! `diagnostic_msgs/msg/DiagnosticArray`, what `rqt_robot_monitor` shows.

use tribo_files::CdrWriter;

/// Its name in DDS.
pub const DIAGNOSTIC_TYPE: &str = "diagnostic_msgs::msg::dds_::DiagnosticArray_";

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// All is well.
    Ok = 0,
    /// Somebody should look.
    Warn = 1,
    /// No wrench goes out.
    Error = 2,
    /// Nothing comes in.
    Stale = 3,
}

/// One status.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// How bad it is.
    pub level: Level,
    /// Who speaks.
    pub name: String,
    /// In a sentence.
    pub message: String,
    /// Which device.
    pub hardware_id: String,
    /// Names and values.
    pub values: Vec<(&'static str, String)>,
}

/// Header without a frame, and one status.
pub fn diagnostic_array(stamp_ns: u64, status: &Status) -> Vec<u8> {
    let mut cdr = CdrWriter::default();
    cdr.header(stamp_ns, "").count(1).u8(status.level as u8);
    cdr.text(&status.name).text(&status.message).text(&status.hardware_id).count(status.values.len());
    for (key, value) in &status.values {
        cdr.text(key).text(value);
    }
    cdr.finish()
}
