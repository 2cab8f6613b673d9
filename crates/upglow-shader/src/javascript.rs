//! A shader as a `JavaScript` module, whose only export takes the textures and returns the functions.

use crate::payload::{MAGIC, VERSION};
use crate::shader::PayloadFile;

/// The functions of every module: what the language lacks, and checks of the textures.
const MODULE: &str = include_str!("templates/module.js");

/// The module: its constants, then the function around all that reads textures.
pub(crate) fn module(
    constants: &str,
    functions: &str,
    textures: &PayloadFile,
    checksum: u64,
) -> String {
    let PayloadFile { name, bytes } = textures;
    let magic = String::from_utf8_lossy(&MAGIC);
    let indented = functions.lines().map(|line| match line {
        "" => "\n".to_owned(),
        _ => format!("    {line}\n"),
    });
    format!(
        "{constants}const UPGLOW_TEXTURES = \"{name}\";
const UPGLOW_MAGIC = \"{magic}\";
const UPGLOW_VERSION = {VERSION};
const UPGLOW_BYTES = {};
const UPGLOW_CHECKSUM = \"{checksum:016x}\";

{MODULE}export function upglow(textures) {{
    upglow_check(textures);
{}
    return {{
{}    }};
}}
",
        bytes.len(),
        indented.collect::<String>(),
        names(functions).map(|name| format!("        {name},\n")).collect::<String>(),
    )
}

/// The names of the functions in a text.
fn names(functions: &str) -> impl Iterator<Item = &str> {
    functions.lines().filter_map(|line| Some(line.strip_prefix("function ")?.split_once('(')?.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_export_returns_every_function_by_its_name() {
        let textures = PayloadFile { name: "gray.textures".into(), bytes: vec![0; 80] };
        let functions =
            "function a(x) {\n    return x;\n}\n\nfunction b() {\n    return a(1);\n}\n";
        let module = module("const UPGLOW_N = 2;\n", functions, &textures, 0xabc);
        assert!(
            module.starts_with("const UPGLOW_N = 2;\nconst UPGLOW_TEXTURES = \"gray.textures\";")
        );
        assert!(
            module.contains(
                "const UPGLOW_BYTES = 80;\nconst UPGLOW_CHECKSUM = \"0000000000000abc\";"
            )
        );
        assert!(
            module.contains("    function a(x) {\n        return x;\n    }\n\n    function b() {")
        );
        assert!(module.ends_with("    return {\n        a,\n        b,\n    };\n}\n"));
        assert_eq!(module.matches("export").count(), 2, "the other is a word of an error");
    }
}
