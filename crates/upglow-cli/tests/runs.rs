//! Every run writes the same bytes, and a stopped one writes nothing.

mod support;

use support::Folder;

#[test]
fn the_number_of_threads_does_not_change_a_byte() {
    for model in ["film", "dyes", "analytic", "reflectance"] {
        let folder = Folder::new();
        for threads in ["1", "2", "3", "7"] {
            folder.done(&format!(
                "build --resolution 5 --model {model} --threads {threads} -o {threads}"
            ));
            assert_eq!(folder.read("1"), folder.read(threads), "{model} {threads}");
        }
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_byte_of_a_baked_file() {
    let folder = Folder::new();
    folder.done("build --space srgb --resolution 5 -o cube.safetensors");
    let mut picture = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 70, 0, 90, 0, 24, 0x20];
    picture.extend((0..90_u8).flat_map(|y| (0..70).flat_map(move |x| [x * 3, y * 2, x + y])));
    folder.write("in.tga", picture);
    for (form, ending) in [
        ("--as material", "exr"),
        ("--as material --fast --format tx", "tx"),
        ("--as spectral --bands 400:700:50", "exr"),
        ("--as radiance --light A --format png", "png"),
    ] {
        let baked = |threads: u32| {
            folder.done(&format!(
                "bake cube.safetensors in.tga -o {threads}.{ending} --threads {threads} \
                 --space srgb --encoding srgb {form}"
            ));
            folder.read(&format!("{threads}.{ending}"))
        };
        let first = baked(1);
        for threads in [2, 3, 7] {
            assert!(baked(threads) == first, "{form} {threads}");
        }
    }
}

#[test]
fn the_same_seed_verifies_the_same_colors() {
    let folder = Folder::new();
    folder.done("build --resolution 3 -o cube");
    let first = folder.done("--json verify cube --points 500 --seed 3 --threads 1");
    assert_eq!(first, folder.done("--json verify cube --points 500 --seed 3 --threads 2"));
    assert_ne!(first, folder.done("--json verify cube --points 500 --seed 4"));
}

#[cfg(target_os = "linux")]
mod stopped {
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    use super::Folder;
    use super::support::{one_line, program, stoppable};

    /// Far longer than the program takes to start or stop on a busy machine.
    const PATIENCE: Duration = Duration::from_secs(60);

    /// Whether the process has set a handler for this signal.
    fn catches(pid: u32, signal: u32) -> bool {
        let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
        mask >> (signal - 1) & 1 == 1
    }

    fn wait_until_it_catches(child: &Child, signal: u32) {
        let start = Instant::now();
        while !catches(child.id(), signal) {
            assert!(start.elapsed() < PATIENCE, "the program does not start");
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(100));
    }

    #[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
    fn send(child: &Child, name: &str) {
        let sent = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    fn stop(words: &str, name: &str, signal: u32) {
        let folder = Folder::new();
        folder.done("build --resolution 2 -o old");
        stop_in(&folder, words, name, signal);
    }

    /// Starts the program in a folder and stops it; nothing there may change.
    #[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
    fn stop_in(folder: &Folder, words: &str, name: &str, signal: u32) {
        let names = folder.names();
        let child = stoppable()
            .args(words.split_whitespace())
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let start = Instant::now();
        wait_until_it_catches(&child, signal);
        send(&child, name);
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{stderr}");
        assert_eq!(one_line(&stderr), "stopped; files are whole or as before");
        assert!(output.stdout.is_empty());
        assert!(start.elapsed() < PATIENCE, "it took too long to stop");
        assert_eq!(folder.names(), names);
    }

    #[test]
    fn a_build_leaves_no_file() {
        stop("build --resolution 128 -o cube", "-INT", 2);
        stop("build --resolution 128 -o cube", "-TERM", 15);
    }

    #[test]
    fn signals_that_were_ignored_at_the_start_stay_ignored() {
        let folder = Folder::new();
        let child = Command::new("sh")
            .args(["-c", "trap '' HUP INT; exec \"$0\" build --resolution 24 -o cube"])
            .arg(program())
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        wait_until_it_catches(&child, 15);
        assert!(!catches(child.id(), 1) && !catches(child.id(), 2));
        send(&child, "-HUP");
        send(&child, "-INT");
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{:?}", String::from_utf8(output.stderr));
        assert_eq!(folder.names(), ["cube"]);
    }

    #[test]
    fn a_bake_leaves_no_file_and_the_old_one_as_it_was() {
        let folder = Folder::new();
        folder.done("build --resolution 2 -o cube");
        folder.done("examples");
        folder.write("out.exr", "old");
        // Tens of seconds of work, in bands of 64 rows.
        let words = "bake cube examples/dusk.exr -o out.exr --as spectral --bands 300:830:5";
        stop_in(&folder, words, "-INT", 2);
        stop_in(&folder, words, "-TERM", 15);
        assert_eq!(folder.read("out.exr"), b"old");
    }

    #[test]
    fn a_pipe_that_nobody_reads_is_not_waited_for_after_a_stop() {
        let folder = Folder::new();
        assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
        stop_in(&folder, "build --resolution 2 -o pipe", "-TERM", 15);
    }

    #[test]
    fn the_files_of_a_picture_appear_together() {
        let folder = Folder::new();
        folder.done("build --resolution 2 -o cube");
        folder.done("examples");
        let words = "bake cube examples/dusk.exr -o out.exr --as rgbu --engine rec709";
        let before = folder.names().len();
        for after_ms in (0..4000).step_by(400) {
            let mut child =
                stoppable().args(words.split(' ')).current_dir(folder.path()).spawn().unwrap();
            wait_until_it_catches(&child, 15);
            std::thread::sleep(Duration::from_millis(after_ms));
            if child.try_wait().unwrap().is_none() {
                send(&child, "-TERM");
            }
            child.wait().unwrap();
            let made = folder.names().len() - before;
            assert!([0, 4].contains(&made), "{made} of four files");
            if made == 4 {
                return;
            }
        }
        panic!("it is never done");
    }

    #[test]
    fn a_verification_stops() {
        stop("verify old --points 1000000000", "-INT", 2);
    }
}
