//! `upglow bake --task`: does tasks of a plan.

use std::path::{Path, PathBuf};

use upglow_image::Hash;
use upglow_terminal::{Console, Failure};

use super::bake::{Recipe, Work, make_folder_of};
use super::bake_plan;
use crate::args::{Args, BakeArgs, Command};
use crate::batch::Batch;
use crate::farm::{PlanFile, Task, TaskNumbers};
use crate::files;

pub(super) fn run(args: &BakeArgs, tasks: &TaskNumbers, console: &Console) -> Result<(), Failure> {
    if let Some(option) = bake_plan::options().first() {
        let message = format!("given with {option}, expected no option that the plan has");
        return Err(Failure::option("--task", message));
    }
    let mut plan = open(&args.cube, tasks)?;
    let mut planned = bake_args(&plan)?;
    planned.threads = args.threads;
    let recipe = Recipe::new(&planned)?;
    check_hash(&planned.cube, &plan.head.cube.sha256)?;
    let cube = files::read_cube(&planned.cube)?;
    let work = Work::new(&planned, &recipe, &cube)?;
    if !work.bakers.iter().map(|baker| baker.hash()).eq(&plan.head.bakers) {
        let message =
            "a light of its options has changed since, expected the same; make the plan again";
        return Err(Failure::file(&args.cube, message));
    }
    let mut batch = Batch::new("baked", tasks.count(), &[]);
    let ended = tasks.iter().try_for_each(|number| {
        let task = plan.task(number)?;
        let picture = Path::new(&task.picture);
        let outputs: Vec<PathBuf> = task.files.iter().map(PathBuf::from).collect();
        let made: Vec<bool> = (0..outputs.len()).map(|i| is_made(&plan, &task, i)).collect();
        let check = || {
            check_hash(picture, &task.sha256)?;
            files::note_input(picture)?;
            for (output, _) in outputs.iter().zip(&made).filter(|(_, made)| !**made) {
                make_folder_of(output)?;
                files::check_output(output)?;
            }
            Ok(())
        };
        match check() {
            Ok(()) => work.bake(picture, &outputs, |i| made[i], &mut batch, console),
            Err(failure) => batch.add_failure(picture, failure),
        }
    });
    batch.finish(console, ended)
}

/// Opens a plan for these tasks, and enters the folder in which its names are valid.
pub(super) fn open(path: &Path, tasks: &TaskNumbers) -> Result<PlanFile, Failure> {
    let plan = PlanFile::open(path)?;
    tasks.check(path, plan.head.count)?;
    let folder = path.parent().unwrap_or(Path::new("")).join(&plan.head.folder);
    std::env::set_current_dir(&folder).map_err(|error| {
        Failure::system(&folder, &error, "the folder in which the plan was made")
    })?;
    Ok(plan)
}

/// What was typed when the plan was made, but for the pictures.
pub(super) fn bake_args(plan: &PlanFile) -> Result<BakeArgs, Failure> {
    let words = ["upglow", "bake"].into_iter().map(str::to_owned);
    let options = plan.head.options.iter().cloned();
    let names = ["--", &plan.head.cube.file, "pictures"].into_iter().map(str::to_owned);
    match upglow_terminal::parse::<Args>(words.chain(options).chain(names)) {
        Ok(Args { command: Command::Bake(args), .. }) => Ok(*args),
        Ok(_) => unreachable!("the second word is bake"),
        Err(failure) => Err(Failure::file(&plan.path, format!("options: {failure}"))),
    }
}

/// Whether a file of a task is made from what the plan says.
pub(super) fn is_made(plan: &PlanFile, task: &Task, file: usize) -> bool {
    Hash::stated(&task.files[file]).is_some_and(|stated| stated == plan.hash(task, file))
}

fn check_hash(path: &Path, planned: &Hash) -> Result<(), Failure> {
    let found = files::hash(path)?;
    if found == *planned {
        return Ok(());
    }
    let message =
        format!("changed since the plan: SHA-256 {found}, expected {planned}; make the plan again");
    Err(Failure::file(path, message))
}
