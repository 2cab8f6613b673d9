//! Outputs are where they belong: behind links, in devices and pipes, with the rights of what they replace, and whole
//! whatever happens to the run or to others.
#![cfg(target_os = "linux")]

mod support;

use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use support::{Folder, one_line, program};

fn folder_with_cube() -> Folder {
    let folder = Folder::new();
    folder.done("build --resolution 3 -o cube");
    folder
}

/// Runs a script of the shell in which `$0` is the program; returns status, standard output and standard error.
#[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
fn in_shell(folder: &Folder, script: &str) -> (i32, String, String) {
    let output = Command::new("sh")
        .args(["-c", script])
        .arg(program())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

/// The commands that write a file, with `OUT` for it.
const WRITERS: [&str; 12] = [
    "build --resolution 3 -o OUT",
    "export cube OUT --format csv",
    "export cube OUT --format coeff --resolution 2",
    "export cube OUT --format html",
    "export cube OUT --format clf --resolution 2",
    "color cube 0.5 0.5 0.5 --plot OUT",
    "color cube 0.5 0.5 0.5 --kind ordinary --output OUT",
    "relight cube 0.5 0.5 0.5 --light A --csv OUT",
    "relight cube 0.5 0.5 0.5 --light A --plot OUT",
    "check cube.exr --output OUT",
    "check cube.exr --heat-map OUT",
    "bake cube cube.exr --plan OUT --output there",
];

#[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
fn folder_with_picture() -> Folder {
    let folder = folder_with_cube();
    folder.done("examples");
    std::fs::copy(folder.path().join("examples/dusk.exr"), folder.path().join("cube.exr")).unwrap();
    folder
}

/// A command of [`WRITERS`] with this output.
fn of(writer: &str, output: &str) -> String {
    writer.replace("OUT", output)
}

#[test]
fn a_full_device_and_a_full_disk_give_the_same_line_in_every_command() {
    let folder = folder_with_picture();
    let disk = folder.path().join("disk");
    std::fs::create_dir(&disk).unwrap();
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=4k", "tmpfs"])
        .arg(&disk)
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    if !mounted {
        eprintln!("skipped the full disk: only root can mount a small one");
    }
    if mounted {
        std::fs::write(disk.join("full"), [0; 4096]).unwrap();
    }
    let mut runs = Vec::new();
    for writer in WRITERS {
        runs.push(("/dev/full", writer, folder.run(&of(writer, "/dev/full"))));
        if mounted {
            runs.push(("disk/x", writer, folder.run(&of(writer, "disk/x"))));
        }
    }
    if mounted {
        let writers = [
            ("disk/x.exr", "bake cube cube.exr -o disk/x.exr"),
            ("disk/x.png", "bake cube cube.exr --as radiance --light A -o disk/x.png"),
            ("disk/dusk.exr", "examples --out disk"),
            ("disk/x.wgsl", "export cube disk/x.wgsl"),
            ("disk/x.mtlx", "export cube disk/x.mtlx"),
        ];
        runs.extend(writers.map(|(path, writer)| (path, writer, folder.run(writer))));
    }
    let left = disk.read_dir().unwrap().count();
    if mounted {
        Command::new("umount").arg(&disk).status().unwrap();
    }
    for (path, writer, run) in runs {
        // Behind a warning.
        assert_eq!(run.status, 1, "{writer}: {}", run.stdout);
        let last = run.stderr.lines().last().unwrap_or_default();
        let line = one_line(&format!("{last}\n"));
        let (place, line) = line.split_once(": ").unwrap();
        // Which of several files does not fit first is not promised.
        let is_there = place == path || Path::new(place).starts_with("disk");
        assert!(is_there, "{writer}: {place}: {line}");
        let expected =
            "no space left on the disk, expected room for the file and the right to write";
        assert_eq!(line, expected, "{writer}");
    }
    assert_eq!(left, usize::from(mounted), "only what filled the disk stays");
    assert!(!Path::new("/dev/full").metadata().unwrap().is_file());
}

/// Runs the program as a user whom rights hold for: as another one if this is root. `None` if that is not allowed.
#[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
fn run_with_few_rights(folder: &Folder, words: &str) -> Option<(i32, String)> {
    use std::os::unix::fs::MetadataExt as _;
    use std::os::unix::process::CommandExt as _;

    const NOBODY: u32 = 65534;
    let mut command = Command::new(program());
    if Path::new("/proc/self").metadata().unwrap().uid() == 0 {
        command.uid(NOBODY).gid(NOBODY);
    }
    let output = command.args(words.split(' ')).current_dir(folder.path()).output().ok()?;
    Some((output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).unwrap()))
}

