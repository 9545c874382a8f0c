//! Packed input, and `-` for standard input.

use super::{CHUNKS, Folder, TAGS, shipped};
use flate2::{Compression, write::GzEncoder};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io::Write;

fn gzip(text: impl AsRef<[u8]>) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(text.as_ref()).and_then(|()| packer.finish()).expect("memory")
}

fn zstd(text: impl AsRef<[u8]>) -> Vec<u8> {
    compress_to_vec(text.as_ref(), CompressionLevel::Fastest)
}

#[test]
fn what_is_packed_is_as_what_is_not() {
    let folder = Folder::new();
    let template = "U:%x[0,0]\nU:%x[-1,0]\nB\n";
    let grammar = std::fs::read(shipped("grammars/dialects.grammar")).expect("shipped");
    for (name, bytes) in [("c", CHUNKS.as_bytes()), ("t", template.as_bytes()), ("g", &grammar)] {
        folder.put(name, bytes);
        folder.put(&format!("{name}.gz"), gzip(bytes));
        folder.put(&format!("{name}.zst"), zstd(bytes));
    }
    // Two archives one behind the other, by a name that says nothing.
    let (first, second) = CHUNKS.split_at(CHUNKS.find("\n\n").expect("a blank line") + 2);
    folder.put("both", [gzip(first), gzip(second)].concat());
    folder.run("train --data c --template t --model m -q");
    for (data, template) in [("c.gz", "t.zst"), ("c.zst", "t.gz"), ("both", "t")] {
        folder.run(&format!("train --data {data} --template {template} --model n -q"));
        // But for the name of what they were trained on.
        let weights = |model| {
            folder.get(model).len() - folder.json(&format!("inspect {model} --json"))["about"]["data"].to_string().len()
        };
        assert_eq!(weights("m"), weights("n"), "{data}");
        let score = folder.json(&format!("evaluate --model n --data {data} --json"));
        assert_eq!(score, folder.json("evaluate --model m --data c --json"));
    }
    let tagged = folder.run_on("tag --model m", CHUNKS);
    let converted = folder.run_on("convert --from conll --to crfsuite --template t", CHUNKS);
    for packed in [gzip(CHUNKS), zstd(CHUNKS), folder.get("both")] {
        assert_eq!(folder.run_on("tag --model m", packed.clone()), tagged);
        assert_eq!(
            folder.run_on("convert --from conll --to crfsuite --template t --data -", packed.clone()),
            converted
        );
        folder.run_on("train --data - --model n -q", packed);
    }
    let drawn = folder.run("generate --grammar g --count 5");
    assert_eq!(folder.run("generate --grammar g.gz --count 5"), drawn);
    assert_eq!(folder.run_on("generate --grammar - --count 5", zstd(&grammar)), drawn);
    assert_eq!(folder.run_on("inspect - --json", folder.get("m")).len(), folder.run("inspect m --json").len());
}

#[test]
fn what_is_no_whole_archive_is_refused() {
    let folder = Folder::new();
    let archive = gzip(TAGS);
    folder.put("whole.gz", &archive);
    folder.put("short.gz", &archive[..archive.len() - 5]);
    folder.put("short.zst", &zstd(TAGS)[..20]);
    folder.put("plain.gz", TAGS);
    folder.run("train --data whole.gz --model m -q");
    let message = folder.refused("train --data short.gz --model n");
    assert!(message.starts_with("error: cannot read short.gz: gzip data that are cut short or damaged ("), "{message}");
    assert!(message.ends_with("); expected a whole archive\n"), "{message}");
    let message = folder.refused("evaluate --model m --data short.zst");
    assert!(message.starts_with("error: cannot read short.zst: zstd data that are cut short"), "{message}");
    let named = "plain.gz: named as packed by gzip, but it is not; pack it, or give it another name";
    folder.says("train --data plain.gz --model n", named);
    // What was read of a stream before is answered, and the end is no success.
    let output = folder.rollin("tag --model m").write_stdin(&archive[..archive.len() - 5]).output().expect("it runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.starts_with("error: cannot read <stdin>: gzip data that are cut short"), "{message}");
}

#[test]
fn standard_input_is_read_once_and_files_go_to_files() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    folder.run("train --data t.txt --model m -q");
    let twice = "<stdin>: read already; give a file in place of one -";
    folder.says_on("evaluate --model - --data -", folder.get("m"), twice);
    folder.says_on("train --data - --template - --model n", TAGS, twice);
    folder.says("tag --model -", "--model is -, but must be a file: standard input has the lines to be tagged");
    let output =
        "-: a file is to be written, and standard output has the report; give a name, or ./- for a file of this name";
    folder.says("train --data t.txt --model -", output);
    folder.says("evaluate --model m --data t.txt --html -", output);
}
