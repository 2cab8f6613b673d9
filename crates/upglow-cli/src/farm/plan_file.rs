//! The file of a plan: one JSON document, with a line for the head and one for each task.
//!
//! A plan may have millions of tasks, so it is neither written nor read as a whole. The lines of tasks are in the
//! order of their numbers, and a line break occurs nowhere else, because JSON escapes those in texts. A task is
//! therefore found by bisection: read the number of the line behind the middle, go on in one half.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use upglow::{Aside, open_input};
use upglow_image::Hash;
use upglow_terminal::{Failure, escaped};

use crate::files::{note_input, unwritten};

/// Changes with the meaning of the file.
const VERSION: u32 = 1;
/// The version of this program: other versions may make other files.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");
/// The longest line that is read: the names of a task may have thousands of letters, but not millions.
const MOST_LINE_BYTES: u64 = 1 << 20;
/// What each line of a task begins with.
const TASK: &str = "{\"task\":";

/// What all tasks have in common.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Head {
    /// Version of this format.
    upglow_plan: u32,
    /// Version of the program.
    program: String,
    /// The folder in which all names are valid, from that of the plan.
    pub(crate) folder: String,
    pub(crate) cube: CubeFile,
    /// Options of `upglow bake`.
    pub(crate) options: Vec<String>,
    /// A hash of cube, form and options for each file of a task.
    pub(crate) bakers: Vec<Hash>,
    /// Number of tasks.
    pub(crate) count: usize,
}

/// A cube of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CubeFile {
    pub(crate) file: String,
    pub(crate) sha256: Hash,
}

/// A picture to bake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Task {
    /// From 1 on.
    pub(crate) task: usize,
    pub(crate) picture: String,
    pub(crate) sha256: Hash,
    /// What the time of the task is proportional to.
    pub(crate) texels: usize,
    /// The files to write.
    pub(crate) files: Vec<String>,
}

impl Head {
    pub(crate) fn new(
        folder: String,
        cube: CubeFile,
        options: Vec<String>,
        bakers: Vec<Hash>,
        count: usize,
    ) -> Self {
        Self { upglow_plan: VERSION, program: PROGRAM.into(), folder, cube, options, bakers, count }
    }
}

/// A plan that is being written. It appears when it is complete.
#[derive(Debug)]
pub(crate) struct PlanWriter {
    file: Aside,
    path: PathBuf,
    is_first: bool,
}

impl PlanWriter {
    pub(crate) fn create(path: &Path, head: &Head) -> Result<Self, Failure> {
        let file = Aside::create(path).map_err(|error| unwritten(path, &error))?;
        let mut writer = Self { file, path: path.to_owned(), is_first: true };
        let head = escaped(&serde_json::to_string(head).expect("texts and numbers are JSON"));
        let open = head.strip_suffix('}').expect("the head is an object");
        writer.write(&format!("{open},\"tasks\":["))?;
        Ok(writer)
    }

    pub(crate) fn add(&mut self, task: &Task) -> Result<(), Failure> {
        let comma = if std::mem::take(&mut self.is_first) { "" } else { "," };
        let task = escaped(&serde_json::to_string(task).expect("texts and numbers are JSON"));
        self.write(&format!("{comma}\n{task}"))
    }

    /// Completes the file; returns its size in bytes.
    pub(crate) fn finish(mut self) -> Result<u64, Failure> {
        self.write("\n]}\n")?;
        let Self { file, path, .. } = self;
        file.commit().map_err(|error| unwritten(&path, &error))
    }

    fn write(&mut self, text: &str) -> Result<(), Failure> {
        self.file.write_all(text.as_bytes()).map_err(|error| unwritten(&self.path, &error))
    }
}

/// A plan whose tasks are read one by one.
#[derive(Debug)]
pub(crate) struct PlanFile {
    file: BufReader<File>,
    pub(crate) path: PathBuf,
    pub(crate) head: Head,
    /// Where the lines of the tasks begin and the file ends.
    tasks: [u64; 2],
    /// The number of the task on the next line.
    next: usize,
}

const A_PLAN: &str = "a plan made by `upglow bake --plan`";

