#!/usr/bin/env python3
"""Runs rollin, Vowpal Wabbit and CRFsuite on CoNLL-2000 in one sitting and prints their ratios.

    cargo build --release
    python3 benches/peers.py --data DIR [--runs 5] [--only train,best,rollout,tag,threads,growth]

DIR holds the shared task's train.txt and test.txt. The peers come from PyPI (pip install vowpalwabbit python-crfsuite);
what is not installed is skipped, and the table says so. All systems get the same 26 observation features, those of
grammars/chunking.template. Of the labels before, ours get the last one, as the peers do (grammars/chunking-chain.template), or more of them where the row says so. The peers get them written out beforehand; rollin reads the text of the corpus itself.

Every command is run --runs times, all commands of a part in turn. CPU is user and system time of one thread: for
rollin of the whole process, for the peers without the start of Python and the import. A ratio is the median of the
ratios run by run. Peak memory is that of the whole process, Python included.
"""
import argparse
import concurrent.futures
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)


# ---- the corpus, and the peers' files ----

def sentences(path):
    sentence = []
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            cells = line.split()
            if cells:
                sentence.append(cells)
            elif sentence:
                yield sentence
                sentence = []
    if sentence:
        yield sentence


def shape(word):
    for pattern, letter in (("[A-Z]", "X"), ("[a-z]", "x"), (r"\d", "d")):
        word = re.sub(pattern, letter, word)
    return word[:8]


def features(sentence, at):
    """The observation features of one token, named after the lines of the template."""
    def cell(offset, column):
        place = at + offset
        if place < 0:
            return "<s>"
        if place >= len(sentence):
            return "</s>"
        text = sentence[place][column]
        return text.lower() if column == 0 else text

    word = sentence[at][0]
    window = range(-2, 3)
    named = [(f"w{d}", [cell(d, 0)]) for d in window] + [(f"p{d}", [cell(d, 1)]) for d in window]
    named += [(f"ww{d}", [cell(d, 0), cell(d + 1, 0)]) for d in (-1, 0)]
    named += [(f"pp{d}", [cell(d, 1), cell(d + 1, 1)]) for d in (-2, -1, 0, 1)]
    named += [(f"ppp{d}", [cell(d, 1), cell(d + 1, 1), cell(d + 2, 1)]) for d in (-2, -1, 0)]
    named += [(f"suf{k}", [word[-k:].lower()]) for k in (1, 2, 3)] + [(f"pre{k}", [word[:k].lower()]) for k in (1, 2, 3)]
    named += [("sh", [shape(word)])]
    return [name + "=" + "|".join(parts) for name, parts in named]


def write_peers_files(data, folder):
    """The corpora as the two peers read them; returns the labels in the order of Vowpal Wabbit's numbers, from 1."""
    parts = {name: list(sentences(os.path.join(data, name + ".txt"))) for name in ("train", "test")}
    labels = sorted({token[2] for part in parts.values() for sentence in part for token in sentence})
    number = {label: i + 1 for i, label in enumerate(labels)}
    mark = str.maketrans({":": "%c", "|": "%b", " ": "_"})
    for name, part in parts.items():
        with open(f"{folder}/{name}.vw", "w", encoding="utf-8") as vw, open(f"{folder}/{name}.crf", "w", encoding="utf-8") as crf:
            for sentence in part:
                for at, token in enumerate(sentence):
                    found = features(sentence, at)
                    vw.write(f"{number[token[2]]} | " + " ".join(f.translate(mark) for f in found) + "\n")
                    crf.write("\t".join([token[2]] + found) + "\n")
                vw.write("\n")
                crf.write("\n")
    return labels, [[token[2] for token in sentence] for sentence in parts["test"]]


# ---- chunk F1 of label sequences ----

def chunks(labels):
    found, start, kind = set(), None, None
    for at, label in enumerate(list(labels) + ["O"]):
        prefix, _, name = label.partition("-")
        if start is not None and (prefix != "I" or name != kind):
            found.add((start, at, kind))
            start = None
        if prefix != "O" and start is None:
            start, kind = at, name
    return found


def f1(gold, guess):
    both = right = guessed = 0
    for expected, got in zip(gold, guess, strict=True):
        expected, got = chunks(expected), chunks(got)
        both, right, guessed = both + len(expected & got), right + len(expected), guessed + len(got)
    return 200 * both / (right + guessed)


