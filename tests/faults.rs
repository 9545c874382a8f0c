//! Readers and writers on streams as systems give them: a few bytes at a time, interrupted by signals, broken in the middle.

use proptest::prelude::*;
use rollin::Seed;
use rollin::corpus::{Corpus, Separator};
use rollin::grammar::{Grammar, defaults};
use rollin::read::conll::Blocks;
use rollin::read::{conllu, crfsuite, vw};
use std::io::{self, BufReader, ErrorKind, Read, Write};

/// A stream that moves at most `piece` bytes at a time, is interrupted before every third, and breaks after `whole` bytes.
struct Faulty<'a> {
    source: &'a [u8],
    moved: Vec<u8>,
    piece: usize,
    calls: usize,
    whole: usize,
}

impl<'a> Faulty<'a> {
    fn new(source: &'a [u8], piece: usize, whole: usize) -> Self {
        Faulty { source, moved: Vec::new(), piece, calls: 0, whole }
    }

    /// How many of so many bytes are moved now.
    fn some(&mut self, wanted: usize) -> io::Result<usize> {
        self.calls += 1;
        if self.calls.is_multiple_of(3) {
            return Err(ErrorKind::Interrupted.into());
        }
        let some = wanted.min(self.piece).min(self.whole - self.moved.len());
        if some == 0 && wanted > 0 { Err(ErrorKind::StorageFull.into()) } else { Ok(some) }
    }
}

impl Read for Faulty<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let rest = &self.source[self.moved.len()..];
        if rest.is_empty() {
            return Ok(0);
        }
        let some = self.some(buffer.len().min(rest.len()))?;
        buffer[..some].copy_from_slice(&rest[..some]);
        self.moved.extend_from_slice(&rest[..some]);
        Ok(some)
    }
}

impl Write for Faulty<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let some = self.some(bytes.len())?;
        self.moved.extend_from_slice(&bytes[..some]);
        Ok(some)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Something that writes itself.
type Written<'w> = (&'static str, Box<dyn Fn(&mut Faulty<'_>) -> io::Result<()> + 'w>);

/// Whatever the library writes to streams.
fn with_all(test: impl Fn(&Written<'_>)) {
    let corpus = Corpus::parse("the D B-NP\nold A I-NP\n\nsinks V B-VP\n").expect("a corpus");
    let ten = Corpus::parse("1 the the DET _ _ 2 det _ _\n2 boat boat NOUN _ _ 0 root _ _\n").expect("a corpus");
    let text = "B-NP\tw=the\tp=D\nI-NP\tw=old\tp=A\n\nB-VP\tw=sinks\n\n";
    let items = crfsuite::parse(text.as_bytes(), "items".as_ref(), 1).expect("items");
    let bank = "# a\n1\tthe\tthe\tDET\t_\t_\t2\tdet\t_\t_\n2\tboat\tboat\tNOUN\t_\t_\t0\troot\t_\t_\n\n";
    let bank = conllu::parse(bank.as_bytes(), "bank".as_ref(), 1).expect("a treebank");
    let grammar = Grammar::parse("embedded", defaults::GRAMMAR).expect("a grammar");
    let sentences = grammar.generate(2, Seed::new(1));
    let arc = |word| conllu::Arc { head: word as u32 % 2, relation: "dep" };
    let all: [Written<'_>; 6] = [
        ("corpus", Box::new(|out| corpus.write(out, Separator::Tab))),
        ("crfsuite", Box::new(|out| crfsuite::write(&items, out))),
        ("vw", Box::new(|out| vw::write(&items, out))),
        ("treebank", Box::new(|out| bank.write(out, arc))),
        ("columns", Box::new(|out| conllu::write_columns(&ten, out).expect("ten columns"))),
        ("sentences", Box::new(|out| grammar.write(&sentences, out))),
    ];
    all.iter().for_each(test);
}

#[test]
fn what_is_written_in_pieces_is_whole() {
    with_all(|(name, write)| {
        let mut plain = Faulty::new(&[], usize::MAX, usize::MAX);
        write(&mut plain).expect("memory has room");
        assert!(!plain.moved.is_empty(), "{name}");
        for piece in [1, 2, 7] {
            let mut pieces = Faulty::new(&[], piece, usize::MAX);
            write(&mut pieces).expect("memory has room");
            assert!(pieces.moved == plain.moved, "{name} by {piece}");
        }
        // Wherever it breaks, the error comes out, and what was written before is a beginning of the whole.
        for whole in 0..plain.moved.len() {
            let mut broken = Faulty::new(&[], 5, whole);
            let error = write(&mut broken).expect_err(name);
            assert_eq!(error.kind(), ErrorKind::StorageFull, "{name} at {whole}");
            assert!(broken.moved == plain.moved[..whole], "{name} at {whole}");
        }
    });
}

proptest! {
    #[test]
    fn what_is_read_in_pieces_is_whole(text in "[ab \n]{0,200}", piece in 1..9usize, room in 1..9usize, size in 1..4usize) {
        let blocks = |reader| -> Vec<(Vec<u8>, usize)> {
            Blocks::new(reader, size).map(|block| block.map(|block| (block.bytes, block.first_line)).expect("it can be read")).collect()
        };
        let plain = blocks(BufReader::with_capacity(1 << 10, Faulty::new(text.as_bytes(), usize::MAX, usize::MAX)));
        let pieces = blocks(BufReader::with_capacity(room, Faulty::new(text.as_bytes(), piece, usize::MAX)));
        prop_assert_eq!(&plain, &pieces);
        prop_assert_eq!(plain.iter().flat_map(|(bytes, _)| bytes.iter().copied()).collect::<Vec<u8>>(), text.as_bytes());
    }

    /// No block is made of what came before the fault, as if that were all.
    #[test]
    fn what_breaks_is_not_taken_for_the_end(text in "[ab \n]{1,200}", at in any::<prop::sample::Index>(), size in 1..4usize) {
        let whole = at.index(text.len());
        let mut blocks = Blocks::new(BufReader::with_capacity(8, Faulty::new(text.as_bytes(), 3, whole)), size);
        let faults = blocks.by_ref().filter(Result::is_err).count();
        prop_assert_eq!(faults, 1);
        prop_assert!(blocks.next().is_none());
    }
}
