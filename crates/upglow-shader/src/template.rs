//! The functions of every shader, and which of them a model needs.

use upglow::{Accounting, Model};
use upglow_color::Choice as _;

use crate::language::Language;

const MATERIAL: &str = include_str!("templates/material.wgsl");
const SHARE: &str = include_str!("templates/share.wgsl");
const CURVES: &str = include_str!("templates/curves.wgsl");
const DYES: &str = include_str!("templates/dyes.wgsl");
const FILM: &str = include_str!("templates/film.wgsl");
const BELLS: &str = include_str!("templates/bells.wgsl");
const EVALUATION: &str = include_str!("templates/evaluation.wgsl");
const SAMPLING: &str = include_str!("templates/sampling.wgsl");
const MATRIX: &str = include_str!("templates/matrix.wgsl");

/// The functions that a model needs, in the templates' dialect, each before it is called.
pub(crate) fn functions(model: &Model, language: Language) -> String {
    let pieces: &[&str] = match model {
        Model::Reflectance => &[MATERIAL, EVALUATION, SAMPLING],
        Model::Dyes(_) => &[MATERIAL, SHARE, CURVES, DYES, EVALUATION, SAMPLING],
        Model::Film(_) => &[MATERIAL, SHARE, CURVES, FILM, EVALUATION, SAMPLING],
        Model::Analytic(_) => &[MATERIAL, SHARE, BELLS, EVALUATION, SAMPLING],
    };
    let mut traits = traits(model);
    traits.push(language.name());
    let pieces: Vec<String> = pieces.iter().map(|piece| kept(piece, &traits)).collect();
    pieces.join("\n")
}

/// The functions that find the nodes around a color, without their materials, in the templates' dialect.
pub(crate) fn places(language: Language) -> String {
    kept(MATERIAL, &["place", language.name()])
}

/// The functions that make the matrix of a color, in the templates' dialect.
pub(crate) fn matrix_functions(language: Language) -> String {
    places(language) + "\n" + MATRIX
}

/// The conditions of template lines that hold for a model.
fn traits(model: &Model) -> Vec<&'static str> {
    let mut traits = match model {
        Model::Reflectance => vec!["passive"],
        Model::Dyes(dyes) => {
            vec!["fluorescent", "concentrated", "dyes", dyes.options().mixing.name()]
        }
        Model::Film(_) => vec!["fluorescent", "film"],
        Model::Analytic(_) => vec!["fluorescent", "concentrated", "bells"],
    };
    traits.extend(model.accounting().map(Accounting::name));
    traits.push("material");
    traits
}

/// The lines outside all `//@if` … `//@end`, and those inside of one that names a trait.
fn kept(template: &str, traits: &[&str]) -> String {
    let mut text = String::new();
    let mut keeps = true;
    for line in template.lines() {
        if let Some(condition) = line.strip_prefix("//@if ") {
            keeps = traits.contains(&condition);
        } else if line == "//@end" {
            keeps = true;
        } else if keeps {
            text += line;
            text.push('\n');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_kept_for_the_traits_of_the_model() {
        let template = "a\n//@if dyes\nb\n//@end\n//@if bells\nc\n//@end\nd\n";
        assert_eq!(kept(template, &["dyes"]), "a\nb\nd\n");
        assert_eq!(kept(template, &[]), "a\nd\n");
    }

    const TEMPLATES: [&str; 9] =
        [MATERIAL, SHARE, CURVES, DYES, FILM, BELLS, EVALUATION, SAMPLING, MATRIX];

    #[test]
    fn every_condition_is_closed_and_a_trait_of_some_shader() {
        let known = [
            "material",
            "place",
            "passive",
            "fluorescent",
            "concentrated",
            "dyes",
            "film",
            "bells",
            "pooled",
            "separate",
            "energy",
            "photon",
            "osl",
            "js",
        ];
        for template in TEMPLATES {
            let mut open = false;
            for line in template.lines().filter(|line| line.trim_start().starts_with("//@")) {
                let opens = line.strip_prefix("//@if ").is_some_and(|name| known.contains(&name));
                assert!(opens != open && (opens || line == "//@end"), "{line}");
                open = opens;
            }
            assert!(!open);
        }
    }

    #[test]
    fn the_plainest_model_has_no_word_of_fluorescence() {
        let text = functions(&Model::Reflectance, Language::Wgsl);
        for word in ["dye", "bell", "film", "concentration", "upglow_share", "//@"] {
            assert!(!text.contains(word), "{word}");
        }
    }

    /// The code of all templates, without comments.
    fn code() -> impl Iterator<Item = &'static str> {
        TEMPLATES.iter().flat_map(|t| t.lines()).filter_map(|line| line.split("//").next())
    }

    #[test]
    fn quotients_of_integers_are_cut_where_a_language_has_no_integers() {
        for line in code() {
            for divisor in line.split(" / ").skip(1) {
                let after = divisor.trim_start_matches(|c: char| c.is_ascii_digit());
                let is_integer = after.len() < divisor.len() && !after.starts_with('.');
                assert!(!is_integer || line.contains("= i32(("), "{line}");
            }
        }
    }

    /// A struct is a value in all languages but `JavaScript`, where a name of it is a reference.
    #[test]
    fn no_struct_is_changed_through_a_second_name() {
        for line in code().map(str::trim) {
            if let Some(copied) = line.strip_prefix("var ").and_then(|l| l.split_once(": Upglow")) {
                let made = copied.1.ends_with(';') && !copied.1.contains(" = ")
                    || copied.1.contains(" = upglow_");
                assert!(made, "{line}");
            }
            let changed = line.split_once(" = ").map_or("", |(changed, _)| changed);
            assert!(changed.matches('.').count() <= 1, "{line}");
        }
    }

    /// Reserved words of the languages that could be taken as names.
    const RESERVED: &str = "active and arguments asm auto await binding case cast catch centroid channel class closure \
        coherent column_major common compile constant continuing debugger delete discard do double emit enum eval \
        export extends extern external filter final finally fixed flat get goto group half handle implements import instanceof highp hvec impl \
        in inline inout input interface invariant layout line lineadj linear long loop lowp match \
        matrix mediump mod module move namespace new noise normal not null of or out output \
        override package pass patch pixel point precise precision private protected ptr public \
        quad ref register resource sample sampler self set shader shared short signed sizeof \
        smooth snorm static string super switch target template texture this throw trait try typeof triangle \
        uniform union unit unorm unsigned use varying vector virtual void volatile where with yield";

    #[test]
    fn no_name_is_a_keyword_of_some_language() {
        let reserved: Vec<&str> = RESERVED.split_whitespace().collect();
        for line in code() {
            for word in line.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
                assert!(!reserved.contains(&word), "{line}");
            }
        }
    }
}
