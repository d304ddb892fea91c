//! JSON whose errors name the field.

use serde::de::DeserializeOwned;

use crate::ParseError;

/// Longest JSON file that is read: more than a thousand times the largest camera list we know.
pub(crate) const MAX_JSON_BYTES: u64 = 256 << 20;

/// Parses a JSON document into `T`.
///
/// # Errors
/// [`ParseError::Json`] with the path of the field that is missing or of the wrong type.
pub(crate) fn parse_json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, ParseError> {
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let field = match error.path().to_string() {
            // The path of the document itself.
            dot if dot == "." => "JSON".to_owned(),
            path => path,
        };
        ParseError::json(field, error.into_inner())
    })?;
    deserializer.end().map_err(|error| ParseError::json("JSON", error))?;
    Ok(value)
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    #[expect(dead_code, reason = "only the parsing is of interest")]
    struct Outer {
        inner: Vec<Inner>,
    }

    #[derive(Debug, Deserialize)]
    #[expect(dead_code, reason = "only the parsing is of interest")]
    struct Inner {
        size: f64,
    }

    #[test]
    fn errors_name_the_field_and_stay_on_one_line() {
        for (text, parts) in [
            (r#"{"inner": [{"size": 1}, {"size": "x"}]}"#, ["inner[1].size", "expected f64"]),
            (r#"{"inner": [{}]}"#, ["inner[0]", "missing field `size`"]),
            (r#"{"inner": [{"size": NaN}]}"#, ["inner[0].size", "expected value"]),
            (r#"{"inner": [{"size": 1e999}]}"#, ["inner[0].size", "out of range"]),
            (r#"{"inner": []} {}"#, ["JSON", "trailing characters"]),
            ("", ["JSON", "EOF"]),
        ] {
            let message = parse_json::<Outer>(text.as_bytes()).unwrap_err().to_string();
            assert!(parts.iter().all(|part| message.contains(part)), "{text} gave {message}");
        }
    }

    #[test]
    fn deep_nesting_and_long_strings_make_short_errors() {
        let deep = "[".repeat(1 << 20);
        assert!(parse_json::<serde_json::Value>(deep.as_bytes()).is_err());
        let long = format!(r#"{{"inner": [{{"size": "{}"}}]}}"#, "x\\n".repeat(1 << 16));
        let message = parse_json::<Outer>(long.as_bytes()).unwrap_err().to_string();
        assert!(message.len() < 300 && !message.contains('\n'), "{message}");
    }
}
