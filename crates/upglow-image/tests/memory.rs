//! A picture of 16384² texels is written and read in bounded memory. The only test of this file, because
//! it measures the memory of the process.

use upglow_image::{ExrDescription, ExrWriter, Picture};

const SIDE: usize = 16_384;
const BAND: usize = 64;

/// A band of `Picture`'s documentation twice over (what is read and what is unpacked), the planes
/// of the writer, and 64 MiB for the program, its threads and its allocator.
const MOST_KIB: u64 = (2 * 32 + 2 * 12 + 64) << 10;

/// The most memory that this process ever held, KiB, where the system says.
fn peak_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[test]
#[ignore = "slow: writes and reads 1.6 GB"]
fn slow_a_picture_of_16k_stays_within_bounded_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("big.exr");
    let description = ExrDescription::new([SIDE, SIDE], ["R", "G", "B"]);
    let mut writer = ExrWriter::create(&path, description).unwrap();
    let mut plane = vec![0.0_f32; SIDE * BAND];
    for top in (0..SIDE).step_by(BAND) {
        for (i, v) in plane.iter_mut().enumerate() {
            *v = ((i * 13 + top * 7) % 1009) as f32 / 1009.0;
        }
        writer.write_band(&[&plane, &plane, &plane]).unwrap();
    }
    writer.finish().unwrap();
    let mut picture = Picture::open(&path).unwrap();
    let mut rows = 0;
    for band in picture.bands(BAND) {
        rows += band.unwrap().rows();
    }
    assert_eq!(rows, SIDE);
    match peak_kib() {
        Some(peak) => assert!(peak < MOST_KIB, "{peak} KiB, expected less than {MOST_KIB}"),
        None => println!("skipped: this system does not report the peak memory of a process"),
    }
}
