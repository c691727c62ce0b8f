//! `include/rockproof.h` says what the library exports. With ROCKPROOF_RENEW=1 it is written anew.

use std::path::Path;

#[test]
fn the_header_is_in_step_with_the_library() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("cbindgen.toml");
    let mut made = Vec::new();
    let sources = ["exports", "block", "check", "contacts", "distance", "tolerances"];
    let builder = sources.iter().fold(cbindgen::Builder::new().with_config(config), |all, name| {
        all.with_src(folder.join(format!("src/{name}.rs")))
    });
    builder.generate().expect("the sources parse").write(&mut made);
    let made = String::from_utf8(made).expect("text");
    let file = folder.join("include/rockproof.h");
    if std::env::var_os("ROCKPROOF_RENEW").is_some() {
        std::fs::write(&file, &made).expect("written");
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(found == made, "include/rockproof.h is out of step: ROCKPROOF_RENEW=1 writes it anew");
}
