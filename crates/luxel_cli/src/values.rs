//! Values of options: sizes, percentages, names from a list.
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Accepts the names of a table, says which there are, and gives what the name stands for.
pub(crate) fn named<T: Copy + Send + Sync + 'static>(
    table: Vec<(&'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    let names: Vec<&'static str> = table.iter().map(|(name, _)| *name).collect();
    PossibleValuesParser::new(names).try_map(move |name| {
        let found = table.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value).ok_or_else(|| format!("unknown name '{name}'"))
    })
}

/// Width and height in pixels from `1280x720`.
pub(crate) fn size(text: &str) -> Result<(u32, u32), String> {
    let parsed = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match parsed {
        Some((width, height)) if width > 0 && height > 0 => Ok((width, height)),
        _ => Err("expected WIDTHxHEIGHT in pixels, such as 1280x720".to_owned()),
    }
}

/// A part of one from `2%` or `2`.
pub(crate) fn percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').unwrap_or(text).trim_end();
    Ok(positive(number).map_err(|_| "expected a positive percentage, such as 2%".to_owned())? / 100.0)
}

/// A number above 0 that is not infinite.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "expected a positive number".to_owned())
}

/// Any number that is not infinite.
pub(crate) fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|number: &f32| number.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

/// A number that is 0 or above and not infinite.
pub(crate) fn limit(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number >= 0.0 && number.is_finite());
    number.ok_or_else(|| "expected a number that is not negative".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("320x180"), Ok((320, 180)));
        assert_eq!(size("1X2"), Ok((1, 2)));
        for bad in ["", "x", "320", "320x", "0x5", "5x0", "-1x2", "1.5x2", "1x2x3", "99999999999x1"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_have_their_range() {
        assert_eq!((percent("2%"), percent("0.5"), percent("2 %")), (Ok(0.02), Ok(0.005), Ok(0.02)));
        assert!(["", "%", "0", "-1%", "NaN", "inf"].iter().all(|bad| percent(bad).is_err()));
        assert!(["0", "-1", "NaN", "inf", "1e999"].iter().all(|bad| positive(bad).is_err()));
        assert_eq!((finite("-1.5"), limit("0")), (Ok(-1.5), Ok(0.0)));
        assert!(finite("NaN").is_err() && limit("-0.1").is_err() && limit("inf").is_err());
    }
}
