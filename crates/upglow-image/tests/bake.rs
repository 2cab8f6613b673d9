//! What baked files promise: colors, filtering, precision, energy, and the same bytes every time.

#![expect(clippy::unwrap_used, reason = "a test fails where its files cannot be made")]

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use tempfile::TempDir;
use upglow::{
    Accounting, AnalyticModel, Cube, DyeModel, DyeOptions, DyeSet, FilmModel, Fluorescence,
    Interpolation, Material, Mixture, Model, ModelOnGrid, Node, QuantumYield, ReducedModel,
};
use upglow_color::{
    Choice as _, Colorimetry, Contract, Grid, Illuminant, LinearRgb, ReducedBasis, RgbSpace, Xyz,
    ciede2000, lab_from_xyz, srgb_encoded,
};
use upglow_fit::{
    BlendKinds, CubeSummary, KindCounts, MaterialKind, Polisher, Preset, Unwatched, build_cube,
};
use upglow_image::{
    BakeError, BakeOptions, Baked, Baker, Checker, Declared, Encoding, ExamplePicture,
    ExrDescription, ExrReader, ExrWriter, Form, Incident, Layout, Lint, MaterialPicture, Picture,
    PngBits, Repair, Sample, SpectralPicture, SpectralTexel,
};

const POLISHED: Form = Form::Material;

/// The bands that most programs use.
fn tens() -> Grid {
    Grid::try_new(380, 780, 10).unwrap()
}

fn spectral(grid: Grid, compact: bool) -> Form {
    Form::Spectral { grid, compact }
}

fn radiance(light: &str) -> Form {
    Form::Radiance { light: Illuminant::named(light).unwrap() }
}

fn dyes(set: &str) -> Model {
    Model::Dyes(DyeModel::new(DyeSet::named(set).unwrap(), DyeOptions::default()).unwrap())
}

fn built(set: &str, resolution: usize) -> Cube {
    let options = Preset::Konig2020.options();
    build_cube(&Contract::default(), &dyes(set), options, resolution, &Unwatched).unwrap()
}

/// A film of the dyes of a set, with photons conserved.
fn film(set: &str, resolution: usize) -> Cube {
    let set = DyeSet::named(set).unwrap();
    let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Measured).unwrap();
    let (model, options) = (Model::Film(film), Preset::Konig2020.options());
    build_cube(&Contract::default(), &model, options, resolution, &Unwatched).unwrap()
}

/// Ten nodes per side, in ACEScg under D65.
fn cube() -> &'static Cube {
    static CUBE: OnceLock<Cube> = OnceLock::new();
    CUBE.get_or_init(|| built("konig8", 10))
}

fn colorimetry() -> &'static Colorimetry {
    static COLORIMETRY: OnceLock<Colorimetry> = OnceLock::new();
    COLORIMETRY.get_or_init(|| cube().contract().on(Grid::FIT))
}

fn difference(a: Xyz, b: Xyz) -> f64 {
    let white = colorimetry().white();
    ciede2000(lab_from_xyz(a, white), lab_from_xyz(b, white))
}

/// Number `i` of points that fill the unit cube evenly, away from its faces.
fn spread(i: usize) -> [f64; 3] {
    // Powers of the root of x⁴ = x + 1: no two of them are in a simple ratio.
    [0.819_172_513, 0.671_043_606, 0.549_700_477].map(|a| (0.5 + a * i as f64).fract())
}

fn single(rgb: [f64; 3]) -> [f32; 3] {
    #[expect(clippy::cast_possible_truncation, reason = "pictures hold single precision")]
    rgb.map(|v| v as f32)
}

fn random_colors(count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|i| single(spread(i))).collect()
}

/// A folder for pictures and what is baked of them.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A picture in ACEScg of rows of `width` texels.
    fn picture(
        &self,
        name: &str,
        width: usize,
        rgb: &[[f32; 3]],
        alpha: Option<&[f32]>,
    ) -> PathBuf {
        let path = self.path(name);
        let names = ["R", "G", "B", "A"][..3 + usize::from(alpha.is_some())].iter().copied();
        let described = ExrDescription::new([width, rgb.len() / width], names)
            .with_sample(Sample::Float)
            .with_space(&RgbSpace::default());
        let mut planes = [0, 1, 2].map(|k| rgb.iter().map(|v| v[k]).collect()).to_vec();
        planes.extend(alpha.map(<[f32]>::to_vec));
        let planes: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
        let mut writer = ExrWriter::create(&path, described).unwrap();
        writer.write_band(&planes).unwrap();
        writer.finish().unwrap();
        path
    }

    /// Bakes colors with [`cube`] and returns the path of the file.
    fn baked(&self, form: Form, sample: Sample, width: usize, rgb: &[[f32; 3]]) -> PathBuf {
        self.baked_with(cube(), form, sample, width, rgb)
    }

    fn baked_with(
        &self,
        cube: &Cube,
        form: Form,
        sample: Sample,
        width: usize,
        rgb: &[[f32; 3]],
    ) -> PathBuf {
        let input = self.picture("in.exr", width, rgb, None);
        let output = self.path("out.exr");
        bake(cube, form, options(sample), &input, &output).unwrap();
        output
    }
}

fn options(sample: Sample) -> BakeOptions {
    BakeOptions { declared: Declared::default(), repair: None, sample, layout: Layout::Rows }
}

fn bake(
    cube: &Cube,
    form: Form,
    options: BakeOptions,
    input: &Path,
    output: &Path,
) -> Result<Baked, BakeError> {
    Baker::new(cube, form, options)?.bake(input, output, &Unwatched)
}

/// All samples of some channels.
fn planes<const N: usize>(path: &Path, names: [&str; N]) -> [Vec<f32>; N] {
    let mut reader = ExrReader::open(path).unwrap();
    let numbers = names.map(|name| reader.channel(name).unwrap());
    let [_, height] = reader.size();
    reader.read_rows(0..height, &numbers).unwrap().try_into().unwrap()
}

/// The bytes of a baked file without the hash of what made it.
fn made(path: &Path) -> Vec<u8> {
    const MADE: &[u8] = b"upglow.made\0string\0";
    let mut bytes = std::fs::read(path).unwrap();
    let at = bytes.windows(MADE.len()).position(|window| window == MADE).unwrap() + MADE.len();
    // The length comes first; 32 bytes are 64 digits.
    bytes[at + 4..at + 4 + 64].fill(b'0');
    bytes
}

fn colors(path: &Path) -> Vec<[f64; 3]> {
    let [r, g, b] = planes(path, ["R", "G", "B"]);
    (0..r.len()).map(|i| [r[i], g[i], b[i]].map(f64::from)).collect()
}

