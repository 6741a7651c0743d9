//! Commands that are programs of their own.

use crate::command::Place;
use std::os::unix::fs::PermissionsExt as _;
use std::process::Command;

/// Every command that hands over gives the program beside `souple` its arguments as they are, and ends with its exit code;
/// where there is none, it says how it is built.
#[test]
fn programs_beside_get_arguments_and_give_exit_codes() {
    let place = Place::new("neighbours");
    let souple = place.path("souple");
    std::fs::copy(env!("CARGO_BIN_EXE_souple"), &souple).unwrap();
    for command in ["campaign", "serve", "view"] {
        let run = || Command::new(&souple).args([command, "--help", "a b"]).env("PATH", "").output().unwrap();
        let missing = run();
        let said = String::from_utf8(missing.stderr).unwrap();
        assert_eq!(missing.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("souple-{command}")) && said.contains("cargo build --release"), "{said}");
        let program = place.path(&format!("souple-{command}"));
        std::fs::write(&program, "#!/bin/sh\necho \"$#: $1, $2\"\nexit 7\n").unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let ended = run();
        assert_eq!(ended.status.code(), Some(7), "{command}");
        assert_eq!(String::from_utf8(ended.stdout).unwrap(), "2: --help, a b\n");
        assert!(ended.stderr.is_empty(), "the program has said why");
    }
}
