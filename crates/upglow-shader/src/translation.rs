//! From the templates' dialect to the other languages.
//!
//! Templates are WGSL that states every type and uses only what all languages have: structs of
//! numbers and structs, functions, `if`, `for`, and the functions of numbers that share a name. What
//! is left to change is the order of names and types, and a few words. In `JavaScript`, where a number
//! has no type, a struct is a function that makes one, and quotients of integers stand in `i32()`.

use crate::language::Language;

/// `wgsl` in `language`, line by line.
pub(crate) fn translate(wgsl: &str, language: Language) -> String {
    if language == Language::Wgsl {
        return wgsl.into();
    }
    let mut in_struct = false;
    let mut text = String::with_capacity(wgsl.len());
    for line in wgsl.lines() {
        let (code, comment) = line.split_at(line.find("//").unwrap_or(line.len()));
        let indent = &code[..code.len() - code.trim_start().len()];
        let code = code.trim_start();
        let closes = in_struct && code == "}";
        in_struct = code.starts_with("struct ") || in_struct && !closes;
        text += indent;
        let code = match language {
            Language::JavaScript => untyped(code, in_struct),
            _ => rearranged(code, in_struct, language),
        };
        text += &words(&code, language);
        text += match language {
            _ if !closes => "",
            Language::JavaScript => ");",
            _ => ";",
        };
        text += comment;
        text.push('\n');
    }
    text
}

/// A line with types before names.
fn rearranged(code: &str, in_struct: bool, language: Language) -> String {
    if let Some((name, kind, value)) = declaration(code, "const ") {
        return constant(name, kind, value, language);
    }
    if let Some((name, kind, rest)) =
        declaration(code, "let ").or_else(|| declaration(code, "var "))
    {
        return format!("{kind} {name}{rest}");
    }
    if let Some(signature) = Signature::of(code) {
        return signature.typed();
    }
    if let Some((name, rest)) = code.strip_prefix("for (var ").and_then(|c| c.split_once(": ")) {
        let (kind, rest) = rest.split_once(' ').unwrap_or((rest, ""));
        return format!("for ({kind} {name} {rest}");
    }
    match code.split_once(": ") {
        Some((name, rest)) if in_struct => {
            let kind = rest.trim_end();
            let blank = &rest[kind.len()..];
            format!("{} {name};{blank}", kind.trim_end_matches(','))
        }
        _ => code.into(),
    }
}

/// Name, type and the rest of a line that declares one with this keyword.
fn declaration<'a>(code: &'a str, keyword: &str) -> Option<(&'a str, &'a str, &'a str)> {
    let (name, rest) = code.strip_prefix(keyword)?.split_once(": ")?;
    let end = rest.find([' ', ';'])?;
    Some((name, &rest[..end], &rest[end..]))
}

/// A line of `JavaScript`, without types.
fn untyped(code: &str, in_struct: bool) -> String {
    if let Some((name, _, value)) =
        declaration(code, "const ").or_else(|| declaration(code, "let "))
    {
        return format!("const {name}{value}");
    }
    if let Some((name, kind, rest)) = declaration(code, "var ") {
        return match rest {
            ";" => format!("const {name} = {kind}();"),
            _ => format!("let {name}{rest}"),
        };
    }
    if let Some(signature) = Signature::of(code) {
        return signature.untyped();
    }
    if let Some((name, rest)) = code.strip_prefix("for (var ").and_then(|c| c.split_once(": ")) {
        return format!("for (let {name} {}", rest.split_once(' ').map_or(rest, |(_, rest)| rest));
    }
    if let Some(name) = code.strip_prefix("struct ").and_then(|c| c.strip_suffix(" {")) {
        return format!("const {name} = () => ({{");
    }
    match code.split_once(": ") {
        Some((name, rest)) if in_struct => {
            let (kind, rest) = rest.split_once(',').unwrap_or((rest, ""));
            let initial = match kind {
                "f32" | "i32" => "0",
                "bool" => "false",
                _ => "null",
            };
            format!("{name}: {initial},{rest}")
        }
        _ => code.into(),
    }
}

fn constant(name: &str, kind: &str, value: &str, language: Language) -> String {
    match language {
        // No variables outside functions.
        Language::Osl => {
            let value = value.trim_start_matches(" = ").trim_end_matches(';');
            format!("#define {name} {value}")
        }
        Language::Hlsl => format!("static const {kind} {name}{value}"),
        _ => format!("const {kind} {name}{value}"),
    }
}

/// The first line of a function, `name(a: A, b: B) -> C {`.
struct Signature<'a> {
    name: &'a str,
    /// Names and types.
    parameters: Vec<(&'a str, &'a str)>,
    kind: &'a str,
    rest: &'a str,
}

