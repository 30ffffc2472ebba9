//! Numbers as people read them: durations, large counts, percentages, words for a shell.

/// `0.4 s`, `12 s`, `3:05 min`, `1:02:03 h`.
pub fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "?".to_owned();
    }
    if seconds < 9.95 {
        return format!("{:.1} s", seconds.max(0.0));
    }
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    match (hours, minutes) {
        (0, 0) => format!("{rest} s"),
        (0, _) => format!("{minutes}:{rest:02} min"),
        _ => format!("{hours}:{minutes:02}:{rest:02} h"),
    }
}

/// `950`, `12.3 k`, `4.56 M`, `7.89 G`: three digits.
pub fn count(n: f64) -> String {
    let (scaled, unit) = [(1e9, " G"), (1e6, " M"), (1e3, " k")]
        .into_iter()
        .find(|(size, _)| n >= *size)
        .map_or((n, ""), |(size, unit)| (n / size, unit));
    match scaled {
        _ if unit.is_empty() => format!("{scaled:.0}"),
        s if s >= 100.0 => format!("{s:.0}{unit}"),
        s if s >= 10.0 => format!("{s:.1}{unit}"),
        s => format!("{s:.2}{unit}"),
    }
}

/// `1 234 567`: all digits, in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() * 2);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A time that is only foreseen, with two digits: `0.42 s`, `34 s`, `12 min`, `4.1 h`, `3.2 days`.
pub fn rough_duration(seconds: f64) -> String {
    let units = [(86_400.0, "days"), (3600.0, "h"), (60.0, "min")];
    let unit = units.into_iter().find(|(size, _)| seconds >= 1.5 * size);
    let (size, name) = unit.unwrap_or((1.0, "s"));
    match seconds / size {
        n if n >= 9.95 => format!("{n:.0} {name}"),
        n if n >= 0.995 || n == 0.0 => format!("{n:.1} {name}"),
        n => format!("{n:.2} {name}"),
    }
}

/// `312 ns`, `4.56 µs`, `7.89 ms`, `1.23 s`: three digits of a time in nanoseconds.
pub fn nanoseconds(ns: f64) -> String {
    let (scaled, unit) = [(1e9, "s"), (1e6, "ms"), (1e3, "µs")]
        .into_iter()
        .find(|(size, _)| ns >= *size)
        .map_or((ns, "ns"), |(size, unit)| (ns / size, unit));
    match scaled {
        s if s >= 100.0 => format!("{s:.0} {unit}"),
        s if s >= 10.0 => format!("{s:.1} {unit}"),
        s => format!("{s:.2} {unit}"),
    }
}

/// `2.34 %` with as many digits as make sense for an error figure.
pub fn percent(fraction: f64) -> String {
    let p = 100.0 * fraction;
    match p {
        _ if !p.is_finite() => "unknown".to_owned(),
        _ if p == 0.0 => "0 %".to_owned(),
        _ if p >= 9.95 => format!("{p:.0} %"),
        _ if p >= 0.995 => format!("{p:.1} %"),
        _ if p >= 0.0995 => format!("{p:.2} %"),
        _ => format!("{p:.1e} %"),
    }
}

/// A word as a POSIX shell takes it.
pub fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,@%+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_carry_into_the_next_unit() {
        for (seconds, text) in [
            (0.04, "0.0 s"),
            (9.94, "9.9 s"),
            (9.96, "10 s"),
            (59.6, "1:00 min"),
            (3599.9, "1:00:00 h"),
            (3723.0, "1:02:03 h"),
            (f64::NAN, "?"),
        ] {
            assert_eq!(duration(seconds), text);
        }
    }

    #[test]
    fn counts_have_three_digits() {
        for (n, text) in [(7.0, "7"), (1500.0, "1.50 k"), (12.34e6, "12.3 M"), (456e9, "456 G")] {
            assert_eq!(count(n), text);
        }
    }

    #[test]
    fn percentages_keep_two_digits() {
        for (f, text) in [
            (0.03, "3.0 %"),
            (0.123, "12 %"),
            (0.0012, "0.12 %"),
            (0.0, "0 %"),
            (1e-5, "1.0e-3 %"),
        ] {
            assert_eq!(percent(f), text);
        }
    }

    #[test]
    fn words_with_blanks_or_quotes_are_quoted() {
        assert_eq!(shell_word("a/b-1.pts"), "a/b-1.pts");
        assert_eq!(shell_word("a b"), "'a b'");
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word(""), "''");
    }

    #[test]
    fn foreseen_times_have_two_digits() {
        for (seconds, text) in [
            (0.0, "0.0 s"),
            (0.42, "0.42 s"),
            (8.04, "8.0 s"),
            (89.0, "89 s"),
            (91.0, "1.5 min"),
            (720.0, "12 min"),
            (5399.0, "90 min"),
            (14_826.0, "4.1 h"),
            (276_480.0, "3.2 days"),
        ] {
            assert_eq!(rough_duration(seconds), text);
        }
    }
}
