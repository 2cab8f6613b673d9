//! Options whose values are words. One table gives names, parser and error.

/// A word that is not a value of an option.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} {found:?}, expected {expected}")]
pub struct UnknownChoice {
    /// What the option chooses.
    pub what: &'static str,
    /// The word given.
    pub found: String,
    /// The known words, as a phrase: "a, b or c".
    pub expected: String,
}

/// An option whose values are words. The macro `choices!` implements it, with `Display` and `FromStr`.
pub trait Choice: Copy + 'static {
    /// What the option chooses, for messages.
    const WHAT: &'static str;
    /// Every value, in the order of messages and help.
    const ALL: &'static [Self];

    /// The word for this value.
    fn name(self) -> &'static str;

    /// Former words for this value, which are read but never written.
    fn aliases(self) -> &'static [&'static str];

    /// The value of a word.
    ///
    /// # Errors
    ///
    /// [`UnknownChoice`] lists the known words, without former ones.
    fn named(word: &str) -> Result<Self, UnknownChoice> {
        let has_name = |value: &Self| value.name() == word || value.aliases().contains(&word);
        Self::ALL.iter().copied().find(has_name).ok_or_else(|| UnknownChoice {
            what: Self::WHAT,
            found: word.into(),
            expected: Self::known_words(),
        })
    }

    /// The known words, without former ones: "a, b or c".
    fn known_words() -> String {
        Self::words(Self::ALL)
    }

    /// The words of some values: "a, b or c".
    fn words(values: &[Self]) -> String {
        alternatives(values.iter().map(|value| value.name()))
    }
}

/// "a, b or c".
fn alternatives(words: impl Iterator<Item = &'static str>) -> String {
    let words: Vec<&str> = words.collect();
    match &words[..] {
        [rest @ .., last] if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        words => words.concat(),
    }
}

/// With the feature `serde`, a choice is serialized as its word.
#[cfg(feature = "serde")]
#[doc(hidden)]
#[macro_export]
macro_rules! serialize_choice {
    ($choice:ty) => {
        impl $crate::serde::Serialize for $choice {
            fn serialize<S: $crate::serde::Serializer>(
                &self,
                serializer: S,
            ) -> Result<S::Ok, S::Error> {
                serializer.serialize_str($crate::Choice::name(*self))
            }
        }
    };
}

#[cfg(not(feature = "serde"))]
#[doc(hidden)]
#[macro_export]
macro_rules! serialize_choice {
    ($choice:ty) => {};
}

/// Implements [`Choice`], `Display` and `FromStr` for an enum from a table of its values and their
/// words. Former words follow the present one: `Variant = "word" | "former word"`.
#[doc(hidden)]
#[macro_export]
macro_rules! choices {
    ($choice:ty, $what:literal, $(
        $variant:ident $(($inner:path))? = $name:literal $(| $alias:literal)*
    ),+ $(,)?) => {
        impl $crate::Choice for $choice {
            const WHAT: &'static str = $what;
            const ALL: &'static [Self] = &[$(Self::$variant $(($inner))?),+];

            fn name(self) -> &'static str {
                match self { $(Self::$variant $(($inner))? => $name),+ }
            }

            fn aliases(self) -> &'static [&'static str] {
                match self { $(Self::$variant $(($inner))? => &[$($alias),*]),+ }
            }
        }

        $crate::serialize_choice!($choice);

        impl ::std::fmt::Display for $choice {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad($crate::Choice::name(*self))
            }
        }

        impl ::std::str::FromStr for $choice {
            type Err = $crate::UnknownChoice;

            fn from_str(word: &str) -> Result<Self, Self::Err> {
                $crate::Choice::named(word)
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Gloss {
        Dull,
        Bright(Coat),
    }

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Coat {
        Thin,
        Thick,
    }

    choices!(
        Gloss,
        "gloss",
        Dull = "dull" | "matt" | "flat",
        Bright(Coat::Thin) = "thin",
        Bright(Coat::Thick) = "thick",
    );

    #[test]
    fn words_round_trip_and_former_words_are_read() {
        for &gloss in Gloss::ALL {
            assert_eq!(gloss.to_string().parse(), Ok(gloss));
        }
        assert_eq!(["matt", "flat"].map(Gloss::named), [Ok(Gloss::Dull), Ok(Gloss::Dull)]);
    }

    #[test]
    fn the_error_for_an_unknown_word_lists_the_known_ones() {
        let unknown = "shiny".parse::<Gloss>().unwrap_err();
        assert_eq!(unknown.to_string(), "unknown gloss \"shiny\", expected dull, thin or thick");
        assert_eq!(alternatives(["one"].into_iter()), "one");
    }
}