fn materials(path: &Path) -> Vec<Material> {
    let mut picture = MaterialPicture::open(path).unwrap();
    let [_, height] = picture.size();
    (0..height).flat_map(|y| picture.row(y).unwrap()).collect()
}

fn texels(path: &Path) -> Vec<SpectralTexel> {
    let mut picture = SpectralPicture::open(path).unwrap();
    let [width, height] = picture.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    places.map(|(x, y)| picture.at(x, y).unwrap()).collect()
}

fn xyz(rgb: [f64; 3]) -> Xyz {
    colorimetry().xyz_from_rgb(LinearRgb(rgb))
}

fn mean(values: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|k| values.iter().map(|v| v[k]).sum::<f64>() / values.len() as f64)
}

/// Cells all of whose eight corners match their colors, by their dark corner.
fn exact_cells() -> Vec<[usize; 3]> {
    let n = cube().resolution();
    let exact = |[r, g, b]: [usize; 3]| {
        f64::from(cube().nodes()[(b * n + g) * n + r].de2000) <= CubeSummary::EXACT_DE2000
    };
    let sides = || 0..n - 1;
    let cells = sides().flat_map(|r| sides().flat_map(move |g| sides().map(move |b| [r, g, b])));
    let corners =
        |[r, g, b]: [usize; 3]| (0..8).map(move |i| [r + (i & 1), g + (i >> 1 & 1), b + (i >> 2)]);
    cells.filter(|&cell| corners(cell).all(exact)).collect()
}

/// Texels that a filter averages into one.
const BLOCK: usize = 16;
/// Greatest difference between filtering a block of exact cells before and after baking.
const FILTERED_DE2000: f64 = 0.01;

#[test]
fn filtering_first_or_last_gives_the_same_radiance_where_corners_are_exact() {
    let cells = exact_cells();
    assert!(cells.len() > 100, "only {} exact cells", cells.len());
    let side = (cube().resolution() - 1) as f64;
    let texel = |cell: &[usize; 3], i: usize| {
        let place = spread(i);
        single([0, 1, 2].map(|k| (cell[k] as f64 + place[k]) / side))
    };
    let blocks: Vec<Vec<[f32; 3]>> =
        cells.iter().map(|cell| (0..BLOCK).map(|i| texel(cell, i)).collect()).collect();
    let means: Vec<[f32; 3]> = blocks
        .iter()
        .map(|b| single(mean(&b.iter().map(|c| c.map(f64::from)).collect::<Vec<_>>())))
        .collect();
    let desk = Desk::new();
    let last = colors(&desk.baked(radiance("D65"), Sample::Float, BLOCK, &blocks.concat()));
    let first = colors(&desk.baked(radiance("D65"), Sample::Float, 1, &means));
    for (first, last) in first.iter().zip(last.chunks(BLOCK)) {
        let found = difference(xyz(*first), xyz(mean(last)));
        assert!(found < FILTERED_DE2000, "{found} {first:?}");
    }
}

#[test]
fn four_files_hold_the_matrices_of_blends_for_an_engine() {
    // Single precision of numbers up to 4.
    const ROUNDING: f64 = 1e-6;
    let basis = ReducedBasis::try_new(cube().contract(), Grid::FIT).unwrap();
    let engine = RgbSpace::named("rec709").unwrap();
    let space = basis.engine_space(&engine).unwrap();
    let model = ReducedModel::new(cube().model(), &basis);
    let rgb = random_colors(400);
    let desk = Desk::new();
    let form = |&incident| Form::Matrix { engine: Some(engine.clone()), incident };
    let forms: Vec<Form> = Incident::ALL.iter().map(form).collect();
    let bakers = Baker::of_forms(cube(), &forms, &options(Sample::Float)).unwrap();
    let input = desk.picture("in.exr", 20, &rgb, None);
    let bakers = bakers.iter().zip(Incident::ALL).enumerate();
    for (column, (baker, incident)) in bakers {
        let path = desk.path("out.exr");
        baker.bake(&input, &path, &Unwatched).unwrap();
        let found = planes(&path, ["R", "G", "B", "U"]);
        for (texel, rgb) in rgb.iter().enumerate() {
            let color = LinearRgb(rgb.map(f64::from));
            let mixture = cube().lookup(color, Interpolation::Blend).unwrap();
            let expected = space.matrix(mixture.reduced_matrix(&model)).0;
            for (plane, row) in found.iter().zip(expected) {
                let error = f64::from(plane[texel]) - row[column];
                assert!(error.abs() < ROUNDING, "{incident:?} {rgb:?} {error}");
            }
        }
    }
}

#[test]
fn within_a_tetrahedron_filtering_first_or_last_gives_the_same_under_any_light() {
    // Single precision of texels, sums and files.
    const ROUNDING: f64 = 2e-6;
    let around = |color: usize| {
        let corners = cube().corners(LinearRgb(spread(color))).unwrap();
        let nodes = corners.map(|(node, _)| cube().node_rgb(node).0);
        (0..BLOCK).map(move |i| {
            let [u, v, w] = spread(31 * color + i);
            let weights = [u * v, u * (1.0 - v), (1.0 - u) * w, (1.0 - u) * (1.0 - w)];
            [0, 1, 2].map(|k| (0..4).map(|c| weights[c] * nodes[c][k]).sum::<f64>())
        })
    };
    let blocks: Vec<Vec<[f64; 3]>> = (0..64).map(|color| around(color).collect()).collect();
    let texels: Vec<[f32; 3]> = blocks.iter().flatten().copied().map(single).collect();
    let means: Vec<[f32; 3]> = blocks.iter().map(|block| single(mean(block))).collect();
    let desk = Desk::new();
    let last = colors(&desk.baked(radiance("A"), Sample::Float, BLOCK, &texels));
    let first = colors(&desk.baked(radiance("A"), Sample::Float, 1, &means));
    for (first, last) in first.iter().zip(last.chunks(BLOCK)) {
        let last = mean(last);
        let worst = (0..3).map(|k| (first[k] - last[k]).abs()).fold(0.0, f64::max);
        assert!(worst < ROUNDING, "{worst} {first:?} {last:?}");
    }
}

/// Evenly spaced colors of the example pictures, and random ones.
fn many_colors() -> Vec<[f32; 3]> {
    const APART: usize = 24;
    let pictures = ExamplePicture::ALL.iter().flat_map(|picture| {
        let [width, height] = picture.size;
        let places = (0..height).step_by(APART);
        places.flat_map(move |y| (0..width).step_by(APART).map(move |x| picture.texel([x, y])))
    });
    pictures.chain(random_colors(1000)).collect()
}

