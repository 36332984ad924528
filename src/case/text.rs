//! Bytes of a text file as text, whatever program saved them.

/// Why bytes are no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// Neither UTF-8 nor UTF-16 with its mark.
    #[error("it is not UTF-8 text: byte {at} belongs to no character")]
    NotText {
        /// Bytes before the first wrong one.
        at: usize,
    },
    /// UTF-16 that breaks off or has half characters.
    #[error("it begins as UTF-16 text, but is damaged")]
    Utf16,
}

/// The text in `bytes`: UTF-8, or UTF-16 that begins with its byte order mark. A mark is left out, and lines that end in `\r`
/// alone, as old Macintosh programs wrote them, end in `\n`.
pub fn text_of(bytes: &[u8]) -> Result<String, TextError> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes)?,
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes)?,
        [0xef, 0xbb, 0xbf, rest @ ..] => utf8(rest)?,
        all => utf8(all)?,
    };
    Ok(if text.contains('\n') { text } else { text.replace('\r', "\n") })
}

fn utf8(bytes: &[u8]) -> Result<String, TextError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(error) => Err(TextError::NotText { at: error.valid_up_to() }),
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String, TextError> {
    let (units, rest) = bytes.as_chunks::<2>();
    let text = char::decode_utf16(units.iter().map(|u| unit(*u))).collect::<Result<String, _>>();
    text.ok().filter(|_| rest.is_empty()).ok_or(TextError::Utf16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_usual_encoding_gives_the_same_text() {
        let text = "a = 1\nκ = 2\n";
        let wide = |order: fn(u16) -> [u8; 2], mark: [u8; 2]| {
            mark.into_iter().chain(text.encode_utf16().flat_map(order)).collect::<Vec<u8>>()
        };
        let marked = ["\u{feff}", text].concat();
        for bytes in [
            text.as_bytes(),
            marked.as_bytes(),
            &wide(u16::to_le_bytes, [0xff, 0xfe]),
            &wide(u16::to_be_bytes, [0xfe, 0xff]),
            text.replace('\n', "\r").as_bytes(),
        ] {
            assert_eq!(text_of(bytes).unwrap(), text);
        }
        assert_eq!(text_of(b"a\r\nb\r\n").unwrap(), "a\r\nb\r\n");
    }

    #[test]
    fn other_bytes_are_refused() {
        assert_eq!(text_of(&[b'a', 0xff]), Err(TextError::NotText { at: 1 }));
        assert_eq!(text_of(&[0xff, 0xfe, 0x41]), Err(TextError::Utf16));
        assert_eq!(text_of(&[0xff, 0xfe, 0x00, 0xd8]), Err(TextError::Utf16));
    }
}
