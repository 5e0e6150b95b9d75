//! Evenly spread stretches of a log that has more rows than its reader needs.

/// Length of a stretch (s): some periods of a usual motion, and many of the memory of a filter.
const STRETCH_S: f64 = 10.0;

/// Keeps every `every`-th stretch, a power of two, the least with which so many rows are left:
///
/// ```text
/// row k stays  where  floor((t_k − t_0) / 10 s) mod every = 0
/// ```
///
/// A log may come in pieces: each doubling of `every` takes rows out of what is there, and never asks for one that is gone. The rows of one stretch
/// stay together, however many they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretches {
    most_rows: usize,
    every: u64,
}

impl Stretches {
    /// At most so many rows; none means all.
    pub fn of(most_rows: Option<usize>) -> Self {
        Self { most_rows: most_rows.unwrap_or(usize::MAX), every: 1 }
    }

    /// Which rows stay, by their stamps (s); none while all do.
    pub fn kept(&mut self, time_s: &[f64]) -> Option<Vec<bool>> {
        if self.every == 1 && time_s.len() <= self.most_rows {
            return None;
        }
        let (first_s, last_s) = time_s.first().zip(time_s.last())?;
        let stretch = |stamp_s: &f64| ((stamp_s - first_s) / STRETCH_S) as u64;
        loop {
            let kept = |stamp_s: &f64| stretch(stamp_s).is_multiple_of(self.every);
            let few = time_s.iter().filter(|stamp_s| kept(stamp_s)).count() <= self.most_rows;
            match self.every.checked_mul(2) {
                Some(doubled) if !few && stretch(last_s) >= self.every => self.every = doubled,
                _ => return (self.every > 1).then(|| time_s.iter().map(kept).collect()),
            }
        }
    }

    /// Takes the other rows out of columns, of which the first holds the stamps (s).
    pub fn thin(&mut self, columns: &mut [Vec<f64>]) {
        let Some(kept) = columns.first().and_then(|time_s| self.kept(time_s)) else { return };
        for column in columns {
            let mut kept = kept.iter();
            column.retain(|_| kept.next().is_none_or(|kept| *kept));
        }
    }

    /// What was left out, in words; none where nothing was.
    pub fn remark(&self) -> Option<String> {
        let Self { most_rows, every } = self;
        (*every > 1).then(|| {
            format!("one of every {every} stretches of {STRETCH_S} s is taken: the log has more than {most_rows} rows")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 200 s at 10 Hz.
    fn stamps() -> Vec<f64> {
        (0..2000).map(|k| 5.0 + 0.1 * f64::from(k)).collect()
    }

    #[test]
    fn the_stretches_that_stay_are_spread_evenly() {
        let mut whole = Stretches::of(Some(2000));
        assert_eq!((whole.kept(&stamps()), whole.remark()), (None, None));
        let mut quarter = Stretches::of(Some(600));
        let kept = quarter.kept(&stamps()).unwrap();
        // 20 stretches, of which the first, fifth, ninth, 13th and 17th stay.
        for (k, kept) in kept.iter().enumerate() {
            assert_eq!(*kept, (k / 100) % 4 == 0, "{k}");
        }
        assert!(quarter.remark().unwrap().starts_with("one of every 4 stretches of 10 s is taken"));
    }

    #[test]
    fn in_pieces_as_in_the_whole() {
        let mut whole = [stamps(), stamps().iter().map(|t| -t).collect()];
        Stretches::of(Some(450)).thin(&mut whole);
        let mut pieces = [Vec::new(), Vec::new()];
        let mut stretches = Stretches::of(Some(450));
        for piece in stamps().chunks(130) {
            pieces[0].extend(piece);
            pieces[1].extend(piece.iter().map(|t| -t));
            stretches.thin(&mut pieces);
            assert!(pieces[0].len() <= 450);
        }
        assert_eq!(pieces, whole);
    }

    #[test]
    fn a_single_stretch_stays_whole() {
        let mut columns = [(0..500).map(|k| 0.01 * f64::from(k)).collect::<Vec<f64>>()];
        Stretches::of(Some(10)).thin(&mut columns);
        assert_eq!(columns[0].len(), 500);
        Stretches::of(Some(10)).thin(&mut []);
    }
}