#[test]
fn the_kinds_of_materials_are_counted_in_every_form() {
    let desk = Desk::new();
    let rgb: Vec<[f32; 3]> =
        (0..cube().nodes().len()).map(|i| single(cube().node_rgb(i).0)).collect();
    let input = desk.picture("nodes.exr", 40, &rgb, None);
    let kinds = |form| {
        let found = bake(cube(), form, options(Sample::Float), &input, &desk.path("out.exr"));
        found.unwrap().kinds
    };
    // Nodes are blends of themselves, but for the rounding of their RGB.
    let inner = BlendKinds::new(cube());
    let blends: KindCounts =
        rgb.iter().map(|rgb| inner.of(LinearRgb(rgb.map(f64::from))).unwrap()).collect();
    for form in [spectral(Grid::try_new(400, 700, 100).unwrap(), false), radiance("A")] {
        assert_eq!(kinds(form.clone()), Some(blends), "{form:?}");
    }
    let mut polished = vec![Node::default(); rgb.len()];
    Polisher::new(cube()).unwrap().polish(&rgb, &mut polished).unwrap();
    let polished = polished.iter().map(|node| MaterialKind::of_node(node, cube())).collect();
    for form in [POLISHED, spectral(tens(), true)] {
        assert_eq!(kinds(form.clone()), Some(polished), "{form:?}");
    }
    assert_eq!(kinds(Form::InterpolatedMaterial), None);
    let some_of_each = [blends, polished].map(|kinds| kinds.dyed > 0 && kinds.missed > 0);
    assert_eq!(some_of_each, [true; 2]);
}

/// Under D65 from a cube in sRGB a color is its own picture: the screen has the same white and primaries.
#[test]
fn a_picture_for_the_screen_has_the_colors_of_its_texels() {
    let contract = Contract { space: RgbSpace::named("srgb").unwrap(), ..Contract::default() };
    let cube =
        build_cube(&contract, &Model::Reflectance, Preset::Jakob2019.options(), 9, &Unwatched);
    let cube = cube.unwrap();
    let (desk, rgb) = (Desk::new(), random_colors(400));
    let input = desk.path("in.exr");
    let described = ExrDescription::new([20, 20], ["R", "G", "B", "A"])
        .with_sample(Sample::Float)
        .with_space(&contract.space);
    let mut writer = ExrWriter::create(&input, described).unwrap();
    let alpha: Vec<f32> = (0..400).map(|i| 1.0 - i as f32 / 400.0).collect();
    let plane = |k: usize| rgb.iter().zip(&alpha).map(|(v, a)| v[k] * a).collect::<Vec<f32>>();
    writer.write_band(&[&plane(0), &plane(1), &plane(2), &alpha]).unwrap();
    writer.finish().unwrap();
    let light = Illuminant::named("D65").unwrap();
    for (bits, greatest) in [(PngBits::Eight, 255.0), (PngBits::Sixteen, 65535.0)] {
        let form = Form::Screen { light: light.clone(), bits, exposure_stops: -1.0 };
        let output = desk.path("out.png");
        let baked = bake(&cube, form, options(Sample::Half), &input, &output).unwrap();
        assert_eq!((baked.beyond_screen, baked.channels), (0, 4));
        let mut picture = Picture::open(&output).unwrap();
        assert_eq!(picture.encoding(), Some(Encoding::Srgb));
        let band = picture.read_band(20).unwrap().unwrap();
        let table = cube.color_table(&contract.on(Grid::FIT));
        let mut xyz = vec![[0.0; 3]; 400];
        table.xyz(&rgb, &mut xyz).unwrap();
        for (i, xyz) in xyz.iter().enumerate() {
            let shown = contract.on(Grid::FIT).rgb_from_xyz(Xyz(xyz.map(f64::from)));
            for k in 0..3 {
                let expected = srgb_encoded(shown.0[k].clamp(0.0, 1.0) / 2.0);
                let found = f64::from(band.rgb[i][k]);
                // Half a step of the file, and single precision.
                assert!((found - expected).abs() < 0.5 / greatest + 1e-6, "{i} {found} {expected}");
            }
        }
        let found = band.alpha.unwrap();
        assert!(
            found.iter().zip(&alpha).all(|(a, b)| f64::from((a - b).abs()) < 0.5 / greatest + 1e-6)
        );
    }
}

/// Colors at which half precision is hard: nearly black, nearly gray, saturated.
fn hard_colors() -> Vec<[f32; 3]> {
    // From 1e-6 to 1e-2, and from 1e-7 to 1e-2.
    let dark = |v: f64| 10_f64.powf(-6.0 + 4.0 * v);
    let apart = |v: f64| (2.0 * v - 1.0).signum() * 10_f64.powf(-7.0 + 5.0 * (2.0 * v).fract());
    let nearly_black = (0..400).map(|i| spread(i).map(dark));
    let in_one_channel = (0..300).map(|i| {
        let mut rgb = [0.0; 3];
        rgb[i % 3] = dark(spread(i)[0]);
        rgb
    });
    let nearly_gray = (0..800).map(|i| {
        let gray = if i % 2 == 0 { spread(i)[1] } else { dark(spread(i)[1]) };
        spread(i + 1000).map(|v| (gray + apart(v) * gray.max(1e-3)).clamp(0.0, 1.0))
    });
    let saturated = (0..300).map(|i| {
        let mut rgb = spread(i);
        rgb[i % 3] *= 1e-3;
        rgb[(i + 1) % 3] = if i % 2 == 0 { 1.0 } else { 1e-4 };
        rgb
    });
    nearly_black.chain(in_one_channel).chain(nearly_gray).chain(saturated).map(single).collect()
}

/// Greatest color difference between a material in half precision and in single precision, under the
/// contract's light. Its cause: half precision holds a visible edge to an eighth of a nanometer, and
/// level and slope to eleven digits.
const HALF_DE2000: f64 = 0.15;

/// The color of a material. Fits without a slope limit match nearly black colors with peaks that are
/// narrower than the steps of any sum, so that the color would depend on where the sum samples them:
/// their reflectance is averaged within each nanometer.
fn look(sums: &ModelOnGrid, fine: &Colorimetry, material: Material) -> Xyz {
    const NARROW_NM: f64 = 5.0;
    const SAMPLES: u32 = 50;
    let features = material.reflectance.to_vertex().and_then(|vertex| vertex.to_features());
    let is_narrow = features.is_some_and(|features| features.width_nm < NARROW_NM);
    if !is_narrow || material.fluorescence != Fluorescence::None {
        return sums.color(material);
    }
    let mut sum = [0.0; 3];
    for (i, nm) in Grid::FINE.wavelengths_nm().enumerate() {
        let samples = (0..SAMPLES).map(|n| {
            let offset = (f64::from(n) + 0.5) / f64::from(SAMPLES) - 0.5;
            material.reflectance.at(nm + offset)
        });
        let mean = samples.sum::<f64>() / f64::from(SAMPLES);
        (0..3).for_each(|k| sum[k] += fine.irradiance()[i] * mean * fine.matching()[i][k]);
    }
    Xyz(sum)
}

