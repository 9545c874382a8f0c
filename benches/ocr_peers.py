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

    vw = pyvw.Workspace("--search 26 --search_task sequence --search_rollin learn --search_rollout none --quiet -b 20")

    def lines(word, labelled):
        _, letters, pixels = word
        return [f"{number(a) if labelled else ''} | {' '.join(on)}" for a, on in zip(letters, pixels)]

    for _ in range(passes):
        for word in train:
            vw.learn(lines(word, True))
    answers = []
    for word in test:
        answers.append([chr(ord("a") + int(a) - 1) for a in vw.predict(lines(word, False))])
    vw.finish()
    return answers


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
