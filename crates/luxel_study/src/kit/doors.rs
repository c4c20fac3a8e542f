//! [`doors!`]: what a study offers to the outside, the same for each.

/// Declares how a study is measured, made again and read; its `Plan` and `Run` are to be in scope.
macro_rules! doors {
    ($study:ty) => {
        /// What a study left.
        pub type Studied = $crate::kit::Studied<Run>;

        /// Measures a plan and writes runs, table and page to a folder, which is made if it is missing, and goes again
        /// if there was no run.
        ///
        /// # Errors
        /// When the folder cannot be written, holds files of something else or is being written to, or when no backend
        /// of the plan works. What was measured before a backend failed stays in `runs.jsonl.part`.
        pub fn run(
            plan: &Plan,
            origin: &$crate::kit::origin::Origin,
            out: &std::path::Path,
            observer: &mut $crate::kit::StudyObserver<'_>,
        ) -> Result<Studied, $crate::StudyError> {
            $crate::kit::run::<$study>(&plan.0, origin, out, observer)
        }

        /// Makes table and page again from a list of runs.
        ///
        /// # Errors
        /// When the list cannot be read or has a damaged line, or the folder cannot be written or has files of
        /// something else.
        pub fn redo(list: &std::path::Path, out: &std::path::Path) -> Result<Studied, $crate::StudyError> {
            $crate::kit::redo::<$study>(list, out)
        }

        /// Reads the records of an earlier study.
        ///
        /// # Errors
        /// [`StudyError::Io`](crate::StudyError::Io), or [`StudyError::Record`](crate::StudyError::Record) with the
        /// first line that is no record of this study.
        pub fn read_runs(path: &std::path::Path) -> Result<Vec<Run>, $crate::StudyError> {
            $crate::kit::list::read_runs(path)
        }
    };
}
pub(crate) use doors;
