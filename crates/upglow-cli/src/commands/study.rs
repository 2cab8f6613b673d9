//! What `figures` and `reproduce` share.

use upglow_fit::BuildError;
use upglow_study::StudyError;

use crate::failure::Failure;

/// Why there is no study.
pub(crate) fn study_failure(error: StudyError) -> Failure {
    match error {
        StudyError::Build(BuildError::Stopped) => Failure::Stopped,
        StudyError::Build(BuildError::Cube(error)) => Failure::option("--resolution", error),
        error => Failure::input("study", error),
    }
}
