//! The files of a study: `runs.jsonl`, a line per run; `runs.csv`, the same without pictures and single frames; its
//! page.
//!
//! Runs are appended to `runs.jsonl.part` as they are measured; a lock keeps other studies from it. When the study is
//! over, page and table are written beside their places, and then all take their names. What an earlier study left,
//! or one that was cut short, is kept as `runs.previous-1.jsonl` and so on. Files that are of no study stay as they
//! are: they are an error. A study that comes to nothing, be it for want of space, leaves nothing.
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Write as _};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::filed::Filed;
use crate::StudyError;

/// Records, a JSON object per line.
pub const RUNS: &str = "runs.jsonl";
/// The records as a table.
pub const TABLE: &str = "runs.csv";
const PART: &str = "runs.jsonl.part";
/// How every table of a study begins, whatever columns follow.
const TABLE_BEGIN: &str = "study,format,sweep,";
/// Bytes at the beginning of a file that say what it is: more than the head of a table.
const BEGIN_BYTES: u64 = 4000;

/// A folder that a study is being written to. It goes again in the end if it was made for the study and nothing is in it.
pub(crate) struct Folder<S: Filed> {
    path: PathBuf,
    /// What of its path was missing, the innermost first.
    made: Vec<PathBuf>,
    study: PhantomData<S>,
}

impl<S: Filed> Folder<S> {
    /// Makes the folder if it is missing, and finds out whether files can be made in it and whether those that are
    /// there may be replaced.
    pub(crate) fn open(path: &Path) -> Result<Self, StudyError> {
        let missing = path.ancestors().filter(|place| !place.as_os_str().is_empty() && !place.exists());
        let made = missing.map(Path::to_owned).collect();
        let folder = Self { path: path.to_owned(), made, study: PhantomData };
        if let Some(file) = path.ancestors().find(|place| place.is_file()) {
            return Err(StudyError::NotAFolder(file.to_owned()));
        }
        fs::create_dir_all(path).map_err(|source| folder.error("", source))?;
        new_file(path).map_err(|source| folder.error("", source))?;
        for name in [RUNS, TABLE, S::PAGE, PART] {
            if path.join(name).is_dir() {
                return Err(folder.error(name, io::Error::from(io::ErrorKind::IsADirectory)));
            }
        }
        let is_of_study = S::read(&path.join(RUNS)).is_ok();
        let title = format!("<title>{}</title>", S::TITLE);
        let row = format!("\n{},", S::STUDY);
        for (name, marks) in [(TABLE, [TABLE_BEGIN, row.as_str()]), (S::PAGE, [title.as_str(), ""])] {
            let file = path.join(name);
            if !is_of_study && file.exists() && !begins_with(&file, &marks) {
                return Err(StudyError::Foreign { file, study: S::KIND });
            }
        }
        Ok(folder)
    }

    /// Begins a list of runs. Records that are there already must be those of the same study: nobody else's file of
    /// that name is touched.
    pub(crate) fn begin_runs(&self) -> Result<RunsFile<'_, S>, StudyError> {
        let there = self.path.join(RUNS);
        if there.exists() {
            S::read(&there)?;
        }
        let mut file = self.lock_part()?;
        if file.metadata().map_err(|source| self.error(PART, source))?.len() > 0 {
            self.keep(PART)?;
            file = self.lock_part()?;
        }
        Ok(RunsFile { folder: self, file })
    }

    /// Goes on with what a study that was cut short left, if `is_same` holds for all of it; else begins anew as
    /// [`Folder::begin_runs`] does.
    pub(crate) fn resume_runs(
        &self,
        is_same: impl Fn(&S::Line) -> bool,
    ) -> Result<(RunsFile<'_, S>, Vec<S::Line>), StudyError> {
        let file = self.lock_part()?;
        let left = S::read(&self.path.join(PART)).unwrap_or_default();
        if left.is_empty() || !left.iter().all(is_same) {
            drop(file);
            return Ok((self.begin_runs()?, Vec::new()));
        }
        Ok((RunsFile { folder: self, file }, left))
    }

    /// Opens the growing list for this study alone.
    fn lock_part(&self) -> Result<File, StudyError> {
        let file = OpenOptions::new().create(true).append(true).open(self.path.join(PART));
        let file = file.map_err(|source| self.error(PART, source))?;
        match file.try_lock() {
            Ok(()) => Ok(file),
            Err(TryLockError::WouldBlock) => Err(StudyError::Busy(self.path.clone())),
            Err(TryLockError::Error(source)) => Err(self.error(PART, source)),
        }
    }

    /// Writes page and table, both or none.
    pub(crate) fn write(&self, runs: &[S::Line], page: &str) -> Result<[PathBuf; 2], StudyError> {
        let (page, table) = (self.beside(S::PAGE, page.as_bytes())?, self.beside(TABLE, &self.table(runs)?)?);
        Ok([self.place(page, S::PAGE)?, self.place(table, TABLE)?])
    }

    fn table(&self, runs: &[S::Line]) -> Result<Vec<u8>, StudyError> {
        let mut table = csv::Writer::from_writer(Vec::new());
        for run in runs {
            table.serialize(S::for_table(run))?;
        }
        table.into_inner().map_err(|error| self.error(TABLE, error.into_error()))
    }

    /// A new file in the folder, which goes away unless it is placed.
    fn beside(&self, name: &str, bytes: &[u8]) -> Result<NamedTempFile, StudyError> {
        let write = || {
            let mut file = new_file(&self.path)?;
            // Through the file itself: an error of the other names a file that nobody has heard of.
            file.as_file_mut().write_all(bytes)?;
            file.as_file().sync_all()?;
            Ok(file)
        };
        write().map_err(|source| self.error(name, source))
    }

    fn place(&self, file: NamedTempFile, name: &str) -> Result<PathBuf, StudyError> {
        let to = self.path.join(name);
        file.persist(&to).map_err(|error| self.error(name, error.error))?;
        Ok(to)
    }

    /// Gives a list of runs the first name of earlier lists that is free.
    fn keep(&self, name: &str) -> Result<(), StudyError> {
        let backup = |number: u64| self.path.join(format!("runs.previous-{number}.jsonl"));
        let mut number = 1;
        while backup(number).symlink_metadata().is_ok() {
            number += 1;
        }
        let to = backup(number);
        fs::rename(self.path.join(name), &to).map_err(|source| StudyError::Write { path: to, source })
    }

    fn error(&self, name: &str, source: io::Error) -> StudyError {
        let path = if name.is_empty() { self.path.clone() } else { self.path.join(name) };
        StudyError::Write { path, source }
    }
}

