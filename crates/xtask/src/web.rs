//! The window as a page: `cargo xtask web`.
//!
//! ```text
//! standard library for wasm32 ─┐
//!                              ├─ cargo build, profile `web` ─► souple-page.wasm ─ tools/web-binding ─► FOLDER
//! souple-viewer, feature `web` ┘
//! ```
//!
//! Few machines have a standard library for pages. It is taken from where it is, or built once from its source and kept
//! with everything else below `target/web`. Nothing here is part of the tests: they look at the folder if it is there.

use crate::workspace::{Workspace, cargo};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const TARGET: &str = "wasm32-unknown-unknown";
/// Every browser that draws by WebGL2 on a machine of today has vectors of two doubles.
const FLAGS: &str = "-C target-feature=+simd128";
/// What a page consists of.
const FILES: [&str; 3] = ["index.html", "souple-page.js", "souple-page_bg.wasm"];

/// A compiler that can compile for pages.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Compiler {
    program: PathBuf,
    library: Library,
    /// What links, where the compiler brings nothing that does.
    linker: Option<PathBuf>,
}

/// Where its standard library for pages comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Library {
    /// It is installed.
    Installed,
    /// Its source is; it is built with everything else, once.
    Source,
}

/// What a compiler says of itself.
struct Sysroot {
    program: PathBuf,
    folder: PathBuf,
    host: String,
}

pub(crate) fn run(workspace: &Workspace, arguments: &[&str]) -> ExitCode {
    let own = workspace.target.join("web");
    let folder = match arguments {
        [] => own.join("page"),
        ["--output", folder] => PathBuf::from(folder),
        other => {
            eprintln!("expected nothing or `--output FOLDER` behind `web`, found `{}`", other.join(" "));
            return ExitCode::from(2);
        }
    };
    match compiler().and_then(|compiler| build(workspace, &compiler, &own, &folder)) {
        Ok(report) => {
            println!("{report}");
            ExitCode::SUCCESS
        }
        Err(complaint) => {
            eprintln!("error: {complaint}");
            ExitCode::FAILURE
        }
    }
}

/// The first compiler that has what pages need: the one in use, or that of the system beside it.
fn compiler() -> Result<Compiler, String> {
    let usual = std::env::var_os("RUSTC").map_or_else(|| PathBuf::from("rustc"), PathBuf::from);
    let roots: Vec<Sysroot> = [usual, PathBuf::from("/usr/bin/rustc")].into_iter().filter_map(sysroot).collect();
    choose(&roots, &std::env::var_os("PATH").unwrap_or_default())
}

/// What a compiler says, if it is there.
fn sysroot(program: PathBuf) -> Option<Sysroot> {
    let ask = |arguments: &[&str]| -> Option<String> {
        let answer = Command::new(&program).args(arguments).output().ok().filter(|o| o.status.success())?;
        String::from_utf8(answer.stdout).ok()
    };
    let folder = PathBuf::from(ask(&["--print", "sysroot"])?.trim());
    let host = ask(&["-vV"])?.lines().find_map(|line| line.strip_prefix("host: ").map(str::to_owned))?;
    Some(Sysroot { program, folder, host })
}

fn choose(roots: &[Sysroot], path: &std::ffi::OsStr) -> Result<Compiler, String> {
    let rustlib = |root: &Sysroot| root.folder.join("lib/rustlib");
    if let Some(root) = roots.iter().find(|root| rustlib(root).join(TARGET).join("lib").is_dir()) {
        return Ok(Compiler { program: root.program.clone(), library: Library::Installed, linker: None });
    }
    let source = roots.iter().find(|root| rustlib(root).join("src/rust/library/std/Cargo.toml").is_file());
    let Some(root) = source else {
        return Err(format!(
            "no compiler here has a standard library for pages ({TARGET}), or its source. Either\n    \
             rustup target add {TARGET}\nor, on Debian and Ubuntu,\n    \
             apt-get install --no-install-recommends rustc-web rust-web-src"
        ));
    };
    let brought = roots.iter().map(|r| rustlib(r).join(&r.host).join("bin/rust-lld"));
    let on_path = std::env::split_paths(path).flat_map(|folder| ["rust-lld", "wasm-ld"].map(|name| folder.join(name)));
    let linker = brought.chain(on_path).find(|file| file.is_file()).ok_or_else(|| {
        format!(
            "{} comes without a linker for pages, and there is no `rust-lld` (toolchains of rustup bring it) and no \
             `wasm-ld` (apt-get install lld) on the path",
            root.program.display()
        )
    })?;
    Ok(Compiler { program: root.program.clone(), library: Library::Source, linker: Some(linker) })
}

