//! The date of an analysis.

use std::time::{SystemTime, UNIX_EPOCH};

/// The variable that sets the date of reproducible results, in seconds since 1970; see reproducible-builds.org.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// Today's date in UTC, such as `2026-12-01`, or the one that `SOURCE_DATE_EPOCH` says.
///
/// # Errors
/// What is wrong with that variable, as a sentence without its full stop.
pub fn today() -> Result<String, String> {
    let seconds = match std::env::var_os(EPOCH) {
        Some(set) => {
            let wrong = || format!("{EPOCH} is {set:?}, not a whole number of seconds since 1970");
            // The last is in the year 9999, beyond which a date has more digits.
            set.to_str().and_then(|s| s.parse().ok()).filter(|s| *s < 253_402_300_800).ok_or_else(wrong)?
        }
        None => SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs()),
    };
    Ok(date(seconds / 86400))
}

/// The date so many days after 1970-01-01, Gregorian.
fn date(days: u64) -> String {
    // Years begin in March here, so that a leap day is the last of its year: 400 years are 146,097 days.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 { (year, month + 3) } else { (year + 1, month - 9) };
    format!("{:04}-{month:02}-{day:02}", 400 * era + year)
}

#[cfg(test)]
mod tests;
