//! `upglow examples`: draws pictures to try the other commands on.

use std::path::Path;

use serde::Serialize;
use upglow_color::RgbSpace;
use upglow_image::{ExamplePicture, ExrDescription, ExrWriter, WriteExrError};
use upglow_terminal::{Console, Failure, Report};

use crate::args::ExamplesArgs;
use crate::files;
use crate::output::Lines;

#[derive(Clone, Debug, Serialize)]
struct ExamplesReport {
    pictures: Vec<PictureReport>,
}

#[derive(Clone, Debug, Serialize)]
struct PictureReport {
    file: String,
    width: usize,
    height: usize,
    about: &'static str,
}

pub(crate) fn run(args: &ExamplesArgs, console: &Console) -> Result<(), Failure> {
    files::make_folder(&args.output)?;
    let mut pictures = Vec::new();
    for picture in ExamplePicture::ALL {
        let path = args.output.join(format!("{}.exr", picture.name));
        write(&path, &picture).map_err(|error| files::unwritten_exr(&path, error))?;
        let [width, height] = picture.size;
        let file = path.display().to_string();
        pictures.push(PictureReport { file, width, height, about: picture.about });
    }
    console.print(&ExamplesReport { pictures })
}

fn write(path: &Path, picture: &ExamplePicture) -> Result<(), WriteExrError> {
    let description =
        ExrDescription::new(picture.size, ["R", "G", "B"]).with_named_space(&RgbSpace::default());
    let mut writer = ExrWriter::create(path, description)?;
    for y in 0..picture.size[1] {
        let row = picture.row(y);
        let planes = [0, 1, 2].map(|k| row.iter().map(|rgb| rgb[k]).collect::<Vec<_>>());
        writer.write_band(&planes.each_ref().map(Vec::as_slice))?;
    }
    writer.finish().map(|_| ())
}

impl Report for ExamplesReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        for PictureReport { file, width, height, about } in &self.pictures {
            lines.add(file, format_args!("{width} × {height}, {about}"));
        }
        lines.to_string()
    }
}