/// Bakes colors with a cube in half and single precision. Checks that no material changes visibly or
/// becomes too steep, and that grays stay flat; returns the greatest difference.
fn greatest_loss_by_half(cube: &Cube, rgb: &[[f32; 3]]) -> f64 {
    let desk = Desk::new();
    let fine = cube.contract().on(Grid::FINE);
    let sums = ModelOnGrid::new(cube.model(), &fine);
    let mut greatest = 0.0_f64;
    for form in [POLISHED, Form::InterpolatedMaterial] {
        let read = |sample| materials(&desk.baked_with(cube, form.clone(), sample, 1, rgb));
        let [half, float] = [Sample::Half, Sample::Float].map(read);
        for ((rgb, half), float) in rgb.iter().zip(&half).zip(&float) {
            let found = difference(look(&sums, &fine, *half), look(&sums, &fine, *float));
            assert!(found <= HALF_DE2000, "{found} {rgb:?} {half:?} {float:?}");
            greatest = greatest.max(found);
            let [half, float] = [half, float].map(|m| m.reflectance.steepest_slope_per_nm().abs());
            // Coefficients in double precision lose digits where edges are far.
            assert!(half <= float * (1.0 + 1e-6) + 1e-12, "{half} {float} {rgb:?}");
            assert!(rgb[0] != rgb[1] || rgb[1] != rgb[2] || half == 0.0, "{half} {rgb:?}");
        }
    }
    greatest
}

/// Pictures with a nearly black and a nearly gray texel; absent outside the project's own checkout.
const HARD_PICTURES: &str = "../../../shared/data/pictures";

#[test]
fn pictures_with_a_nearly_black_or_nearly_gray_texel_are_baked_in_half_precision() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(HARD_PICTURES);
    if !folder.is_dir() {
        println!("skipped without {HARD_PICTURES}");
        return;
    }
    let (desk, cube) = (Desk::new(), built("konig8", 9));
    for name in ["near_black_16bit.png", "near_black_red.exr", "near_gray.exr"] {
        let declared = Declared {
            space: Some(RgbSpace::named("srgb").unwrap()),
            encoding: Some(if name.ends_with("png") { Encoding::Srgb } else { Encoding::Linear }),
            ..Declared::default()
        };
        let options = BakeOptions { declared, ..options(Sample::Half) };
        let output = desk.path("out.exr");
        bake(&cube, POLISHED, options, &folder.join(name), &output).expect(name);
        assert!(!materials(&output).is_empty());
    }
}

#[test]
fn half_precision_moves_no_material_visibly_and_makes_none_steeper() {
    let rgb = [many_colors(), hard_colors()].concat();
    let mut greatest = greatest_loss_by_half(cube(), &rgb);
    for preset in [Preset::Natural, Preset::Konig2020, Preset::Jakob2019] {
        for resolution in [5, 9] {
            let (contract, model) = (Contract::default(), preset.model());
            let cube =
                build_cube(&contract, &model, preset.options(), resolution, &Unwatched).unwrap();
            let nodes = (0..cube.nodes().len()).map(|i| single(cube.node_rgb(i).0));
            let rgb = [nodes.collect(), hard_colors(), random_colors(300)].concat();
            let found = greatest_loss_by_half(&cube, &rgb);
            println!("{preset} {resolution}: {found:.4}");
            greatest = greatest.max(found);
        }
    }
    println!("greatest ΔE00 by half precision: {greatest:.4}");
}

/// Greatest ΔE00 between the color of a material at any level, stored in half precision, and the mean of
/// the picture's colors that it covers. Half precision adds up to 0.04 for such colors, a polished material 0.01.
const LEVEL_DE2000: f64 = 0.05;

#[test]
fn every_level_has_the_mean_color_of_the_texels_it_stands_for() {
    const SIZE: [usize; 2] = [256, 128];
    let cube = build_cube(
        &Contract::default(),
        &Preset::Natural.model(),
        Preset::Natural.options(),
        9,
        &Unwatched,
    )
    .unwrap();
    let desk = Desk::new();
    // Waves of several lengths, so that each level has colors of its own, and noise.
    let texel = |i: usize| {
        let (x, y) = ((i % SIZE[0]) as f64, (i / SIZE[0]) as f64);
        let waves = [(x + y) / 40.0, x / 17.0, y / 9.0].map(f64::sin);
        let noise = spread(i);
        single([0, 1, 2].map(|k| 0.45 + 0.25 * waves[k] + 0.25 * (noise[k] - 0.5)))
    };
    let rgb: Vec<[f32; 3]> = (0..SIZE[0] * SIZE[1]).map(texel).collect();
    let (input, output) = (desk.picture("in.exr", SIZE[0], &rgb, None), desk.path("out.tx"));
    let polisher = Polisher::new(&cube).unwrap();
    let sums = ModelOnGrid::new(cube.model(), &cube.contract().on(Grid::FIT));
    for sample in [Sample::Float, Sample::Half] {
        let mipmap = BakeOptions { layout: Layout::Mipmap, ..options(sample) };
        let baked = bake(&cube, POLISHED, mipmap, &input, &output).unwrap();
        let kinds = baked.kinds.unwrap();
        assert_eq!(kinds.each().iter().map(|(_, count)| count).sum::<u64>(), 32_768);
        let (mut worst, mut missed, mut all) = (0.0_f64, 0, 0);
        for level in 0..9 {
            let mut picture = MaterialPicture::open_level(&output, level).unwrap();
            let [width, height] = picture.size();
            let sides = [SIZE[0] / width, SIZE[1] / height];
            for y in 0..height {
                let color = |x: usize| {
                    let rows = y * sides[1]..(y + 1) * sides[1];
                    let texels = rows.flat_map(|y| &rgb[y * SIZE[0] + x * sides[0]..][..sides[0]]);
                    mean(&texels.map(|rgb| rgb.map(f64::from)).collect::<Vec<_>>())
                };
                let colors: Vec<[f64; 3]> = (0..width).map(color).collect();
                let mut nodes = vec![Node::default(); width];
                let means: Vec<[f32; 3]> = colors.iter().copied().map(single).collect();
                polisher.polish(&means, &mut nodes).unwrap();
                let row = picture.row(y).unwrap();
                for ((color, material), node) in colors.iter().zip(row).zip(&nodes) {
                    all += 1;
                    // A color that the cube misses is missed at every level.
                    if f64::from(node.de2000) > CubeSummary::EXACT_DE2000 {
                        missed += 1;
                        continue;
                    }
                    let found = difference(xyz(*color), sums.color(material));
                    assert!(found <= LEVEL_DE2000, "level {level}: {found} {color:?}");
                    worst = worst.max(found);
                }
            }
        }
        assert!(missed * 100 < all, "{missed} of {all} missed");
        println!("{sample:?}: at most {worst:.4} ΔE00 in {all} texels of all levels");
    }
}

