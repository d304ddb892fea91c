//! CLIP's byte-pair encoding (Radford et al. 2021), as open_clip applies it for MobileCLIP: clean,
//! lower-case, split into words, merge, frame with start and end, cut or fill to 77 tokens.
//!
//! The merges are those of the `instant-clip-tokenizer` crate, which gives open_clip's tokens for
//! every clean text; cleaning ([`clean`]) is ours.

mod cleaning;

use instant_clip_tokenizer::Tokenizer as Merges;

pub use cleaning::clean;

/// Tokens of a text, what every CLIP text tower takes.
pub const CONTEXT_LENGTH: usize = 77;

/// Turns texts into tokens. Making one reads the vocabulary (49 408 entries) and takes some ten
/// milliseconds; it is made once.
pub struct Tokenizer {
    merges: Merges,
}

impl Default for Tokenizer {
    fn default() -> Self {
        Self::new()
    }
}

impl Tokenizer {
    /// A tokenizer with CLIP's vocabulary.
    #[must_use]
    pub fn new() -> Self {
        Self { merges: Merges::new() }
    }

    /// The tokens of a text: start, words, end, zeros. What does not fit is cut off, and the end
    /// stands in the last place.
    ///
    /// Any text is accepted, of any length; an empty one gives start and end.
    #[must_use]
    pub fn encode(&self, text: &str) -> [u32; CONTEXT_LENGTH] {
        let mut tokens = [0; CONTEXT_LENGTH];
        let words = self.words(text);
        let framed = self.framed(&words, CONTEXT_LENGTH);
        tokens.iter_mut().zip(framed).for_each(|(to, token)| *to = token);
        tokens
    }

    /// The tokens of a text's words, however many.
    #[must_use]
    pub fn words(&self, text: &str) -> Vec<u32> {
        let mut words = Vec::new();
        self.merges.encode(&clean(text), &mut words);
        words.into_iter().map(|token| u32::from(token.to_u16())).collect()
    }

    /// Start, as many words as fit, end, zeros: `length` tokens.
    pub fn framed(&self, words: &[u32], length: usize) -> impl Iterator<Item = u32> {
        let kept = &words[..words.len().min(length.saturating_sub(2))];
        std::iter::once(self.merges.start_of_text().to_u16().into())
            .chain(kept.iter().copied())
            .chain(std::iter::once(self.merges.end_of_text().to_u16().into()))
            .chain(std::iter::repeat(0))
            .take(length)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use proptest::prelude::*;

    use super::*;

    /// Reading the vocabulary takes longer than all tests together.
    static TOKENIZER: LazyLock<Tokenizer> = LazyLock::new(Tokenizer::new);

    const START: u32 = 49_406;
    const END: u32 = 49_407;

    fn words(text: &str) -> Vec<u32> {
        let tokens = TOKENIZER.encode(text);
        let end = tokens.iter().position(|&token| token == END).unwrap();
        assert_eq!(tokens[0], START);
        assert!(tokens[end + 1..].iter().all(|&token| token == 0));
        tokens[1..end].to_vec()
    }

    #[test]
    fn texts_get_the_tokens_that_the_models_were_trained_with() {
        assert_eq!(words("a photo of a fern"), [320, 1125, 539, 320, 21_685]);
        assert_eq!(words("dog"), [1929]);
        assert_eq!(words("a red and white checkered ball").len(), 7);
        assert_eq!(words("  A PHOTO\tof \n a fern "), words("a photo of a fern"));
    }

    #[test]
    fn what_is_too_long_is_cut_and_still_ends() {
        let tokens = TOKENIZER.encode(&"dog ".repeat(2_500));
        assert_eq!((tokens[0], tokens[75], tokens[76]), (START, 1929, END));
    }

    #[test]
    fn nothing_is_start_and_end() {
        assert!(words("").is_empty() && words(" \t\n").is_empty());
    }

    proptest! {
        #[test]
        fn any_text_is_framed_by_start_and_end(text in "\\PC{0,200}|[\\x00-\\x7f]{0,400}|(&#?[a-z0-9]{0,8};?){0,20}") {
            let tokens = TOKENIZER.encode(&text);
            let end = tokens.iter().position(|&token| token == END);
            prop_assert_eq!(tokens[0], START);
            prop_assert!(end.is_some_and(|end| tokens[end + 1..].iter().all(|&t| t == 0)));
            prop_assert!(tokens.iter().all(|&token| token <= END));
        }
    }
}