impl<'a> Signature<'a> {
    fn of(code: &'a str) -> Option<Self> {
        let (name, rest) = code.strip_prefix("fn ")?.split_once('(')?;
        let (parameters, rest) = rest.split_once(") -> ")?;
        let (kind, rest) = rest.split_once(' ')?;
        let parameters: Option<_> = parameters.split(", ").map(|p| p.split_once(": ")).collect();
        Some(Self { name, parameters: parameters?, kind, rest })
    }

    /// `C name(A a, B b) {`.
    fn typed(&self) -> String {
        let Self { name, parameters, kind, rest } = self;
        let parameters: Vec<String> =
            parameters.iter().map(|(name, kind)| format!("{kind} {name}")).collect();
        format!("{kind} {name}({}) {rest}", parameters.join(", "))
    }

    /// `function name(a, b) {`.
    fn untyped(&self) -> String {
        let Self { name, parameters, rest, .. } = self;
        let names: Vec<&str> = parameters.iter().map(|(name, _)| *name).collect();
        format!("function {name}({}) {rest}", names.join(", "))
    }
}

/// The line with each word in the language's own.
fn words(code: &str, language: Language) -> String {
    let mut text = String::with_capacity(code.len());
    let mut rest = code;
    while !rest.is_empty() {
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        text += word(&rest[..end], language);
        let next = rest[end..].find(is_word).map_or(rest.len(), |at| end + at);
        text += &rest[end..next];
        rest = &rest[next..];
    }
    text
}

fn word(word: &str, language: Language) -> &str {
    use Language::{Glsl, Hlsl, JavaScript, Osl};
    match (word, language) {
        ("f32", JavaScript) => "",
        ("i32", JavaScript) => "Math.trunc",
        ("abs", JavaScript) => "Math.abs",
        ("exp", JavaScript) => "Math.exp",
        ("max", JavaScript) => "Math.max",
        ("min", JavaScript) => "Math.min",
        ("mix", JavaScript) => "upglow_mix",
        ("sqrt", JavaScript) => "Math.sqrt",
        ("f32", _) => "float",
        ("i32", _) => "int",
        ("vec3f", Glsl) => "vec3",
        ("vec3f", Hlsl) => "float3",
        ("vec3f", Osl) => "color",
        ("vec4f", Glsl) => "vec4",
        ("vec4f", Hlsl) => "float4",
        ("vec4f", Osl) => "UpglowTexel",
        ("mix", Hlsl) => "lerp",
        ("bool", Osl) => "int",
        ("true", Osl) => "1",
        ("false", Osl) => "0",
        _ => word,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WGSL: &str = "\
const COUNT: i32 = 3;
// A pair: of numbers.
struct Pair {
    a: f32, // the first: nm
    b: vec4f,
}

fn f(p: Pair, n: i32) -> bool {
    let x: f32 = mix(p.a, 1.0, 0.5); // let y: f32
    var q: Pair;
    for (var k: i32 = 0; k < COUNT; k += 1) {
        q.a = f32(k) * x;
    }
    return true;
}
";

    #[test]
    fn declarations_turn_around_and_words_change() {
        assert_eq!(
            translate(WGSL, Language::Hlsl),
            "\
static const int COUNT = 3;
// A pair: of numbers.
struct Pair {
    float a; // the first: nm
    float4 b;
};

bool f(Pair p, int n) {
    float x = lerp(p.a, 1.0, 0.5); // let y: f32
    Pair q;
    for (int k = 0; k < COUNT; k += 1) {
        q.a = float(k) * x;
    }
    return true;
}
"
        );
    }

    #[test]
    fn osl_has_its_own_constants_and_truths() {
        let osl = translate(WGSL, Language::Osl);
        assert!(osl.starts_with("#define COUNT 3\n"));
        assert!(osl.contains("    UpglowTexel b;\n};\n"));
        assert!(osl.contains("int f(Pair p, int n) {\n"));
        assert!(osl.contains("return 1;\n"));
        assert!(osl.contains("1.0, 0.5)"));
    }

    #[test]
    fn javascript_has_no_types_and_makes_structs() {
        assert_eq!(
            translate(WGSL, Language::JavaScript),
            "\
const COUNT = 3;
// A pair: of numbers.
const Pair = () => ({
    a: 0, // the first: nm
    b: null,
});

function f(p, n) {
    const x = upglow_mix(p.a, 1.0, 0.5); // let y: f32
    const q = Pair();
    for (let k = 0; k < COUNT; k += 1) {
        q.a = (k) * x;
    }
    return true;
}
"
        );
    }

    #[test]
    fn wgsl_stays_as_it_is() {
        assert_eq!(translate(WGSL, Language::Wgsl), WGSL);
    }
}
