//! The files of a study: `runs.jsonl`, a line per run; `runs.csv`, the same without pictures; `octree.html`.
//!
//! Runs are appended to `runs.jsonl.part` as they are measured. When the study is over the file takes its name; a
//! study that was there before is kept as `runs.previous.jsonl`. Whatever else is in the folder stays as it is.
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use super::picture::is_png;
use super::record::{FORMAT, Run, STUDY};
use crate::StudyError;

/// Records, a JSON object per line.
pub const RUNS: &str = "runs.jsonl";
/// The records of the study that was there before.
pub const PREVIOUS_RUNS: &str = "runs.previous.jsonl";
/// The records as a table.
pub const TABLE: &str = "runs.csv";
/// The page.
pub const PAGE: &str = "octree.html";
const PART: &str = "runs.jsonl.part";

/// Reads the records of an earlier study.
///
/// # Errors
/// [`StudyError::Io`], or [`StudyError::Record`] with the first line that is no record of this study.
pub fn read_runs(path: &Path) -> Result<Vec<Run>, StudyError> {
    let text = fs::read_to_string(path).map_err(|source| StudyError::Io { path: path.to_owned(), source })?;
    let bad = |line: usize, reason: String| StudyError::Record { path: path.to_owned(), line, reason };
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let runs = lines.map(|(i, line)| read_run(line).map_err(|reason| bad(i + 1, reason)));
    let runs = runs.collect::<Result<Vec<Run>, StudyError>>()?;
    if runs.is_empty() { Err(bad(1, "there is no run in it".to_owned())) } else { Ok(runs) }
}

fn read_run(line: &str) -> Result<Run, String> {
    let run: Run = serde_json::from_str(line).map_err(|error| error.to_string())?;
    if (run.study.as_str(), run.format) != (STUDY, FORMAT) {
        return Err(format!("study '{}', format {}: not of this study", run.study, run.format));
    }
    let numbers = [
        run.build_secs,
        run.frame_ms,
        run.frame_ms_p25,
        run.frame_ms_p75,
        run.fps,
        run.rays,
        run.rays_per_sec,
        run.nodes_per_ray,
        run.tests_per_ray,
        run.wrong_pixels.unwrap_or_default(),
        run.wrong_rays.unwrap_or_default(),
        run.noise.unwrap_or_default(),
    ];
    if numbers.iter().any(|number| !(0.0..=f64::MAX).contains(number))
        || run.frame_ms == 0.0
        || run.fps == 0.0
    {
        return Err("a time, count or share is out of range".to_owned());
    }
    if run.picture_png.as_ref().is_some_and(|text| !is_png(text)) {
        return Err("picture_png is not a PNG file in base64".to_owned());
    }
    Ok(run)
}

/// A folder that a study is being written to.
pub(crate) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder if it is missing, and finds out whether files can be made in it.
    pub(crate) fn open(path: &Path) -> Result<Self, StudyError> {
        let folder = Self { path: path.to_owned() };
        fs::create_dir_all(path).map_err(|source| folder.error("", source))?;
        tempfile::tempfile_in(path).map_err(|source| folder.error("", source))?;
        for name in [RUNS, PREVIOUS_RUNS, TABLE, PAGE, PART] {
            if path.join(name).is_dir() {
                return Err(folder.error(name, io::Error::from(io::ErrorKind::IsADirectory)));
            }
        }
        Ok(folder)
    }

    /// Begins a list of runs. Records that are there already must be those of an octree study: nobody else's file of
    /// that name is touched.
    pub(crate) fn begin_runs(&self) -> Result<RunsFile<'_>, StudyError> {
        let there = self.path.join(RUNS);
        if there.exists() {
            read_runs(&there)?;
        }
        let path = self.path.join(PART);
        let file = OpenOptions::new().create(true).write(true).truncate(true).open(path);
        Ok(RunsFile { folder: self, file: file.map_err(|source| self.error(PART, source))? })
    }

    /// Writes the table of runs.
    pub(crate) fn write_table(&self, runs: &[Run]) -> Result<PathBuf, StudyError> {
        let mut table = csv::Writer::from_writer(Vec::new());
        for run in runs {
            table.serialize(Run { picture_png: None, ..run.clone() })?;
        }
        let bytes = table.into_inner().map_err(|error| self.error(TABLE, error.into_error()))?;
        self.write(TABLE, &bytes)
    }

    /// Writes the page.
    pub(crate) fn write_page(&self, page: &str) -> Result<PathBuf, StudyError> {
        self.write(PAGE, page.as_bytes())
    }

    /// Writes a file beside its place and moves it there.
    fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, StudyError> {
        let part = self.path.join(format!("{name}.part"));
        fs::write(&part, bytes).map_err(|source| self.error(name, source))?;
        self.rename(&part, name)
    }

    fn rename(&self, from: &Path, name: &str) -> Result<PathBuf, StudyError> {
        let to = self.path.join(name);
        fs::rename(from, &to).map_err(|source| self.error(name, source))?;
        Ok(to)
    }

    fn error(&self, name: &str, source: io::Error) -> StudyError {
        let path = if name.is_empty() { self.path.clone() } else { self.path.join(name) };
        StudyError::Write { path, source }
    }
}