#[test]
fn a_polished_material_has_its_color_where_the_corners_do() {
    let (desk, rgb) = (Desk::new(), random_colors(1000));
    let sums = ModelOnGrid::new(cube().model(), colorimetry());
    let found = materials(&desk.baked(POLISHED, Sample::Float, 1, &rgb));
    let exact = rgb.iter().zip(found).filter(|(rgb, _)| is_exact(**rgb));
    let misses: Vec<f64> =
        exact.map(|(rgb, m)| difference(xyz(rgb.map(f64::from)), sums.color(m))).collect();
    assert!(misses.len() > 400, "only {} exact colors", misses.len());
    let worst = misses.iter().copied().fold(0.0, f64::max);
    assert!(worst <= CubeSummary::EXACT_DE2000, "{worst}");
}

/// Whether the four materials around a color match theirs.
fn is_exact(rgb: [f32; 3]) -> bool {
    let corners = cube().corners(LinearRgb(rgb.map(f64::from))).unwrap();
    let misses = corners.map(|(node, _)| f64::from(cube().nodes()[node].de2000));
    misses.iter().all(|&miss| miss <= CubeSummary::EXACT_DE2000)
}

#[test]
fn the_contracts_own_light_reproduces_rgb_where_the_corners_are_exact() {
    // Half of the last of eleven digits, and of the smallest step.
    let half_step = |v: f64| v.abs() / 2048.0 + 3e-8;
    let desk = Desk::new();
    let rgb: Vec<[f32; 3]> = many_colors().into_iter().filter(|rgb| is_exact(*rgb)).collect();
    assert!(rgb.len() > 1000, "only {} exact colors", rgb.len());
    let float = colors(&desk.baked(radiance("D65"), Sample::Float, 1, &rgb));
    let half = colors(&desk.baked(radiance("D65"), Sample::Half, 1, &rgb));
    for ((rgb, float), half) in rgb.iter().zip(float).zip(half) {
        let miss = difference(xyz(rgb.map(f64::from)), xyz(float));
        assert!(miss <= CubeSummary::EXACT_DE2000, "{miss} {rgb:?} {float:?}");
        assert!((0..3).all(|k| (half[k] - float[k]).abs() <= half_step(float[k])));
    }
}

/// The color of a texel's bands under the contract's light.
fn color_of_bands(texel: &SpectralTexel, grid: Grid) -> Xyz {
    let sums = cube().contract().on(grid);
    let at = |nm: f64| grid.wavelengths_nm().position(|band| band == nm).unwrap();
    let mut sum = [0.0; 3];
    let mut add = |incident: usize, outgoing: usize, share: f32| {
        let light = sums.irradiance()[incident] * f64::from(share);
        (0..3).for_each(|k| sum[k] += light * sums.matching()[outgoing][k]);
    };
    texel.reflectance.iter().for_each(|&(nm, share)| add(at(nm), at(nm), share));
    texel.reradiation.iter().for_each(|&(i, o, share)| add(at(i), at(o), share));
    Xyz(sum)
}

#[test]
fn compact_and_full_files_have_the_same_colors() {
    // One material against four of the same color: sums over 10 nm bands have different errors.
    const BANDS_DE2000: f64 = 0.25;
    let desk = Desk::new();
    let rgb: Vec<[f32; 3]> =
        random_colors(400).into_iter().filter(|rgb| is_exact(*rgb)).take(64).collect();
    let read = |compact| texels(&desk.baked(spectral(tens(), compact), Sample::Half, 8, &rgb));
    let (full, compact) = (read(false), read(true));
    let mut fluorescent = 0;
    for ((rgb, full), compact) in rgb.iter().zip(full).zip(compact) {
        assert_eq!(full.preview, compact.preview);
        let found = difference(color_of_bands(&full, tens()), color_of_bands(&compact, tens()));
        assert!(found < BANDS_DE2000, "{found} {rgb:?}");
        fluorescent += usize::from(full.reradiation.iter().any(|(.., share)| *share > 0.01));
    }
    assert!(fluorescent > 5, "only {fluorescent} fluorescent texels");
}

/// The shares of a texel of the bands of [`tens`] against a matrix, `[outgoing][incident]`.
fn assert_matrix(texel: &SpectralTexel, matrix: &[Vec<f64>], tolerance: f64) {
    let at = |nm: f64| tens().wavelengths_nm().position(|band| band == nm).unwrap();
    assert_eq!((texel.reflectance.len(), texel.reradiation.len()), (41, 820));
    for &(nm, share) in &texel.reflectance {
        let miss = (matrix[at(nm)][at(nm)] - f64::from(share)).abs();
        assert!(miss < tolerance, "{miss} {nm} {share}");
    }
    for &(in_nm, out_nm, share) in &texel.reradiation {
        let miss = (matrix[at(out_nm)][at(in_nm)] - f64::from(share)).abs();
        assert!(miss < tolerance, "{miss} {in_nm} {out_nm} {share}");
    }
}

#[test]
fn a_compact_file_expands_to_the_matrix_of_the_polished_material() {
    // Attributes print single precision; a share is at most 1.
    const ROUNDING: f64 = 1e-6;
    let (desk, rgb) = (Desk::new(), random_colors(40));
    for cube in [cube(), &film("konig8", 6)] {
        let path = desk.baked_with(cube, spectral(tens(), true), Sample::Float, 8, &rgb);
        assert_eq!(Lint::of_file(&path).unwrap().findings, []);
        let mut nodes = vec![Node::default(); rgb.len()];
        Polisher::new(cube).unwrap().polish(&rgb, &mut nodes).unwrap();
        for (texel, node) in texels(&path).iter().zip(nodes) {
            let mixture = Mixture::of(cube.model(), node.material(cube.model()));
            assert_matrix(texel, &mixture.reradiation_matrix(tens()), ROUNDING);
        }
    }
}

