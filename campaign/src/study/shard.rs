//! Which part of a study a process computes.

use super::settings::Study;
use super::{Cell, mixed};

/// Slice `index` of `count`, from 0: the cells whose place in a fixed pseudo-random order leaves that remainder. Neighbouring cells
/// take equally long, so that each slice has its share of the long ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    count: u64,
}

/// Why there is no slice.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShardError {
    /// Not `K/N`.
    #[error("shard {0}; allowed: K/N with 1 <= K <= N <= 1000000")]
    Form(String),
    /// Half of what a job array sets.
    #[error("{0} is set and {1} is not or is no number; say --shard K/N")]
    Environment(&'static str, &'static str),
}

impl Default for Shard {
    /// Everything.
    fn default() -> Self {
        Self { index: 0, count: 1 }
    }
}

impl std::str::FromStr for Shard {
    type Err = ShardError;

    /// `K/N`, K from 1.
    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse::<u64>().ok()?, n.parse::<u64>().ok()?)));
        match parts {
            Some((k, count)) if (1..=count).contains(&k) && count <= 1_000_000 => Ok(Self { index: k - 1, count }),
            _ => Err(ShardError::Form(text.to_owned())),
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.count)
    }
}

impl Shard {
    /// The slice that a job array gives to this process, from its environment: Slurm's `SLURM_ARRAY_TASK_ID`, `_MIN`, `_STEP` and
    /// `_COUNT`, or `JOB_COMPLETION_INDEX` of an indexed Kubernetes job with `JOB_COMPLETIONS` beside it, which the job's manifest
    /// has to set.
    ///
    /// # Errors
    /// An array whose size nobody says.
    pub fn of_job_array(variable: impl Fn(&str) -> Option<String>) -> Result<Option<Self>, ShardError> {
        let number = |name: &str| variable(name).and_then(|text| text.trim().parse::<u64>().ok());
        if variable("SLURM_ARRAY_TASK_ID").is_some() {
            let needed = |name: &'static str| number(name).ok_or(ShardError::Environment("SLURM_ARRAY_TASK_ID", name));
            let (id, count) = (needed("SLURM_ARRAY_TASK_ID")?, needed("SLURM_ARRAY_TASK_COUNT")?);
            let (least, step) = (needed("SLURM_ARRAY_TASK_MIN")?, number("SLURM_ARRAY_TASK_STEP").unwrap_or(1));
            return Self::of(id.checked_sub(least).map(|above| above / step.max(1)), count).map(Some);
        }
        if variable("JOB_COMPLETION_INDEX").is_some() {
            let index = number("JOB_COMPLETION_INDEX");
            let missing = ShardError::Environment("JOB_COMPLETION_INDEX", "JOB_COMPLETIONS");
            return Self::of(index, number("JOB_COMPLETIONS").ok_or(missing)?).map(Some);
        }
        Ok(None)
    }

    fn of(index: Option<u64>, count: u64) -> Result<Self, ShardError> {
        match index {
            Some(index) if index < count => Ok(Self { index, count }),
            // An array with holes, `--array=1,5,9`, has no size that its tasks could be counted by.
            _ => Err(ShardError::Form(format!("{}/{count}", index.map_or(0, |index| index + 1)))),
        }
    }

    /// The cells of this slice.
    pub fn cells(&self, study: &Study) -> Vec<Cell> {
        let mut order: Vec<(u64, Cell)> =
            study.cells().into_iter().enumerate().map(|(place, cell)| (mixed(place as u64), cell)).collect();
        order.sort_by_key(|(key, _)| *key);
        let of_slice = order.into_iter().enumerate().filter(|(k, _)| *k as u64 % self.count == self.index);
        of_slice.map(|(_, (_, cell))| cell).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(variables: &[(&str, &str)]) -> Result<Option<Shard>, ShardError> {
        let find = |name: &str| variables.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned());
        Shard::of_job_array(find)
    }

    #[test]
    fn is_read_from_text_and_from_job_arrays() {
        assert_eq!("2/4".parse(), Ok(Shard { index: 1, count: 4 }));
        for wrong in ["0/4", "5/4", "1", "1/0", "a/b", "-1/4", "1/4/2", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert_eq!(array(&[]), Ok(None));
        let slurm = |id: &'static str, min: &'static str, step: &'static str, count: &'static str| {
            array(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", min),
                ("SLURM_ARRAY_TASK_STEP", step),
                ("SLURM_ARRAY_TASK_COUNT", count),
            ])
        };
        assert_eq!(slurm("3", "0", "1", "4"), Ok(Some(Shard { index: 3, count: 4 })));
        assert_eq!(slurm("9", "5", "2", "4"), Ok(Some(Shard { index: 2, count: 4 })));
        assert!(slurm("9", "1", "1", "3").is_err(), "an array with holes");
        assert!(array(&[("SLURM_ARRAY_TASK_ID", "1")]).is_err());
        assert_eq!(
            array(&[("JOB_COMPLETION_INDEX", "2"), ("JOB_COMPLETIONS", "3")]),
            Ok(Some(Shard { index: 2, count: 3 }))
        );
        assert!(array(&[("JOB_COMPLETION_INDEX", "2")]).is_err());
    }
}