impl PlanFile {
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let failed = |error: io::Error| Failure::system(path, &error, A_PLAN);
        note_input(path)?;
        let file = open_input(path).map_err(failed)?;
        let end = file.metadata().map_err(failed)?.len();
        let mut file = BufReader::new(file);
        let line = line(&mut file).map_err(failed)?;
        let head = head(&line).map_err(|message| Failure::file(path, message))?;
        let tasks = [line.len() as u64, end];
        Ok(Self { file, path: path.to_owned(), head, tasks, next: 1 })
    }

    /// The task with this number, which the plan must have.
    pub(crate) fn task(&mut self, number: usize) -> Result<Task, Failure> {
        let found = if number == self.next { self.read() } else { self.find(number) };
        let failed = |error: io::Error| Failure::system(&self.path, &error, A_PLAN);
        let line = found.map_err(failed)?;
        let text = line.trim_ascii_end();
        match serde_json::from_slice::<Task>(text.strip_suffix(b",").unwrap_or(text)) {
            Ok(task) if task.task == number && task.files.len() == self.head.bakers.len() => {
                self.next = number + 1;
                Ok(task)
            }
            _ => {
                let message = format!("no line of task {number}, expected {A_PLAN}, unchanged");
                Err(Failure::file(&self.path, message))
            }
        }
    }

    /// What the file of a task is stated to be made from.
    pub(crate) fn hash(&self, task: &Task, file: usize) -> Hash {
        self.head.bakers[file].with_picture(&task.sha256)
    }

    /// The next line.
    fn read(&mut self) -> io::Result<Vec<u8>> {
        line(&mut self.file)
    }

    /// The line of the task with this number, or that of another if the file is damaged.
    fn find(&mut self, number: usize) -> io::Result<Vec<u8>> {
        /// So many bytes are read in one piece anyway.
        const CLOSE: u64 = 1 << 13;
        // The lines that begin before the first have no greater number, those from the second on have.
        let [mut low, mut high] = self.tasks;
        while high - low > CLOSE {
            let middle = u64::midpoint(low, high);
            self.file.seek(SeekFrom::Start(middle))?;
            let begin = middle + self.read()?.len() as u64;
            let found = numbered(&self.read()?);
            if begin < high && found.is_some_and(|found| found <= number) {
                low = begin;
            } else {
                high = middle;
            }
        }
        self.file.seek(SeekFrom::Start(low))?;
        loop {
            let line = self.read()?;
            if numbered(&line).is_none_or(|found| found >= number) {
                return Ok(line);
            }
        }
    }
}

/// The next line with its break; empty at the end. Not text, because a search begins amid a line, even amid a letter.
fn line(file: &mut BufReader<File>) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    file.take(MOST_LINE_BYTES).read_until(b'\n', &mut line)?;
    Ok(line)
}

/// The number of the task on a line.
fn numbered(line: &[u8]) -> Option<usize> {
    let rest = line.strip_prefix(TASK.as_bytes())?;
    let end = rest.iter().position(|&byte| byte == b',')?;
    std::str::from_utf8(&rest[..end]).ok()?.parse().ok()
}

/// The head on the first line.
fn head(line: &[u8]) -> Result<Head, String> {
    #[derive(Deserialize)]
    struct Version {
        upglow_plan: u32,
    }
    let no_plan = |_| format!("no plan, expected {A_PLAN}");
    let text = String::from_utf8_lossy(line.trim_ascii_end()) + "]}";
    let Version { upglow_plan: found } = serde_json::from_str(&text).map_err(no_plan)?;
    if found != VERSION {
        return Err(format!("a plan of version {found}, expected {VERSION}; make the plan again"));
    }
    let head: Head = serde_json::from_str(&text).map_err(no_plan)?;
    if head.program != PROGRAM {
        let found = &head.program;
        let message = format!("a plan of upglow {found}, expected {PROGRAM}");
        return Err(message + "; make the plan again, or run it with that version");
    }
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(number: usize) -> Task {
        // Names of many lengths, with what JSON escapes and what has several bytes.
        let picture = format!("{}\n\"ß{number}.png", "x".repeat(number * 37 % 400));
        Task {
            task: number,
            sha256: Hash::of(picture.as_bytes()),
            texels: number * number,
            files: vec![format!("{picture}.exr")],
            picture,
        }
    }

    fn plan(path: &Path, count: usize) {
        let cube = CubeFile { file: "c".into(), sha256: Hash::of(b"c") };
        let options = vec!["--output=out".to_owned()];
        let head = Head::new(".".into(), cube, options, vec![Hash::of(b"b")], count);
        let mut writer = PlanWriter::create(path, &head).unwrap();
        (1..=count).for_each(|number| writer.add(&task(number)).unwrap());
        writer.finish().unwrap();
    }

    #[test]
    fn each_task_is_found_in_any_order_and_the_whole_is_json() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.json");
        for count in [1, 2, 3, 100, 3000] {
            plan(&path, count);
            let mut file = PlanFile::open(&path).unwrap();
            let scattered = (0..count).map(|i| i * 1_000_003 % count + 1);
            for number in (1..=count).chain(scattered) {
                assert_eq!(file.task(number), Ok(task(number)), "{count}");
            }
            for number in [0, count + 1, usize::MAX] {
                assert!(file.task(number).is_err(), "{count}");
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let whole: serde_json::Value = serde_json::from_str(&text).unwrap();
            assert_eq!(whole["tasks"].as_array().map(Vec::len), Some(count));
        }
    }

    #[test]
    fn a_damaged_plan_is_refused_and_never_mistaken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.json");
        plan(&path, 500);
        let whole = std::fs::read(&path).unwrap();
        for cut in (0..whole.len()).step_by(997) {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let Ok(mut file) = PlanFile::open(&path) else { continue };
            for number in [1, 77, 250, 500] {
                assert!(file.task(number).is_err() || file.task(number) == Ok(task(number)));
            }
        }
        for content in ["", "\n", "{}", "[]", "{\"upglow_plan\":1,\"tasks\":[\n]}", "\u{0}\u{1}"] {
            std::fs::write(&path, content).unwrap();
            let refused = PlanFile::open(&path).unwrap_err().to_string();
            let line = format!("{}: no plan, expected {A_PLAN}", path.display());
            assert_eq!(refused, line, "{content}");
        }
    }
}