#[test]
fn a_full_file_of_films_has_the_matrix_of_the_blend() {
    // Single precision of shares of at most 1.
    const ROUNDING: f64 = 1e-7;
    let (desk, rgb, cube) = (Desk::new(), random_colors(24), film("konig8", 6));
    let path = desk.baked_with(&cube, spectral(tens(), false), Sample::Float, 8, &rgb);
    for (texel, rgb) in texels(&path).iter().zip(&rgb) {
        let color = LinearRgb(rgb.map(f64::from));
        let mixture = cube.lookup(color, Interpolation::Blend).unwrap();
        assert_matrix(texel, &mixture.reradiation_matrix(tens()), ROUNDING);
    }
}

#[test]
fn films_are_baked_as_the_materials_of_the_polisher_and_read_back() {
    // Half precision of densities up to 6 and of what they do to the color.
    const HALF_DE2000: f64 = 0.3;
    let (desk, rgb, cube) = (Desk::new(), random_colors(300), film("konig8", 6));
    let polisher = Polisher::new(&cube).unwrap();
    let sums = ModelOnGrid::new(cube.model(), colorimetry());
    for form in [POLISHED, Form::InterpolatedMaterial] {
        let mut nodes = vec![Node::default(); rgb.len()];
        match form {
            POLISHED => polisher.polish(&rgb, &mut nodes).unwrap(),
            _ => polisher.interpolate(&rgb, &mut nodes).unwrap(),
        };
        let read = |sample| materials(&desk.baked_with(&cube, form.clone(), sample, 1, &rgb));
        let [half, float] = [Sample::Half, Sample::Float].map(read);
        let mut pairs = 0;
        for ((node, half), float) in nodes.iter().zip(&half).zip(&float) {
            assert_eq!(node.material(cube.model()).fluorescence, float.fluorescence);
            let found = difference(sums.color(*half), sums.color(*float));
            assert!(found <= HALF_DE2000, "{found} {half:?} {float:?}");
            pairs += usize::from(matches!(
                float.fluorescence,
                Fluorescence::Film { densities: [_, second], .. } if second > 0.0
            ));
        }
        assert!(pairs > 30, "only {pairs} films of two dyes");
    }
}

#[test]
fn materials_without_fluorescence_are_read_back_as_such_for_every_model() {
    let analytic = Model::Analytic(AnalyticModel::default());
    let options = Preset::Jung2019.options();
    let analytic = build_cube(&Contract::default(), &analytic, options, 4, &Unwatched).unwrap();
    let reflectances = Preset::Jakob2019.options();
    let reflectances =
        build_cube(&Contract::default(), &Model::Reflectance, reflectances, 4, &Unwatched);
    let cubes = [reflectances.unwrap(), built("konig8", 4), film("konig8", 4), analytic];
    let (desk, rgb) = (Desk::new(), random_colors(200));
    for cube in &cubes {
        for form in [POLISHED, Form::InterpolatedMaterial] {
            for sample in [Sample::Half, Sample::Float] {
                let read = materials(&desk.baked_with(cube, form.clone(), sample, 1, &rgb));
                let is_dark = |material: &&Material| material.fluorescence == Fluorescence::None;
                let dark = read.iter().filter(is_dark).count();
                assert!(dark > 0, "{}: every texel fluoresces", cube.model().name());
            }
        }
    }
}

#[test]
fn a_film_of_fourteen_dyes_has_no_compact_form() {
    let cube = film("wide14", 2);
    let refused = Baker::new(&cube, spectral(tens(), true), options(Sample::Half)).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "14 dyes, expected 1 to 12 with a map each, or the spectral form that is not compact"
    );
    let passive = Model::Reflectance;
    let options = Preset::Konig2020.options();
    let cube = build_cube(&Contract::default(), &passive, options, 2, &Unwatched).unwrap();
    let form = spectral(tens(), true);
    let refused = Baker::new(&cube, form, self::options(Sample::Half)).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "a cube with the model reflectance, expected dyes or film for the compact form"
    );
}

#[test]
fn a_ring_of_fourteen_dyes_expands_to_the_matrix_of_the_blend() {
    // The half precision that is asked for would move a position on the ring by 0.004, and shares by
    // 1e-5: such files are float.
    const ROUNDING: f64 = 1e-6;
    let cube = built("wide14", 4);
    let (desk, rgb) = (Desk::new(), random_colors(24));
    let (input, output) = (desk.picture("in.exr", 8, &rgb, None), desk.path("out.exr"));
    bake(&cube, spectral(tens(), true), options(Sample::Half), &input, &output).unwrap();
    for (texel, rgb) in texels(&output).iter().zip(&rgb) {
        let color = LinearRgb(rgb.map(f64::from));
        let matrix = cube.lookup(color, Interpolation::Blend).unwrap();
        assert_matrix(texel, &matrix.reradiation_matrix(tens()), ROUNDING);
    }
}

#[test]
fn no_band_loses_more_light_than_it_receives() {
    // Forty shares of a column, each rounded by at most 2⁻¹² of itself; float sums have seven digits.
    let tolerances = [(Sample::Half, 1.0 / 4096.0), (Sample::Float, 1e-6)];
    let desk = Desk::new();
    // The faces of the cube have most dye.
    let faces = (0..24).map(|i| {
        let [u, v, w] = spread(i);
        single(if w < 0.5 { [u, v, 0.0] } else { [1.0, u * v, u] })
    });
    let rgb: Vec<[f32; 3]> = faces.chain([[1.0; 3], [0.0; 3]]).chain(random_colors(22)).collect();
    let film = film("konig8", 6);
    for (cube, (sample, tolerance)) in
        [cube(), &film].into_iter().flat_map(|cube| tolerances.map(|t| (cube, t)))
    {
        for compact in [false, true] {
            let path = desk.baked_with(cube, spectral(tens(), compact), sample, 8, &rgb);
            assert_eq!(Lint::of_file(&path).unwrap().findings, []);
            let read = texels(&path);
            let moved = |texel: &SpectralTexel, nm: f64| -> f64 {
                let row = texel.reradiation.iter().filter(|(in_nm, ..)| *in_nm == nm);
                row.map(|(.., share)| f64::from(*share)).sum()
            };
            let sums = read.iter().flat_map(|texel| {
                texel.reflectance.iter().map(|&(nm, share)| f64::from(share) + moved(texel, nm))
            });
            let greatest = sums.fold(0.0, f64::max);
            assert!(greatest <= 1.0 + tolerance, "{greatest} {sample:?} compact {compact}");
            // White itself is among them.
            assert!(greatest > 0.999, "{greatest}");
        }
    }
}

