//! From column names to the columns of a log, whatever the order in the file.
//!
//! N = 1 + the largest joint index that occurs. A quantity is there with all its columns or not at all; `time`, `q_i`
//! and `tau_J_i` must be there. Names that are not canonical are kept as `unknown`.

use std::collections::HashMap;
use std::ops::Range;

use tribo_files::LogError;

use crate::log::LogColumns;
use crate::quantity::Quantity;

/// Where each canonical column stands in a file.
pub(crate) struct Header {
    /// Number of joints.
    pub joints: usize,
    /// Quantities the file has, in canonical order.
    pub quantities: Vec<Quantity>,
    /// Position in the file of each canonical column, in canonical order.
    pub positions: Vec<usize>,
    /// Names that are not canonical.
    pub unknown: Vec<String>,
}

impl Header {
    /// Reads the column names of a file.
    pub fn from_names<S: AsRef<str>>(names: &[S]) -> Result<Self, LogError> {
        positions_by_name(names)?;

        // What the names stand for.
        let mut unknown = Vec::new();
        let mut joints = 1;
        let mut position_of: HashMap<(Quantity, usize), usize> = HashMap::new();
        for (position, name) in names.iter().map(AsRef::as_ref).enumerate() {
            match Quantity::from_column_name(name) {
                Some((quantity, index)) => {
                    if quantity.is_per_joint() {
                        joints = joints.max(index + 1);
                    }
                    if let Some(first) = position_of.insert((quantity, index), position) {
                        let column = quantity.column_name(index);
                        return Err(LogError::DuplicateColumn { column, first: first + 1, second: position + 1 });
                    }
                }
                None if name.is_empty() => unknown.push("(unnamed)".to_owned()),
                None => unknown.push(name.to_owned()),
            }
        }

        // Whole quantities only.
        let (mut quantities, mut positions, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for quantity in Quantity::ALL {
            let columns = 0..quantity.column_count(joints);
            let present = columns.clone().any(|index| position_of.contains_key(&(quantity, index)));
            // Velocities can be worked out from the positions.
            let needed = quantity.is_required() && quantity != Quantity::Velocity;
            if !(present || needed) {
                continue;
            }
            quantities.push(quantity);
            for index in columns {
                match position_of.get(&(quantity, index)) {
                    Some(&position) => positions.push(position),
                    None => missing.push(quantity.column_name(index)),
                }
            }
        }
        if missing.is_empty() {
            Ok(Self { joints, quantities, positions, unknown })
        } else {
            Err(LogError::MissingColumns { missing, unknown })
        }
    }

    /// Names of the canonical columns, in the order of `positions`.
    pub fn column_names(&self) -> Vec<String> {
        let names =
            |&quantity: &Quantity| (0..quantity.column_count(self.joints)).map(move |i| quantity.column_name(i));
        self.quantities.iter().flat_map(names).collect()
    }

    /// Where the columns of a quantity stand among the canonical columns; empty if it is not there.
    pub fn columns_of(&self, quantity: Quantity) -> Range<usize> {
        let count = |&q: &Quantity| q.column_count(self.joints);
        let start = self.quantities.iter().take_while(|&&q| q != quantity).map(count).sum();
        start..start + self.quantities.iter().find(|&&q| q == quantity).map_or(0, count)
    }

    /// Columns given in canonical order become the columns of a log.
    pub fn assemble(&self, columns: Vec<Vec<f64>>) -> LogColumns {
        let mut columns = columns.into_iter();
        let mut log = LogColumns::default();
        for &quantity in &self.quantities {
            log.set_quantity(quantity, columns.by_ref().take(quantity.column_count(self.joints)).collect());
        }
        log
    }
}

/// Where each name stands. A second column of one name is an error, understood or not.
pub(crate) fn positions_by_name<S: AsRef<str>>(names: &[S]) -> Result<HashMap<&str, usize>, LogError> {
    let mut position_of = HashMap::with_capacity(names.len());
    for (position, name) in names.iter().enumerate() {
        let name = name.as_ref();
        if let Some(first) = position_of.insert(name, position) {
            let column = name.to_owned();
            return Err(LogError::DuplicateColumn { column, first: first + 1, second: position + 1 });
        }
    }
    Ok(position_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joint_count_comes_from_the_largest_index() {
        let header = Header::from_names(&["q_1", "tau_J_0", "x", "q_0", "dq_1", "dq_0", "time", "tau_J_1"]).unwrap();
        assert_eq!(header.joints, 2);
        assert_eq!(header.positions, [6, 3, 0, 5, 4, 1, 7]);
        assert_eq!(header.unknown, ["x"]);
    }

    #[test]
    fn missing_and_duplicate_columns_are_named() {
        let text = Header::from_names(&["time", "q_0", "dq_0", "tau_j_0"]).err().unwrap().to_string();
        assert_eq!(text, "missing column: tau_J_0 (not understood: tau_j_0)");
        let text = Header::from_names(&["time", "q_0", "dq_0", "tau_J_0", "theta_1"]).err().unwrap().to_string();
        assert_eq!(text, "missing columns: q_1, dq_1, tau_J_1, theta_0");
        let text = Header::from_names(&["time", "q_0", "dq_0", "q_0"]).err().unwrap().to_string();
        assert_eq!(text, "column `q_0` occurs twice, as columns 2 and 4");
    }
}
