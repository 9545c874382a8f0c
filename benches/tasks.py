"""Every trainer on every task, through `rollin compare`: what it loses against what it asks.

cargo build --release
ROLLIN_DATA=... python3 benches/tasks.py target/release/rollin [FOLDER]

Graphs, maps and a tabular problem are drawn here, the same in every run, and kept in FOLDER if it is given; the other corpora are in $ROLLIN_DATA.
"""

import json
import os
import random
import subprocess
import sys
import tempfile

TRAINERS = """supervised forward smile searn dagger lols
searn-shortcut cpi dagger-online aggrevate lols-online stacked early-update""".split()
LEARNER = "csoaa"


def graphs(draw):
    """Random trees with a few more edges; labels run along them, and every other node shows its own."""
    text = []
    for _ in range(120):
        size = draw.randint(10, 25)
        labels = []
        edges = []
        for node in range(size):
            parent = draw.randrange(node) if node else None
            if node:
                edges.append((parent, node))
            own = parent is None or draw.random() < 0.2
            labels.append(draw.randrange(4) if own else labels[parent])
        for _ in range(size // 5):
            a, b = sorted(draw.sample(range(size), 2))
            if (a, b) not in edges:
                edges.append((a, b))
        for node, label in enumerate(labels):
            shown = label if draw.random() < 0.5 else draw.randrange(4)
            text.append(f"n{node} L{label} shows{shown}\n")
        text += [f"n{a} -- n{b}\n" for a, b in edges] + ["\n"]
    return "".join(text)


def reached(cells, start):
    seen, ahead = {start}, [start]
    while ahead:
        x, y = ahead.pop()
        for to in (x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y):
            if to not in seen and cells.get(to, "#") != "#":
                seen.add(to)
                ahead.append(to)
    return seen


def maps(draw, side=10):
    """Patches of five terrains and some walls, one trip on each map."""
    text = []
    while len(text) < 100:
        centres = [(draw.randrange(side), draw.randrange(side), draw.choice("abcde")) for _ in range(18)]
        cells = {}
        for x in range(side):
            for y in range(side):
                near = min(centres, key=lambda c: abs(c[0] - x) + abs(c[1] - y))
                cells[x, y] = "#" if draw.random() < 0.1 else near[2]
        start = draw.choice([cell for cell in cells if cells[cell] != "#"])
        far = [c for c in sorted(reached(cells, start)) if abs(c[0] - start[0]) + abs(c[1] - start[1]) >= side]
        if not far:
            continue
        goal = draw.choice(far)
        rows = ["".join(cells[x, y] for x in range(side)) for y in range(side)]
        trip = f"{start[0] + 1},{start[1] + 1} -> {goal[0] + 1},{goal[1] + 1}"
        text.append("\n".join([*rows, trip, "", ""]))
    return "".join(text)


def instance(draw, states=12, actions=3, horizon=20):
    """A random problem with its best stationary policy for expert; pairs of states look alike to the learner."""
    def law():
        weights = [draw.random() ** 4 for _ in range(states)]
        return [w / sum(weights) for w in weights]

    moves = [[law() for _ in range(actions)] for _ in range(states)]
    cost = [[round(draw.random() ** 2, 3) for _ in range(actions)] for _ in range(states)]
    value = [0.0] * states
    for _ in range(horizon):
        q = [[cost[s][a] + sum(p * v for p, v in zip(moves[s][a], value)) for a in range(actions)] for s in range(states)]
        value = [min(row) for row in q]
    expert = [row.index(min(row)) for row in q]
    phi = [s // 2 if s >= 8 else s for s in range(states)]
    start = [1.0 / states] * states
    return json.dumps(dict(S=states, A=actions, T=horizon, mu=start, P=moves, C=cost, expert=expert, phi=phi), indent=1)


def corpora(folder, data):
    made = {"graph": graphs(random.Random(1)), "navigation": maps(random.Random(2)), "tabular": instance(random.Random(3))}
    for name, text in made.items():
        with open(os.path.join(folder, name), "w") as out:
            out.write(text)
    real = {
        "tagging": ("conll2000/train.txt", "--first 1000"),
        "segmenting": ("conll2000/train.txt", "--first 1000"),
        "ocr": ("ocr/letters.tsv", "--first 2000"),
        "parsing": ("ud-english-ewt/en_ewt-ud-train.conllu", "--first 600"),
    }
    if data:
        for task, (path, options) in real.items():
            yield task, os.path.join(data, path), options
    else:
        print("ROLLIN_DATA is not set: no tagging, segmenting, ocr and parsing", file=sys.stderr)
    for task, options in ("graph", ""), ("navigation", "--costs 1,2,4,8,16"), ("tabular", "--first 150"):
        yield task, os.path.join(folder, task), options


def main():
    rollin = sys.argv[1]
    folder = sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp()
    for task, path, options in corpora(folder, os.environ.get("ROLLIN_DATA")):
        print(f"\n## {task}\n\n`rollin compare --task {task} --data {os.path.basename(path)} {options} --learner {LEARNER} --algorithms ...`\n")
        rows = []
        for trainer in TRAINERS:
            line = [rollin, "compare", "--task", task, "--data", path, *options.split(), "--algorithms", trainer]
            line += ["--json", "--quiet"] + ([] if trainer == "early-update" else ["--learner", LEARNER])
            done = subprocess.run(line, capture_output=True, text=True)
            if done.returncode:
                rows.append((trainer, None, done.stderr.strip().removeprefix("error: ")))
            else:
                rows.append((trainer, json.loads(done.stdout)["rows"][0], None))
        table(rows)


def table(rows):
    def measures(reading):
        return [k for k, v in reading.items() if k not in ("reading", "loss") and v is not None]

    names = next((measures(row["readings"][0]) for _, row, _ in rows if row), [])
    print("| trainer | read as | loss |", " | ".join(f"{name} %" for name in names), "| labels | expert acts | roll-outs | roll-out acts |")
    print("|---|---|--:|" + "--:|" * (len(names) + 4))
    for trainer, row, refusal in rows:
        if refusal:
            print(f"| {trainer} | refused: {refusal} |" + " |" * (len(names) + 5))
            continue
        for reading in row["readings"]:
            if reading["reading"] == "vote":
                continue
            cells = [trainer, reading["reading"] or "-", f"{reading['loss']:.3f}"]
            cells += [f"{reading[name]:.2f}" for name in names]
            cells += [f"{row['ledger'][key]:,}" for key in ("labels", "expert_acts", "rollouts", "rollout_acts")]
            print("|", " | ".join(cells), "|")


main()
