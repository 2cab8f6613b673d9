//! Why a cube misses texels, and what other cubes would do with them.

use std::fmt;

use rayon::prelude::*;
use upglow::{Cube, Model, Node};
use upglow_color::{Choice as _, Contract, Grid, LinearRgb, RgbSpace, StandingKind, Xyz};
use upglow_fit::{FitOptions, Fitter, Polisher, Preset};

use super::cube_match::{BEYOND, BlendFindings, ColorDifference, DRAWN, OUTSIDE, WITHIN};
use super::display::Display;
use super::draw::Draw;
use super::limits::{Blends, Limits};
use super::ranking::Candidate;

/// Fits of single colors with a cube's own options and with others.
#[derive(Debug)]
pub(super) struct Alternatives<'c> {
    has_no_dyes: bool,
    slope_max_per_nm: Option<f64>,
    /// With the cube's options; `None` if these are of another version.
    own: Option<Fitter>,
    steeper: Option<Alternative>,
    presets: Vec<Alternative>,
    polisher: Option<Polisher<'c>>,
}

/// Fits as for another cube.
#[derive(Debug)]
struct Alternative {
    name: String,
    options: String,
    fitter: Fitter,
}

/// What a cube does with a picture, or would do.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Change {
    /// What is different from the cube, in words.
    pub name: String,
    /// The options of `upglow build` for it; empty for the cube itself.
    pub options: String,
    /// Share of the texels in range within 1 ΔE00, 0..=1. For other cubes it is estimated from colors that are
    /// fitted one by one, so without what interpolation between nodes costs.
    pub within_one: f64,
    /// Share of these texels that have dye, estimated likewise.
    pub with_dye: f64,
    /// Colors that were fitted; none for the cube itself.
    pub fitted: usize,
}

/// A texel that a cube misses.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MissedTexel {
    /// Column, from 0 at the left.
    pub x: usize,
    /// Row, from 0 at the top.
    pub y: usize,
    /// Its color, linear RGB of the contract's space.
    pub rgb: [f32; 3],
    /// ΔE00 of the cube's blend.
    pub de2000: f64,
    /// From the texel's color to that of the cube's blend.
    pub difference: ColorDifference,
    /// ΔE00 to the nearest color of any material; 0 if some material matches it.
    pub material_de2000: f64,
    /// ΔE00 of the single material that `upglow bake` stores, if there is one.
    pub polished_de2000: Option<f64>,
    /// Why it is missed.
    pub cause: Cause,
    /// The texel's color, that of the cube's blend, and the nearest of any material, in sRGB.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) swatches: [[u8; 3]; 3],
}

/// Why a cube misses a color: what more than half of the difference goes back to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", tag = "because"))]
#[non_exhaustive]
pub enum Cause {
    /// It lies between nodes: a material of its own, with the cube's options, is nearer.
    BetweenNodes {
        /// ΔE00 of that material.
        own_de2000: f64,
    },
    /// No material shows it.
    NoMaterial,
    /// The cube's reflectances are not steep enough.
    Slope {
        /// The cube's limit, 1/nm.
        limit_per_nm: f64,
        /// ΔE00 with [`Cause::STEEPER`] times that limit.
        steeper_de2000: f64,
    },
    /// It needs fluorescence, and the cube has none.
    NoFluorescence,
    /// It needs other dyes, or more of them.
    Dyes,
}

impl Cause {
    /// How much steeper the reflectances are that a cube's own are compared with.
    pub const STEEPER: f64 = 2.0;
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BetweenNodes { own_de2000 } => {
                write!(f, "between nodes: fitted by itself it is {own_de2000:.2} off")
            }
            Self::NoMaterial => f.write_str("no material shows it"),
            Self::Slope { limit_per_nm, steeper_de2000 } => write!(
                f,
                "needs a reflectance steeper than {limit_per_nm}/nm: {steeper_de2000:.2} off with \
                 {}/nm",
                limit_per_nm * Self::STEEPER
            ),
            Self::NoFluorescence => f.write_str("needs fluorescence, which the cube lacks"),
            Self::Dyes => f.write_str("needs other dyes, or more of them"),
        }
    }
}

