//! A table or figure of the document on the page.
use maud::{Markup, html};

use crate::StudyError;
use crate::kit::figure::{Part, Table};
use crate::kit::page::{badge, part};
use crate::kit::verdict::{Case, Verdict};

/// What a section shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Label {
    /// Chapter and number.
    Table(u32, u32),
    Figure(u32, u32),
    /// What the document lacks.
    Further(&'static str),
}

/// A table or figure.
pub(super) struct Section {
    pub(super) label: Label,
    pub(super) title: String,
    /// What the document claims with it.
    pub(super) claim: Option<String>,
    pub(super) verdict: Verdict,
    /// What is to be known of the document's numbers or of ours.
    pub(super) notes: Vec<String>,
    pub(super) parts: Vec<Part>,
}

impl Section {
    /// A table whose claim holds as far as the cases do.
    pub(super) fn table(
        (chapter, number): (u32, u32),
        title: impl Into<String>,
        claim: &str,
        cases: &[Case],
        because: String,
    ) -> Self {
        Self {
            label: Label::Table(chapter, number),
            title: title.into(),
            claim: Some(claim.to_owned()),
            verdict: Verdict::of(cases, because),
            notes: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// A figure, which shows something and claims nothing.
    pub(super) fn figure((chapter, number): (u32, u32), title: impl Into<String>, parts: Vec<Part>) -> Self {
        let is_shown = parts.iter().any(|part| match part {
            Part::Chart(chart) => !chart.is_empty(),
            Part::Pictures(pictures) => !pictures.is_empty(),
            _ => true,
        });
        let verdict = match is_shown {
            true => Verdict::no_claim("It is there to be looked at.".to_owned()),
            false => Verdict::not_measured(),
        };
        Self {
            label: Label::Figure(chapter, number),
            title: title.into(),
            claim: None,
            verdict,
            notes: Vec::new(),
            parts,
        }
    }

    pub(super) fn with(mut self, parts: impl IntoIterator<Item = Part>) -> Self {
        self.parts.extend(parts);
        self
    }

    pub(super) fn noted(mut self, notes: impl IntoIterator<Item = String>) -> Self {
        self.notes.extend(notes);
        self
    }

    /// As texts call it.
    pub(super) fn name(&self) -> String {
        match self.label {
            Label::Table(chapter, number) => format!("Table {chapter}.{number}"),
            Label::Figure(chapter, number) => format!("Figure {chapter}.{number}"),
            Label::Further(name) => name.to_owned(),
        }
    }

    /// As links call it.
    pub(super) fn id(&self) -> String {
        self.name().to_lowercase().replace(' ', "-")
    }

    pub(super) fn html(&self) -> Result<Markup, StudyError> {
        let parts: Vec<Markup> = self.parts.iter().map(part).collect::<Result<_, _>>()?;
        Ok(html! {
            section class="figure" id=(self.id()) {
                h3 { (self.name()) ": " (self.title) }
                @for part in parts { (part) }
                @if let Some(claim) = &self.claim { p class="claim" { "Claim: " (claim) } }
                p { (badge(self.verdict.answer)) " " (self.verdict.because) }
                @for note in &self.notes { p { strong { "Note: " } (note) } }
            }
        })
    }
}

/// Rows under a head.
pub(super) fn rows(head: &[&str], rows: Vec<Vec<String>>) -> Part {
    Part::Table(Table { head: head.iter().map(|name| (*name).to_owned()).collect(), rows })
}

/// A value that may be missing.
pub(super) fn cell<T>(value: Option<T>, say: impl Fn(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), say)
}
