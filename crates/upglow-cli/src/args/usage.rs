//! Examples of each command, which its help ends with.

/// What the help of the program ends with.
pub(super) const PROGRAM: &str = "\
Commands that take a cube as their first argument also take it as --cube FILE, in any place.

Exit status: 0 done; 1 a file or a color is invalid, or a law is broken; 2 the command line is wrong; 130 stopped.

Examples:
  upglow build -o acescg.safetensors
  upglow color acescg.safetensors 0.9 0 0.9
  upglow bake --help";

pub(super) const BUILD: &str = "\
Examples:
  upglow build -o acescg.safetensors
  upglow build --space rec2020 --resolution 48 -o rec2020.safetensors
  upglow build --light A --preset jakob2019 -o reflectances.safetensors";

pub(super) const INSPECT: &str = "\
Examples:
  upglow inspect acescg.safetensors
  upglow --json inspect acescg.safetensors
  upglow inspect rec2020.coeff --space rec2020";

pub(super) const VERIFY: &str = "\
Examples:
  upglow verify acescg.safetensors
  upglow verify acescg.safetensors --points 100000 --seed 7";

pub(super) const COLOR: &str = "\
Examples:
  upglow color acescg.safetensors 0.9 0 0.9 --plot magenta.svg
  upglow color acescg.safetensors 0.9 0.3 0.02 --light D65 --light lamp.csv
  upglow color acescg.safetensors 0.9 0.3 0.02 --kind fluorescent --known A 0.75 0.28 0.02";

pub(super) const FIT_MATRIX: &str = "\
Examples:
  upglow fit-matrix sample.bfc -o sample.safetensors
  upglow fit-matrix sample.csv --dyes wide8 --plot sample.svg";

pub(super) const RELIGHT: &str = "\
Examples:
  upglow relight acescg.safetensors 0.9 0 0.9 --light A --light FL11
  upglow relight acescg.safetensors --colors paints.csv --csv seen.csv --plot paints.svg
  upglow relight acescg.safetensors --nodes --observer cie-1964-10deg --csv nodes.csv";

pub(super) const EXPORT: &str = "\
Examples:
  upglow export acescg.safetensors -o acescg.wgsl
  upglow export acescg.safetensors -o acescg.coeff --resolution 64
  upglow export acescg.safetensors -o marks.clf --show out-of-reach";

pub(super) const BAKE: &str = "\
Examples:
  upglow bake acescg.safetensors wall.exr -o wall_material.exr
  upglow bake acescg.safetensors textures --recursive -o baked --as spectral --compact
  upglow bake acescg.safetensors wall.exr -o wall.png --as radiance --light A";

pub(super) const CHECK: &str = "\
Examples:
  upglow check wall.exr
  upglow check textures --cube acescg.safetensors -o report.html";

pub(super) const READ: &str = "\
Examples:
  upglow read wall_material.exr --at 24,7";

pub(super) const LINT: &str = "\
Examples:
  upglow lint baked/wall.exr baked/floor.exr
  upglow lint --names-only spectral.exr";

#[cfg(feature = "explore")]
pub(super) const EXPLORE: &str = "\
Examples:
  upglow explore acescg.safetensors
  upglow explore --no-open --port 8080";

pub(super) const EXAMPLES: &str = "\
Examples:
  upglow examples -o pictures";

#[cfg(test)]
mod tests {
    use std::ffi::OsString;

    use clap::{CommandFactory as _, Parser as _};

    use crate::args::{Args, with_cube_first};

    /// What the help of a command ends with.
    fn told(command: &clap::Command) -> String {
        command.get_after_help().map(ToString::to_string).unwrap_or_default()
    }

    fn is_shown(command: &&clap::Command) -> bool {
        let is_elsewhere = command.is_disable_help_flag_set();
        !command.is_hide_set() && !is_elsewhere
    }

    #[test]
    fn every_help_ends_with_examples_that_the_program_accepts() {
        let program = Args::command();
        for command in program.get_subcommands().filter(is_shown) {
            let name = command.get_name();
            let text = told(command);
            let lines: Vec<&str> = text.lines().skip(1).collect();
            assert!(!lines.is_empty(), "{name} has no example");
            for line in lines {
                assert!(line.split(' ').any(|word| word == name), "{name}: {line}");
                let words = line.trim().split(' ').map(OsString::from);
                let read = Args::try_parse_from(with_cube_first(words));
                assert!(read.is_ok(), "{line}: {}", read.unwrap_err());
                assert!(line.len() < 100, "{line} is wrapped");
            }
        }
    }

    #[test]
    fn every_output_can_be_given_by_o_and_every_light_by_light() {
        for command in Args::command().get_subcommands().filter(is_shown) {
            let name = command.get_name();
            let options: Vec<_> = command.get_opts().collect();
            let output = options.iter().find(|option| option.get_long() == Some("output"));
            assert!(output.is_none_or(|option| option.get_short() == Some('o')), "{name}");
            if options.iter().any(|option| option.get_long() == Some("illuminant")) {
                let takes_light = options.iter().any(|option| {
                    let aliases = option.get_all_aliases().unwrap_or_default();
                    option.get_long() == Some("light") || aliases.contains(&"light")
                });
                assert!(takes_light, "{name}");
            }
        }
    }

    #[test]
    fn former_names_of_options_still_work() {
        for line in [
            "upglow export a.safetensors a.csv",
            "upglow examples --out pictures",
            "upglow build --light A -o a.safetensors",
            "upglow check a.exr --light A",
            "upglow inspect --cube a.safetensors",
        ] {
            let words = with_cube_first(line.split(' ').map(OsString::from));
            assert!(Args::try_parse_from(words).is_ok(), "{line}");
        }
    }
}
