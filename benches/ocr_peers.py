"""CRFsuite and Vowpal Wabbit on the handwritten words, ten folds: the pixels and the letter before, untuned.

python3 -m venv v && v/bin/pip install python-crfsuite vowpalwabbit
v/bin/python benches/ocr_peers.py $ROLLIN_DATA/ocr/letters.tsv [SYSTEM]
"""

import os
import random
import sys
import tempfile

import pycrfsuite
from vowpalwabbit import pyvw


def read(path):
    """Words as (fold, letters, active pixels of each letter)."""
    words = []
    with open(path) as lines:
        next(lines)
        for line in lines:
            _, position, fold, letter, bits = line.rstrip("\n").split("\t")
            if position == "1":
                words.append((int(fold), [], []))
            words[-1][1].append(letter)
            words[-1][2].append([f"p{i}" for i, bit in enumerate(bits) if bit == "1"])
    return words


def crfsuite(train, test):
    trainer = pycrfsuite.Trainer(algorithm="ap", verbose=False)
    for _, letters, pixels in train:
        trainer.append(pixels, letters)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "model")
        trainer.train(path)
        tagger = pycrfsuite.Tagger()
        tagger.open(path)
        return [tagger.tag(pixels) for _, _, pixels in test]


def vowpal_wabbit(train, test, passes=10):
    def number(letter):
        return ord(letter) - ord("a") + 1

    def write(path, words):
        with open(path, "w") as out:
            for _, letters, pixels in words:
                out.writelines(f"{number(a)} | {' '.join(on)}\n" for a, on in zip(letters, pixels))
                out.write("\n")

    with tempfile.TemporaryDirectory() as folder:
        learn, ask, model, answers = (os.path.join(folder, name) for name in ("learn", "ask", "model", "answers"))
        write(learn, train)
        write(ask, test)
        search = "--search 26 --search_task sequence --search_rollin learn --search_rollout none -b 20"
        cache = f"-k -c --cache_file {folder}/cache --passes {passes} --holdout_off"
        pyvw.Workspace(f"-d {learn} {search} {cache} -f {model} --quiet").finish()
        pyvw.Workspace(f"-t -d {ask} -i {model} -p {answers} --quiet").finish()
        with open(answers) as lines:
            words = [line.split() for line in lines if line.strip()]
    return [[chr(ord("a") + int(a) - 1) for a in word] for word in words]


def measure(words, system, small):
    letters, right, whole = [], [], []
    for fold in range(10):
        train = [word for word in words if (word[0] == fold) == small]
        test = [word for word in words if (word[0] == fold) != small]
        # The file is sorted by word, which misleads whatever learns in its order.
        random.Random(fold).shuffle(train)
        answers = system(train, test)
        hits = [sum(a == b for a, b in zip(word[1], answer)) for word, answer in zip(test, answers)]
        right.append(100 * sum(hits) / sum(len(word[1]) for word in test))
        whole.append(100 * sum(n == len(word[1]) for n, word in zip(hits, test)) / len(test))
    return sum(right) / 10, sum(whole) / 10


SYSTEMS = {"CRFsuite, averaged perceptron": crfsuite, "Vowpal Wabbit search": vowpal_wabbit}

if __name__ == "__main__":
    words = read(sys.argv[1])
    for name in sys.argv[2:] or SYSTEMS:
        for small in (False, True):
            print(f"| {name} | {'small' if small else 'large'} | %.2f | %.1f |" % measure(words, SYSTEMS[name], small), flush=True)
