//! Numbers as people read them.

/// Three significant digits, with commas between thousands.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    let text = if size >= 999.5 {
        let unit = 10f64.powf(size.log10().floor() - 2.0);
        count(((size / unit).round() * unit).round() as u64)
    } else {
        significant(size)
    };
    if value < 0.0 { format!("−{text}") } else { text }
}

/// Three significant digits of a size below 1000.
fn significant(size: f64) -> String {
    if size == 0.0 || size >= 99.95 {
        return format!("{size:.0}");
    }
    let digits = (2.0 - size.log10().floor()).clamp(0.0, 8.0) as usize;
    let text = format!("{size:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A count with its thousands apart.
pub(crate) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A part as a percentage.
pub(crate) fn percent(part: f64) -> String {
    format!("{} %", short(100.0 * part))
}

/// How many times as much.
pub(crate) fn times(ratio: f64) -> String {
    format!("{}×", short(ratio))
}

/// Names or numbers as an enumeration; `none` for an empty one.
pub(crate) fn list<T: ToString>(items: impl IntoIterator<Item = T>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    match items.split_last() {
        None => "none".to_owned(),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.001234, "0.00123"),
            (0.1, "0.1"),
            (9.999, "10"),
            (12.34, "12.3"),
            (144.0, "144"),
            (2000.0, "2,000"),
            (12_345.0, "12,300"),
            (999.7, "1,000"),
            (1e6, "1,000,000"),
            (-3.456, "−3.46"),
        ] {
            assert_eq!(short(value), text);
        }
        assert_eq!(
            (count(1_234_567), count(7), count(1000)),
            ("1,234,567".into(), "7".into(), "1,000".into())
        );
        assert_eq!(
            (percent(0.0312), times(2.5), times(1e4)),
            ("3.12 %".into(), "2.5×".into(), "10,000×".into())
        );
        assert_eq!(
            (list([1, 2, 3]), list([1]), list::<u32>([])),
            ("1, 2 and 3".into(), "1".into(), "none".into())
        );
    }
}
