//! Work that a farm does in tasks: plans of `upglow bake`, and job templates of other programs that run them.

mod plan_file;
mod task_numbers;
mod template;

pub(crate) use plan_file::{CubeFile, Head, PlanFile, PlanWriter, Task};
pub(crate) use task_numbers::TaskNumbers;
pub(crate) use template::Template;