# ---- running ----

PEER = """
import json, os, resource, sys
def cpu():
    t = os.times()
    return t.user + t.system
%s
print(json.dumps(dict(cpu=cpu() - start, rss=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)))
"""
VW = PEER % """
from vowpalwabbit import pyvw
start = cpu()
pyvw.Workspace(arg_list=sys.argv[1:]).finish()
"""
CRF_TRAIN = PEER % """
import pycrfsuite
trainer = pycrfsuite.Trainer(algorithm=sys.argv[3], verbose=False)
words, labels = [], []
for line in open(sys.argv[1], encoding="utf-8"):
    cells = line.rstrip("\\n").split("\\t")
    if cells != [""]:
        labels.append(cells[0])
        words.append(cells[1:])
    elif words:
        trainer.append(words, labels)
        words, labels = [], []
trainer.set_params(json.loads(sys.argv[4]))
start = cpu()
trainer.train(sys.argv[2])
"""
CRF_TAG = PEER % """
import pycrfsuite
part, words = [], []
for line in open(sys.argv[1], encoding="utf-8"):
    cells = line.rstrip("\\n").split("\\t")
    if cells != [""]:
        words.append(cells[1:])
    elif words:
        part.append(words)
        words = []
tagger = pycrfsuite.Tagger()
start = cpu()
tagger.open(sys.argv[2])
out = [tagger.tag(words) for words in part]
used = cpu()
with open(sys.argv[3], "w") as file:
    file.writelines(" ".join(labels) + "\\n" for labels in out)
start += cpu() - used
"""


def run(command, stdin=None, stdout=None):
    """One run of a process: CPU seconds, those of the system among them, seconds by the clock, peak MiB."""
    with open(stdin or os.devnull, "rb") as source, open(stdout or os.devnull, "wb") as target:
        begin = time.perf_counter()
        process = subprocess.Popen(command, stdin=source, stdout=target, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"failed with {process.returncode}: {' '.join(command)}")
        wall = time.perf_counter() - begin
        return dict(cpu=used.ru_utime + used.ru_stime, system=used.ru_stime, wall=wall, rss=used.ru_maxrss / 1024)


