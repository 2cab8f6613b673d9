//! Every file of the corpus is read, or refused: those that once led to a fault too.

use std::fs;
use std::path::Path;

use upglow_fuzz::{Mutator, Random, TARGETS};

/// Bytes of all files together, so that a checkout stays small.
const MOST_BYTES: usize = 250_000;

fn files(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let entries = fs::read_dir(&folder).expect("a folder of each target");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.map(|p| (p.display().to_string(), fs::read(&p).expect("a file"))).collect()
}

#[test]
fn every_kept_file_is_read_or_refused() {
    let mut total = 0;
    for target in TARGETS {
        let files = files(target.name);
        assert!(!files.is_empty(), "no corpus for {}", target.name);
        for (path, bytes) in files {
            total += bytes.len();
            println!("{path}");
            (target.run)(&bytes);
        }
    }
    assert!(total <= MOST_BYTES, "the corpus has {total} bytes");
}

#[test]
fn some_altered_files_are_read_or_refused() {
    for target in TARGETS {
        let kept = files(target.name).into_iter().map(|(_, bytes)| bytes).collect();
        let mut mutator = Mutator::new(kept, Random::new(7));
        for _ in 0..50 {
            (target.run)(&mutator.next_file());
        }
    }
}