#[test]
fn alpha_is_copied_and_multiplies_light_but_no_material() {
    let (desk, rgb) = (Desk::new(), random_colors(12));
    let alpha: Vec<f32> = (0..12_u8).map(|i| f32::from(i) / 8.0).collect();
    let dimmed = |rgb: &[[f32; 3]]| -> Vec<[f32; 3]> {
        rgb.iter().zip(&alpha).map(|(rgb, a)| rgb.map(|v| v * a)).collect()
    };
    let input = desk.picture("alpha.exr", 4, &dimmed(&rgb), Some(&alpha));
    let opaque = desk.picture("opaque.exr", 4, &rgb, None);
    let output = desk.path("out.exr");
    let bake = |input: &Path, form: Form| {
        bake(cube(), form, options(Sample::Float), input, &output).unwrap();
    };
    bake(&opaque, radiance("A"));
    let expected = colors(&output);
    bake(&input, radiance("A"));
    assert_eq!(planes(&output, ["A"])[0], alpha);
    for (i, found) in colors(&output).iter().enumerate() {
        for k in 0..3 {
            let dimmed = f64::from(alpha[i]) * expected[i][k];
            // Multiplied by alpha and divided again, then twice rounded.
            assert!((found[k] - dimmed).abs() < 1e-6, "{i} {found:?} {dimmed}");
        }
    }
    bake(&opaque, POLISHED);
    let expected = materials(&output);
    bake(&input, POLISHED);
    assert_eq!(planes(&output, ["A"])[0], alpha);
    let sums = ModelOnGrid::new(cube().model(), colorimetry());
    // Nothing is left of the color where alpha is 0.
    for (found, expected) in materials(&output).iter().zip(&expected).skip(1) {
        assert!(difference(sums.color(*found), sums.color(*expected)) < 1e-3);
    }
}

/// A PNG of 8 bits, as sRGB if it says so.
fn png(path: &Path, color: png::ColorType, width: u32, bytes: &[u8], says_srgb: bool) {
    let channels = u32::try_from(color.samples()).unwrap();
    let height = u32::try_from(bytes.len()).unwrap() / channels / width;
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), width, height);
    encoder.set_color(color);
    if says_srgb {
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    }
    encoder.write_header().unwrap().write_image_data(bytes).unwrap();
}

/// 8-bit codes of many colors.
fn codes() -> Vec<[u8; 3]> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    (0..60).map(|i| spread(i).map(|v| (256.0 * v) as u8)).collect()
}

#[test]
fn an_srgb_png_gets_its_own_colors_from_an_acescg_cube() {
    // Single precision of the matrix between the spaces, beside the corners' own miss.
    const DE2000: f64 = 1.2 * CubeSummary::EXACT_DE2000;
    let (desk, codes) = (Desk::new(), codes());
    let (input, output) = (desk.path("in.png"), desk.path("out.exr"));
    png(&input, png::ColorType::Rgb, 10, codes.as_flattened(), true);
    bake(cube(), radiance("D65"), options(Sample::Float), &input, &output).unwrap();
    let srgb = Contract { space: RgbSpace::named("srgb").unwrap(), ..Contract::default() };
    let srgb = srgb.on(Grid::FIT);
    let mut exact = 0;
    for (code, found) in codes.iter().zip(colors(&output)) {
        let linear = Encoding::Srgb.to_linear(code.map(|v| f64::from(v) / 255.0));
        let expected = srgb.xyz_from_rgb(LinearRgb(linear));
        if is_exact(single(colorimetry().rgb_from_xyz(expected).0)) {
            exact += 1;
            let miss = difference(expected, xyz(found));
            assert!(miss < DE2000, "{miss} {code:?}");
        }
    }
    assert!(exact > 20, "only {exact} exact colors");
    // The same with the space and encoding given by the caller.
    let said = made(&output);
    png(&input, png::ColorType::Rgb, 10, codes.as_flattened(), false);
    let declared = Declared {
        space: RgbSpace::named("srgb").ok(),
        encoding: Some(Encoding::Srgb),
        ..Declared::default()
    };
    let told = BakeOptions { declared, ..options(Sample::Float) };
    bake(cube(), radiance("D65"), told, &input, &output).unwrap();
    assert!(made(&output) == said);
    let refused = bake(cube(), POLISHED, options(Sample::Half), &input, &output).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the file does not state its RGB space and encoding, expected a declaration"
    );
    assert!(made(&output) == said);
}

#[test]
fn light_of_a_png_with_alpha_is_multiplied_by_alpha_as_in_openexr() {
    let (desk, codes) = (Desk::new(), codes());
    let (input, output) = (desk.path("in.png"), desk.path("out.exr"));
    let bake = || {
        bake(cube(), radiance("A"), options(Sample::Float), &input, &output).unwrap();
        colors(&output)
    };
    png(&input, png::ColorType::Rgb, 10, codes.as_flattened(), true);
    let opaque = bake();
    let alpha = |i: usize| u8::try_from(4 * i).unwrap();
    let with_alpha: Vec<u8> =
        codes.iter().enumerate().flat_map(|(i, &[r, g, b])| [r, g, b, alpha(i)]).collect();
    png(&input, png::ColorType::Rgba, 10, &with_alpha, true);
    for (i, (found, opaque)) in bake().iter().zip(opaque).enumerate() {
        let share = f64::from(alpha(i)) / 255.0;
        assert!((0..3).all(|k| (found[k] - share * opaque[k]).abs() < 1e-6), "{i}");
    }
}

/// Every form, with bands that make a small file.
fn forms() -> [Form; 5] {
    let coarse = Grid::try_new(400, 700, 50).unwrap();
    let fast = Form::InterpolatedMaterial;
    [POLISHED, fast, spectral(coarse, false), spectral(coarse, true), radiance("A")]
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let (desk, rgb) = (Desk::new(), random_colors(7 * 150));
    for form in forms() {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let path = pool.install(|| desk.baked(form.clone(), Sample::Half, 7, &rgb));
            std::fs::read(path).unwrap()
        };
        assert!(run(1) == run(3), "{form:?}");
    }
}

#[test]
fn a_texel_is_the_same_wherever_the_picture_is_cut() {
    let (desk, rgb) = (Desk::new(), random_colors(7 * 150));
    for form in forms() {
        let samples = |rgb: &[[f32; 3]]| {
            let mut reader =
                ExrReader::open(desk.baked(form.clone(), Sample::Half, 7, rgb)).unwrap();
            let channels: Vec<usize> = (0..reader.channel_names().len()).collect();
            reader.read_rows(0..rgb.len() / 7, &channels).unwrap()
        };
        let whole = samples(&rgb);
        for cut in [1, 37, 64, 100] {
            for (part, whole) in samples(&rgb[7 * cut..]).iter().zip(&whole) {
                assert!(part[..] == whole[7 * cut..], "{form:?} from row {cut}");
            }
        }
    }
}

