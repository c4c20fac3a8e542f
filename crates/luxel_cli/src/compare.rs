//! `luxel compare`: how far one picture is from another, and whether that is too far.
use luxel_engine::ExitCode;
use luxel_study::{Comparison, read_image};
use serde::Serialize;

use crate::args::CompareArgs;
use crate::error::CliError;
use crate::reply;

/// A metric, its value and its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    name: &'static str,
    value: Value,
    limit: Option<Limit>,
}

/// A metric's value for a pair of pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Value {
    Number(f64),
    /// The pictures are equal: no limit is too strict.
    Equal,
    /// The metric does not exist for this pair, so that no limit can be met.
    Missing(&'static str),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Limit {
    AtMost(f64),
    AtLeast(f64),
}

#[derive(Serialize)]
struct Answer<'a> {
    a: String,
    b: String,
    #[serde(flatten)]
    metrics: &'a Comparison,
    /// Names of the metrics that are past their limit.
    failed: Vec<&'static str>,
}

/// Compares two pictures.
pub(crate) fn compare(args: &CompareArgs) -> Result<ExitCode, CliError> {
    let metrics = luxel_study::compare(&read_image(&args.a)?, &read_image(&args.b)?)?;
    let rows = rows(&metrics, args);
    let failed: Vec<&'static str> = rows.iter().filter(|row| row.is_failed()).map(|row| row.name).collect();
    let code = if failed.is_empty() { ExitCode::Done } else { ExitCode::ComparisonFailed };
    if args.json {
        let (a, b) = (args.a.display().to_string(), args.b.display().to_string());
        reply::print_json(&Answer { a, b, metrics: &metrics, failed })?;
    } else {
        reply::print_text(&rows.iter().map(Row::line).collect::<String>())?;
    }
    Ok(code)
}

fn rows(metrics: &Comparison, args: &CompareArgs) -> [Row; 6] {
    const LINEAR: Value = Value::Missing("only for EXR");
    let at_most = |limit: Option<f64>| limit.map(Limit::AtMost);
    let at_least = |limit: Option<f64>| limit.map(Limit::AtLeast);
    let row = |name, value, limit| Row { name, value, limit };
    [
        row("RMSE", Value::Number(metrics.rmse), at_most(args.max_rmse)),
        row("RMSE (linear)", metrics.rmse_linear.map_or(LINEAR, Value::Number), None),
        row("relMSE", metrics.rel_mse.map_or(LINEAR, Value::Number), at_most(args.max_relmse)),
        row("PSNR", metrics.psnr_db.map_or(Value::Equal, Value::Number), at_least(args.min_psnr)),
        row(
            "SSIM",
            metrics.ssim.map_or(Value::Missing("smaller than 11x11 pixels"), Value::Number),
            at_least(args.min_ssim),
        ),
        row("FLIP", Value::Number(metrics.flip), at_most(args.max_flip)),
    ]
}

impl Row {
    fn is_failed(&self) -> bool {
        match (self.value, self.limit) {
            (_, None) | (Value::Equal, _) => false,
            (Value::Missing(_), Some(_)) => true,
            (Value::Number(value), Some(Limit::AtMost(limit))) => value > limit,
            (Value::Number(value), Some(Limit::AtLeast(limit))) => value < limit,
        }
    }

    fn line(&self) -> String {
        let value = match self.value {
            Value::Number(value) => format!("{value:.6}"),
            Value::Equal => "equal".to_owned(),
            Value::Missing(why) => format!("none ({why})"),
        };
        let verdict = if self.is_failed() { "FAILED" } else { "ok" };
        let limit = match self.limit {
            None => String::new(),
            Some(Limit::AtMost(limit)) => format!("  at most {limit}: {verdict}"),
            Some(Limit::AtLeast(limit)) => format!("  at least {limit}: {verdict}"),
        };
        format!("{:13}  {value:<12}{limit}", self.name).trim_end().to_owned() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failed(value: Value, limit: Limit) -> bool {
        Row { name: "metric", value, limit: Some(limit) }.is_failed()
    }

    #[test]
    fn a_limit_is_exceeded_beyond_it_and_not_at_it() {
        assert!(
            !failed(Value::Number(0.5), Limit::AtMost(0.5))
                && failed(Value::Number(0.51), Limit::AtMost(0.5))
        );
        assert!(
            !failed(Value::Number(0.5), Limit::AtLeast(0.5))
                && failed(Value::Number(0.49), Limit::AtLeast(0.5))
        );
    }

    #[test]
    fn what_cannot_be_measured_fails_its_limit_and_equal_pictures_pass() {
        assert!(failed(Value::Missing("too small"), Limit::AtLeast(0.0)));
        assert!(!failed(Value::Equal, Limit::AtLeast(1e9)));
        assert!(!Row { name: "metric", value: Value::Missing("too small"), limit: None }.is_failed());
    }

    #[test]
    fn a_line_says_value_limit_and_verdict() {
        let row = Row { name: "RMSE", value: Value::Number(0.25), limit: Some(Limit::AtMost(0.1)) };
        assert_eq!(row.line(), "RMSE           0.250000      at most 0.1: FAILED\n");
    }
}
