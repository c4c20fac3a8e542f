//! The files that a render leaves: a PNG with one more per output, or an EXR with layers.
use std::path::PathBuf;

use luxel_engine::output::{self, Format, Metadata, OutputError, Picture, Precision};
use luxel_engine::{AovKind, Engine, Rendered, View};

use crate::error::CliError;

/// What is to be written, and how.
pub(crate) struct Targets {
    /// The picture.
    pub(crate) output: PathBuf,
    /// What goes with it.
    pub(crate) aovs: Vec<AovKind>,
    /// What a PNG shows.
    pub(crate) view: View,
    /// How an EXR keeps colours.
    pub(crate) precision: Precision,
}

impl Targets {
    /// Finds out before a long render whether everything could be written.
    pub(crate) fn check(&self) -> Result<(), CliError> {
        match Format::of(&self.output)? {
            Format::Exr if self.view != View::PathTraced => Err(CliError::Usage(format!(
                "--view {} shows in a PNG; an EXR takes --aov",
                self.view.name()
            ))),
            Format::Exr => Ok(output::check(&self.output)?),
            Format::Png => Ok(self.pictures().iter().try_for_each(|(path, _)| output::check(path))?),
        }
    }

    /// Writes everything and gives the files, the picture first.
    pub(crate) fn write(&self, rendered: &Rendered, engine: &Engine) -> Result<Vec<PathBuf>, CliError> {
        let metadata = rendered.metadata(engine);
        match Format::of(&self.output)? {
            Format::Exr => {
                output::write_exr(&self.output, &rendered.film, &self.aovs, self.precision, &metadata)?;
                Ok(vec![self.output.clone()])
            }
            Format::Png => self.write_pictures(rendered, engine, &metadata),
        }
    }

    fn write_pictures(
        &self,
        rendered: &Rendered,
        engine: &Engine,
        metadata: &Metadata,
    ) -> Result<Vec<PathBuf>, CliError> {
        let pictures = self.pictures();
        for (path, view) in &pictures {
            let missing = || {
                let message = format!("first hits were not traced, so there is no {} to show", view.name());
                OutputError::Encode { path: path.clone(), message }
            };
            let picture = Picture::of(&rendered.film, engine.display(), *view).ok_or_else(missing)?;
            output::write_png(path, &picture, metadata)?;
        }
        Ok(pictures.into_iter().map(|(path, _)| path).collect())
    }

    /// PNG files and what each shows: `out.png`, `out.albedo.png`, …
    fn pictures(&self) -> Vec<(PathBuf, View)> {
        let of_aov =
            |kind: &AovKind| (self.output.with_extension(format!("{}.png", kind.name())), view_of(*kind));
        [(self.output.clone(), self.view)].into_iter().chain(self.aovs.iter().map(of_aov)).collect()
    }
}

/// The view that shows an output.
fn view_of(kind: AovKind) -> View {
    match kind {
        AovKind::Albedo => View::Albedo,
        AovKind::Normal => View::Normal,
        AovKind::Depth => View::Depth,
        AovKind::Position => View::Position,
        AovKind::Ids => View::Ids,
        AovKind::SampleCount => View::SampleCount,
        AovKind::Variance => View::Variance,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(output: &str, view: View) -> Targets {
        Targets {
            output: output.into(),
            aovs: vec![AovKind::Albedo, AovKind::Ids],
            view,
            precision: Precision::Half,
        }
    }

    #[test]
    fn outputs_lie_beside_a_png() {
        let pictures = targets("a/b.c.png", View::Steps).pictures();
        let expected =
            [("a/b.c.png", View::Steps), ("a/b.c.albedo.png", View::Albedo), ("a/b.c.ids.png", View::Ids)];
        assert_eq!(pictures, expected.map(|(path, view)| (PathBuf::from(path), view)));
    }

    #[test]
    fn an_exr_shows_no_view() {
        let error = targets("a.exr", View::Steps).check().unwrap_err().to_string();
        assert_eq!(error, "--view steps shows in a PNG; an EXR takes --aov");
        targets("a.exr", View::PathTraced).check().unwrap();
    }
}