/// The list of runs as it grows.
pub(crate) struct RunsFile<'a> {
    folder: &'a Folder,
    file: File,
}

impl RunsFile<'_> {
    /// Appends a run.
    pub(crate) fn append(&mut self, run: &Run) -> Result<(), StudyError> {
        let line = serde_json::to_string(run)?;
        writeln!(self.file, "{line}").map_err(|source| self.folder.error(PART, source))
    }

    /// Removes it: nothing was measured.
    pub(crate) fn discard(self) -> Result<(), StudyError> {
        let Self { folder, file } = self;
        drop(file);
        fs::remove_file(folder.path.join(PART)).map_err(|source| folder.error(PART, source))
    }

    /// Gives the file its name.
    pub(crate) fn finish(self) -> Result<PathBuf, StudyError> {
        let Self { folder, file } = self;
        file.sync_all().map_err(|source| folder.error(PART, source))?;
        drop(file);
        let there = folder.path.join(RUNS);
        if there.exists() {
            folder.rename(&there, PREVIOUS_RUNS)?;
        }
        folder.rename(&folder.path.join(PART), RUNS)
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::example;
    use super::*;

    fn line() -> String {
        serde_json::to_string(&example()).unwrap()
    }

    #[test]
    fn runs_come_back_from_both_files() {
        let folder = tempfile::tempdir().unwrap();
        let store = Folder::open(folder.path()).unwrap();
        let runs = [
            example(),
            Run { wrong_pixels: Some(0.25), wrong_rays: Some(0.5), noise: None, spheres: 7, ..example() },
        ];
        let mut file = store.begin_runs().unwrap();
        runs.iter().for_each(|run| file.append(run).unwrap());
        assert_eq!(read_runs(&file.finish().unwrap()).unwrap(), runs);
        let table = store.write_table(&runs).unwrap();
        let rows: Vec<Run> =
            csv::Reader::from_path(table).unwrap().deserialize().map(Result::unwrap).collect();
        assert_eq!(rows, runs);
    }

    #[test]
    fn the_study_before_is_kept_and_a_foreign_file_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let store = Folder::open(folder.path()).unwrap();
        for spheres in [1, 2] {
            let mut file = store.begin_runs().unwrap();
            file.append(&Run { spheres, ..example() }).unwrap();
            file.finish().unwrap();
        }
        assert_eq!(read_runs(&folder.path().join(PREVIOUS_RUNS)).unwrap()[0].spheres, 1);
        assert_eq!(read_runs(&folder.path().join(RUNS)).unwrap()[0].spheres, 2);
        fs::write(folder.path().join(RUNS), "{\"study\":\"sales\"}\n").unwrap();
        assert!(matches!(store.begin_runs(), Err(StudyError::Record { line: 1, .. })));
        assert_eq!(fs::read_to_string(folder.path().join(RUNS)).unwrap(), "{\"study\":\"sales\"}\n");
    }

    #[test]
    fn a_damaged_file_is_one_error_with_file_and_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.jsonl");
        let good = line();
        for (third, part) in [
            ("{\"study\"", "EOF"),
            (&good.replace("\"octree\",\"format\"", "\"bvh\",\"format\""), "study 'bvh'"),
            (&good.replace("\"fps\":100.0", "\"fps\":0.0"), "out of range"),
            (&good.replace("\"fps\":100.0", "\"fps\":-1.0"), "out of range"),
            (&good.replace("\"fps\":100.0", "\"fps\":1e999"), "number out of range"),
            (&good.replace("\"fps\"", "\"pfs\""), "unknown field `pfs`"),
            (&good.replace('}', ",\"picture_png\":\"\\\" onerror=\"}"), "picture_png"),
        ] {
            assert_ne!(third, good);
            fs::write(&path, format!("{good}\n\n{third}\n")).unwrap();
            let message = read_runs(&path).unwrap_err().to_string();
            assert!(message.contains("runs.jsonl, line 3:") && message.contains(part), "{message}");
        }
        fs::write(&path, "\n").unwrap();
        assert!(read_runs(&path).unwrap_err().to_string().contains("no run"));
    }

    #[test]
    fn a_place_that_cannot_be_written_is_named_before_anything_is_measured() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let message = Folder::open(&file.join("out")).err().unwrap().to_string();
        assert!(message.contains("file/out"), "{message}");
        fs::create_dir_all(folder.path().join("out/octree.html")).unwrap();
        let message = Folder::open(&folder.path().join("out")).err().unwrap().to_string();
        assert!(message.contains("octree.html"), "{message}");
    }
}
