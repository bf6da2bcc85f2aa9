//! Lines, tokens and numbers of text formats, as bytes: names need not be UTF-8.

/// Longest piece of an input that an error message repeats, in bytes.
const QUOTE_BYTES: usize = 40;

/// One line without its end, and where it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub offset: usize,
    pub bytes: &'a [u8],
}

/// The lines of `bytes` from `start` on; a line ends in LF or CR LF.
pub(super) fn lines(bytes: &[u8], start: usize) -> impl Iterator<Item = Line<'_>> {
    let mut at = start;
    std::iter::from_fn(move || {
        let rest = bytes.get(at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let line = Line { offset: at, bytes: &rest[..length] };
        at += length + 1;
        Some(line)
    })
}

/// The pieces of a line between white space (a CR is white space too).
pub(super) fn tokens(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty())
}

/// A number in any usual spelling, NaN and infinity included.
pub(super) fn number(token: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(token).ok()?;
    // "1.#IND", "-1.#QNAN" and "1.#INF" are how older C libraries print what is not finite.
    text.parse().ok().or_else(|| text.contains(".#").then_some(f64::NAN))
}

/// A whole number.
pub(super) fn integer(token: &[u8]) -> Option<i64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// A piece of the input for a message: shortened, and without control characters.
pub(super) fn quote(token: &[u8]) -> String {
    let head = String::from_utf8_lossy(&token[..token.len().min(QUOTE_BYTES)]);
    let end = if token.len() > QUOTE_BYTES { "..." } else { "" };
    format!("`{}{end}`", head.escape_debug())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn lines_know_where_they_begin() {
        let found: Vec<_> = lines(b"a\r\n\nbc", 0).map(|line| (line.offset, line.bytes)).collect();
        assert_eq!(found, [(0, &b"a\r"[..]), (3, b""), (4, b"bc")]);
    }

    #[test]
    fn numbers_in_every_spelling() {
        assert_eq!(number(b"-1.5e3"), Some(-1500.0));
        assert_eq!(number(b".5"), Some(0.5));
        assert!(number(b"-nan").unwrap().is_nan() && number(b"1.#QNAN").unwrap().is_nan());
        assert_eq!(number(b"+Inf"), Some(f64::INFINITY));
        assert_eq!((number(b"1,5"), number(b"abc"), number(b"\xff")), (None, None, None));
    }
}
