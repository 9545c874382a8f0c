#!/usr/bin/env python3
"""Runs rollin and CRFsuite on Spanish named entities and English parts of speech in one sitting, and prints how right they are.

    cargo build --release
    python3 benches/taggers.py --data DIR [--part dev|test] [--only ner,pos] [--seeds 1,2,3] [--skip-peer]

DIR holds conll2002 (esp.train, esp.testa, esp.testb) and ud-english-ewt. CRFsuite comes from PyPI (pip install python-crfsuite); without it
only rollin runs. Both get the observation features of grammars/words.template: CRFsuite as `rollin convert` writes them out. The second reading of rollin adds
labels of the first (grammars/words-ahead.template), no features of the words. CPU is that of training, user and system, for CRFsuite without
the start of Python.
"""
import argparse
import itertools
import json
import os
import resource
import subprocess
import sys
import tempfile

from peers import f1

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

CRFSUITE = """
import json, os, sys, pycrfsuite
algorithm, train, test, model = sys.argv[1:]
def read(path):
    labels, attributes = [], []
    for line in open(path, encoding="utf-8"):
        line = line.rstrip("\\n")
        if line:
            cells = line.split("\\t")
            labels.append(cells[0])
            # Every attribute is there or is not: a value behind a colon is part of its name.
            attributes.append([cell.replace("\\\\:", ":") for cell in cells[1:]])
        elif labels:
            yield labels, attributes
            labels, attributes = [], []
    if labels:
        yield labels, attributes
trainer = pycrfsuite.Trainer(algorithm=algorithm, verbose=False)
for labels, attributes in read(train):
    trainer.append(attributes, labels)
trainer.set_params({"lbfgs": {"c2": 1.0, "max_iterations": 200}, "ap": {"max_iterations": 20}}[algorithm])
before = os.times()
trainer.train(model)
after = os.times()
tagger = pycrfsuite.Tagger()
tagger.open(model)
guess = [tagger.tag(attributes) for _, attributes in read(test)]
print(json.dumps({"cpu": after.user + after.system - before.user - before.system, "labels": guess}))
"""


class Task:
    """A corpus as CoNLL columns in `folder`, the label last."""

    def __init__(self, name, measure, options):
        self.name, self.measure, self.options = name, measure, options

    def prepare(self, data, part, folder):
        paths = {}
        for piece, source in self.sources(data, part).items():
            paths[piece] = os.path.join(folder, f"{self.name}.{piece}")
            with open(source, encoding="utf-8") as lines, open(paths[piece], "w", encoding="utf-8") as out:
                for line in lines:
                    kept = self.line(line.rstrip("\n"))
                    if kept is not None:
                        out.write(kept + "\n")
        return paths


class Entities(Task):
    def sources(self, data, part):
        return {"train": f"{data}/conll2002/esp.train", "test": f"{data}/conll2002/esp.{'testa' if part == 'dev' else 'testb'}"}

    def line(self, line):
        cells = line.split()
        return f"{cells[0]} {cells[-1]}" if cells else ""


class Parts(Task):
    def sources(self, data, part):
        return {piece: f"{data}/ud-english-ewt/en_ewt-ud-{name}.conllu" for piece, name in (("train", "train"), ("test", part))}

    def line(self, line):
        if not line:
            return ""
        cells = line.split("\t")
        # Comments, words written as one and words left out are no tokens.
        return f"{cells[1].replace(' ', '_')} {cells[3]}" if cells[0].isdigit() else None


TASKS = {
    "ner": Entities("ner", "F1 %", ["--repair"]),
    "pos": Parts("pos", "accuracy %", []),
}


SETTINGS = ["--rate", "0.06", "--tolerance", "0.05"]
TRAINERS = {
    "DAgger online": ["--algorithm", "dagger-online", "--rounds", "8"],
    "SMILe": ["--algorithm", "smile", "--alpha", "0.2", "--rounds", "7"],
}
TEMPLATES = {"one reading": "words", "two readings": "words-ahead"}


def run(command, stdin=None, stdout=None):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdin=stdin, stdout=stdout or subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measured(rollin, task, model, test):
    """What `rollin evaluate` says of a model."""
    score = json.loads(run([rollin, "evaluate", "--json", "--model", model, "--data", test, "-q"])[0])
    return 100 * (score["chunks"]["f1"] if task.measure == "F1 %" else score["accuracy"])


def judged(task, test, guess):
    """The same measure of labels that CRFsuite gave: by conlleval's rules, or the share that is right."""
    gold, sentence = [], []
    for line in open(test, encoding="utf-8"):
        cells = line.split()
        if cells:
            sentence.append(cells[-1])
        elif sentence:
            gold.append(sentence)
            sentence = []
    if sentence:
        gold.append(sentence)
    if task.measure == "accuracy %":
        pairs = [pair for g, p in zip(gold, guess, strict=True) for pair in zip(g, p, strict=True)]
        return 100 * sum(a == b for a, b in pairs) / len(pairs)
    return f1(gold, guess)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True)
    parser.add_argument("--part", choices=["dev", "test"], default="test")
    parser.add_argument("--only", default=",".join(TASKS))
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--skip-peer", action="store_true")
    parser.add_argument("--rollin", default=os.path.join(ROOT, "target", "release", "rollin"))
    options = parser.parse_args()
    template = lambda name: os.path.join(ROOT, "grammars", name + ".template")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.only.split(","):
            task = TASKS[name]
            paths = task.prepare(options.data, options.part, folder)
            print(f"\n### {name}, {options.part}\n\n| system | CPU s | {task.measure} |\n|---|---|---|")
            try:
                import pycrfsuite  # noqa: F401
            except ImportError:
                options.skip_peer = True
                print("| CRFsuite is not installed: skipped | | |")
            if not options.skip_peer:
                crf = {}
                for piece, path in paths.items():
                    crf[piece] = path + ".crf"
                    with open(crf[piece], "w", encoding="utf-8") as out:
                        run([options.rollin, "convert", "--from", "conll", "--to", "crfsuite", "--template", template("words"), "--data", path], stdout=out)
                for algorithm, title in (("lbfgs", "CRFsuite L-BFGS"), ("ap", "CRFsuite averaged perceptron")):
                    out, _ = run([sys.executable, "-c", CRFSUITE, algorithm, crf["train"], crf["test"], os.path.join(folder, "crf")])
                    result = json.loads(out)
                    print(f"| {title} | {result['cpu']:.1f} | {judged(task, paths['test'], result['labels']):.2f} |", flush=True)
            for (trainer, settings), (readings, which) in itertools.product(TRAINERS.items(), TEMPLATES.items()):
                for seed in options.seeds.split(","):
                    title = f"rollin, {trainer}, {readings}, seed {seed}"
                    model = os.path.join(folder, "model")
                    _, cpu = run([options.rollin, "train", "--data", paths["train"], "--template", template(which), "--model", model, "--threads", "1",
                                  "-q", "--seed", seed, *task.options, *SETTINGS, *settings])
                    print(f"| {title} | {cpu:.1f} | {measured(options.rollin, task, model, paths['test']):.2f} |", flush=True)


if __name__ == "__main__":
    main()
