//! Text files and tables of numbers, independent of the program that wrote them.
use std::fs::File;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

/// Greatest size of a file of text in bytes: forces of a hundred modes at a hundred frequencies take a tenth of it.
const LONGEST: u64 = 1 << 30;

/// Reason why bytes are not text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// The bytes are neither UTF-8 nor UTF-16 with a byte order mark.
    #[error("it is not UTF-8 text: byte {at} belongs to no character")]
    NotText {
        /// Position of the first invalid byte.
        at: usize,
    },
    /// The bytes are truncated or invalid UTF-16.
    #[error("it begins as UTF-16 text, but is damaged")]
    Utf16,
}

/// Opens a file that a case names. Pipes and devices are rejected, because reading them might never end.
pub fn open_regular(path: &Path) -> std::io::Result<File> {
    let kind = std::fs::metadata(path)?;
    if kind.is_file() {
        return File::open(path);
    }
    let what = if kind.is_dir() { "it is a folder" } else { "it is no regular file, but a pipe or a device" };
    Err(Error::new(ErrorKind::InvalidInput, what))
}

/// Reads the bytes of a file that [`open_regular`] accepts.
pub fn read_regular(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The same of a file of text, which is rejected where it is larger than any that people or programs write.
pub fn read_written(path: &Path) -> std::io::Result<Vec<u8>> {
    refuse_longer(&open_regular(path)?, LONGEST)?;
    read_regular(path)
}

/// Rejects a file of more than `most` bytes before any of them is read.
pub fn refuse_longer(file: &File, most: u64) -> std::io::Result<()> {
    let length = file.metadata()?.len();
    if length <= most {
        return Ok(());
    }
    let what = format!("it has {length} bytes, more than the {most} that are read");
    Err(Error::new(ErrorKind::FileTooLarge, what))
}

/// Decodes `bytes` as UTF-8, or as UTF-16 with a byte order mark or with first characters of which one byte is zero.
/// The byte order mark is removed, and line ends `\r` of old Macintosh programs become `\n`.
pub fn text_of(bytes: &[u8]) -> Result<String, TextError> {
    read(bytes, utf8)
}

/// Decodes the bytes of a file of numbers; characters of other encodings in comments and names are accepted.
pub fn numbers_of(bytes: &[u8]) -> Result<String, TextError> {
    read(bytes, |all| Ok(String::from_utf8_lossy(all).into_owned()))
}

fn read(bytes: &[u8], other: fn(&[u8]) -> Result<String, TextError>) -> Result<String, TextError> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes)?,
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes)?,
        [1..=255, 0, 1..=255, 0, ..] => utf16(bytes, u16::from_le_bytes)?,
        [0, 1..=255, 0, 1..=255, ..] => utf16(bytes, u16::from_be_bytes)?,
        [0xef, 0xbb, 0xbf, rest @ ..] => other(rest)?,
        all => other(all)?,
    };
    Ok(if text.contains('\n') { text } else { text.replace('\r', "\n") })
}