def run_peer(script, *arguments):
    done = subprocess.run([sys.executable, "-c", script, *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
    return json.loads(done.stdout.decode().splitlines()[-1])


def in_turn(runs, jobs):
    """Runs all jobs in turn, `runs` times over."""
    results = {name: [] for name in jobs}
    for _ in range(runs):
        for name, job in jobs.items():
            results[name].append(job())
    return results


def median(results, what):
    return statistics.median(result[what] for result in results)


def ratio(results, over, what="cpu"):
    return statistics.median(a[what] / b[what] for a, b in zip(results, over))


class Sitting:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.data = options.data
        self.rollin = options.rollin
        self.template = os.path.join(ROOT, "grammars", "chunking.template")
        # In a process of its own: what is started from a large one is counted as large.
        with concurrent.futures.ProcessPoolExecutor(1) as pool:
            self.labels, self.gold = pool.submit(write_peers_files, options.data, folder).result()
        self.tokens = {name: sum(len(s) for s in sentences(f"{self.data}/{name}.txt")) for name in ("train", "test")}
        self.has = {name: self.installed(name) for name in ("vowpalwabbit", "pycrfsuite")}
        for name, there in self.has.items():
            if not there:
                print(f"skipped: all rows of {name}, which is not installed", file=sys.stderr)

    @staticmethod
    def installed(name):
        return subprocess.run([sys.executable, "-c", f"import {name}"], capture_output=True).returncode == 0

    def path(self, name):
        return os.path.join(self.folder, name)

    # -- commands --

    def train(self, model, *options, threads=1, data=None):
        template = [] if "--template" in options else ["--template", self.template]
        return [self.rollin, "train", "--data", data or f"{self.data}/train.txt", "--model", self.path(model),
                "--threads", str(threads), "-q", *template, *options]

    def score(self, model):
        command = [self.rollin, "evaluate", "--model", self.path(model), "--data", f"{self.data}/test.txt", "--json"]
        report = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)
        return report["chunks"]["f1"]

    def vw_train(self, model, *options):
        def job():
            for name in (model, model + ".cache"):
                if os.path.exists(self.path(name)):
                    os.remove(self.path(name))
            return run_peer(VW, "-d", self.path("train.vw"), "-k", "-c", "--cache_file", self.path(model + ".cache"),
                            "--search", str(len(self.labels)), "--search_task", "sequence", "-b", "22", "--holdout_off",
                            "-f", self.path(model), "--quiet", *options)
        return job

    def vw_tag(self, model):
        return lambda: run_peer(VW, "-d", self.path("test.vw"), "-t", "-i", self.path(model), "-p", self.path("vw.out"), "--quiet")

    def vw_score(self, model):
        self.vw_tag(model)()
        with open(self.path("vw.out")) as lines:
            return f1(self.gold, [[self.labels[int(n) - 1] for n in line.split()] for line in lines])

    def crf_train(self, algorithm, settings):
        return lambda: run_peer(CRF_TRAIN, self.path("train.crf"), self.path("crf." + algorithm), algorithm, json.dumps(settings))

    def crf_tag(self, algorithm):
        return lambda: run_peer(CRF_TAG, self.path("test.crf"), self.path("crf." + algorithm), self.path("crf.out"))

    def crf_score(self, algorithm):
        self.crf_tag(algorithm)()
        with open(self.path("crf.out")) as lines:
            return f1(self.gold, [line.split() for line in lines])

    def generated(self, tokens, name):
        """A generated corpus of about so many tokens; returns how many there are."""
        path = self.path(name)
        # The grammar's sentences have 19 tokens in the mean.
        command = [self.rollin, "generate", "--count", str(tokens // 19), "--seed", "7"]
        run([*command, "--grammar", os.path.join(ROOT, "grammars", "dialects.grammar")], stdout=path)
        with open(path, "rb") as lines:
            return sum(1 for line in lines if line.strip())


# ---- the parts of the table ----

class Table:
    def __init__(self, title, note=None):
        print(f"\n### {title}\n")
        if note:
            print(note + "\n")

    def head(self, *cells):
        print("| " + " | ".join(cells) + " |")
        print("|" + "---|" * len(cells))

    def row(self, *cells):
        print("| " + " | ".join(f"{c:.2f}" if isinstance(c, float) else str(c) for c in cells) + " |", flush=True)


CHAIN = ["--template", os.path.join(ROOT, "grammars", "chunking-chain.template")]
FAST = ["--algorithm", "dagger-online", "--rounds", "3", "--learner", "hinge"]
AHEAD = ["--template", os.path.join(ROOT, "grammars", "chunking-ahead.template"), "--rounds", "5", "--rate", "0.06", "--tolerance", "0.05"]
WIDE = ["--template", os.path.join(ROOT, "grammars", "chunking-wide.template"), "--algorithm", "smile", "--alpha", "0.2", "--rounds", "7",
        "--rate", "0.06", "--tolerance", "0.05"]


def against(sitting, title, peers, ours, scores, passes=None):
    """A table of ours against peers: CPU, its ratio to each of the peers, memory and F1."""
    table = Table(title)
    results = in_turn(sitting.options.runs, {**peers, **ours})
    names = list(peers)
    table.head("system", "CPU s", *(f"times {name}" for name in names), "peak MiB", "F1 %",
               *(["tokens/s and pass"] if passes else []))
    for name, measured in results.items():
        speeds = [ratio(results[peer], measured) for peer in names]
        more = [f"{passes * sitting.tokens['train'] / median(measured, 'cpu'):,.0f}"] if passes else []
        table.row(name, median(measured, "cpu"), *speeds, f"{median(measured, 'rss'):.0f}", scores[name](), *more)


def models_of(sitting, ours, part):
    """For trainings by their names and options: what runs each, and what scores the model that it makes."""
    jobs, scores = {}, {}
    for i, (name, options) in enumerate(ours.items()):
        model = f"{part}{i}.model"
        jobs[f"rollin, {name}"] = lambda model=model, options=options: run(sitting.train(model, *options))
        scores[f"rollin, {name}"] = lambda model=model: 100 * sitting.score(model)
    return jobs, scores


def part_train(sitting):
    peers = {}
    if sitting.has["vowpalwabbit"]:
        peers["Vowpal Wabbit, 3 passes"] = sitting.vw_train("dagger.vwm", "--passes", "3", "--search_rollout", "none", "--search_rollin", "learn")
    ours = {"hinge": [*FAST, *CHAIN],
            "hinge, cutoff 2": [*FAST, *CHAIN, "--cutoff", "2"],
            "perceptron": ["--rounds", "3", "--learner", "perceptron", *CHAIN],
            "tolerance 0.3": ["--rounds", "3", "--tolerance", "0.3", *CHAIN],
            "by default": ["--rounds", "3", *CHAIN],
            "hinge, more of the labels before": FAST,
            "hinge, more of the labels before, cutoff 2": [*FAST, "--cutoff", "2"],
            "by default, more of the labels before": ["--rounds", "3"],
            "by default, more of the labels before, cutoff 2": ["--rounds", "3", "--cutoff", "2"]}
    jobs, scores = models_of(sitting, ours, "train")
    scores["Vowpal Wabbit, 3 passes"] = lambda: sitting.vw_score("dagger.vwm")
    against(sitting, "Training, DAgger-like", peers, jobs, scores, 3)


def part_best(sitting):
    peers = {}
    if sitting.has["pycrfsuite"]:
        peers["CRFsuite L-BFGS"] = sitting.crf_train("lbfgs", {"c2": 1.0, "max_iterations": 100})
        peers["CRFsuite averaged perceptron"] = sitting.crf_train("ap", {"max_iterations": 20})
    settings = {"two readings": AHEAD, "more features and SMILe": WIDE}
    ours = {f"{name}, seed {seed}": [*options, "--seed", str(seed)] for name, options in settings.items() for seed in (1, 2, 3)}
    jobs, scores = models_of(sitting, ours, "best")
    scores |= {"CRFsuite L-BFGS": lambda: sitting.crf_score("lbfgs"), "CRFsuite averaged perceptron": lambda: sitting.crf_score("ap")}
    against(sitting, "The best F1, on the same observation features but for the last three", peers, jobs, scores)


def part_rollout(sitting):
    peers = {}
    if sitting.has["vowpalwabbit"]:
        peers["Vowpal Wabbit, mixed roll-outs, 3 passes"] = sitting.vw_train(
            "lols.vwm", "--passes", "3", "--search_rollout", "mix_per_roll", "--search_rollin", "learn")
    searn = ["--rounds", "3", "--warm", "--learner", "hinge"]
    lols = ["--algorithm", "lols-online", "--rounds", "3", "--learner", "hinge"]
    ours = {"LOLS online": [*lols, *CHAIN],
            "SEARN online": ["--algorithm", "searn-online", *searn, *CHAIN],
            "SEARN online, beta 0.1": ["--algorithm", "searn-online", *searn, *CHAIN, "--beta", "0.1"],
            "SEARN": ["--algorithm", "searn", "--passes", "1", *searn, *CHAIN],
            "LOLS online, more of the labels before": lols,
            "SEARN online, more of the labels before": ["--algorithm", "searn-online", *searn]}
    jobs, scores = models_of(sitting, ours, "rollout")
    scores["Vowpal Wabbit, mixed roll-outs, 3 passes"] = lambda: sitting.vw_score("lols.vwm")
    against(sitting, "Training with roll-outs of every action", peers, jobs, scores, 3)


def part_tag(sitting):
    """Whole runs on the test set, and what a further copy of the corpus costs: tagging without the start."""
    run(sitting.train("fast.model", *FAST, *CHAIN))
    long = sitting.path("long.txt")
    with open(long, "wb") as out:
        for name in ("train", "test") * 4:
            with open(f"{sitting.data}/{name}.txt", "rb") as part:
                out.write(part.read().rstrip(b"\n") + b"\n\n")
    tokens = 4 * sum(sitting.tokens.values())
    tag = [sitting.rollin, "tag", "--model", sitting.path("fast.model"), "--threads", "1"]
    jobs = {"rollin, test set": lambda: run(tag, f"{sitting.data}/test.txt"), "rollin, long": lambda: run(tag, long)}
    if sitting.has["vowpalwabbit"]:
        sitting.vw_train("dagger.vwm", "--passes", "3", "--search_rollout", "none", "--search_rollin", "learn")()
        jobs["Vowpal Wabbit, test set"] = sitting.vw_tag("dagger.vwm")
    if sitting.has["pycrfsuite"]:
        sitting.crf_train("ap", {"max_iterations": 20})()
        jobs["CRFsuite, test set"] = sitting.crf_tag("ap")
    results = in_turn(sitting.options.runs, jobs)
    table = Table("Tagging from text", "Whole processes, loading the model included; CRFsuite's attributes are in memory beforehand.")
    table.head("system", "CPU s", "tokens/s", "times as fast, token by token", "peak MiB")
    for name, measured in results.items():
        count = tokens if name.endswith("long") else sitting.tokens["test"]
        per_token = [{"cpu": result["cpu"] / count} for result in measured]
        best = [{"cpu": result["cpu"] / tokens} for result in results["rollin, long"]]
        table.row(name, median(measured, "cpu"), f"{count / median(measured, 'cpu'):,.0f}", ratio(per_token, best), f"{median(measured, 'rss'):.0f}")


def part_threads(sitting):
    long = sitting.path("long.txt")
    if not os.path.exists(long):
        part_tag(sitting)
    jobs, models = {}, {}
    work = {"roll-ins (smile, 3 rounds)": ["--algorithm", "smile", "--rounds", "3", "--passes", "1"],
            "roll-outs (searn, 3 rounds)": ["--algorithm", "searn", "--rounds", "3", "--passes", "1"]}
    for name, options in work.items():
        for threads in (1, 2):
            models[name, threads] = f"threads{threads}.{options[1]}"
            command = sitting.train(models[name, threads], *options, threads=threads) + ["--json"]
            jobs[name, threads] = lambda command=command: run(command)
    for threads in (1, 2):
        command = [sitting.rollin, "tag", "--model", sitting.path("fast.model"), "--threads", str(threads)]
        jobs["tagging", threads] = lambda command=command, threads=threads: run(command, long, sitting.path(f"tags{threads}"))
    results = in_turn(sitting.options.runs, jobs)
    table = Table("Two threads against one", "Whole runs by the clock, reading and what is sequential in learning included.")
    table.head("work", "one, s", "two, s", "times as fast", "same bytes")
    for name in [*work, "tagging"]:
        files = [models.get((name, threads), f"tags{threads}") for threads in (1, 2)]
        same = open(sitting.path(files[0]), "rb").read() == open(sitting.path(files[1]), "rb").read()
        one, two = results[name, 1], results[name, 2]
        table.row(name, median(one, "wall"), median(two, "wall"), ratio(one, two, "wall"), "yes" if same else "NO")


def part_growth(sitting):
    table = Table("Growth with generated text")
    table.head("tokens", "training, CPU us/token", "of it the system's", "training, bytes/token", "tagging, CPU us/token", "tagging, peak MiB")
    template = os.path.join(ROOT, "grammars", "words.template")
    for millions in (1, 10):
        tokens = sitting.generated(millions * 1_000_000, "grown.txt")
        command = sitting.train("grown.model", "--rounds", "1", "--template", template, data=sitting.path("grown.txt"))
        tag = [sitting.rollin, "tag", "--model", sitting.path("grown.model"), "--threads", "1"]
        results = in_turn(max(1, sitting.options.runs // 2), {"train": lambda: run(command), "tag": lambda: run(tag, sitting.path("grown.txt"))})

        def per_token(job, what):
            return 1e6 * median(results[job], what) / tokens

        table.row(f"{tokens:,}", per_token("train", "cpu"), per_token("train", "system"), f"{2**20 * median(results['train'], 'rss') / tokens:.0f}",
                  per_token("tag", "cpu"), f"{median(results['tag'], 'rss'):.0f}")
        os.remove(sitting.path("grown.txt"))


PARTS = {"train": part_train, "best": part_best, "rollout": part_rollout, "tag": part_tag, "threads": part_threads, "growth": part_growth}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, help="the folder with train.txt and test.txt of CoNLL-2000")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--only", default=",".join(PARTS), help="parts, separated by commas")
    parser.add_argument("--rollin", default=os.path.join(ROOT, "target", "release", "rollin"))
    options = parser.parse_args()
    unknown = set(options.only.split(",")) - set(PARTS)
    if unknown:
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    with tempfile.TemporaryDirectory() as folder:
        sitting = Sitting(options, folder)
        for part in options.only.split(","):
            PARTS[part](sitting)


if __name__ == "__main__":
    main()
