//! Column maps, as text and as YAML.

use std::path::Path;

use tribo_logs::{ColumnMap, ReadOptions, read_from};

/// What errors call the input.
const NAME: &str = "map.yaml";

/// Lines of two joints under names that maps of the seeds use.
const TABLE: &[u8] = b"stamp,pos_1 [deg],pos_2 [deg],vel_1,vel_2,eff_1,eff_2,run,name\n0,1,2,3,4,5,6,0,a\n1,1,2,3,4,5,6,0,a\n2,1,2,3,4,5,6,1,a\n";

/// A map is refused with a reason, or its text means the same again; held against a table it gives a log or a sentence.
pub fn check(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let maps = [text.trim_end().parse::<ColumnMap>(), ColumnMap::from_yaml(text, Path::new(NAME))];
    for map in maps {
        match map {
            Ok(map) => {
                let _ = map.to_string().parse::<ColumnMap>();
                if let Err(error) = read_from(TABLE, Path::new(NAME), &ReadOptions::from(map)) {
                    assert!(!error.to_string().is_empty());
                }
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}