#[test]
fn without_the_right_to_write_every_command_gives_one_line_and_changes_nothing() {
    let folder = folder_with_picture();
    // A folder of a test is its user's alone.
    let rights = |path: &Path, mode| {
        std::fs::set_permissions(path, PermissionsExt::from_mode(mode)).unwrap();
    };
    let closed = folder.path().join("closed");
    folder.write("closed/old", "old");
    rights(folder.path(), 0o755);
    rights(&closed, 0o555);
    let others = ["bake cube cube.exr -o OUT.exr", "examples -o OUT", "man -o OUT"];
    for writer in WRITERS.into_iter().chain(others) {
        for name in ["closed/new", "closed/old"] {
            if name == "closed/old" && others.contains(&writer) {
                continue;
            }
            let Some((status, stderr)) = run_with_few_rights(&folder, &of(writer, name)) else {
                eprintln!("skipped: no program may be run as another user");
                return;
            };
            assert_eq!(status, 1, "{writer}: {stderr}");
            let last = stderr.lines().last().unwrap_or_default();
            let line = one_line(&format!("{last}\n"));
            assert!(line.starts_with(name), "{writer}: {line}");
            assert!(line.contains(": permission denied, expected "), "{writer}: {line}");
        }
    }
    rights(&closed, 0o755);
    assert_eq!(folder.read("closed/old"), b"old");
    assert_eq!(closed.read_dir().unwrap().count(), 1);
}

/// Commands that read and write files: `<` is before the names of those that exist, `>` before those that are written.
const READERS_AND_WRITERS: [&str; 12] = [
    "build --resolution 2 --light <lamp --observer <eye -o >a",
    "color <cube .5 .5 .5 --light <lamp --plot >a",
    "color <cube .9 .3 .02 --kind fluorescent --known <lamp .9 .3 .02 --light <light -o >a --plot >b",
    "relight <cube --colors <list --light <lamp --observer <eye --csv >a --plot >b",
    "fit-matrix <matrix.csv --light <lamp -o >a --plot >b",
    "export <cube --format csv -o >a",
    "export <cube --format mtlx --light <lamp -o >a",
    "bake <cube <picture --as radiance --light <lamp -o z.exr --plan >a",
    "bake <cube <picture --as radiance --light <lamp -o >a",
    "check <picture --cube <cube -o >a --heat-map >b",
    "check <picture --light <lamp --adapt none -o >a --heat-map >b",
    "check --task 1 <plan -o >a --heat-map >b",
];

#[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
fn folder_with_all_inputs() -> Folder {
    let folder = folder_with_picture();
    std::fs::rename(folder.path().join("cube.exr"), folder.path().join("picture")).unwrap();
    for lamp in ["lamp", "light"] {
        folder.write(lamp, support::curves("power", |_| "1".to_owned()));
    }
    folder.write("eye", support::eye());
    folder.write("list", "r,g,b\n0.5,0.3,0.2\n");
    folder
        .write("matrix.csv", "outgoing_nm\\incident_nm per_band,400,500\n400,0.5,0\n500,0.1,0.5\n");
    folder.done("bake cube picture -o baked.exr --plan planned.json");
    std::fs::rename(folder.path().join("planned.json"), folder.path().join("plan")).unwrap();
    folder
}

