//! The languages that shaders are written in.

use std::fmt;

/// A language that shaders are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Language {
    /// `WebGPU`'s.
    Wgsl,
    /// OpenGL's and Vulkan's, from version 4.20 or ES 3.10 on.
    Glsl,
    /// Direct3D's, from shader model 4 on.
    Hlsl,
    /// Open Shading Language, which has no buffers: it reads TIFF files.
    Osl,
    /// `JavaScript`, for pages of a browser: the arithmetic is in double precision.
    JavaScript,
}

impl Language {
    /// Every language.
    pub const ALL: [Self; 5] = [Self::Wgsl, Self::Glsl, Self::Hlsl, Self::Osl, Self::JavaScript];

    /// The name that options use, which is also the suffix of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::Hlsl => "hlsl",
            Self::Osl => "osl",
            Self::JavaScript => "js",
        }
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
