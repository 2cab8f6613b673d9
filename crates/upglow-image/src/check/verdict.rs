//! The result of a check in sentences.

use upglow_color::StandingKind;
use upglow_fit::CubeSummary;

use super::alternatives::Change;
use super::cube_match::CubeMatch;
use super::report::CheckReport;
use super::text::{grouped, percent};

/// Another cube is advised if it brings at least this share of what the cube misses within 1 ΔE00: less is
/// within the error of the estimate, or not worth another cube.
const WORTH_IT: f64 = 0.2;

impl CheckReport {
    /// The result in one sentence.
    #[must_use]
    pub fn headline(&self) -> String {
        match (self.counts.no_color, &self.cube) {
            (0, Some(cube)) => self.cube_headline(cube),
            (0, None) => self.needs_headline(),
            (1, _) => "1 texel is NaN or infinite.".into(),
            (no_color, _) => format!("{} texels are NaN or infinite.", grouped(no_color)),
        }
    }

    fn needs_headline(&self) -> String {
        let counts = &self.counts;
        let needs = percent(counts.share(counts.needs_fluorescence));
        let beyond = percent(counts.share(counts.unreachable));
        match (counts.unreachable, counts.needs_fluorescence) {
            (0, 0) => "Reflectances match every texel.".into(),
            (0, _) => {
                format!("{needs} of the texels need fluorescence; materials match all texels.")
            }
            (_, 0) => format!("No material matches {beyond} of the texels."),
            _ => format!("{needs} of the texels need fluorescence; no material matches {beyond}."),
        }
    }

    fn cube_headline(&self, cube: &CubeMatch) -> String {
        let all = self.counts.texels;
        let beyond = cube.beyond_one.texels();
        let outside = all - cube.texels;
        if beyond == 0 && outside == 0 {
            let greatest = cube.greatest_de2000;
            return if greatest <= CubeSummary::EXACT_DE2000 {
                "This cube matches every texel.".into()
            } else {
                format!("Every texel is within 1 ΔE00 with this cube, at most {greatest:.2} off.")
            };
        }
        let share = |texels| percent(self.counts.share(texels));
        let within = share(cube.texels - beyond);
        let mut sentence = format!("{within} of this picture is within 1 ΔE00 with this cube");
        if beyond > 0 {
            let (kind, hue, count) = cube.beyond_one.most();
            let colors = hue.map_or("colors", |hue| hue.words());
            let most = if count == beyond { "" } else { "mostly " };
            let why = match kind {
                StandingKind::Reflectance => "that only a steeper reflectance or dye shows",
                StandingKind::NeedsFluorescence => "that only fluorescence shows",
                StandingKind::Unreachable => "that no material shows",
            };
            sentence += &format!("; {} is further off", share(beyond));
            // Less than half of them explain nothing.
            if 2 * count > beyond {
                sentence += &format!(": {most}{colors} {why}");
            }
        }
        if outside > 0 {
            let outside = share(outside);
            sentence += &format!("; {outside} is outside 0 to 1, where it has no material");
        }
        sentence + "."
    }

    /// What to do about it, in one sentence; options are between backticks.
    #[must_use]
    pub fn advice(&self) -> String {
        let counts = &self.counts;
        if counts.no_color > 0 {
            return "Find the cause of the NaN or infinite values (the first texels are listed below), \
                    or make them black with `--repair`."
                .into();
        }
        if !counts.all_in_range() {
            let wider = self.cube.as_ref().and_then(|cube| cube.wider_space.as_ref());
            let wider = wider.map_or(String::new(), |wider| {
                let (inside, space) = (percent(wider.inside), &wider.space);
                format!(" About {inside} of them are inside in {space}: build the cube with `--space {space}`.")
            });
            return "Baking refuses values outside 0 to 1: correct them, or use `--repair clip`, `scale` \
                    or `nearest`."
                .to_owned()
                + &wider;
        }
        self.cube
            .as_ref()
            .map_or_else(|| self.advice_on_needs().into(), |cube| self.advice_on(cube))
    }

    fn advice_on_needs(&self) -> &'static str {
        if self.counts.unreachable > 0 {
            "Desaturate the areas that are pink to purple in the map, or let `--repair nearest` move \
             them to the nearest color of a material."
        } else if self.counts.needs_fluorescence > 0 {
            "Bake it with a cube that has dyes; without dyes, the areas that are yellow to brown in the \
             map become less saturated."
        } else {
            "Bake it with any cube: it needs no fluorescence."
        }
    }

    fn advice_on(&self, cube: &CubeMatch) -> String {
        if cube.beyond_one.texels() == 0 {
            return "Bake it with this cube.".into();
        }
        if let Some((better, own)) = better(&cube.changes) {
            let (to, from) = (percent(better.within_one), percent(own.within_one));
            return format!(
                "A cube with {} (`{}`) brings about {to} within 1 ΔE00 instead of {from}.",
                better.name, better.options
            );
        }
        match cube.beyond_one.most().0 {
            StandingKind::Unreachable => {
                "Desaturate the areas that are red in the map of differences, or accept the nearest \
                 colors: no other cube brings much more within 1 ΔE00."
            }
            StandingKind::Reflectance | StandingKind::NeedsFluorescence => {
                "None of the other presets brings much more within 1 ΔE00: desaturate the areas that are \
                 red in the map of differences, or give the cube other dyes with `--dyes`."
            }
        }
        .into()
    }
}

/// The other cube that brings most within 1 ΔE00, if that is worth it, and the cube itself.
fn better(changes: &[Change]) -> Option<(&Change, &Change)> {
    let own = changes.first()?;
    let others = changes.iter().filter(|change| !change.options.is_empty());
    // The first of several that are as good.
    let best = others.reduce(|a, b| if b.within_one > a.within_one { b } else { a })?;
    let gain = best.within_one - own.within_one;
    (gain >= WORTH_IT * (1.0 - own.within_one)).then_some((best, own))
}
