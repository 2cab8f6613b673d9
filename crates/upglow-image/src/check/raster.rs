//! A small picture of the report.

/// 8-bit sRGB, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Raster {
    pub(super) width: u32,
    pub(super) height: u32,
    /// `[row][column]`, red, green, blue.
    pub(super) pixels: Vec<[u8; 3]>,
}

impl Raster {
    /// Rows of `width` pixels.
    pub(super) fn new(width: usize, pixels: Vec<[u8; 3]>) -> Self {
        let height = pixels.len() / width;
        let side = |n: usize| u32::try_from(n).expect("a raster has at most 1024 pixels per side");
        Self { width: side(width), height: side(height), pixels }
    }

    /// The picture as a PNG file.
    pub(super) fn to_png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let written = encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(self.pixels.as_flattened()));
        written.expect("writing to memory cannot fail");
        bytes
    }
}
