//! Templates of Open Job Description, which render managers run as jobs.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

/// Tasks that one worker does at a time. Fewer would spend more time on starting programs than on small pictures,
/// more would keep a worker of a short job idle; the specification allows 150.
const TASKS_TOGETHER: usize = 50;

/// Most pictures on the page of the check; browsers become slow with more.
const MOST_CHECKED: usize = 1000;
/// Bytes of the maps of these pictures, which are in memory together. Workers of farms have more.
const CHECKED_BYTES: usize = 4 << 30;
/// Bytes of the maps for each of their pixels, as measured, and the most pixels that they have.
const MAP_BYTES: usize = 35;
const MAP_PIXELS: usize = 1 << 20;

/// A template and the plan beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Template {
    pub(crate) path: PathBuf,
    pub(crate) plan: PathBuf,
}

impl Template {
    /// `walls.template.json` has the plan `walls.plan.json`; `None` for other names. A name with yaml in place of
    /// json does as well, because JSON is YAML.
    pub(crate) fn named(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy();
        let endings = [".template.json", ".template.yaml"];
        let stem = endings.iter().find_map(|ending| name.strip_suffix(ending))?;
        let plan = path.with_file_name(format!("{stem}.plan.json"));
        Some(Self { path: path.to_owned(), plan })
    }

    /// The text of the template of a plan with so many tasks and texels.
    ///
    /// # Source
    ///
    /// Open Job Description, template schemas 2023-09, with the extension `TASK_CHUNKING` of RFC 0001.
    pub(crate) fn text(&self, count: usize, texels: usize) -> String {
        let plan = self.plan.file_name().unwrap_or_default().to_string_lossy();
        let all = format!("1-{count}");
        let pixels = (texels / count.max(1)).clamp(1, MAP_PIXELS);
        let checked = (CHECKED_BYTES / (MAP_BYTES * pixels)).min(MOST_CHECKED).min(count);
        let file = |name: &str, flow: &str, default: &str, description: &str| {
            json!({
                "name": name, "type": "PATH", "objectType": "FILE", "dataFlow": flow,
                "default": default, "description": description,
            })
        };
        let template = json!({
            "specificationVersion": "jobtemplate-2023-09",
            "extensions": ["TASK_CHUNKING"],
            "name": "upglow bake",
            "parameterDefinitions": [
                file("Plan", "IN", &plan, "The plan, made by `upglow bake --plan`"),
                file("Page", "OUT", "check.html", "The report of `upglow check` on all pictures"),
                {
                    "name": "Upglow", "type": "STRING", "default": "upglow",
                    "description": "The program",
                },
                {
                    "name": "TasksTogether", "type": "INT", "default": TASKS_TOGETHER,
                    "minValue": 1, "maxValue": 150,
                    "description": "Pictures that one worker bakes at a time",
                },
                {
                    "name": "Checked", "type": "STRING",
                    "default": format!("1-{checked}"),
                    "description": "Tasks whose pictures are on the page",
                },
            ],
            "steps": [
                step("Bake", &all, None, &["bake"]),
                step("Lint", &all, Some("Bake"), &["lint"]),
                {
                    "name": "Check",
                    "script": action(&["check", "--output", "{{Param.Page}}"], "{{Param.Checked}}"),
                },
            ],
        });
        format!("{template:#}\n")
    }
}

/// A step over chunks of tasks.
fn step(name: &str, all: &str, after: Option<&str>, words: &[&str]) -> Value {
    let task = json!({
        "name": "Task", "type": "CHUNK[INT]", "range": all,
        "chunks": {
            "defaultTaskCount": "{{Param.TasksTogether}}", "rangeConstraint": "CONTIGUOUS",
        },
    });
    let mut step = json!({
        "name": name,
        "parameterSpace": { "taskParameterDefinitions": [task] },
        "script": action(words, "{{Task.Param.Task}}"),
    });
    if let Some(after) = after {
        step["dependencies"] = json!([{ "dependsOn": after }]);
    }
    step
}

/// A call of the program with tasks of the plan.
fn action(words: &[&str], tasks: &str) -> Value {
    let args = [words, &["--quiet", "--task", tasks, "{{Param.Plan}}"]].concat();
    json!({ "actions": { "onRun": { "command": "{{Param.Upglow}}", "args": args } } })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_the_template_names_the_plan() {
        let plan = |name: &str| Template::named(Path::new(name)).map(|template| template.plan);
        assert_eq!(plan("a/walls.template.json"), Some("a/walls.plan.json".into()));
        assert_eq!(plan("b.c.template.yaml"), Some("b.c.plan.json".into()));
        assert_eq!(plan("plan.json"), None);
    }

    #[test]
    fn the_page_has_as_many_pictures_as_fit_into_memory() {
        let template = Template::named(Path::new("a.template.json")).unwrap();
        let checked = |count: usize, side: usize| {
            let text = template.text(count, count * side * side);
            let template: Value = serde_json::from_str(&text).unwrap();
            template["parameterDefinitions"][4]["default"].as_str().map(str::to_owned)
        };
        assert_eq!(checked(3, 64).as_deref(), Some("1-3"));
        assert_eq!(checked(1_000_000, 64).as_deref(), Some("1-1000"));
        assert_eq!(checked(1_000_000, 8192), checked(1000, 1024));
        assert_eq!(checked(1000, 8192).as_deref(), Some("1-117"));
    }
}
