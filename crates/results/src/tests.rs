//! What a directory of results promises: nobody else's file is touched, and nothing damaged is gone on from.

use super::*;

const FILES: [&str; 2] = ["run.json", "rows.csv"];

fn claim(dir: &Path, start: Start) -> Result<Directory, ResultsError> {
    Directory::claim(Claim { dir, owner: Owner::Campaign, start, files: &FILES })
}

/// Every file but the lock, with its bytes.
fn files(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(dir).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => found.extend(files(&path)),
            false => drop(found.insert(path.clone(), fs::read(&path).expect("a file"))),
        }
    }
    found
}

#[test]
fn whoever_wrote_nothing_leaves_the_directory_free() {
    let dir = tempfile::tempdir().expect("a folder");
    drop(claim(dir.path(), Start::Fresh).expect("free"));
    let mut directory = claim(dir.path(), Start::Fresh).expect("still free");
    directory.write("rows.csv", FileKind::Table, b"1").expect("ours");
    drop(directory);
    assert!(matches!(claim(dir.path(), Start::Fresh), Err(ResultsError::Occupied { .. })));
}

#[test]
fn a_manifest_of_files_that_were_never_written_leaves_the_directory_free() {
    // As on a full disk: files are listed before they are written.
    let dir = tempfile::tempdir().expect("a folder");
    let mut directory = claim(dir.path(), Start::Fresh).expect("free");
    directory.write("rows.csv", FileKind::Table, b"1").expect("ours");
    drop(directory);
    fs::remove_file(dir.path().join("rows.csv")).expect("removed");
    drop(claim(dir.path(), Start::Fresh).expect("free"));
    // What comes there later is somebody else's.
    fs::write(dir.path().join("rows.csv"), "theirs").expect("write");
    for start in [Start::Fresh, Start::Overwrite] {
        assert!(matches!(claim(dir.path(), start), Err(ResultsError::Foreign { .. })), "{start:?}");
    }
}

#[test]
fn a_name_that_a_file_has_is_no_directory_and_the_file_stays() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("taken");
    fs::write(&file, "theirs").expect("write");
    for place in [file.clone(), file.join("run")] {
        for start in [Start::Fresh, Start::Resume, Start::Overwrite] {
            let told = format!("taken is no directory, so no results can be written to {}; --out DIR", place.display());
            let error = claim(&place, start).expect_err("a file").to_string();
            assert!(error.contains(&told), "{error}");
            let early = start.refuse_held(&place, Owner::Campaign).expect_err("a file").to_string();
            assert_eq!(early, error);
        }
    }
    assert_eq!(fs::read(&file).expect("a file"), b"theirs");
}

#[test]
fn what_is_not_ours_is_named_and_nothing_changes() {
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("rows.csv"), "theirs").expect("write");
    let before = files(dir.path());
    for start in [Start::Fresh, Start::Resume, Start::Overwrite] {
        let error = claim(dir.path(), start).expect_err("in the way");
        assert!(matches!(&error, ResultsError::Foreign { file, .. } if file.ends_with("rows.csv")), "{error}");
    }
    assert_eq!(files(dir.path()), before);
    fs::remove_file(dir.path().join("rows.csv")).expect("removed");
    let mut directory = claim(dir.path(), Start::Fresh).expect("free");
    fs::create_dir(dir.path().join("cases")).expect("a folder");
    fs::write(dir.path().join("cases/a.toml"), "theirs").expect("write");
    assert!(matches!(directory.write("cases/a.toml", FileKind::Case, b"ours"), Err(ResultsError::Foreign { .. })));
    assert_eq!(fs::read(dir.path().join("cases/a.toml")).expect("a file"), b"theirs");
}

#[test]
fn overwriting_discards_what_is_listed_and_nothing_else() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut directory = claim(dir.path(), Start::Fresh).expect("free");
    directory.write("cases/ours.toml", FileKind::Case, b"ours").expect("written");
    directory.write("run.json", FileKind::Run, b"{}").expect("written");
    drop(directory);
    for name in ["cases/theirs.toml", "notes.txt", ".notes.txt.1.2.tmp", ".summary.csv.1.2.tmp"] {
        fs::write(dir.path().join(name), "theirs").expect("write");
    }
    for name in [".run.json.1.2.tmp", "cases/.ours.toml.1.2.tmp", ".rockproof.manifest.json.1.2.tmp"] {
        fs::write(dir.path().join(name), "half of ours").expect("write");
    }
    assert!(matches!(claim(dir.path(), Start::Fresh), Err(ResultsError::Occupied { .. })));
    let other = Claim { dir: dir.path(), owner: Owner::Simulate, start: Start::Overwrite, files: &FILES };
    assert!(matches!(Directory::claim(other), Err(ResultsError::OtherCommand { .. })));
    let directory = claim(dir.path(), Start::Overwrite).expect("ours");
    assert!(!directory.resumes() && !directory.has("run.json"));
    drop(directory);
    let left: Vec<String> = files(dir.path())
        .keys()
        .map(|path| path.strip_prefix(dir.path()).expect("inside").to_string_lossy().into_owned())
        .collect();
    let expected = [".notes.txt.1.2.tmp", ".summary.csv.1.2.tmp", "cases/theirs.toml", "notes.txt", MANIFEST];
    assert_eq!(left, expected);
}

