//! Tokens that open_clip's tokenizer gives, token for token.

use std::path::Path;

use trapeze_query::tokenizer::{CONTEXT_LENGTH, Tokenizer};

#[test]
fn every_fixture_has_the_same_tokens() {
    let Some(data) = std::env::var_os("TRAPEZE_DATA").filter(|data| Path::new(data).is_dir())
    else {
        eprintln!("SKIPPED: token fixtures need TRAPEZE_DATA");
        return;
    };
    let file = std::fs::read(Path::new(&data).join("clip/token_fixtures.json")).unwrap();
    let fixtures: serde_json::Value = serde_json::from_slice(&file).unwrap();
    let fixtures = fixtures.as_array().unwrap();
    assert!(fixtures.len() >= 28);
    let tokenizer = Tokenizer::new();
    for fixture in fixtures {
        let text = fixture["text"].as_str().unwrap();
        let tokens: Vec<u32> = serde_json::from_value(fixture["tokens"].clone()).unwrap();
        assert_eq!(tokens.len(), CONTEXT_LENGTH);
        assert_eq!(tokenizer.encode(text)[..], tokens, "{text:?}");
    }
}
