//! File names in which a word replaces a number: `<UDIM>`, `%04d` or `####`.

use std::path::{Path, PathBuf};

use upglow_terminal::Failure;

/// A file name with one such word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NamePattern {
    folder: PathBuf,
    before: String,
    word: String,
    number: Number,
    after: String,
}

/// The numbers that a word replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    /// A tile of a UDIM: four digits, 1001 or greater.
    Udim,
    /// At least as many digits, of which the first is 0 only to make up this count.
    Digits(usize),
}

/// The word for the number of a tile.
pub(crate) const UDIM: &str = "<UDIM>";

/// Whether a text is the number of a UDIM tile.
pub(crate) fn is_udim(text: &str) -> bool {
    Number::Udim.is(text)
}

impl NamePattern {
    /// The pattern of a path whose file name has such a word; `None` for other paths.
    ///
    /// # Errors
    ///
    /// [`Failure`] if it has several.
    pub(crate) fn of(path: &Path) -> Result<Option<Self>, Failure> {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(None) };
        let Some((before, word, number, after)) = split(name) else { return Ok(None) };
        if split(after).is_some() {
            let message = format!("more than {word} in its name, expected one word for a number");
            return Err(Failure::file(path, message));
        }
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let [before, word, after] = [before, word, after].map(str::to_owned);
        Ok(Some(Self { folder, before, word, number, after }))
    }

    /// The word.
    pub(crate) fn word(&self) -> &str {
        &self.word
    }

    /// The path with a number in place of the word.
    pub(crate) fn with(&self, number: &str) -> PathBuf {
        self.folder.join([&self.before, number, &self.after].concat())
    }

    /// The numbers of the files that have one in place of the word, in ascending order, and these files.
    ///
    /// # Errors
    ///
    /// [`Failure`] if there are none, or the folder cannot be read.
    pub(crate) fn files(&self) -> Result<Vec<(String, PathBuf)>, Failure> {
        let path = self.with(&self.word);
        let here = Path::new(".");
        let folder = if self.folder.as_os_str().is_empty() { here } else { &self.folder };
        let unread = |error| Failure::system(folder, &error, "a folder of pictures");
        let mut found = Vec::new();
        for entry in folder.read_dir().map_err(unread)? {
            let name = entry.map_err(unread)?.file_name();
            let number = name
                .to_str()
                .and_then(|name| name.strip_prefix(&*self.before)?.strip_suffix(&*self.after));
            if let Some(number) = number.filter(|text| self.number.is(text)) {
                found.push((number.to_owned(), self.with(number)));
            }
        }
        // A longer number is a greater one, because it does not begin with 0.
        found.sort_by(|(a, _), (b, _)| a.len().cmp(&b.len()).then_with(|| a.cmp(b)));
        if found.is_empty() {
            let expected = match self.number {
                Number::Udim => "four digits from 1001 on".to_owned(),
                Number::Digits(0) => "a number".to_owned(),
                Number::Digits(least) => format!("a number of {least} digits"),
            };
            let message = format!("no file of such a name, expected {expected} for {}", self.word);
            return Err(Failure::file(&path, message));
        }
        Ok(found)
    }
}

impl Number {
    fn is(self, text: &str) -> bool {
        let all_digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        all_digits
            && match self {
                Self::Udim => text.len() == 4 && text > "1000",
                Self::Digits(least) => {
                    text.len() == least.max(1) || text.len() > least && !text.starts_with('0')
                }
            }
    }
}

/// The text before the first word for a number, the word, what it replaces, and the text after it.
fn split(name: &str) -> Option<(&str, &str, Number, &str)> {
    let at = |start: usize, length: usize, number: Number| {
        let end = start + length;
        (&name[..start], &name[start..end], number, &name[end..])
    };
    let udim = name.find(UDIM).map(|start| at(start, UDIM.len(), Number::Udim));
    let hashes = name.find('#').map(|start| {
        let rest = name[start..].trim_start_matches('#');
        let count = name.len() - start - rest.len();
        at(start, count, Number::Digits(count))
    });
    let printf = name.match_indices('%').find_map(|(start, _)| {
        let digits: String = name[start + 1..].chars().take_while(char::is_ascii_digit).collect();
        let is_padded = digits.is_empty() || digits.starts_with('0');
        let is_word = is_padded && name[start + 1 + digits.len()..].starts_with('d');
        let least = if digits.is_empty() { 0 } else { digits.parse().ok()? };
        is_word.then(|| at(start, digits.len() + 2, Number::Digits(least)))
    });
    [udim, hashes, printf].into_iter().flatten().min_by_key(|found| found.0.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path, pattern: &str) -> Result<Vec<String>, Failure> {
        let pattern = NamePattern::of(&folder.join(pattern))?.expect("a pattern");
        let name = |(_, path): (String, PathBuf)| {
            path.file_name().unwrap_or_default().to_string_lossy().into_owned()
        };
        Ok(pattern.files()?.into_iter().map(name).collect())
    }

    #[test]
    fn a_word_replaces_numbers_in_ascending_order() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["0998", "1001", "1011", "9999", "10001", "12", "7", "007", "x1"] {
            std::fs::write(folder.path().join(format!("a.{name}.png")), "").expect("a file");
        }
        let found = |pattern: &str| names(folder.path(), pattern).expect("files").join(" ");
        assert_eq!(found("a.<UDIM>.png"), "a.1001.png a.1011.png a.9999.png");
        let four = "a.0998.png a.1001.png a.1011.png a.9999.png a.10001.png";
        assert_eq!(found("a.%04d.png"), four);
        assert_eq!(found("a.####.png"), four);
        assert_eq!(
            found("a.%d.png"),
            "a.7.png a.12.png a.1001.png a.1011.png a.9999.png a.10001.png"
        );
        assert_eq!(found("a.###.png").split(' ').next(), Some("a.007.png"));
        let message = names(folder.path(), "b.<UDIM>.png").expect_err("no files");
        let Failure::Input(message) = message else { panic!("{message:?}") };
        let line = "no file of such a name, expected four digits from 1001 on for <UDIM>";
        assert!(message.ends_with(line), "{message}");
    }

    #[test]
    fn a_name_has_one_word_or_none() {
        let of = |name: &str| NamePattern::of(Path::new(name));
        for name in ["a.png", "100%.png", "50%dark.png.", "a<udim>.png", "%4d.png"] {
            let is_pattern = name.contains("%d");
            assert_eq!(of(name).expect(name).is_some(), is_pattern, "{name}");
        }
        assert!(of("a.%04d.<UDIM>.exr").is_err());
        let pattern = of("x/a_<UDIM>_b.exr").expect("one word").expect("a pattern");
        assert_eq!((pattern.word(), pattern.with("1002")), (UDIM, "x/a_1002_b.exr".into()));
    }
}
