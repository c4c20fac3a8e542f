//! What the files of a study are known by.
use std::path::Path;

use serde::Serialize;

use super::list::read_runs;
use super::record::{Record, Shared};
use super::study::Study;
use crate::StudyError;

/// Something that is kept as a list of runs, a table and a page.
pub(crate) trait Filed {
    /// A line of the list, a row of the table.
    type Line: Clone + PartialEq + Serialize;

    /// What it is called in errors: `an octree study`.
    const KIND: &'static str;
    /// The title of its page, by which the page is known again.
    const TITLE: &'static str;
    /// The file of its page.
    const PAGE: &'static str;
    /// The first value of every row of its table.
    const STUDY: &'static str;

    /// Reads a list of runs, every line checked.
    ///
    /// # Errors
    /// [`StudyError::Io`], or [`StudyError::Record`] with the first line that is no run of this study.
    fn read(list: &Path) -> Result<Vec<Self::Line>, StudyError>;

    /// A run without what is too long for a table.
    fn for_table(line: &Self::Line) -> Self::Line;
}

impl<S: Study> Filed for S {
    type Line = S::Run;

    const KIND: &'static str = <S as Study>::KIND;
    const TITLE: &'static str = <S as Study>::TITLE;
    const PAGE: &'static str = <S as Study>::PAGE;
    const STUDY: &'static str = S::Run::STUDY;

    fn read(list: &Path) -> Result<Vec<S::Run>, StudyError> {
        read_runs(list)
    }

    fn for_table(line: &S::Run) -> S::Run {
        Shared::for_table(line)
    }
}