#[test]
fn tables_go_on_from_their_seals_and_damaged_ones_do_not() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut directory = claim(dir.path(), Start::Fresh).expect("free");
    let mut table = directory.begin_table("rows.csv", b"a,b\n").expect("a table");
    table.append(b"1,2\n").expect("rows");
    let seal = table.seal().expect("sealed");
    assert_eq!(seal, Seal { bytes: 8, sha256: crate::digest(b"a,b\n1,2\n") });
    table.append(b"3,").expect("half a row");
    drop((table, directory));
    let directory = claim(dir.path(), Start::Resume).expect("ours");
    assert!(directory.resumes());
    let mut tables = directory.resume_tables([("rows.csv", &seal)]).expect("whole");
    tables[0].append(b"5,6\n").expect("rows");
    let path = dir.path().join("rows.csv");
    assert_eq!(fs::read(&path).expect("rows"), b"a,b\n1,2\n5,6\n");
    assert_eq!(tables[0].seal().expect("sealed").sha256, crate::digest(b"a,b\n1,2\n5,6\n"));
    for damaged in [&b"a,b\n1,3\n"[..], b"a,b\n1,2", b""] {
        fs::write(&path, damaged).expect("write");
        let error = directory.resume_tables([("rows.csv", &seal)]).expect_err("damaged").to_string();
        assert!(error.contains("rows.csv") && error.contains("--overwrite"), "{error}");
        assert_eq!(fs::read(&path).expect("rows"), damaged, "nothing is cut off");
    }
}

#[test]
fn sealed_objects_and_manifests_are_believed_only_as_written() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut directory = claim(dir.path(), Start::Fresh).expect("free");
    let object = BTreeMap::from([("pairs".to_owned(), 7_u64)]);
    directory.write_sealed("run.json", &object).expect("written");
    assert_eq!(directory.read_sealed::<BTreeMap<String, u64>>("run.json").expect("whole"), object);
    let change = |name: &str, from: &str, to: &str| {
        let file = dir.path().join(name);
        let text = fs::read_to_string(&file).expect("text");
        assert!(text.contains(from), "{text}");
        fs::write(&file, text.replacen(from, to, 1)).expect("write");
    };
    change("run.json", "7", "8");
    let error = directory.read_sealed::<BTreeMap<String, u64>>("run.json").expect_err("changed");
    assert!(matches!(&error, ResultsError::Damaged { what, .. } if what.contains("not as it was written")), "{error}");
    drop(directory);
    change(MANIFEST, "run.json", "my_own.csv");
    fs::write(dir.path().join("my_own.csv"), "theirs").expect("write");
    assert!(matches!(claim(dir.path(), Start::Overwrite), Err(ResultsError::Manifest { .. })));
    // Nor is a whole one that reaches outside.
    let text = sealed("{\"owner\":\"campaign\",\"files\":{\"../theirs\":\"table\"}}");
    fs::write(dir.path().join(MANIFEST), text).expect("write");
    let error = claim(dir.path(), Start::Overwrite).expect_err("outside").to_string();
    assert!(error.contains("../theirs"), "{error}");
    assert!(dir.path().join("my_own.csv").exists());
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_a_link_is_refused_and_nothing_behind_it_changes() {
    let dir = tempfile::tempdir().expect("a folder");
    let (results, theirs) = (dir.path().join("run"), dir.path().join("theirs"));
    let mut directory = claim(&results, Start::Fresh).expect("free");
    directory.write("cases/a.toml", FileKind::Case, b"ours").expect("written");
    drop(directory);
    fs::rename(results.join("cases"), &theirs).expect("moved");
    fs::write(theirs.join("a.toml"), "theirs").expect("write");
    std::os::unix::fs::symlink(&theirs, results.join("cases")).expect("a link");
    for start in [Start::Resume, Start::Overwrite] {
        let error = claim(&results, start).expect_err("a link");
        assert!(matches!(&error, ResultsError::Link { file } if file.ends_with("run/cases")), "{error}");
        assert!(error.to_string().contains("cases is a symbolic link"), "{error}");
    }
    // Nor where no file of ours was in it before.
    fs::remove_file(results.join(MANIFEST)).expect("removed");
    let mut directory = claim(&results, Start::Fresh).expect("free");
    assert!(matches!(directory.make_folder("cases"), Err(ResultsError::Link { .. })));
    let written = directory.write("cases/deep/b.toml", FileKind::Case, b"ours");
    assert!(matches!(written, Err(ResultsError::Link { .. })), "{written:?}");
    assert_eq!(files(&theirs), BTreeMap::from([(theirs.join("a.toml"), b"theirs".to_vec())]));
}