/// An RGB space that has texels inside which are outside 0..=1 in the cube's.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct WiderSpace {
    /// Its name.
    pub space: String,
    /// Share of the texels outside that it has inside, estimated from some of them, 0..=1.
    pub inside: f64,
    /// Colors that this was estimated from.
    pub sampled: usize,
}

impl<'c> Alternatives<'c> {
    pub(super) fn new(cube: &'c Cube) -> Self {
        let (contract, model) = (cube.contract(), cube.model());
        let options = FitOptions::try_from(cube.fit()).ok();
        let fitter = |options: FitOptions| Fitter::new(contract, model, options).ok();
        let base = match &cube.fit().preset {
            Some(preset) if *preset == Preset::default().to_string() => String::new(),
            Some(preset) => format!("--preset {preset} "),
            None => "the cube's own and ".into(),
        };
        let steeper = options.and_then(|options| {
            let limit = Cause::STEEPER * options.slope_max_per_nm?;
            Some(Alternative {
                name: format!("slopes up to {limit}/nm"),
                options: format!("{base}--slope-max-per-nm {limit}"),
                fitter: fitter(options.with_slope_max_per_nm(Some(limit)))?,
            })
        });
        let own_preset = options.and_then(|options| Preset::of(model, &options));
        let others = Preset::ALL.iter().filter(|preset| Some(**preset) != own_preset);
        let presets = others.filter_map(|preset| {
            Some(Alternative {
                name: format!("preset {preset}"),
                options: format!("--preset {preset}"),
                fitter: Fitter::new(contract, &preset.model(), preset.options()).ok()?,
            })
        });
        Self {
            has_no_dyes: matches!(model, Model::Reflectance),
            slope_max_per_nm: cube.fit().slope_max_per_nm,
            own: options.and_then(fitter),
            steeper,
            presets: presets.collect(),
            polisher: Polisher::new(cube).ok(),
        }
    }

    /// Measures the texels that the cube misses most, which were ranked by their differences.
    pub(super) fn measure(
        &self,
        ranked: &[Candidate],
        limits: &Limits<'_>,
        blends: &Blends<'_>,
        display: &Display,
    ) -> Vec<MissedTexel> {
        let measured =
            ranked.par_iter().map(|&Candidate { x, y, rgb, distance: de2000, .. }| {
                let color = LinearRgb(rgb.map(f64::from));
                let standing = limits.table.standing(color);
                let colorimetry = limits.table.colorimetry();
                let wanted = colorimetry.xyz_from_rgb(color);
                let mut blend = [[0.0; 3]];
                blends.colors.xyz(&[rgb], &mut blend).expect("one color for one");
                let blend = Xyz(blend[0].map(f64::from));
                let [from, to] = [wanted, blend].map(|xyz| colorimetry.lab_from_xyz(xyz));
                let nearest = standing.fluorescence;
                MissedTexel {
                    x,
                    y,
                    rgb,
                    de2000,
                    difference: ColorDifference::new(from, to),
                    material_de2000: nearest.de2000,
                    polished_de2000: self.polished(rgb),
                    cause: self.cause(color, de2000, standing.kind, nearest.de2000),
                    swatches: display.srgb_together([wanted, blend, nearest.color]),
                }
            });
        measured.collect()
    }

    fn polished(&self, rgb: [f32; 3]) -> Option<f64> {
        let mut node = [Node::default()];
        self.polisher.as_ref()?.polish(&[rgb], &mut node).expect("one material for one color");
        Some(node[0].de2000.into())
    }