impl<S: Filed> Drop for Folder<S> {
    fn drop(&mut self) {
        for made in &self.made {
            // A folder that holds something stays.
            _ = fs::remove_dir(made);
        }
    }
}

/// Appends bytes; a file that cannot take all of them is as long as before.
fn append_whole(file: &mut File, bytes: &[u8]) -> io::Result<()> {
    let before = file.metadata()?.len();
    file.write_all(bytes).inspect_err(|_| {
        // What the disk refuses now as well stays as the end that was cut off.
        _ = file.set_len(before);
    })
}

/// A file that others may read as far as the user's umask allows; temporary files are private by default.
fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".luxel-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// True if marks stand at the beginning of a file, or not far from it.
fn begins_with(path: &Path, marks: &[&str]) -> bool {
    let mut begin = Vec::new();
    let read = File::open(path).and_then(|file| file.take(BEGIN_BYTES).read_to_end(&mut begin));
    let begin = String::from_utf8_lossy(&begin);
    read.is_ok() && marks.iter().all(|mark| begin.contains(mark))
}

/// The list of runs as it grows.
pub(crate) struct RunsFile<'a, S: Filed> {
    folder: &'a Folder<S>,
    file: File,
}

impl<S: Filed> RunsFile<'_, S> {
    /// Appends a run, all of it or nothing.
    pub(crate) fn append(&mut self, run: &S::Line) -> Result<(), StudyError> {
        let line = serde_json::to_string(run)? + "\n";
        append_whole(&mut self.file, line.as_bytes()).map_err(|source| self.folder.error(PART, source))
    }

    /// Removes it: nothing was measured.
    pub(crate) fn discard(self) -> Result<(), StudyError> {
        let Self { folder, file: _open } = self;
        fs::remove_file(folder.path.join(PART)).map_err(|source| folder.error(PART, source))
    }

    /// Writes page and table, and gives all three their names.
    pub(crate) fn finish(self, runs: &[S::Line], page: &str) -> Result<[PathBuf; 3], StudyError> {
        let Self { folder, file } = self;
        file.sync_all().map_err(|source| folder.error(PART, source))?;
        let [page, table] = folder.write(runs, page)?;
        let list = folder.path.join(RUNS);
        if list.exists() {
            folder.keep(RUNS)?;
        }
        fs::rename(folder.path.join(PART), &list).map_err(|source| folder.error(RUNS, source))?;
        Ok([page, list, table])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::{OctreeStudy, read_runs};
    use crate::octree::{PAGE, Run, example, page};

    fn make(store: &Folder<OctreeStudy>, runs: &[Run]) -> [PathBuf; 3] {
        let mut file = store.begin_runs().unwrap();
        runs.iter().for_each(|run| file.append(run).unwrap());
        file.finish(runs, "page").unwrap()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn runs_come_back_from_both_files() {
        let folder = tempfile::tempdir().unwrap();
        let store = Folder::<OctreeStudy>::open(folder.path()).unwrap();
        let frames_ms = vec![10.0; 51];
        let runs = [
            Run { frames_ms, ..example() },
            Run { wrong_pixels: Some(0.25), wrong_rays: Some(0.5), noise: None, spheres: 7, ..example() },
        ];
        let [_, list, table] = make(&store, &runs);
        assert_eq!(read_runs(&list).unwrap(), runs);
        let rows: Vec<Run> =
            csv::Reader::from_path(table).unwrap().deserialize().map(Result::unwrap).collect();
        assert_eq!(rows, runs.map(|run| Run { frames_ms: Vec::new(), ..run }));
    }

    #[test]
    fn every_study_before_is_kept_and_what_one_that_was_cut_short_left() {
        let folder = tempfile::tempdir().unwrap();
        let store = Folder::<OctreeStudy>::open(folder.path()).unwrap();
        for spheres in 1..=3 {
            make(&store, &[Run { spheres, ..example() }]);
        }
        let mut cut = store.begin_runs().unwrap();
        cut.append(&Run { spheres: 4, ..example() }).unwrap();
        drop(cut);
        make(&store, &[Run { spheres: 5, ..example() }]);
        let kept = (1..=4).map(|number| format!("runs.previous-{number}.jsonl"));
        let lists: Vec<String> = kept.chain([RUNS.to_owned()]).collect();
        let spheres = lists.iter().map(|name| read_runs(&folder.path().join(name)).unwrap()[0].spheres);
        assert_eq!(spheres.collect::<Vec<u32>>(), [1, 2, 4, 3, 5]);
        assert_eq!(names(folder.path()).len(), 7);
    }

    #[test]
    fn two_studies_do_not_share_a_list() {
        let folder = tempfile::tempdir().unwrap();
        let store = Folder::<OctreeStudy>::open(folder.path()).unwrap();
        let first = store.begin_runs().unwrap();
        assert!(matches!(store.begin_runs(), Err(StudyError::Busy(_))));
        first.discard().unwrap();
        assert!(names(folder.path()).is_empty());
        store.begin_runs().unwrap().discard().unwrap();
        assert!(folder.path().exists(), "a folder that was there before stays");
    }

    #[test]
    fn a_study_without_a_run_leaves_no_folder_behind() {
        let folder = tempfile::tempdir().unwrap();
        let open = || Folder::<OctreeStudy>::open(&folder.path().join("new/out")).unwrap();
        open().begin_runs().unwrap().discard().unwrap();
        assert!(names(folder.path()).is_empty());
        drop(open());
        assert!(names(folder.path()).is_empty());
        let store = open();
        let file = store.begin_runs().unwrap();
        fs::write(folder.path().join("new/notes"), "").unwrap();
        file.discard().unwrap();
        drop(store);
        assert_eq!(names(&folder.path().join("new")), ["notes"]);
    }

    #[test]
    fn files_of_something_else_are_left_alone() {
        for name in [TABLE, PAGE] {
            let folder = tempfile::tempdir().unwrap();
            let foreign = folder.path().join(name);
            fs::write(&foreign, "sales").unwrap();
            let message = Folder::<OctreeStudy>::open(folder.path()).err().unwrap().to_string();
            assert!(message.contains(name), "{message}");
            fs::write(folder.path().join(RUNS), serde_json::to_string(&example()).unwrap()).unwrap();
            Folder::<OctreeStudy>::open(folder.path()).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let store = Folder::<OctreeStudy>::open(folder.path()).unwrap();
        let list = folder.path().join(RUNS);
        fs::write(&list, "{\"study\":\"sales\"}\n").unwrap();
        assert!(matches!(store.begin_runs(), Err(StudyError::Record { line: 1, .. })));
        assert_eq!(fs::read_to_string(list).unwrap(), "{\"study\":\"sales\"}\n");
    }

    #[test]
    fn page_and_table_of_a_study_may_be_made_again() {
        let folder = tempfile::tempdir().unwrap();
        for _ in 0..2 {
            let store = Folder::<OctreeStudy>::open(folder.path()).unwrap();
            store.write(&[example()], &page(&[example()]).unwrap()).unwrap();
        }
        assert_eq!(names(folder.path()), [PAGE, TABLE]);
    }

    #[test]
    fn a_place_that_cannot_be_written_is_named_before_anything_is_measured() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        for path in [file.join("out"), file] {
            let message = Folder::<OctreeStudy>::open(&path).err().unwrap().to_string();
            assert!(message.ends_with("file is not a folder"), "{message}");
        }
        fs::create_dir_all(folder.path().join("out/octree.html")).unwrap();
        let message = Folder::<OctreeStudy>::open(&folder.path().join("out")).err().unwrap().to_string();
        assert!(message.contains("octree.html"), "{message}");
    }
}
