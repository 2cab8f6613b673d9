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

    const TEMPLATES: [&str; 8] = [MATERIAL, SHARE, CURVES, DYES, FILM, BELLS, EVALUATION, SAMPLING];

    #[test]
    fn every_condition_is_closed_and_a_trait_of_some_shader() {
        let known = [
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

    /// Reserved words of the languages that could be taken as names.
    const RESERVED: &str = "active and asm auto binding case cast centroid channel class closure \
        coherent column_major common compile constant continuing discard do double emit enum \
        export extern external filter final fixed flat get goto group half handle highp hvec impl \
        in inline inout input interface invariant layout line lineadj linear long loop lowp match \
        matrix mediump mod module move namespace new noise normal not null of or out output \
        override package pass patch pixel point precise precision private protected ptr public \
        quad ref register resource sample sampler self set shader shared short signed sizeof \
        smooth snorm static string super switch target template texture this trait triangle \
        uniform union unit unorm unsigned use varying vector virtual void volatile where with";

    #[test]
    fn no_name_is_a_keyword_of_some_language() {
        let reserved: Vec<&str> = RESERVED.split_whitespace().collect();
        for template in TEMPLATES {
            for line in template.lines() {
                let code = line.split("//").next().unwrap_or_default();
                for word in code.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
                    assert!(!reserved.contains(&word), "{line}");
                }
            }
        }
    }
}