/// Runs a command that must be refused, and change nothing.
fn assert_refused(folder: &Folder, line: &str) -> String {
    let content = |folder: &Folder| -> Vec<(String, Option<Vec<u8>>)> {
        let read = |name: String| (name.clone(), std::fs::read(folder.path().join(name)).ok());
        folder.names().into_iter().map(read).collect()
    };
    let before = content(folder);
    let run = folder.run(line);
    assert!(run.status == 1 && run.stdout.is_empty(), "{line}: {} {}", run.status, run.stdout);
    assert!(content(folder) == before, "{line}: files have changed");
    one_line(&run.stderr)
}

#[test]
fn no_command_writes_over_what_it_reads() {
    let folder = folder_with_all_inputs();
    for command in READERS_AND_WRITERS {
        let words: Vec<&str> = command.split(' ').collect();
        let inputs = words.iter().filter_map(|word| word.strip_prefix('<'));
        for input in inputs {
            let link = format!("link-to-{input}");
            symlink(input, folder.path().join(&link)).unwrap();
            for output in words.iter().filter(|word| word.starts_with('>')) {
                for target in [input, &link] {
                    let line = command.replace(output, target).replace(['<', '>'], "");
                    let told = assert_refused(&folder, &line);
                    assert!(told.contains(", expected "), "{line}: {told}");
                }
            }
            std::fs::remove_file(folder.path().join(&link)).unwrap();
        }
    }
}

#[test]
fn no_command_writes_two_outputs_to_one_file() {
    let folder = folder_with_all_inputs();
    symlink("one", folder.path().join("other")).unwrap();
    for command in READERS_AND_WRITERS.iter().filter(|command| command.contains(">b")) {
        for (a, b) in [("one", "one"), ("one", "other"), ("/dev/stdout", "/dev/stdout")] {
            let line = command.replace(">a", a).replace(">b", b).replace('<', "");
            let told = assert_refused(&folder, &line);
            let names_one = [a, b].iter().any(|path| told.contains(&format!("{path}: ")));
            assert!(names_one && told.contains("another output"), "{line}: {told}");
        }
    }
    symlink("out.exr", folder.path().join("out.mtlx")).unwrap();
    symlink("out.wgsl", folder.path().join("out.textures")).unwrap();
    for line in
        ["bake cube picture --as radiance --light A --mtlx -o out.exr", "export cube -o out.wgsl"]
    {
        let told = assert_refused(&folder, line);
        assert!(told.contains("another output"), "{line}: {told}");
    }
}

#[test]
fn a_task_writes_over_nothing_that_it_reads() {
    let folder = folder_with_all_inputs();
    let plan = String::from_utf8(folder.read("plan")).unwrap();
    for input in ["picture", "cube", "altered"] {
        folder.write("altered", plan.replace("\"baked.exr\"", &format!("\"{input}\"")));
        let told = assert_refused(&folder, "bake --task 1 altered");
        let expected = "an input of this command, expected another file to write";
        assert_eq!(told, format!("{input}: {expected}"));
    }
    folder.write("altered", plan.replace("\"options\":[", "\"options\":[\"--help\","));
    let told = assert_refused(&folder, "bake --task 1 altered");
    assert!(told.starts_with("altered: options: "), "{told}");
}