/// Builds the program, binds it and writes the folder; what was written, in words.
fn build(workspace: &Workspace, compiler: &Compiler, own: &Path, folder: &Path) -> Result<String, String> {
    let mut build = Command::new(cargo());
    build.current_dir(&workspace.root).args(["build", "--locked", "--profile", "web", "--target", TARGET]);
    build.args(["--package", "souple-viewer", "--bin", "souple-page", "--no-default-features", "--features", "web"]);
    build.arg("--target-dir").arg(own).env("RUSTC", &compiler.program);
    // Flags for this machine's processor are none for pages, and would replace ours.
    build.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", FLAGS);
    if let Some(linker) = &compiler.linker {
        build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
    }
    if compiler.library == Library::Source {
        // Building the standard library is not stable yet; the variable lets a stable cargo do it.
        build.arg("-Zbuild-std=std,panic_abort").env("RUSTC_BOOTSTRAP", "1");
    }
    finish(build)?;

    let program = own.join(TARGET).join("web/souple-page.wasm");
    std::fs::create_dir_all(folder).map_err(|e| format!("cannot make the folder {}: {e}", folder.display()))?;
    let mut bind = Command::new(cargo());
    bind.current_dir(&workspace.root).args(["run", "--quiet", "--locked", "--release"]);
    bind.arg("--manifest-path").arg(workspace.root.join("tools/web-binding/Cargo.toml"));
    bind.arg("--target-dir").arg(own.join("tools")).arg("--").arg(&program).arg(absolute(folder)?);
    finish(bind)?;

    let page = workspace.root.join("crates/viewer/page/index.html");
    std::fs::copy(&page, folder.join("index.html"))
        .map_err(|e| format!("cannot copy {} into {}: {e}", page.display(), folder.display()))?;
    report(folder)
}

fn absolute(folder: &Path) -> Result<PathBuf, String> {
    std::path::absolute(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

fn finish(mut command: Command) -> Result<(), String> {
    let name = Path::new(command.get_program()).display().to_string();
    let words: Vec<_> = command.get_args().map(|a| a.to_string_lossy().into_owned()).collect();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`cargo {}` ended with {status}; what it said is above", words.join(" "))),
        Err(e) => Err(format!("cannot start {name}: {e}")),
    }
}

/// The files with their sizes, and how to look at them.
fn report(folder: &Path) -> Result<String, String> {
    let mut lines = Vec::new();
    for name in FILES {
        let path = folder.join(name);
        let bytes = std::fs::metadata(&path).map_err(|e| format!("{}: {e}", path.display()))?.len();
        lines.push(match compressed(&path) {
            Some(packed) => format!("{bytes:>10} bytes, {packed:>9} compressed  {}", path.display()),
            None => format!("{bytes:>10} bytes  {}", path.display()),
        });
    }
    lines.push(format!(
        "Any server of files will do: python3 -m http.server --directory {0} 8080\n\
         and then http://127.0.0.1:8080/?scene=mixed_bar",
        folder.display()
    ));
    Ok(lines.join("\n"))
}

/// What a server that compresses sends, where there is a gzip to ask.
fn compressed(path: &Path) -> Option<usize> {
    let packed = Command::new("gzip").args(["-9", "-c"]).arg(path).output().ok()?;
    packed.status.success().then_some(packed.stdout.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(folder: &Path, name: &str, files: &[&str]) -> Sysroot {
        let folder = folder.join(name);
        for file in files {
            let path = folder.join("lib/rustlib").join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        Sysroot { program: folder.join("bin/rustc"), folder, host: "here".into() }
    }

    /// An installed library is taken before a source, whichever compiler has it; a source needs a linker, which another
    /// compiler may bring; and what is missing is named with the command that brings it.
    #[test]
    fn a_compiler_is_found_or_what_is_missing_is_said() {
        let at = &std::env::temp_dir().join(format!("souple-web-{}", std::process::id()));
        let bare = || root(at, "bare", &["here/lib/libstd.rlib"]);
        let linking = || root(at, "linking", &["here/bin/rust-lld"]);
        let source = || root(at, "source", &["src/rust/library/std/Cargo.toml"]);
        let whole = || root(at, "whole", &["wasm32-unknown-unknown/lib/libstd.rlib"]);
        let nothing = std::ffi::OsStr::new("");

        let chosen = choose(&[source(), whole()], nothing).unwrap();
        assert_eq!((chosen.program, chosen.library), (whole().program, Library::Installed));
        let chosen = choose(&[linking(), source()], nothing).unwrap();
        assert_eq!((&chosen.program, chosen.library), (&source().program, Library::Source));
        assert_eq!(chosen.linker, Some(linking().folder.join("lib/rustlib/here/bin/rust-lld")));
        assert!(choose(&[bare(), source()], nothing).unwrap_err().contains("apt-get install lld"));
        let missing = choose(&[bare(), linking()], nothing).unwrap_err();
        assert!(missing.contains("rustup target add") && missing.contains("rustc-web rust-web-src"), "{missing}");
        std::fs::remove_dir_all(at).unwrap();
    }

    /// The binding tool is of the version that the program was compiled with: another one refuses its files.
    #[test]
    fn the_binding_has_the_version_of_the_program() {
        let version = |file: &str, package: &str| -> Option<String> {
            let lock = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)).unwrap();
            let after = lock.split_once(&format!("name = \"{package}\"\nversion = \""))?.1;
            after.split('"').next().map(str::to_owned)
        };
        let tool = version("tools/web-binding/Cargo.lock", "wasm-bindgen-cli-support");
        assert!(tool.is_some());
        assert_eq!(tool, version("Cargo.lock", "wasm-bindgen"));
    }
}
