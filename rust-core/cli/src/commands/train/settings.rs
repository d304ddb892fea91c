//! Settings of a run from a file, for everything that has no argument of its own.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde_json::Value;
use trapeze_formats::{ParseError, ReadError};
use trapeze_train::config::TrainingConfig;

use crate::error::CliError;

/// All settings take about a kilobyte.
const MOST_BYTES: u64 = 1 << 20;

/// `config` with what a JSON file says otherwise: an object of any of the settings, nested as in the
/// summary of a run.
pub(super) fn overridden(config: &TrainingConfig, path: &Path) -> Result<TrainingConfig, CliError> {
    let file = File::open(path).map_err(|error| CliError::file(path, error))?;
    let mut text = String::new();
    let read = file.take(MOST_BYTES + 1).read_to_string(&mut text);
    read.map_err(|error| CliError::file(path, error))?;
    parse(config, &text).map_err(|error| ReadError::new(path, error).into())
}

fn parse(config: &TrainingConfig, text: &str) -> Result<TrainingConfig, ParseError> {
    if text.len() as u64 > MOST_BYTES {
        let expected = format!("at most {MOST_BYTES} bytes");
        return Err(ParseError::value("settings", expected, "more"));
    }
    let malformed = |error: serde_json::Error| {
        ParseError::value("settings", "an object of settings of a run", error)
    };
    let over: Value = serde_json::from_str(text).map_err(malformed)?;
    if !over.is_object() {
        let found = serde_json::to_string(&over).unwrap_or_default();
        return Err(ParseError::value("settings", "an object of settings of a run", found));
    }
    let mut merged = serde_json::to_value(config).map_err(malformed)?;
    put_over(&mut merged, over);
    let config: TrainingConfig = serde_json::from_value(merged).map_err(malformed)?;
    config
        .validate()
        .map_err(|error| ParseError::value("settings", "a run that makes sense", error))?;
    Ok(config)
}

/// Objects are merged, everything else is replaced.
fn put_over(base: &mut Value, over: Value) {
    match (base, over) {
        (Value::Object(base), Value::Object(over)) => {
            for (name, value) in over {
                put_over(base.entry(name).or_insert(Value::Null), value);
            }
        }
        (base, over) => *base = over,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_file_says_replaces_and_the_rest_stays() {
        let config = TrainingConfig::automatic(2_000, 50_000);
        let text = r#"{"seed": 9, "rates": {"sh_dc": 0.5}, "search": null, "holdout": 8}"#;
        let found = parse(&config, text).unwrap();
        assert_eq!((found.seed, found.rates.sh_dc, found.holdout), (9, 0.5, Some(8)));
        assert_eq!(found.search, None);
        assert_eq!(found.rates.log_scales, config.rates.log_scales);
        assert_eq!(found.densification, config.densification);
        assert_eq!(parse(&config, "{}").unwrap(), config);
    }

    #[test]
    fn what_is_not_a_setting_is_refused_by_name() {
        let config = TrainingConfig::fixed(100);
        for (text, named) in [
            ("", "settings"),
            ("[1]", "object"),
            (r#"{"rates": {"sh_ac": 1}}"#, "sh_ac"),
            (r#"{"learning": 1}"#, "learning"),
            (r#"{"steps": -1}"#, "-1"),
            (r#"{"steps": 0}"#, "steps"),
            (r#"{"ssim_weight": 3.0}"#, "ssim_weight"),
        ] {
            let error = parse(&config, text).unwrap_err().to_string();
            assert!(error.contains(named), "{text}: {error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
