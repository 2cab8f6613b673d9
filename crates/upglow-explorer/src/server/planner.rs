//! Options of builds, which the program's command line defines.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::Serialize;
use upglow::{DyeSet, Model};
use upglow_color::{Contract, Illuminant, Observer};
use upglow_fit::FitOptions;

use super::answer::Refusal;
use super::drops::Drops;

/// A cube to build.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What RGB means.
    pub contract: Contract,
    /// What fluoresces, and by what rules.
    pub model: Model,
    /// How materials are fitted.
    pub options: FitOptions,
    /// Nodes along each axis.
    pub resolution: usize,
}

/// An option of builds, as the program's help describes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuildOption {
    /// With its dashes: `--preset`.
    pub name: String,
    /// The heading that it stands under.
    pub heading: String,
    /// What it does.
    pub help: String,
    /// The value it has when it is not given, if that does not depend on others.
    pub default: Option<String>,
    /// Its values, if they are words.
    pub words: Vec<String>,
    /// Whether it has a value.
    pub has_value: bool,
}

/// Makes a plan of options and their values.
pub type PlanOf = Box<dyn Fn(&BTreeMap<String, String>) -> Result<Plan, String> + Send + Sync>;

/// Understands the options of builds.
pub struct Planner {
    /// The options that it understands.
    pub options: Vec<BuildOption>,
    /// Makes a plan of options and their values, or says in one line what is wrong.
    pub plan: PlanOf,
}

impl fmt::Debug for Planner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Planner").field("options", &self.options).finish_non_exhaustive()
    }
}

/// Nodes along each axis: beyond the greatest a build takes minutes, and the page much memory.
pub(super) const RESOLUTIONS: [usize; 2] = [2, 64];

/// Whether a name is built in, or the library's refusal of it.
type Known = fn(&str) -> Result<(), String>;

/// Options whose values the command line also takes as paths. From the page only built-in names come
/// through, and what it has dropped, whose paths the server knows.
const FROM_FILES: [(&str, Known); 3] = [
    ("--illuminant", |name| Illuminant::named(name).map(drop).map_err(|e| e.to_string())),
    ("--observer", |name| Observer::named(name).map(drop).map_err(|e| e.to_string())),
    ("--dyes", |name| DyeSet::named(name).map(drop).map_err(|e| e.to_string())),
];

impl Planner {
    /// The plan of options that come from the page, and the command line that builds the same.
    pub(super) fn checked(
        &self,
        given: &BTreeMap<String, String>,
        drops: &Drops,
    ) -> Result<(Plan, String), Refusal> {
        let _unchanged = drops.unchanged();
        let (mut known, mut typed) = (given.clone(), given.clone());
        for (name, value) in given {
            if !self.options.iter().any(|option| option.name == *name) {
                let known: Vec<&str> = self.options.iter().map(|o| o.name.as_str()).collect();
                let error = format!("{name:?}, expected an option of {}", known.join(", "));
                return Err(Refusal::bad(error));
            }
            if let Some((_, check)) = FROM_FILES.iter().find(|(option, _)| option == name) {
                if let Some(path) = drops.path_of(name, value)? {
                    let file = Path::new(&path).file_name().unwrap_or_default();
                    typed.insert(name.clone(), file.to_string_lossy().into_owned());
                    known.insert(name.clone(), path);
                } else {
                    check(value).map_err(|error| Refusal::bad(format!("{name}: {error}")))?;
                }
            }
        }
        let plan = (self.plan)(&known).map_err(Refusal::bad)?;
        let [least, most] = RESOLUTIONS;
        if !(least..=most).contains(&plan.resolution) {
            let found = plan.resolution;
            let error =
                format!("--resolution: {found}, expected {least} to {most} in the explorer");
            return Err(Refusal::bad(error));
        }
        Ok((plan, command_line(&typed)))
    }
}

/// The words to type.
fn command_line(given: &BTreeMap<String, String>) -> String {
    let words = given.iter().flat_map(|(name, value)| [name.as_str(), value.as_str()]);
    let words = words.filter(|word| !word.is_empty()).map(quoted);
    let line = ["upglow build -o cube.safetensors".to_owned()].into_iter().chain(words);
    line.collect::<Vec<_>>().join(" ")
}

/// A word as shells take it for one.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.,:/=".contains(c);
    if word.chars().all(is_plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
