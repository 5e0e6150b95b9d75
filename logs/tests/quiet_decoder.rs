//! What a decoder does with damaged files of other programs is an error, and nobody hears of its panics.
//!
//! In a process of its own: who hears of panics is one for all threads.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use std::panic::{catch_unwind, set_hook};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use parquet::data_type::DoubleType;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use tribo_logs::read_log_from;

/// A log as another program writes it: columns that repeat and others, a dictionary and none, nulls.
fn foreign() -> Vec<u8> {
    let schema =
        "message m { REQUIRED DOUBLE time; REQUIRED DOUBLE q_0; OPTIONAL DOUBLE dq_0; REQUIRED DOUBLE tau_J_0; }";
    let properties = WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build();
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for index in 0..4 {
        let mut column = group.next_column().unwrap().unwrap();
        let values: Vec<f64> = (0..40).map(|k| if index == 0 { f64::from(k) } else { f64::from(k % 3) }).collect();
        let levels = (index == 2).then(|| vec![1_i16; 40]);
        column.typed::<DoubleType>().write_batch(&values, levels.as_deref(), None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.into_inner().unwrap()
}

#[test]
fn panics_of_the_decoder_are_errors_and_are_not_told() {
    static HEARD: AtomicUsize = AtomicUsize::new(0);
    set_hook(Box::new(|_| {
        HEARD.fetch_add(1, Ordering::SeqCst);
    }));
    let whole = foreign();
    let name = Path::new("damaged.parquet");
    assert!(read_log_from(whole.clone(), name).is_ok());
    let (mut state, mut gave_up) = (0x9E37_79B9_7F4A_7C15_u64, 0);
    for _ in 0..30_000 {
        // xorshift64: the same files in every run.
        let mut random = |below: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state % below as u64) as usize
        };
        let mut damaged = whole.clone();
        for _ in 0..=random(3) {
            let place = random(damaged.len());
            damaged[place] = random(256) as u8;
        }
        if let Err(error) = read_log_from(damaged, name) {
            let text = error.to_string();
            assert!(text.starts_with("damaged.parquet: "), "{text}");
            gave_up += usize::from(text.contains("gave up"));
        }
    }
    println!("the decoder panicked on {gave_up} of 30 000 files");
    assert!(gave_up > 0, "none of these files makes the decoder panic: they test nothing");
    assert_eq!(HEARD.load(Ordering::SeqCst), 0);
    // All other panics are told as ever.
    assert!(catch_unwind(|| panic!("this one")).is_err());
    assert_eq!(HEARD.load(Ordering::SeqCst), 1);
}
