//! Whether a log is believed.

use std::path::Path;

use serde_json::{Value, json};
use tribo_logs::recognise::{Remark, Severity, Use, refusal, said};

use crate::failure::BadInput;

/// Remarks in a JSON document.
pub fn remarks_json(remarks: &[Remark]) -> Value {
    let remarks = remarks.iter().map(|remark| {
        let severity = if remark.severity == Severity::Refuse { "refuse" } else { "warn" };
        json!({
            "fault": remark.fault.name(),
            "severity": severity,
            "joints": remark.joints,
            "evidence": remark.evidence,
            "remedy": remark.remedy,
        })
    });
    remarks.collect()
}

/// What is done with a log that cannot be right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// It is an error.
    IsAnError,
    /// Somebody who knows better goes on with it.
    IsTaken,
}

impl Refused {
    /// As `--anyway` says.
    pub fn unless(anyway: bool) -> Self {
        if anyway { Self::IsTaken } else { Self::IsAnError }
    }
}

/// Refuses a log that cannot be right for what it is wanted for, with every reason; what only may be wrong goes to standard error.
///
/// # Errors
/// [`BadInput`], one line per reason.
pub fn believe(path: &Path, remarks: &[Remark], wanted: Use, refused: Refused, quiet: bool) -> anyhow::Result<()> {
    let name = path.display().to_string();
    if let Some(reasons) = refusal(&name, remarks, wanted).filter(|_| refused == Refused::IsAnError) {
        return Err(BadInput(reasons).into());
    }
    if !quiet {
        said(&name, remarks).for_each(|line| message!("tribo: {line}"));
    }
    Ok(())
}