#[test]
fn a_texel_outside_is_refused_by_its_place_and_the_old_file_stays() {
    let desk = Desk::new();
    let output = desk.path("out.exr");
    std::fs::write(&output, "old").unwrap();
    let flaws = [
        ([0.5, 1.25, 0.5], "green is 1.25, expected 0 to 1, the range of the cube"),
        ([0.5, 0.5, -0.25], "blue is -0.25, expected 0 to 1, the range of the cube"),
        ([f32::NAN, 0.5, 0.5], "red is NaN, expected 0 to 1, the range of the cube"),
        ([0.5, f32::INFINITY, 0.5], "green is inf, expected 0 to 1, the range of the cube"),
    ];
    for (flaw, expected) in flaws {
        for (place, others) in [(3 + 7 * 90, ""), (5, ", and 1 more in the same rows")] {
            let mut rgb = random_colors(7 * 100);
            rgb[place] = flaw;
            rgb[place + usize::from(!others.is_empty())] = flaw;
            let input = desk.picture("in.exr", 7, &rgb, None);
            let refused = bake(cube(), POLISHED, options(Sample::Half), &input, &output);
            let (x, y) = (place % 7, place / 7);
            let refused = refused.unwrap_err();
            let cause = std::error::Error::source(&refused).map(ToString::to_string);
            assert_eq!(refused.to_string(), format!("texel {x},{y}{others}"));
            assert_eq!(cause.as_deref(), Some(expected));
            assert_eq!(std::fs::read(&output).unwrap(), b"old");
        }
    }
    assert_eq!(std::fs::read_dir(desk.0.path()).unwrap().count(), 2);
}

#[test]
fn alpha_that_is_not_finite_is_refused_by_its_place_in_every_form() {
    let desk = Desk::new();
    let output = desk.path("out.exr");
    let screen = Form::Screen {
        light: Illuminant::named("D65").unwrap(),
        bits: PngBits::Eight,
        exposure_stops: 0.0,
    };
    for (n, form) in forms().into_iter().chain([screen]).enumerate() {
        for (value, text) in
            [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")]
        {
            let rgb = random_colors(7 * 70);
            let place = (n * 97 + 13) % rgb.len();
            let mut alpha = vec![1.0; rgb.len()];
            alpha[place..].fill(value);
            let input = desk.picture("in.exr", 7, &rgb, Some(&alpha));
            let line = format!(
                "texel {},{}: alpha is {text}, expected a finite number",
                place % 7,
                place / 7
            );
            let refused = bake(cube(), form.clone(), options(Sample::Half), &input, &output);
            assert_eq!(refused.unwrap_err().to_string(), line);
            assert!(!output.exists());
            let mut checker = Checker::new(cube().contract().clone(), Declared::default());
            assert_eq!(checker.check(&input, &Unwatched).unwrap_err().to_string(), line);
        }
    }
}

#[test]
fn repaired_alpha_leaves_the_color_that_the_file_has() {
    let desk = Desk::new();
    let rgb = [[0.5, 0.4, 0.3], [0.2; 3], [0.3, 0.5, 0.4], [0.7; 3]];
    let broken = [f32::NAN, f32::NEG_INFINITY, f32::INFINITY, 1.0];
    let input = desk.picture("in.exr", 2, &rgb, Some(&broken));
    let mended = desk.picture("mended.exr", 2, &rgb, Some(&[0.0, 0.0, 1.0, 1.0]));
    let (output, expected) = (desk.path("out.exr"), desk.path("expected.exr"));
    for (form, &repair) in forms().into_iter().zip(Repair::ALL.iter().cycle()) {
        let options = BakeOptions { repair: Some(repair), ..options(Sample::Float) };
        let baked = bake(cube(), form.clone(), options.clone(), &input, &output).unwrap();
        assert_eq!(baked.repaired, 3, "{repair} {form:?}");
        bake(cube(), form.clone(), options, &mended, &expected).unwrap();
        assert!(made(&output) == made(&expected), "{repair} {form:?}");
    }
}

#[test]
fn each_repair_bakes_the_colors_it_documents() {
    let desk = Desk::new();
    let flawed = [[2.0, 0.5, -1.0], [0.25, 0.5, 1.0], [f32::NAN, 0.5, 0.5], [0.0, 4.0, 0.0]];
    let input = desk.picture("flawed.exr", 2, &flawed, None);
    let cases = [
        (Repair::Clip, 3, vec![[1.0, 0.5, 0.0], flawed[1], [0.0; 3], [0.0, 1.0, 0.0]]),
        (
            Repair::Scale,
            4,
            vec![[0.5, 0.125, 0.0], [0.0625, 0.125, 0.25], [0.0; 3], [0.0, 1.0, 0.0]],
        ),
    ];
    let output = desk.path("out.exr");
    for (repair, count, expected) in cases {
        let mending = BakeOptions { repair: Some(repair), ..options(Sample::Half) };
        let baked = bake(cube(), POLISHED, mending, &input, &output).unwrap();
        assert_eq!((baked.repaired, baked.channels, baked.size), (count, 6, [2, 2]), "{repair}");
        let found = std::fs::read(&output).unwrap();
        assert_eq!(baked.bytes, found.len() as u64);
        let plain = desk.baked(POLISHED, Sample::Half, 2, &expected);
        assert!(made(&output) == made(&plain), "{repair}");
    }
    let mending = BakeOptions { repair: Some(Repair::Nearest), ..options(Sample::Float) };
    let baked = bake(cube(), radiance("D65"), mending, &input, &output).unwrap();
    assert_eq!(baked.repaired, 3);
    let found = colors(&output);
    assert!(difference(xyz([0.25, 0.5, 1.0]), xyz(found[1])) < 0.5, "{:?}", found[1]);
    assert!(found[2].iter().all(|v| v.abs() < 1e-6), "NaN becomes black");
}

#[test]
fn fluorescence_survives_its_file() {
    let desk = Desk::new();
    let read = materials(&desk.baked(POLISHED, Sample::Half, 1, &[[0.9, 0.0, 0.9], [0.4; 3]]));
    assert!(matches!(
        read[0].fluorescence,
        Fluorescence::Dyes { concentration, .. } if concentration > 0.5
    ));
    assert_eq!(read[1].fluorescence.dose(), 0.0);
}