#[test]
fn what_cannot_be_written_is_told_before_the_work_starts() {
    let folder = folder_with_picture();
    let long = "x".repeat(300);
    for (output, expected) in
        [("new/", "new/: a path that ends in /, expected a file to write"), (&*long, "expected ")]
    {
        // Hours of work.
        let line = format!("build --resolution 256 --method exhaustive -o {output}");
        let told = assert_refused(&folder, &line);
        assert!(told.starts_with(output) && told.contains(expected), "{told}");
    }
    let (status, _, stderr) =
        in_shell(&folder, "TMPDIR=/no/such \"$0\" export cube --format csv -o /dev/stdout");
    assert_eq!(status, 1);
    let told = one_line(&stderr);
    assert!(
        told.contains("/no/such") && told.ends_with("expected TMPDIR to name a folder to write in"),
        "{told}"
    );
    let (status, _, stderr) = in_shell(&folder, "\"$0\" --help >/dev/full");
    assert_eq!(
        (status, one_line(&stderr).starts_with("standard output: no space left")),
        (1, true)
    );
}

#[test]
fn a_limit_on_the_size_of_files_is_an_error_of_the_file() {
    let folder = folder_with_picture();
    for writer in WRITERS {
        let line = of(writer, "limited");
        let (status, _, stderr) = in_shell(&folder, &format!("ulimit -f 1; exec \"$0\" {line}"));
        let is_small = folder.path().join("limited").is_file();
        assert!(status == 1 || (status == 0 && is_small), "{line}: {status} {stderr}");
        if status == 1 {
            let last = stderr.lines().last().unwrap_or_default();
            let told = one_line(&format!("{last}\n"));
            assert!(told.starts_with("limited: file too large, expected "), "{line}: {told}");
        }
        let left: Vec<String> =
            folder.names().into_iter().filter(|name| name.starts_with(".upglow")).collect();
        assert_eq!(left, [""; 0], "{line}");
        let _ = std::fs::remove_file(folder.path().join("limited"));
    }
}

#[test]
fn links_are_followed_and_modes_are_kept() {
    let folder = folder_with_picture();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("deep")).unwrap();
    symlink("deep/file", at("link")).unwrap();
    for writer in WRITERS {
        folder.write("deep/file", "old");
        std::fs::set_permissions(at("deep/file"), PermissionsExt::from_mode(0o640)).unwrap();
        let run = folder.run(&of(writer, "link"));
        assert_eq!(run.status, 0, "{writer}: {}", run.stderr);
        assert!(at("link").is_symlink(), "{writer}");
        assert_ne!(folder.read("deep/file"), b"old", "{writer}");
        let mode = at("deep/file").metadata().unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640, "{writer}");
        // And the same through a pipe, without the report; a time in it differs.
        if !writer.starts_with("build") && !writer.contains("--plan") {
            let script = format!("\"$0\" {} 2>report | cat >piped", of(writer, "/dev/stdout"));
            let (status, ..) = in_shell(&folder, &script);
            let same = folder.read("piped") == folder.read("deep/file");
            assert!(status == 0 && (same || writer.contains("heat-map")), "{writer}");
        }
    }
    for (mask, mode) in [("077", 0o600), ("022", 0o644), ("002", 0o664)] {
        let (status, ..) =
            in_shell(&folder, &format!("umask {mask}; \"$0\" build --resolution 2 -o {mask}"));
        assert_eq!(status, 0);
        assert_eq!(at(mask).metadata().unwrap().permissions().mode() & 0o777, mode);
    }
}

#[test]
fn a_file_in_standard_output_is_alone_there_and_keeps_what_was_there() {
    let folder = folder_with_cube();
    folder.done("export cube a.csv");
    folder.write("log", "before\n");
    let script = "\"$0\" export cube /dev/stdout --format csv >> log";
    let (status, _, stderr) = in_shell(&folder, script);
    assert_eq!(status, 0);
    assert!(stderr.contains("format:  csv"), "{stderr}");
    let expected = [&b"before\n"[..], &folder.read("a.csv")].concat();
    assert!(folder.read("log") == expected);
    // A reader that has seen enough is no failure.
    let script = "\"$0\" export cube /dev/stdout --format html 2>err | true; cat err";
    assert_eq!(in_shell(&folder, script).1, "");
    let line = folder.refused(1, "export cube /dev/null --format wgsl");
    let expected = "/dev/null: a device or pipe, expected a file, beside which others are written";
    assert_eq!(line, expected);
}