    /// Each cause is named if it leaves less than half of the difference that the causes before left.
    fn cause(
        &self,
        color: LinearRgb,
        de2000: f64,
        needs: StandingKind,
        material_de2000: f64,
    ) -> Cause {
        let off = |fitter: &Fitter| fitter.fit(color).map_or(f64::INFINITY, |fit| fit.de2000);
        let own_de2000 = self.own.as_ref().map_or(de2000, off);
        if own_de2000 < de2000 / 2.0 {
            return Cause::BetweenNodes { own_de2000 };
        }
        if needs == StandingKind::Unreachable && material_de2000 > own_de2000 / 2.0 {
            return Cause::NoMaterial;
        }
        if let (Some(limit_per_nm), Some(steeper)) = (self.slope_max_per_nm, &self.steeper) {
            let steeper_de2000 = off(&steeper.fitter);
            if steeper_de2000 < own_de2000 / 2.0 {
                return Cause::Slope { limit_per_nm, steeper_de2000 };
            }
        }
        if self.has_no_dyes { Cause::NoFluorescence } else { Cause::Dyes }
    }

    /// What the cube does, which is known, and what others would do.
    pub(super) fn changes(
        &self,
        found: &BlendFindings,
        [within_one, with_dye]: [f64; 2],
    ) -> Vec<Change> {
        if found.texels == 0 {
            return Vec::new();
        }
        let own = Change {
            name: "this cube".into(),
            options: String::new(),
            within_one,
            with_dye,
            fitted: 0,
        };
        let drawn = [WITHIN, BEYOND].map(|which| &found.drawn[which]);
        let change = |name: &str, options: &str, fitter: &Fitter| {
            let [a, b] = drawn.map(|draw| shares(draw, fitter));
            let both = |k: usize| within_one * a[k] + (1.0 - within_one) * b[k];
            Change {
                name: name.into(),
                options: options.into(),
                within_one: both(0),
                with_dye: both(1),
                fitted: drawn.iter().map(|draw| draw.colors().count()).sum(),
            }
        };
        let alone = self.own.as_ref().map(|own| change("each color fitted by itself", "", own));
        let others = self.steeper.iter().chain(&self.presets);
        let others = others.map(|other| change(&other.name, &other.options, &other.fitter));
        std::iter::once(own).chain(alone).chain(others).collect()
    }
}

/// Of the colors of a draw, the share whose fits are within 1 ΔE00, and the share of fits with dye.
fn shares(draw: &Draw<DRAWN>, fitter: &Fitter) -> [f64; 2] {
    let colors: Vec<[f32; 3]> = draw.colors().collect();
    let fits = colors.par_iter().map(|rgb| fitter.fit(LinearRgb(rgb.map(f64::from))));
    let counts = fits.map(|fit| {
        let fit = fit.expect("blends are drawn in 0..=1");
        [usize::from(fit.de2000 <= 1.0), usize::from(fit.fluorescence.dose() > 0.0)]
    });
    let counts = counts.reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    counts.map(|count| count as f64 / colors.len().max(1) as f64)
}

impl WiderSpace {
    /// The first of the built-in spaces that has the most of the texels inside that a cube has outside.
    pub(super) fn of(found: &BlendFindings, limits: &Limits<'_>) -> Option<Self> {
        let contract = &limits.contract;
        let outside: Vec<Xyz> = found.drawn[OUTSIDE]
            .colors()
            .map(|rgb| limits.table.colorimetry().xyz_from_rgb(LinearRgb(rgb.map(f64::from))))
            .collect();
        let others = RgbSpace::names().into_iter().filter(|name| *name != contract.space.name());
        let counted = others.filter_map(|name| {
            let space = RgbSpace::named(name).ok()?;
            let colorimetry = Contract { space, ..contract.clone() }.on(Grid::FIT);
            let is_inside = |xyz: &&Xyz| {
                colorimetry.rgb_from_xyz(**xyz).0.iter().all(|v| (0.0..=1.0).contains(v))
            };
            Some((name, outside.iter().filter(is_inside).count()))
        });
        let most = counted.fold(None, |most: Option<(&str, usize)>, next| match most {
            Some(most) if most.1 >= next.1 => Some(most),
            _ => Some(next),
        });
        let (space, inside) = most.filter(|(_, inside)| *inside > 0)?;
        let sampled = outside.len();
        Some(Self { space: space.into(), inside: inside as f64 / sampled as f64, sampled })
    }
}
