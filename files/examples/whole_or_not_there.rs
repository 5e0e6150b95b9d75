//! A table on disk: written in one step, sealed, and refused when a byte of it is lost.
//!
//! `cargo run --release -p tribo-files --example whole_or_not_there`

use tribo_files::{Table, read_table, seal_of, write_atomic, write_table};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("temperatures.parquet");
    let columns = vec![("time_s".to_owned(), vec![0.0, 1.0, 2.0]), ("motor_c".to_owned(), vec![21.0, 21.5, 22.25])];
    write_table(&path, &Table { columns, ..Table::default() })?;
    let table = read_table(&path)?;
    println!("read back: {} rows, motor_c {:?}", table.rows(), table.column("motor_c").unwrap_or_default());
    println!("seal: {:?}", seal_of(&path)?);

    let bytes = std::fs::read(&path)?;
    let torn = folder.path().join("torn.parquet");
    write_atomic(&torn, |file| file.write_all(&bytes[..bytes.len() - 1]))?;
    match read_table(&torn) {
        Ok(_) => println!("torn: read all the same"),
        Err(error) => println!("torn: {error}"),
    }
    Ok(())
}