#[test]
fn a_standard_error_that_cannot_be_written_costs_only_its_text() {
    let folder = folder_with_cube();
    for (script, status) in [
        // With a warning.
        ("\"$0\" export cube a.coeff --resolution 2 2>/dev/full", 0),
        ("\"$0\" export cube a.coeff --resolution 2 2>&-", 0),
        ("\"$0\" inspect none 2>/dev/full", 1),
        ("\"$0\" inspect --none 2>/dev/full", 2),
        ("\"$0\" export cube /dev/stdout --format csv 2>/dev/full >b.csv", 0),
    ] {
        assert_eq!(in_shell(&folder, script).0, status, "{script}");
        assert!(status != 0 || folder.names().len() > 1, "{script}");
        let _ = std::fs::remove_file(folder.path().join("a.coeff"));
    }
    folder.done("export cube a.csv");
    assert!(folder.read("a.csv") == folder.read("b.csv"));
}

#[test]
fn two_writers_of_one_shader_end_with_source_and_textures_of_one() {
    /// Often enough that runs overlap in their last moments, where the names change.
    const ROUNDS: usize = 40;
    let folder = Folder::new();
    let cubes = ["one", "two"];
    for (cube, resolution) in cubes.into_iter().zip([3, 4]) {
        folder.done(&format!("build --resolution {resolution} -o {cube}"));
        folder.done(&format!("export {cube} {cube}.wgsl"));
    }
    let textures = cubes.map(|cube| folder.read(&format!("{cube}.textures")));
    let mut winners = [0; 2];
    for _ in 0..ROUNDS {
        let runs = cubes.map(|cube| {
            Command::new(program())
                .args(["export", cube, "sky.wgsl"])
                .current_dir(folder.path())
                .stdout(Stdio::null())
                .spawn()
                .unwrap()
        });
        for mut run in runs {
            assert!(run.wait().unwrap().success());
        }
        let source = String::from_utf8(folder.read("sky.wgsl")).unwrap();
        let found = folder.read("sky.textures");
        let winner = textures.iter().position(|textures| *textures == found).unwrap();
        let checksum = u64::from_le_bytes(found[32..40].try_into().unwrap());
        assert!(source.contains(&format!("checksum {checksum:016x}.")), "{winners:?}");
        winners[winner] += 1;
    }
    println!("last: {winners:?}");
}

#[test]
fn the_temporary_files_of_killed_runs_are_removed_by_the_next_and_no_others() {
    const PATIENCE: Duration = Duration::from_secs(60);
    let folder = folder_with_picture();
    let temporary = || -> Vec<String> {
        folder.names().into_iter().filter(|name| name.starts_with(".upglow-")).collect()
    };
    let bake = |output: &str| {
        let before = temporary();
        // Tens of seconds of work.
        let run = Command::new(program())
            .args([
                "bake",
                "cube",
                "cube.exr",
                "--as",
                "spectral",
                "--bands",
                "300:830:5",
                "-o",
                output,
            ])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while temporary().iter().all(|name| before.contains(name)) {
            assert!(start.elapsed() < PATIENCE, "the program does not start");
            std::thread::sleep(Duration::from_millis(5));
        }
        // It has looked at the folder by then.
        std::thread::sleep(Duration::from_millis(300));
        run
    };
    let mut killed = bake("a.exr");
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(temporary().len(), 1, "a run that is killed cannot clean up");
    let mut alive = bake("b.exr");
    let of_alive = temporary();
    assert_eq!(of_alive.len(), 1, "the next run removes it");
    folder.done("export cube a.csv");
    assert_eq!(temporary(), of_alive, "that of a run at work stays");
    alive.kill().unwrap();
    alive.wait().unwrap();
    folder.done("export cube a.csv");
    assert!(temporary().is_empty());
}
