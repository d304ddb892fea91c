//! What happens to a text before it is split into words.
//!
//! open_clip runs `ftfy.fix_text`, undoes HTML entities twice, joins white space and lower-cases.
//! Of ftfy's steps those are here that concern text as people type or paste it: entities, ligatures,
//! full-width characters, curly quotes, control characters, composition. Its repair of text that
//! was decoded with the wrong character set is not: a search field hands over Unicode.

use unicode_normalization::{Recompositions, UnicodeNormalization};

/// The text as the merges expect it.
#[must_use]
pub fn clean(text: &str) -> String {
    // ftfy leaves entities alone in what looks like markup; open_clip then undoes them in any case,
    // twice, because scraped captions were escaped twice.
    let once = html_escape::decode_html_entities(text).into_owned();
    let twice = html_escape::decode_html_entities(&once).into_owned();
    let fixed: String = twice.chars().flat_map(fix_character).nfc().collect();
    let words: Vec<&str> = fixed.split_whitespace().collect();
    words.join(" ").to_lowercase()
}

/// One character in the form that text usually has it in.
fn fix_character(c: char) -> impl Iterator<Item = char> {
    let plain: &str = match c {
        '\u{2018}'..='\u{201b}' | '\u{2bc}' => "'",
        '\u{201c}'..='\u{201f}' => "\"",
        '\u{132}' => "IJ",
        '\u{133}' => "ij",
        '\u{149}' => "'n",
        '\u{1f1}' => "DZ",
        '\u{1f2}' => "Dz",
        '\u{1f3}' => "dz",
        '\u{1c4}' => "D\u{17d}",
        '\u{1c5}' => "D\u{17e}",
        '\u{1c6}' => "d\u{17e}",
        '\u{1c7}' => "LJ",
        '\u{1c8}' => "Lj",
        '\u{1c9}' => "lj",
        '\u{1ca}' => "NJ",
        '\u{1cb}' => "Nj",
        '\u{1cc}' => "nj",
        '\u{fb00}' => "ff",
        '\u{fb01}' => "fi",
        '\u{fb02}' => "fl",
        '\u{fb03}' => "ffi",
        '\u{fb04}' => "ffl",
        '\u{fb05}' => "\u{17f}t",
        '\u{fb06}' => "st",
        _ if is_removed(c) => return Fixed::Removed,
        _ if is_wide(c) => return Fixed::Wide(Some(c).into_iter().nfkc()),
        _ => return Fixed::Same(Some(c)),
    };
    Fixed::Plain(plain.chars())
}

/// Control characters that show nothing, and marks of direction and byte order.
fn is_removed(c: char) -> bool {
    matches!(c, '\0'..='\x08' | '\x0b' | '\x0e'..='\x1f' | '\x7f' | '\u{206a}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffc}')
}

/// Full-width Latin, half-width Katakana and Hangul, and the ideographic space.
fn is_wide(c: char) -> bool {
    matches!(c, '\u{ff01}'..='\u{ffef}' | '\u{3000}')
}

/// What became of a character.
enum Fixed {
    Same(Option<char>),
    Plain(std::str::Chars<'static>),
    Wide(Recompositions<std::option::IntoIter<char>>),
    Removed,
}

impl Iterator for Fixed {
    type Item = char;

    fn next(&mut self) -> Option<char> {
        match self {
            Self::Same(c) => c.take(),
            Self::Plain(chars) => chars.next(),
            Self::Wide(chars) => chars.next(),
            Self::Removed => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pasted_text_becomes_what_one_would_type() {
        assert_eq!(clean("“Red” ball’s"), "\"red\" ball's");
        assert_eq!(clean("ＦＵＬＬ\u{3000}ｗｉｄｔｈ"), "full width");
        assert_eq!(clean("e\u{301} ﬁne"), "é fine");
        assert_eq!(clean("&amp;lt;b&amp;gt; &quot;x&quot;"), "<b> \"x\"");
        assert_eq!(clean("a\u{0}b\u{feff}c\u{1b}"), "abc");
        assert_eq!(clean("\u{a0}two\t \nwords "), "two words");
    }

    #[test]
    fn text_that_is_clean_stays() {
        for text in ["a red ball", "日本語 テキスト", "naïve café", "$100 @home #tag 50%", "🐶"]
        {
            assert_eq!(clean(text), text);
        }
    }
}
