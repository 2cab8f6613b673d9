//! MaterialX and USD documents beside the files that they name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use upglow::Cube;
use upglow_image::InteropSpace;
use upglow_shader::{ColorMap, Documents};
use upglow_terminal::Failure;

use crate::files;
use crate::name_pattern::UDIM;
use crate::pictures::{Input, Named};

/// The documents of baked maps.
#[derive(Debug)]
pub(super) struct MapDocuments {
    /// The MaterialX document and the USD stage.
    paths: [PathBuf; 2],
}

impl MapDocuments {
    /// The documents beside the output `path`: with its name if it is that of files, without the word for the number
    /// of a tile; else in that folder.
    pub(super) fn beside(path: &Path, outputs: &Named<'_>) -> Self {
        let (folder, name) = match outputs.file() {
            Some(file) => {
                let name = file.file_stem().unwrap_or_default().to_string_lossy().replace(UDIM, "");
                let name = name.trim_end_matches(['.', '_', '-']).to_owned();
                (file.parent().unwrap_or(Path::new("")), name)
            }
            None => (path, "materials".to_owned()),
        };
        let with = |ending: &str| folder.join(format!("{name}.{ending}"));
        Self { paths: ["mtlx", "usda"].map(with) }
    }

    /// The files.
    pub(super) fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// The documents of those maps that `is_there` keeps; `whites` are what the perfect diffuser is in the files of a
    /// picture.
    pub(super) fn of(
        &self,
        cube: &Cube,
        inputs: &[Input],
        outputs: &Named<'_>,
        whites: &[[f64; 3]],
        is_there: impl Fn(&Path) -> bool,
    ) -> Result<Documents, Failure> {
        let mut maps: Vec<ColorMap> = Vec::new();
        let mut places = HashMap::new();
        for input in inputs {
            for (path, white) in outputs.files(input)?.iter().zip(whites) {
                if !is_there(path) {
                    continue;
                }
                let (file, tile) = tiled(relative(path, &self.paths[0])?, input);
                let place = *places.entry(file.clone()).or_insert(maps.len());
                match maps.get_mut(place) {
                    Some(map) => map.tiles.push(tile),
                    None => maps.push(ColorMap { file, tiles: vec![tile], white: *white }),
                }
            }
        }
        let space = InteropSpace::linear_id(&cube.contract().space);
        Documents::of_maps(&maps, space).map_err(|error| Failure::file(&self.paths[0], error))
    }

    /// Writes the documents, and returns their names.
    pub(super) fn write(&self, documents: &Documents) -> Result<Vec<String>, Failure> {
        let texts = [&documents.materialx, &documents.usd];
        let files = self.paths.iter().zip(texts);
        let files = files.map(|(path, text)| files::aside(path, text.as_bytes()));
        files::write_together(&self.paths[0], files.collect::<Result<_, _>>()?)?;
        Ok(self.paths.iter().map(|path| path.display().to_string()).collect())
    }
}

/// The name with `<UDIM>` in place of the number of the tile that a picture is, and that number; 1001 for others.
fn tiled(file: String, input: &Input) -> (String, u32) {
    let tile = input.tile().and_then(|tile| {
        let (before, after) = file.rsplit_once(&tile)?;
        Some((format!("{before}{UDIM}{after}"), tile.parse().ok()?))
    });
    tile.unwrap_or((file, 1001))
}

/// The path of a file from the folder of a document, with `/` between folders.
pub(super) fn relative(file: &Path, document: &Path) -> Result<String, Failure> {
    let folder = document.parent().unwrap_or(Path::new(""));
    let inside = file.strip_prefix(folder).unwrap_or(file);
    let names: Option<Vec<&str>> = inside.iter().map(|name| name.to_str()).collect();
    let names = names.ok_or_else(|| Failure::file(file, "not UTF-8, expected a name that is"))?;
    Ok(names.join("/"))
}
