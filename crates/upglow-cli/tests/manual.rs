//! Manual pages and completions, which packages of the program are made with.

mod support;

use support::Folder;

#[test]
fn every_command_of_the_help_has_a_manual_page() {
    let folder = Folder::new();
    let told = folder.json("man -o man");
    let help = folder.done("--help");
    let (_, commands) = help.split_once("Commands:\n").unwrap();
    let lines = commands.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let mut names: Vec<&str> = names.filter_map(|line| line.split_whitespace().next()).collect();
    // The help lists it in every build, and says which have it.
    names.retain(|name| cfg!(feature = "explore") || *name != "explore");
    assert!(names.contains(&"build") && names.contains(&"help"), "{names:?}");
    for name in names.iter().filter(|name| **name != "help") {
        let page = String::from_utf8(folder.read(&format!("man/upglow-{name}.1"))).unwrap();
        assert!(page.contains(".SH SYNOPSIS"), "{name}: {page}");
        assert!(page.contains("\"upglow 0."), "{name}: {page}");
    }
    // One for each command, without `help`, and one for the program.
    assert_eq!(told["files"].as_array().map(Vec::len), Some(names.len()));
    assert!(folder.read("man/upglow.1").starts_with(b".ie"));
}

#[test]
fn every_shell_gets_a_script_with_the_options() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.done(&format!("completions {shell}"));
        assert!(script.contains("slope-max-per-nm") && script.contains("--cube"), "{shell}");
        assert!(!script.contains("reproduce"), "{shell}");
    }
    let line = folder.refused(2, "completions tcsh");
    assert!(line.contains("bash"), "{line}");
}