/// A number with at most `digits` digits, in powers of ten where it is very small or large.
pub fn rounded(value: f64, digits: usize) -> String {
    let value: f64 = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    if (1e-3..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// `text` with numbers that have very many digits in powers of ten: 1e300 for a one with 300 zeros.
pub fn abridged(text: &str) -> String {
    /// Digits of the longest number that stays as it is.
    const MOST: usize = 30;
    /// Digits of a number that is told.
    const TOLD: usize = 6;
    let (mut short, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let end = rest[at..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len() - at);
        let number = rest[at..at + end].trim_end_matches('.');
        short += &rest[..at];
        match number.parse::<f64>() {
            _ if number.len() <= MOST => short += number,
            Ok(value) if value.is_finite() && value > 0.0 => short += &rounded(value, TOLD),
            _ => short += &format!("{}…", &number[..2 * TOLD]),
        }
        rest = &rest[at + number.len()..];
    }
    short + rest
}

/// Separator of the columns of a table: the first of `;`, tab and comma that appears in its header.
pub fn separator(table: &str) -> char {
    let said = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let header = table.lines().find(said).unwrap_or_default();
    [';', '\t'].into_iter().find(|c| header.trim().contains(*c)).unwrap_or(',')
}

/// The first number with a decimal comma among several words of a line.
pub fn decimal_comma(line: &str) -> Option<&str> {
    let number = |part: &str, more: &str| {
        part.trim_start_matches(['-', '+']).chars().all(|c| c.is_ascii_digit() || more.contains(c))
    };
    let with_comma = |word: &&str| {
        let begins = |part: &str| part.starts_with(|c: char| c.is_ascii_digit());
        word.split_once(',').is_some_and(|(a, b)| number(a, "") && begins(b) && number(b, "eE+-"))
    };
    let words = || line.split(|c: char| c == ';' || c.is_whitespace()).filter(|w| !w.is_empty());
    words().find(with_comma).filter(|_| words().count() > 1)
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
    fn a_file_that_is_too_large_is_rejected_before_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.toml");
        std::fs::write(&path, "mach = 0.5").unwrap();
        assert_eq!(read_written(&path).unwrap(), b"mach = 0.5");
        // a hole takes no place on the disk
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        let told = read_written(&path).unwrap_err().to_string();
        assert_eq!(told, "it has 1099511627776 bytes, more than the 1073741824 that are read");
    }

    #[test]
    fn numbers_with_hundreds_of_digits_are_told_in_powers_of_ten() {
        let (large, small) = (format!("{}", 1.25e300), format!("{}", 1e-300));
        let told = abridged(&format!("`x` is {large}, not -{small} or 1.5e-7 or 0.0060. It is. 12"));
        assert_eq!(told, "`x` is 1.25e300, not -1e-300 or 1.5e-7 or 0.0060. It is. 12");
        assert_eq!(abridged(&"9".repeat(400)), "999999999999…");
    }

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
            &wide(u16::to_le_bytes, [0xff, 0xfe])[2..],
            &wide(u16::to_be_bytes, [0xfe, 0xff])[2..],
            text.replace('\n', "\r").as_bytes(),
        ] {
            assert_eq!(text_of(bytes).unwrap(), text);
            assert_eq!(numbers_of(bytes).unwrap(), text);
        }
        assert_eq!(numbers_of(b"a \xb0\n").unwrap(), "a \u{fffd}\n");
        assert_eq!(text_of(b"a\r\nb\r\n").unwrap(), "a\r\nb\r\n");
    }

    #[test]
    fn separators_and_decimal_commas_are_seen() {
        assert_eq!(["# a;b\ntime,x\n", "time;x\n", "time\tx\n", "x"].map(separator), [',', ';', '\t', ',']);
        for bad in ["0,5 1", "vertex 0 1,0e-3 2", "-0,5;2"] {
            assert!(decimal_comma(bad).is_some(), "{bad}");
        }
        for good in ["0.5,1", "0,1", "0, 1", "1 2", "x,y z"] {
            assert_eq!(decimal_comma(good), None);
        }
    }

    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(open_regular(folder.path()).unwrap_err().to_string(), "it is a folder");
        assert_eq!(open_regular(&folder.path().join("none")).unwrap_err().kind(), ErrorKind::NotFound);
        std::fs::write(folder.path().join("a"), "b").unwrap();
        assert!(open_regular(&folder.path().join("a")).is_ok());
        if cfg!(unix) {
            assert!(open_regular(Path::new("/dev/null")).unwrap_err().to_string().contains("a pipe or a device"));
        }
    }

    #[test]
    fn other_bytes_are_refused() {
        assert_eq!(text_of(&[b'a', 0xff]), Err(TextError::NotText { at: 1 }));
        assert_eq!(text_of(&[0xff, 0xfe, 0x41]), Err(TextError::Utf16));
        assert_eq!(text_of(&[0xff, 0xfe, 0x00, 0xd8]), Err(TextError::Utf16));
    }
}
