#!/usr/bin/env python3
"""Measures what the named constants of the floors `fit` and `search` do.

Each is halved and doubled, short jobs are run, and their reports are compared with those of the unchanged program.

    python3 benches/tuning.py WORK [--stage all] [--jobs 3] [--factors 2 0.5] [--only LISTS] [--minutes 60] [--limit 20]

Needs Python 3.9 or later, cargo and a Unix; no packages. Run it alone on the machine, or bind it to one core
(`taskset -c 1`): jobs run one after the other, each in one thread; what is compared is the time of the processor.

Stages, each of which takes up what the one before left in the folder WORK:

`build`  copies the workspace to WORK/copy, where every use of a constant `NAME: f64 | usize | Duration`, or of tuples
         and arrays of these, in the body of a function becomes `crate::tune::varied(ID, NAME)`, and builds it in
         WORK/target (or CARGO_TARGET_DIR). Uses that a constant expression needs (other constants, array lengths,
         patterns) stay as they are; what does not compile is put back. The variable TORSE_TUNE="ID:FACTOR"
         then varies one constant of a run, all numbers of a tuple or an array at once; TORSE_TUNE_TRACE=FILE records
         what is read. Writes constants.json.
`trace`  runs every job once with the trace and twice without. Writes baseline.json; jobs in it are not run again.
`vary`   runs, for each constant that some job reads and each factor, the cheapest job that reads it, then the one that
         reads it most often, then the next cheapest, preferably of another command, up to --jobs of them. First every
         constant with its first job, then with its second, so that --minutes may end it at any time; started again,
         it begins with what has not moved anything yet.
         Appends to runs.jsonl. With --only, just the constants of a list that `table` wrote: `--only nothing --factors
         1000 0.001` tells which of those that half and double leave alone are guards, and which do nothing at all. With
         `--only rowless`, what docs/tuning.md has no row for; with both names, what is in both.
`table`  writes tuning.md (what changes) and lists: nothing.txt (read, but the report stays the same to the last digit),
         idle.txt (those of them that do nothing far off either),
         digits.txt (only digits change), unread.txt (no job reads it), better.txt (better in some jobs, worse in none),
         worse.txt (all changes, the worst first).
`page`   gives what has been varied, but has no row in docs/tuning.md, one there, and jobs too. Not among `all`.

A whole number stays at least 1 and changes at least by 1; 0 stays 0, and 1 cannot be halved. Whether a constant does
nothing is said of these jobs only: a guard against what they do not meet is as quiet as one that is superfluous.
"""

import argparse
import hashlib
import itertools
import json
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path
from random import Random

FLOORS = ("fit", "search")
LIBRARY = "crates/torse/src"

# ---------------------------------------------------------------------------------------------------------------- jobs

# Name, then arguments; `{data}` holds the models of the project, `{made}` what `make_inputs` writes, `{base}` the
# results of the baseline by name of job. Short ones: the whole list runs a thousand times.
JOBS = {
    "loft-duct": "loft {data}/duct_square.dxf {data}/duct_round.dxf --tolerance 0.01mm",
    "loft-chine": "loft {data}/chine_low.csv {data}/chine_high.csv --unit mm --tolerance 0.05mm",
    "loft-extend": "loft {data}/chine_low.csv {data}/chine_high.csv --unit mm --tolerance 0.5mm --ends extend",
    "fit-rulings": "fit {data}/hood_strip.csv --tolerance 1mm",
    "fit-robust": "fit {data}/hood_strip.csv --tolerance 0.6mm --robust --min-clearance 20mm",
    "fit-planes": "fit {made}/planes.csv --region 0,0,0,500 --tolerance 0.2mm --min-clearance 10mm",
    "fit-face": "fit {data}/cone_holes.step --tolerance 0.5mm",
    "fit-cylinder": "fit {data}/cylinder_holes.step --tolerance 0.5mm",
    "fit-scan": "fit {made}/scan.csv --unit mm --tolerance 1mm",
    "fit-mesh": "fit {made}/mesh.obj --unit mm --tolerance 1mm",
    "cones": "cones {data}/cone_holes.step --tolerance 0.5mm",
    "cones-cylinder": "cones {data}/cylinder_holes.step --tolerance 0.5mm",
    "hull": "hull {made}/loop.csv --unit mm --tolerance 0.5mm",
    "hull-duct": "hull {data}/duct_square.dxf {data}/duct_round.dxf --tolerance 0.1mm",
    "shape": "shape {data}/pulled_hull.json --tolerance 0.5mm",
    "net": "net {data}/keel_net.json --end-width 200mm --tolerance 0.01mm",
    "planarise": "planarise {data}/hood_strip.csv --levels 1 --tolerance 0.01mm",
    "unroll": "unroll {data}/bracket.step --k 0.44 --tolerance 0.01mm",
    "pipe": "approximate {data}/cylinder_holes.step --tolerance 0.5mm",
    "hopper": "approximate {data}/cone_holes.step --tolerance 0.5mm",
    "bracket": "approximate {data}/bracket.step --tolerance 0.1mm",
    "torus": "approximate {data}/torus_piece.step --tolerance 10mm",
    "torus-rings": "approximate {data}/torus_piece.step --tolerance 10mm --layout rings --seams independent",
    "torus-sheet": "approximate {data}/torus_piece.step --tolerance 10mm --sheet 600x600 --seams independent",
    "torus-width": "approximate {data}/torus_piece.step --tolerance 10mm --max-width 250mm --seams independent",
    "torus-bend": "approximate {data}/torus_piece.step --tolerance 10mm --min-bend-radius 100mm --seams independent",
    "torus-along": "approximate {data}/torus_piece.step --tolerance 15mm --curves u=0.5 --seams independent",
    "torus-cones": "approximate {data}/torus_piece.step --tolerance 20mm --cones",
    "bowl": "approximate {data}/half_bowl.step --tolerance 40mm",
    "bowl-few": "approximate {data}/half_bowl.step --tolerance 60mm --seams independent",
    "hull-meet": "approximate {data}/hull.step --tolerance 15mm",
    "hull-few": "approximate {data}/hull.step --tolerance 40mm --seams independent",
    "hull-section": "approximate {data}/hull.step --tolerance 40mm --seam-at x=3000mm --seams independent",
    "hull-rings": "approximate {data}/hull.step --tolerance 60mm --layout rings",
    "hull-strips": "approximate {data}/hull.step --tolerance 40mm --layout strips",
    "hull-stopped": "approximate {data}/hull.step --tolerance 10mm --max-panels 2 --seams independent",
    "fuselage": "approximate {data}/fuselage.step --tolerance 150mm",
    "fuselage-along": "approximate {data}/fuselage.step --tolerance 120mm --curves v=0.5 --seams independent",
    "roof": "approximate {data}/wavy_roof.step --tolerance 120mm",
    "roof-guided": "approximate {data}/wavy_roof.step --tolerance 90mm --direction x --seams independent",
    "torus-many": "approximate {data}/torus_piece.step --tolerance 1mm --seams independent",
    "torus-meet": "approximate {data}/torus_piece.step --tolerance 2mm",
    "dome": "approximate {made}/dome.igs --tolerance 10mm",
    "dome-finer": "approximate {made}/dome.igs --tolerance 3mm",
    "dome-rings": "approximate {made}/dome.igs --tolerance 25mm --layout rings --seams independent",
    "saddle": "approximate {made}/saddle.igs --tolerance 10mm",
    "saddle-narrow": "approximate {made}/saddle.igs --tolerance 10mm --max-width 200mm --min-clearance 50mm",
    "saddle-sheet": "approximate {made}/saddle.igs --tolerance 10mm --sheet 700x700 --min-bend-radius 200mm",
    "smooth-faces": "approximate {made}/two.igs --tolerance 3mm",
    "monkey": "approximate {made}/monkey.igs --tolerance 40mm",
    "monkey-ruled": "ruled {made}/monkey.igs --tolerance 10mm",
    "saddle-ruled": "ruled {made}/saddle.igs --tolerance 10mm --width 400mm",
    "torus-section": "approximate {data}/torus_piece.step --tolerance 15mm --curves z=20mm --seams independent",
    "torus-timed": "approximate {data}/torus_piece.step --tolerance 10mm --time-limit 100s --seams independent",
    "torus-finer": "approximate {data}/torus_piece.step --tolerance 0.5mm --seams independent",
    "saddle-cut": "approximate {made}/saddle.igs --tolerance 10mm --min-bend-radius 1200mm --seams independent",
    "tip": "approximate {made}/tip.igs --tolerance 1mm",
    "cones-tip": "cones {made}/tip.igs --tolerance 1mm",
    "cones-bracket": "cones {data}/bracket.step --tolerance 0.1mm",
    "fit-long": "fit {made}/rulings.csv --unit mm --tolerance 0.5mm",
    "fit-pipe": "fit {made}/pipe.obj --unit mm --tolerance 1mm",
    "saddle-narrow-ruled": "ruled {made}/saddle.igs --tolerance 10mm --width 150mm --spacing 100mm",
    "joined": "approximate {base}/torus/panels.step --tolerance 10mm --smooth-angle 30",
    "apart": "approximate {base}/torus/panels.step --tolerance 1mm",
    "cones-panels": "cones {base}/torus/panels.step --tolerance 1mm",
    "fit-panels": "fit {base}/torus/panels.step --tolerance 1mm",
    "fit-smooth": "fit {data}/hood_strip.csv --tolerance 2mm --smooth 1 --fix-ends",
    "loft-twist": "loft {data}/chine_low.csv {data}/chine_high.csv --unit mm --tolerance 0.5mm --least-twist",
    "loft-panels": "loft {data}/duct_round.dxf {data}/chine_high.csv --unit mm --tolerance 0.5mm",
    "unroll-panels": "unroll {base}/torus/panels.step --tolerance 0.1mm",
    "conoidal": "ruled {data}/wavy_roof.step --tolerance 80mm --conoidal",
    "ruled": "ruled {data}/wavy_roof.step --tolerance 80mm",
    "ruled-hull": "ruled {data}/hull.step --tolerance 40mm",
    "fit-lines": "fit {made}/lines.csv --unit mm --tolerance 1mm",
    "fit-fine": "fit {made}/fine.obj --unit mm --tolerance 1mm",
    "fit-gap": "fit {made}/gap.csv --unit mm --tolerance 0.2mm",
    "fit-astray": "fit {made}/planes_astray.csv --region 0,0,0,500 --tolerance 0.2mm --robust",
    "fit-clear": "fit {data}/hood_strip.csv --tolerance 1mm --min-clearance 1m",
    "fit-scan-clear": "fit {made}/scan.csv --unit mm --tolerance 1mm --min-clearance 5m",
    "fit-twisted": "fit {made}/twisted.csv --unit mm --tolerance 10mm --max-strips 1",
    "cones-wave": "cones {made}/wave.igs --tolerance 1mm",
    "loft-snake": "loft {made}/snake_low.csv {made}/snake_high.csv --unit mm --tolerance 0.2mm",
    "loft-coil": "loft {made}/coil_low.csv {made}/coil_high.csv --unit mm --tolerance 0.2mm",
    "unroll-tip": "unroll {made}/tip.igs --tolerance 1mm",
    "tip-sheet": "approximate {made}/tip.igs --tolerance 0.3mm --sheet 300x300 --seams independent",
    "saddle-along": "approximate {made}/saddle.igs --tolerance 10mm --seam-along x=100mm",
    "saddle-on": "approximate {made}/saddle.igs --tolerance 10mm --curves {made}/on.csv --unit mm --seams independent",
    "ruled-cone": "ruled {data}/cone_holes.step --tolerance 0.5mm --width 100mm",
    "sharp": "approximate {made}/sharp.igs --tolerance 3mm",
    "dome-finest": "approximate {made}/dome.igs --tolerance 0.1mm --seams independent",
    "roof-finer": "approximate {data}/wavy_roof.step --tolerance 50mm --seams independent",
    "dished": "approximate {data}/dished_end.step --tolerance 10mm",
    "creased": "approximate {made}/creased.igs --tolerance 3mm",
    "torus-limited": "approximate {data}/torus_piece.step --tolerance 1mm --min-bend-radius 3m --seams independent",
    "nose": "approximate {made}/nose.igs --tolerance 2mm",
    "tip-sheet-met": "approximate {made}/tip.igs --tolerance 0.3mm --sheet 300x300",
    "dished-clear": "approximate {data}/dished_end.step --tolerance 40mm --min-clearance 800mm --seams independent",
    "sharp-finer": "approximate {made}/sharp.igs --tolerance 2mm",
    "refold": "refold {base}/pipe",
    "refold-hopper": "refold {base}/hopper",
}

# Files of a result that hold its figures.
REPORTS = ("report.json", "refold.json")


def make_inputs(folder: Path) -> None:
    """Things to measure and to cover, made up, the same on every machine."""
    folder.mkdir(parents=True, exist_ok=True)
    random = Random(1).random

    def bent(turn: float, far: float) -> tuple:
        """A sheet: a cone about the z axis up to the turn 0.75, a plane wing beyond."""
        sin, cos, fold = math.sin(0.5), math.cos(0.5), 0.75

        def ruling(t):
            return (sin * math.cos(t / sin), sin * math.sin(t / sin), -cos)

        if turn < fold:
            return tuple(far * c for c in ruling(turn))
        edge, along = ruling(fold), (-math.sin(fold / sin), math.cos(fold / sin), 0.0)
        up = (edge[1] * along[2] - edge[2] * along[1], edge[2] * along[0] - edge[0] * along[2],
              edge[0] * along[1] - edge[1] * along[0])
        side = tuple(math.cos(0.7) * a - math.sin(0.7) * u for a, u in zip(along, up))
        return tuple(far * (math.cos(turn - fold) * e + math.sin(turn - fold) * s) for e, s in zip(edge, side))

    def line(numbers) -> str:
        return ",".join(f"{n:.6f}" for n in numbers)

    scan, hole = ["x,y,z"], (690 * math.cos(0.35), 690 * math.sin(0.35))
    for i in range(48):
        for j in range(26):
            turn, far = 1.15 * (i + random()) / 48, 500 + 400 * (j + random()) / 26
            if math.dist((far * math.cos(turn), far * math.sin(turn)), hole) > 75:
                scan.append(line(c + 0.1 * (2 * random() - 1) for c in bent(turn, far)))
    (folder / "scan.csv").write_text("\n".join(scan) + "\n")

    for name, rows, columns in (("mesh", 4, 25), ("fine", 18, 60)):
        mesh = ["v " + " ".join(f"{c:.6f}" for c in bent(1.15 * i / (columns - 1), 500 + 400 * j / (rows - 1)))
                for i in range(columns) for j in range(rows)]
        for i in range(columns - 1):
            for j in range(rows - 1):
                a = i * rows + j + 1
                mesh += [f"f {a} {a + rows} {a + rows + 1}", f"f {a} {a + rows + 1} {a + 1}"]
        (folder / f"{name}.obj").write_text("\n".join(mesh) + "\n")

    planes, astray = ["a,b,c,d"], ["a,b,c,d"]
    for i in range(21):
        turn, slope = -0.7 + 0.07 * i, 0.2
        normal = (math.cos(turn), math.sin(turn), -slope)
        length = math.hypot(*normal)
        away = 400 + 20 * math.sin(2 * turn)
        planes.append(line([*(c / length for c in normal), away / length]))
        astray.append(line([*(c / length for c in normal), (away + (20 if i == 7 else 0)) / length]))
    (folder / "planes.csv").write_text("\n".join(planes) + "\n")
    (folder / "planes_astray.csv").write_text("\n".join(astray) + "\n")

    rulings = ["ax,ay,az,bx,by,bz"]
    for i in range(120):
        turn = 0.05 * i
        radius = 300 + (30 * math.sin(2 * turn) if turn < 3 else 0)
        rulings.append(line([radius * math.cos(turn), radius * math.sin(turn), 0,
                             0.6 * radius * math.cos(turn), 0.6 * radius * math.sin(turn), 250]))
    (folder / "rulings.csv").write_text("\n".join(rulings) + "\n")

    gap = ["ax,ay,az,bx,by,bz"]
    for turn in (0.05 * k + (0 if k < 12 else 1) for k in range(24)):
        x, y = 100 * math.cos(turn), 100 * math.sin(turn)
        gap.append(line([x, y, 0, x, y, 80]))
    (folder / "gap.csv").write_text("\n".join(gap) + "\n")

    lines = ["x,y,z"]
    for j in range(12):
        for k in range(200):
            a = (k + 0.1 * random()) / 300
            lines.append(line([300 * math.sin(a), 15 * j + 0.05 * random(), 300 * math.cos(a)]))
    (folder / "lines.csv").write_text("\n".join(lines) + "\n")

    pipe = [f"v {200 * math.cos(a):.6f} {200 * math.sin(a):.6f} {z}" for a in (math.tau * k / 36 for k in range(36))
            for z in (0, 900)]
    for k in range(36):
        a, b = 2 * k + 1, 2 * ((k + 1) % 36) + 1
        pipe += [f"f {a} {b} {b + 1}", f"f {a} {b + 1} {a + 1}"]
    (folder / "pipe.obj").write_text("\n".join(pipe) + "\n")

    rim = [(-300, 0, 0), (-150, 350, 60), (250, 300, -40), (320, 0, 30)]
    iges(folder / "tip.igs", [[(0, -50, 600)] * 4 + rim], across=1)
    iges(folder / "dome.igs", [graph((-500, 500), (-400, 400), {(2, 0): -4e-4, (0, 2): -4e-4})])
    iges(folder / "saddle.igs", [graph((-500, 500), (-400, 400), {(2, 0): -3e-4, (0, 2): 5e-4})])
    iges(folder / "monkey.igs", [graph((-500, 500), (-400, 400), {(3, 0): 8e-7, (1, 2): -2.4e-6, (2, 0): -1e-4})])
    vault = {(2, 0): -5e-4, (0, 2): -1e-4}
    iges(folder / "two.igs", [graph((-500, 0), (-300, 300), vault), graph((0, 400), (-300, 300), vault)])

    iges(folder / "wave.igs", [[(-300, 0, 0), (-90, 0, 300), (90, 0, -300), (300, 0, 0),
                                (-200, 400, 0), (-60, 400, 200), (60, 400, -200), (200, 400, 0)]], across=1)
    bent_over = [(-300, 0), (-200, 60), (-100, 90), (0, 100), (100, 60), (200, 0), (300, -90)]
    iges(folder / "creased.igs", [[(x, y, z - far) for y, far in ((-300, 20), (-100, 0), (100, 0), (300, 20))
                                   for x, z in bent_over]])
    nose = [(0, 0), (0, 2.76), (2.24, 5), (5, 5), (200, 5), (400, 35), (600, 50)]
    iges(folder / "nose.igs", [[(x, y, up * z) for y in (-300, 300) for x, z in nose[::up]] for up in (1, -1)], across=1)
    for name, height in (("low", 0), ("high", 120)):
        wide = 1 + height / 400
        snake = [line((wide * 10 * k, wide * 60 * math.sin(k / 9), height)) for k in range(60)]
        (folder / f"snake_{name}.csv").write_text("x,y,z\n" + "\n".join(snake) + "\n")
        coil = [line(((200 + height / 3) * math.cos(k / 12), 200 * math.sin(k / 12), height + k)) for k in range(66)]
        (folder / f"coil_{name}.csv").write_text("x,y,z\n" + "\n".join(coil) + "\n")
    twisted = ["ax,ay,az,bx,by,bz"]
    for k in range(30):
        c, s = math.cos(0.04 * k), math.sin(0.04 * k)
        twisted.append(line((15 * k, -60 * c, -60 * s, 15 * k, 60 * c, 60 * s)))
    (folder / "twisted.csv").write_text("\n".join(twisted) + "\n")
    on = [line((x, 100, -3e-4 * x * x + 5)) for x in range(-500, 501, 20)]
    (folder / "on.csv").write_text("x,y,z\n" + "\n".join(on) + "\n")
    slopes = [((-500, 0), 0.8), ((0, 500), -0.8)]
    iges(folder / "sharp.igs", [graph(xs, (-300, 300), {(1, 0): c, (2, 0): -3e-4, (0, 2): -2e-4}) for xs, c in slopes])
    ring = [2 * math.pi * (k % 72) / 72 for k in range(73)]
    loop = [line((100 * math.cos(t), 100 * math.sin(t), 35 * math.cos(3 * t))) for t in ring]
    (folder / "loop.csv").write_text("x,y,z\n" + "\n".join(loop) + "\n")


def graph(xs: tuple, ys: tuple, terms: dict) -> list:
    """z = Σ c xⁱ yʲ over a rectangle, exact, as a Bézier patch of degree 3 by 3."""

    def polar(ends: tuple, power: int, k: int) -> float:
        """Control value `k` of the cubic t^power between two ends."""
        places = [ends[1]] * k + [ends[0]] * (3 - k)
        picks = list(itertools.combinations(places, power))
        return sum(math.prod(pick) for pick in picks) / len(picks)

    def height(i: int, j: int) -> float:
        return sum(c * polar(xs, a, i) * polar(ys, b, j) for (a, b), c in terms.items())

    return [(polar(xs, 1, i), polar(ys, 1, j), height(i, j)) for j in range(4) for i in range(4)]


def iges(path: Path, patches: list, across: int = 3) -> None:
    """Writes Bézier patches of degree 3 by `across`, or rows of them, as surfaces without trims (type 128)."""

    def cards(text: str, letter: str) -> list:
        rows = [text[k : k + 72] for k in range(0, len(text), 72)]
        return [f"{row:<72}{letter}{k + 1:7d}" for k, row in enumerate(rows)]

    date, name = "15H20260101.000000", "4Hmade"
    first = cards("Patches, made up", "S")
    first += cards(f"1H,,1H;,{name},{name},{name},{name},32,38,6,308,15,{name},1.,2,2HMM,1,1.,{date},1E-6,1E4,"
                   f"{name},{name},11,0,{date};", "G")
    directory, data = [], []
    for k, points in enumerate(patches):
        along = len(points) // (across + 1) - 1
        knots = [f"{3 * span / along:.6f}".rstrip("0") for span in range(along // 3 + 1) for _ in range(3)]
        numbers = f"128 {along} {across} 3 {across} 0 0 1 0 0".split() + [knots[0], *knots, knots[-1]]
        numbers += ["0."] * (across + 1) + ["1."] * (across + 1) + ["1."] * len(points)
        numbers += [f"{c:.6f}" for p in points for c in p] + "0. 1. 0. 1.".split()
        rows = [""]
        for n in numbers:
            if len(rows[-1]) + len(n) > 62:
                rows.append("")
            rows[-1] += n + ","
        rows[-1] = rows[-1][:-1] + ";"
        here, entity = len(data) + 1, 2 * k + 1
        data += [f"{row:<64}{entity:8d}P{here + j:7d}" for j, row in enumerate(rows)]
        directory.append("".join(f"{f:8d}" for f in (128, here, 0, 0, 0, 0, 0, 0)) + f"00000000D{entity:7d}")
        directory.append("".join(f"{f:8d}" for f in (128, 0, 0, len(rows), 0)) + f"{0:32d}D{entity + 1:7d}")
    last = f"S{1:7d}G{len(first) - 1:7d}D{len(directory):7d}P{len(data):7d}"
    path.write_text("\n".join([*first, *directory, *data, f"{last:<72}T{1:7d}"]) + "\n")


# ----------------------------------------------------------------------------------------------------- reading of Rust

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<string>b?r(?P<h>\#*)".*?"(?P=h)|b?"(?:\\.|[^"\\])*"|b?'(?:\\[^\n]*?|[^'\\\n])')
      | (?P<lifetime>'[A-Za-z_]\w*)
      | (?P<number>[0-9][0-9_]*(?:\.[0-9][0-9_]*)?(?:[eE][+-]?[0-9_]+)?\w*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<mark>::|=>|->|\.\.=|\.\.|[^\s])""",
    re.S | re.X,
)
OPEN, CLOSE = "([{", ")]}"


class Source:
    """A file as tokens, with its brackets matched and the stretches where constants stay as they are."""

    def __init__(self, path: Path, module: tuple):
        self.path, self.module = path, module
        self.text = path.read_text()
        found = (m for m in TOKEN.finditer(self.text) if m.lastgroup != "comment")
        self.tokens = [(m.lastgroup, m.group(), m.start()) for m in found]
        self.match, self.inside = {}, {}
        stack = []
        for i, (_, word, _) in enumerate(self.tokens):
            self.inside[i] = stack[-1] if stack else None
            if self.is_mark(i) and word in OPEN:
                stack.append(i)
            elif self.is_mark(i) and word in CLOSE:
                self.match[stack.pop()] = i
        # Why a token stays as it is, if it does.
        self.fixed = [""] * len(self.tokens)
        self.uses = []
        self.consts = []
        self.survey()

    def is_mark(self, i: int) -> bool:
        return self.tokens[i][0] == "mark"

    def word(self, i: int) -> str:
        return self.tokens[i][1] if 0 <= i < len(self.tokens) else ""

    def end_of(self, i: int, closers: str = ";") -> int:
        """First of `closers` after `i` outside inner brackets."""
        while i < len(self.tokens):
            if self.is_mark(i) and self.word(i) in closers:
                return i
            i = self.match.get(i, i) + 1
        return len(self.tokens) - 1

    def fix(self, start: int, end: int, why: str) -> None:
        for k in range(start, min(end + 1, len(self.tokens))):
            self.fixed[k] = self.fixed[k] or why

    def survey(self) -> None:
        i = 0
        while i < len(self.tokens):
            word = self.word(i)
            if word == "#" and self.word(i + 1) in ("[", "!"):
                start = i + 1 if self.word(i + 1) == "[" else i + 2
                end = self.match[start]
                self.fix(i, end, "attribute")
                if "".join(self.word(k) for k in range(start, end + 1)) == "[cfg(test)]":
                    item = end + 1
                    while self.word(item) == "#":
                        item = self.match[item + 1] + 1
                    stop = self.end_of(item, ";{")
                    stop = self.match.get(stop, stop)
                    self.fix(item, stop, "test")
                    i = stop + 1
                    continue
            elif word == "use" and not self.fixed[i]:
                end = self.end_of(i)
                self.uses.append((i + 1, end))
                self.fix(i, end, "import")
            elif word in ("const", "static") and not self.fixed[i]:
                if self.word(i + 1) == "fn" or self.word(i + 2) == "fn":
                    body = self.end_of(i, "{;")
                    self.fix(i, self.match.get(body, body), "constant")
                elif self.word(i + 1) == "{":
                    self.fix(i, self.match[i + 1], "constant")
                elif self.word(i + 2) == ":" and re.fullmatch(r"[A-Z][A-Z0-9_]*|_", self.word(i + 1)):
                    if self.word(self.inside[i] or -1) != "<" and self.word(i - 1) not in ("<", ","):
                        end = self.end_of(i)
                        self.constant(i, end)
                        self.fix(i, i + 2, "name")
                        self.fix(i + 3, end, "constant")
            elif word == "[" and self.is_mark(i) and self.word(i - 1) != "!":
                split = self.end_of(i + 1, ";]")
                if self.word(split) == ";":
                    self.fix(split, self.match[i], "constant")
            i += 1

    def constant(self, i: int, end: int) -> None:
        start = self.tokens[i][2]
        block = self.inside[i]
        scope = (block, self.match[block]) if block is not None else (0, len(self.tokens))
        kind = "".join(self.word(k) for k in range(i + 3, next(k for k in range(i, end) if self.word(k) == "=")))
        equals = next(k for k in range(i, end) if self.word(k) == "=")
        value = self.text[self.tokens[equals][2] + 1 : self.tokens[end][2]].strip()
        before = self.text[:start].rstrip().split("\n")
        if before and re.fullmatch(r"\s*pub(\([a-z: ]+\))?\s*", before[-1]):
            before.pop()
        doc = []
        for text in reversed(before):
            found = re.match(r"\s*///? ?(.*)", text)
            if found:
                doc.insert(0, found.group(1))
            elif not re.match(r"\s*#\[", text):
                break
        owner = block is not None and self.word(block) == "{" and self.owner(block)
        self.consts.append({
            "name": self.word(i + 1), "kind": kind, "value": " ".join(value.split()),
            "line": self.text.count("\n", 0, start) + 1, "doc": " ".join(doc), "scope": scope,
            "local": block is not None, "associated": owner,
        })

    def owner(self, block: int) -> bool:
        """Whether a brace belongs to an `impl` or `trait`."""
        head, k = set(), block - 1
        while k >= 0 and self.word(k) not in (";", "}", "{"):
            head.add(self.word(k))
            k -= 1
        return bool(head & {"impl", "trait"}) and "fn" not in head

    def imports(self):
        """Paths of all `use`, flat, with the name each is known by."""
        for start, end in self.uses:
            words = [self.word(k) for k in range(start, end)]
            yield from flattened(words, ())


def flattened(words, prefix):
    """`a::{b, c::D as E}` as (path, name)."""
    path, k = list(prefix), 0
    while k < len(words):
        if words[k] == "::":
            k += 1
        elif words[k] == "{":
            depth, piece = 1, []
            k += 1
            while depth:
                depth += (words[k] == "{") - (words[k] == "}")
                if depth == 0 or (depth == 1 and words[k] == ","):
                    if piece:
                        yield from flattened(piece, path)
                    piece = []
                else:
                    piece.append(words[k])
                k += 1
            return
        elif words[k] == "as":
            yield tuple(path), words[k + 1]
            return
        else:
            path.append(words[k])
            k += 1
    yield tuple(path), path[-1] if path else ""


# ------------------------------------------------------------------------------------------------ rewriting of the copy

TUNE = """//! Varied constants, written by `benches/tuning.py`.
#![allow(missing_docs)]

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::OnceLock;

struct State {
    id: usize,
    factor: f64,
    trace: Option<PathBuf>,
}

static STATE: OnceLock<State> = OnceLock::new();
static READ: [AtomicUsize; COUNT] = [const { AtomicUsize::new(0) }; COUNT];
const COUNT: usize = @COUNT@;

fn state() -> &'static State {
    STATE.get_or_init(|| {
        let varied = std::env::var("TORSE_TUNE").ok();
        let parts = varied.as_deref().and_then(|v| v.split_once(':'));
        let parts = parts.and_then(|(id, factor)| Some((id.parse().ok()?, factor.parse().ok()?)));
        let (id, factor) = parts.unwrap_or((usize::MAX, 1.0));
        State { id, factor, trace: std::env::var_os("TORSE_TUNE_TRACE").map(PathBuf::from) }
    })
}

/// Told at the first read, the tenth, the hundredth and so on.
fn trace(file: &PathBuf, id: usize, value: f64) {
    let read = READ[id].fetch_add(1, Ordering::Relaxed) + 1;
    if read == 10usize.pow(read.ilog10()) {
        let open = std::fs::OpenOptions::new().create(true).append(true).open(file);
        let _ = open.and_then(|mut f| f.write_all(format!("{id} {value} {read}\\n").as_bytes()));
    }
}

/// Numbers, and tuples and arrays of them, which one factor varies all at once.
pub(crate) trait Numbers: Copy {
    fn times(self, factor: f64) -> Self;
    fn largest(&self) -> f64;
}

impl Numbers for f64 {
    fn times(self, factor: f64) -> Self {
        self * factor
    }
    fn largest(&self) -> f64 {
        self.abs()
    }
}

impl Numbers for usize {
    fn times(self, factor: f64) -> Self {
        if self == 0 || factor == 1.0 {
            return self;
        }
        let varied = (self as f64 * factor).round() as usize;
        if factor > 1.0 { varied.max(self + 1) } else { varied.min(self - 1).max(1) }
    }
    fn largest(&self) -> f64 {
        *self as f64
    }
}

impl Numbers for std::time::Duration {
    fn times(self, factor: f64) -> Self {
        self.mul_f64(factor)
    }
    fn largest(&self) -> f64 {
        self.as_secs_f64()
    }
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    fn times(self, factor: f64) -> Self {
        self.map(|number| number.times(factor))
    }
    fn largest(&self) -> f64 {
        self.iter().map(T::largest).fold(0.0, f64::max)
    }
}

impl<A: Numbers, B: Numbers> Numbers for (A, B) {
    fn times(self, factor: f64) -> Self {
        (self.0.times(factor), self.1.times(factor))
    }
    fn largest(&self) -> f64 {
        self.0.largest().max(self.1.largest())
    }
}

impl<A: Numbers, B: Numbers, C: Numbers> Numbers for (A, B, C) {
    fn times(self, factor: f64) -> Self {
        (self.0.times(factor), self.1.times(factor), self.2.times(factor))
    }
    fn largest(&self) -> f64 {
        self.0.largest().max(self.1.largest()).max(self.2.largest())
    }
}

pub(crate) fn varied<T: Numbers>(id: usize, value: T) -> T {
    let state = state();
    if let Some(file) = &state.trace {
        trace(file, id, value.largest());
    }
    if state.id == id { value.times(state.factor) } else { value }
}
"""


# What is varied: numbers, tuples and arrays of numbers.
NUMBERS = re.compile(r"(?:f64|usize|Duration|\d+|[\[\](),;])+")


class Rewriter:
    """Finds the constants of the floors and their uses, and writes the copy."""

    def __init__(self, root: Path):
        self.root = root
        self.sources = {}
        for path in sorted(root.rglob("*.rs")):
            parts = path.relative_to(root).with_suffix("").parts
            module = () if parts == ("lib",) else parts[:-1] if parts[-1] == "mod" else parts
            if path.name != "tests.rs" and path.name != "tune.rs":
                self.sources[module] = Source(path, module)
        self.constants, self.of_module = [], {}
        for module, source in self.sources.items():
            if not module or module[0] not in FLOORS:
                continue
            for c in source.consts:
                c.update(file=str(source.path.relative_to(root)), id=None, uses=0, excluded="", partly=False)
                if NUMBERS.fullmatch(c["kind"]):
                    c["id"] = sum(k["id"] is not None for k in self.constants)
                    if not c["local"]:
                        self.of_module[module, c["name"]] = c
                self.constants.append(c)
        self.aliases = {}
        for module, source in self.sources.items():
            for path, name in source.imports():
                if re.fullmatch(r"[A-Z][A-Z0-9_]*", path[-1] if path else ""):
                    self.aliases[module, name] = path

    def absolute(self, module: tuple, path: tuple) -> tuple:
        """A path of modules from the root of the crate."""
        path, base = list(path), None
        while path and path[0] in ("crate", "self", "super"):
            first = path.pop(0)
            base = () if first == "crate" else module if base is None and first == "self" else (base or module)
            if first == "super":
                base = base[:-1]
        if base is not None:
            return base + tuple(path)
        return module + tuple(path)

    def resolved(self, module: tuple, path: tuple, depth: int = 0):
        """The constant a path means, if it is one of the floors'."""
        where = self.absolute(module, path)
        home, name = where[:-1], where[-1]
        if (home, name) in self.of_module:
            return self.of_module[home, name]
        if (home, name) in self.aliases and depth < 5:
            return self.resolved(home, self.aliases[home, name], depth + 1)
        # A child module imported by its name, such as `use super::scan;`.
        return None

    def uses(self):
        """Every use to be replaced: (source, from, to, constant), first and last character."""
        for module, source in self.sources.items():
            for i, (group, word, at) in enumerate(source.tokens):
                if group != "word" or source.fixed[i] not in ("", "constant"):
                    continue
                if not re.fullmatch(r"[A-Z][A-Z0-9_]*", word):
                    continue
                if source.word(i + 1) in ("::", "!"):
                    continue
                # A pattern, unless it is the end of a guard.
                if source.word(i + 1) == "=>" and source.word(i - 1) not in ("<", ">", "="):
                    continue
                start = i
                while source.word(start - 1) == "::" and source.tokens[start - 2][0] == "word":
                    start -= 2
                path = tuple(source.word(k) for k in range(start, i + 1, 2))
                if any(part[0].isupper() for part in path[:-1]) or source.word(start - 1) in (".", "::"):
                    continue
                if source.word(start - 1) == "<" and source.word(i + 1) in (">", ","):
                    continue
                found = None
                if len(path) == 1:
                    inner = [c for c in source.consts if c["name"] == word and c["local"] and not c["associated"]
                             and c["scope"][0] < i < c["scope"][1]]
                    if inner:
                        found = max(inner, key=lambda c: c["scope"][0])
                        found = found if found.get("id") is not None else None
                    else:
                        found = self.resolved(module, path)
                else:
                    found = self.resolved(module, path)
                if found and source.fixed[i]:
                    found["partly"] = True
                elif found and not found["excluded"]:
                    yield source, source.tokens[start][2], at + len(word), found

    def write(self) -> None:
        changes = {}
        for c in self.constants:
            c["uses"] = 0
        for source, start, end, c in self.uses():
            c["uses"] += 1
            changes.setdefault(source.path, (source.text, []))[1].append((start, end, c))
        self.places = {}
        for path, (text, all_changes) in changes.items():
            out, last = [], 0
            for start, end, c in sorted(all_changes, key=lambda change: change[0]):
                out += [text[last:start], f"crate::tune::varied({c['id']}, {text[start:end]})"]
                last = end
            path.write_text("".join(out) + text[last:])
        number = sum(c["id"] is not None for c in self.constants)
        (self.root / "tune.rs").write_text(TUNE.replace("@COUNT@", str(number)))
        lib = self.root / "lib.rs"
        if "mod tune;" not in lib.read_text():
            lib.write_text(lib.read_text().replace("pub mod control;", "pub mod control;\npub(crate) mod tune;", 1))


def build(workspace: Path, work: Path) -> None:
    """Copies, rewrites and builds; what does not compile is put back."""
    copy = work / "copy"
    shutil.rmtree(copy, ignore_errors=True)
    copy.mkdir(parents=True)
    for name in ("crates", "data"):
        shutil.copytree(workspace / name, copy / name)
    for name in ("Cargo.toml", "Cargo.lock"):
        shutil.copy(workspace / name, copy / name)
    shrink_pictures(copy)
    rewriter = Rewriter(copy / LIBRARY)
    rewriter.write()
    target = os.environ.get("CARGO_TARGET_DIR", str(work / "target"))
    environment = os.environ | {"CARGO_TARGET_DIR": target, "CARGO_TERM_COLOR": "never"}
    package = ["-p", "torse-cli", "--message-format", "short"]
    for attempt in range(8):
        checked = subprocess.run(["cargo", "check", *package], cwd=copy, env=environment, capture_output=True, text=True)
        if checked.returncode == 0:
            break
        (work / f"build-{attempt}.log").write_text(checked.stderr)
        if not put_back(rewriter, copy, checked.stderr):
            sys.exit(f"the copy does not compile:\n{checked.stderr[-4000:]}")
        rewriter.write()
    else:
        sys.exit("the copy does not compile")
    subprocess.run(["cargo", "build", "--release", *package], cwd=copy, env=environment, check=True)
    shutil.copy(Path(target) / "release" / "torse", work / "torse")
    for c in rewriter.constants:
        c.pop("scope")
    (work / "constants.json").write_text(json.dumps(rewriter.constants, indent=1))
    varied = [c for c in rewriter.constants if c["uses"]]
    print(f"{len(rewriter.constants)} constants, {len(varied)} varied")
    for c in rewriter.constants:
        if c["id"] is not None and not c["uses"]:
            reason = c["excluded"] or "in constant expressions only"
            print(f"not varied: {c['file']}:{c['line']} {c['name']} ({reason})")


def shrink_pictures(copy: Path) -> None:
    """Pictures take most of the time of a short job and are not looked at here."""
    path = copy / LIBRARY / "draw/picture.rs"
    text = path.read_text()
    if text.count("width: 1600,") != 1:
        print("pictures keep their size", file=sys.stderr)
    path.write_text(text.replace("width: 1600,", "width: 400,"))


def put_back(rewriter: Rewriter, copy: Path, errors: str) -> set:
    """Excludes the constants on the lines that the compiler names, and puts all files back; the constants' names."""
    bad = set()
    for found in re.finditer(r"^(\S+\.rs):(\d+):\d+: error(.*)$", errors, re.M):
        path, line = copy / found.group(1), int(found.group(2))
        here = path.read_text().split("\n")[line - 1] if path.exists() else ""
        for number in re.findall(r"crate::tune::varied\((\d+),", here):
            c = next(c for c in rewriter.constants if c["id"] == int(number))
            c["excluded"] = "does not compile:" + found.group(3)[:80]
            bad.add(c["name"])
    if bad:
        for source in rewriter.sources.values():
            if source.path.name != "lib.rs":
                source.path.write_text(source.text)
    return bad


# ------------------------------------------------------------------------------------------------------------- running


class Runner:
    """Runs jobs and tells what came of them."""

    def __init__(self, work: Path, limit: float):
        self.work, self.limit = work, limit
        self.made, self.base, self.out = work / "made", work / "base", work / "out"
        make_inputs(self.made)

    def run(self, job: str, varied: str = "", trace: Path = None, keep: bool = False) -> dict:
        folder = self.base / job if keep else self.out
        shutil.rmtree(folder, ignore_errors=True)
        folder.parent.mkdir(parents=True, exist_ok=True)
        arguments = JOBS[job].format(data=self.work / "copy/data", made=self.made, base=self.base).split()
        environment = os.environ | {"RAYON_NUM_THREADS": "1"}
        environment.pop("TORSE_TUNE", None)
        environment.pop("TORSE_TUNE_TRACE", None)
        if varied:
            environment["TORSE_TUNE"] = varied
        if trace:
            environment["TORSE_TUNE_TRACE"] = str(trace)
        limits = (math.ceil(self.limit), math.ceil(self.limit) + 1)

        def limited():
            resource.setrlimit(resource.RLIMIT_CPU, limits)

        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        process = subprocess.Popen(
            [str(self.work / "torse"), *arguments, "--out", str(folder), "--quiet"],
            env=environment, preexec_fn=limited, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )
        try:
            _, words = process.communicate(timeout=8 * self.limit)
        except subprocess.TimeoutExpired:
            process.kill()
            _, words = process.communicate()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        exit_status = process.returncode
        if exit_status < 0 and cpu > 0.9 * self.limit:
            return {"exit": "over", "cpu": round(cpu, 3)}
        told = {"exit": exit_status, "cpu": round(cpu, 3)}
        report = next((folder / name for name in REPORTS if (folder / name).exists()), None)
        if report:
            told |= figures(json.loads(report.read_text()))
        else:
            told["words"] = words.decode(errors="replace")[-300:]
        return told


def figures(report: dict) -> dict:
    """The figures of a report that are compared, and a hash of all that it says beyond time."""
    report.pop("seconds", None)
    text = json.dumps(report, sort_keys=True)
    all_figures = [f for f in report.get("figures") or [] if isinstance(f.get("value"), (int, float))]
    with_limit = [f for f in all_figures if isinstance(f.get("limit"), (int, float)) and f["limit"] > 0]
    main = next(iter(with_limit or all_figures), None)
    refolded = [p.get("distance_bound") for p in report.get("parts") or [] if isinstance(p, dict)]
    if main is None and refolded and all(isinstance(d, (int, float)) for d in refolded):
        main = {"value": max(refolded)}
    seams = [s for s in report.get("seams") or [] if isinstance(s, dict)]
    return {
        "status": report.get("status"),
        "panels": len(report.get("panels") or []),
        "parts": len(report.get("parts") or []),
        "coverage": report.get("coverage"),
        "bound": main["value"] if main else None,
        "limit": main.get("limit") if main else None,
        "exact": sum(s.get("joint") == "exact" for s in seams),
        "seams": len(seams),
        "hash": hashlib.sha256(text.encode()).hexdigest()[:16],
    }


def trace(work: Path, limit: float) -> None:
    """Every job with what it reads; jobs that fail or last too long are left out."""
    runner, known = Runner(work, limit), work / "baseline.json"
    baseline = json.loads(known.read_text()) if known.exists() else {}
    reads = {number for b in baseline.values() for number in b["reads"]}
    for job in (job for job in JOBS if job not in baseline):
        record = work / "trace.txt"
        record.unlink(missing_ok=True)
        first = runner.run(job, trace=record, keep=True)
        counts, values = {}, {}
        for line in record.read_text().splitlines() if record.exists() else []:
            number, value, count = line.split()
            counts[number], values[number] = max(int(count), counts.get(number, 0)), float(value)
        if first["exit"] not in (0, 3):
            print(f"{job}: left out, {first}")
            continue
        runs = [runner.run(job), runner.run(job)]
        cpu = sorted([r["cpu"] for r in runs])
        baseline[job] = first | {"cpu": cpu[0], "noise": round(cpu[-1] / max(cpu[0], 1e-3) - 1, 3), "reads": counts,
                                 "same": all(r.get("hash") == first.get("hash") for r in runs), "values": values}
        new = set(counts) - reads
        reads |= set(counts)
        print(f"{job}: {cpu[0]} s, exit {first['exit']}, panels {first.get('panels')}, bound {first.get('bound')}, "
              f"seams {first.get('exact')}/{first.get('seams')}, reads {len(counts)}, new {len(new)}, "
              f"repeats {baseline[job]['same']}", flush=True)
        known.write_text(json.dumps(baseline, indent=1))


# Longer jobs (seconds of the processor) run only for what no shorter one reads.
LONG = 3.0


def chosen(number: str, baseline: dict, most: int) -> list:
    """Jobs for one constant: the cheapest, the one that reads it most often, then the cheapest of other commands."""
    readers = sorted((j for j in baseline if number in baseline[j]["reads"]), key=lambda j: baseline[j]["cpu"])
    if not readers:
        return []
    out = [readers[0]]
    short = [j for j in readers if baseline[j]["cpu"] <= max(LONG, baseline[readers[0]]["cpu"])]
    often = sorted(short, key=lambda j: (-baseline[j]["reads"][number], baseline[j]["cpu"]))
    commands = {JOBS[readers[0]].split()[0]}
    out += [j for j in often[:1] if j not in out]
    commands |= {JOBS[j].split()[0] for j in out}
    for j in sorted(short, key=lambda j: (JOBS[j].split()[0] in commands, baseline[j]["cpu"])):
        if j not in out:
            out.append(j)
    return out[:most]


def place_of(c: dict) -> str:
    """Where a constant stands, and its name: how lines of lists begin."""
    return f"{c['file']}:{c['line']} {c['name']}"


PAGE = "docs/tuning.md"
NO_ROW = "## Without a row"


def sections(page: str) -> dict:
    """Rows of the page by file."""
    out, file = {}, None
    for line in page[: page.index(NO_ROW)].splitlines():
        if found := re.fullmatch(r"\*\*(\S+\.rs)\*\*", line):
            file = found.group(1)
        elif file and re.match(r"\| [A-Z]", line):
            out.setdefault(file, []).append(line)
    return out


def starts(c: dict) -> list:
    """How a row of a constant begins."""
    return [f"| {c['name']}{mark} | {c['value'][:28]} |" for mark in ("", "†")]


def rowless(workspace: Path, constants: list) -> list:
    """The constants that the page lists as those without a row."""
    page = (workspace / PAGE).read_text()
    rows, named = sections(page), set()
    for file, names in re.findall(r"^\| (\S+\.rs) \| (.*) \|$", page[page.index(NO_ROW) :], re.M):
        named |= {(file, name.split()[0]) for name in names.split(", ")}

    def has_row(c: dict) -> bool:
        """Of two of one name in a file one may have a row."""
        return any(line.startswith(s) for line in rows.get(c["file"], []) for s in starts(c))

    return [c for c in constants if (c["file"], c["name"]) in named and not has_row(c)]


def vary(workspace: Path, work: Path, limit: float, most: int, factors: list, minutes: float, only: list) -> None:
    end = time.monotonic() + 60 * minutes
    runner = Runner(work, limit)
    constants = json.loads((work / "constants.json").read_text())
    for name in only:
        if name == "rowless":
            constants = rowless(workspace, constants)
        else:
            wanted = {" ".join(line.split()[:2]) for line in (work / f"{name}.txt").read_text().splitlines()}
            constants = [c for c in constants if place_of(c) in wanted]
    baseline = json.loads((work / "baseline.json").read_text())
    record = work / "runs.jsonl"
    known = [json.loads(line) for line in record.read_text().splitlines()] if record.exists() else []
    done = {(r["id"], r["factor"], r["job"]) for r in known}
    # What has not moved anything yet comes first.
    moved = {r["id"] for r in known if effect(r, baseline[r["job"]], limit)[1] not in ([], ["digits"])}
    plan = []
    for c in constants:
        if c["id"] is None or not c["uses"]:
            continue
        for rank, job in enumerate(chosen(str(c["id"]), baseline, most)):
            value = baseline[job]["values"][str(c["id"])]
            for factor in factors:
                unmoved = value == 0 or (c["kind"] == "usize" and value == 1 and factor < 1)
                if not unmoved and (c["id"], factor, job) not in done:
                    order = (rank, c["id"] in moved, factors.index(factor), baseline[job]["cpu"])
                    plan.append((*order, c["id"], factor, job))
    plan.sort()
    print(f"{len(plan)} runs, about {sum(p[3] for p in plan):.0f} s of the processor", flush=True)
    with record.open("a") as out:
        for k, (*_, number, factor, job) in enumerate(plan):
            if time.monotonic() > end:
                print(f"time is up after {k} of {len(plan)} runs")
                return
            told = runner.run(job, varied=f"{number}:{factor}")
            out.write(json.dumps({"id": number, "factor": factor, "job": job} | told) + "\n")
            out.flush()


# --------------------------------------------------------------------------------------------------------------- table

# Time of the processor that changes less than this is noise, and so is less than so many seconds.
QUIET, SHORT = 0.25, 0.15
# Bounds that change less than this share of their limit are told as digits.
DIGITS = 0.005


def effect(run: dict, base: dict, limit: float) -> tuple:
    """How bad a change is, below 0 if it is for the better, and in words; (0, []) if the report is the same."""
    if run["exit"] == "over":
        return 1000.0, [f"over {limit:.0f} s"]
    if run["exit"] not in (0, 3):
        return 900.0, ["refused" if run["exit"] == 2 else f"exit {run['exit']}"]
    words, harm = [], 0.0
    if run["exit"] != base["exit"]:
        words.append("not certified" if run["exit"] == 3 else "certified")
        harm += 500 if run["exit"] == 3 else -500
    covered = [r.get("coverage") or 0.0 for r in (base, run)]
    if abs(covered[1] - covered[0]) > 1e-4:
        words.append(f"coverage {100 * covered[0]:.1f}→{100 * covered[1]:.1f} %")
        harm += 300 * (covered[0] - covered[1])
    panels = [r.get("panels") or 0 for r in (base, run)]
    if panels[0] != panels[1]:
        words.append(f"panels {panels[0]}→{panels[1]}")
        harm += 100 * (panels[1] / max(panels[0], 1) - 1) if panels[1] else 400
    # Of fewer panels fewer seams are exact.
    seams = [(r.get("exact") or 0, r.get("seams") or 0) for r in (base, run)]
    if seams[0] != seams[1] and (panels[0] == panels[1] or seams[0][0] + seams[1][0] > 0):
        words.append(f"exact {seams[0][0]}/{seams[0][1]}→{seams[1][0]}/{seams[1][1]}")
        harm += 40 * (seams[0][0] / max(seams[0][1], 1) - seams[1][0] / max(seams[1][1], 1))
    old, new = base.get("bound"), run.get("bound")
    if (old is None) != (new is None):
        words.append("bound unknown" if new is None else "bound known")
        harm += 200 if new is None else -200
    elif old and new and abs(new - old) > DIGITS * (base.get("limit") or abs(old)):
        words.append(f"bound {100 * (new / old - 1):+.{0 if abs(new / old - 1) > 0.01 else 1}f} %")
        harm += 20 * min((new - old) / (base.get("limit") or abs(old)), 2.0)
    slower = run["cpu"] / max(base["cpu"], 1e-3) - 1
    if abs(slower) > max(QUIET, 2 * base["noise"]) and abs(run["cpu"] - base["cpu"]) > SHORT:
        words.append(f"cpu {100 * slower:+.0f} %")
        harm += 10 * min(slower, 10.0)
    if not words and run.get("hash") != base.get("hash"):
        words, harm = ["digits"], 0.01
    return harm, words


def first_sentence(doc: str, most: int = 90) -> str:
    sentence = re.split(r"(?<=[.:;])\s", doc, maxsplit=1)[0].replace("|", "\\|")
    return sentence if len(sentence) <= most else sentence[:most].rsplit(" ", 1)[0] + " …"


def cell(told: list) -> tuple:
    """The worst of (harm, words, job), in words, and its harm; the best if nothing is worse."""
    if not told:
        return 0.0, "—"
    changed = [t for t in told if t[1]]
    if not changed:
        return 0.0, "nothing"
    worst = max(changed, key=lambda t: t[0])
    if worst[0] < 0.1:
        worst = min(changed, key=lambda t: t[0])
    if worst[1] == ["digits"]:
        return 0.01, "digits"
    return worst[0], f"{', '.join(worst[1])} ({worst[2]}, {len(changed)} of {len(told)})"


HEAD = ["| constant | value | what | at half | at double | far off |", "|---|---|---|---|---|---|"]


def effects(work: Path, baseline: dict, limit: float) -> dict:
    """What came of all runs, by constant and factor."""
    runs = {}
    for r in map(json.loads, (work / "runs.jsonl").read_text().splitlines()):
        runs.setdefault((r["id"], r["factor"]), []).append((*effect(r, baseline[r["job"]], limit), r["job"]))
    return runs


def of_one(c: dict, runs: dict, factors: list) -> tuple:
    """What came of one constant: by factor, and with all other factors."""
    told = {factor: runs.get((c["id"], factor), []) for factor in sorted(factors)}
    others = ((factor, those) for (number, factor), those in runs.items() if number == c["id"] and factor not in told)
    return told, [(harm, words, f"×{factor:g} {job}") for factor, those in others for harm, words, job in those]


def row(c: dict, told: dict, far: list, newer: str = "") -> str:
    cells = [cell(those)[1] for those in [*told.values(), far]]
    return f"{starts(c)[c['partly']][:-2]}{newer} | {first_sentence(c['doc'])} | {' | '.join(cells)} |"


def job_row(job: str, b: dict) -> str:
    bound = "—" if b.get("bound") is None else f"{b['bound']:.4g}"
    bound += f" / {b['limit']:g}" if b.get("limit") else ""
    command = re.sub(r"\{(data|made|base)\}/", "", JOBS.get(job, ""))
    return (f"| {job} | `{command}` | {b['exit']} | {b.get('panels', '—')} | {bound} | "
            f"{b.get('exact', 0)}/{b.get('seams', 0)} | {b['cpu']:.2f} | {len(b['reads'])} |")


def page(workspace: Path, work: Path, limit: float, factors: list) -> None:
    """Rows for constants and jobs that the page has none for, marked as newer, in the order of the sources."""
    constants = json.loads((work / "constants.json").read_text())
    baseline = json.loads((work / "baseline.json").read_text())
    runs = effects(work, baseline, limit)
    text = (workspace / PAGE).read_text()
    rows, found = sections(text), 0
    place = {start: k for k, c in enumerate(constants) for start in [c["file"] + s for s in starts(c)]}
    for c in rowless(workspace, constants):
        told, far = of_one(c, runs, factors)
        if not any(told.values()):
            continue
        own = rows.setdefault(c["file"], [])
        later = [k for k, line in enumerate(own)
                 if any(place[s] > constants.index(c) for s in place if (c["file"] + line).startswith(s))]
        own.insert(later[0] if later else len(own), row(c, told, far, " ‡"))
        names = re.compile(rf"^(\| {re.escape(c['file'])} \|.*?) {c['name']}(?: \(since\))?(?:, | (?=\|))", re.M)
        text = names.sub(r"\1 ", text)
        found += 1
    text = re.sub(r"^\| \S+\.rs \| +\|\n", "", text, flags=re.M)
    text = re.sub(r"^(\| \S+\.rs \| .*), \|$", r"\1 |", text, flags=re.M)
    jobs = [job_row(job, b) for job, b in baseline.items() if f"\n| {job} |" not in text]
    lines, file = [], None
    for name in dict.fromkeys(c["file"] for c in constants):
        if name in rows:
            if file is None or Path(name).parent != Path(file).parent:
                lines += [f"## {Path(name).parent}", ""]
            file = name
            lines += [f"**{file}**", "", *HEAD, *rows[file], ""]
    first = re.search(r"^## ", text, re.M).start()
    text = text[:first].rstrip() + "\n".join(["", *jobs, "", *lines, ""]) + text[text.index(NO_ROW) :]
    (workspace / PAGE).write_text(text)
    print(f"{found} rows")


def table(work: Path, limit: float, factors: list) -> None:
    constants = json.loads((work / "constants.json").read_text())
    baseline = json.loads((work / "baseline.json").read_text())
    runs = effects(work, baseline, limit)
    read = {number for b in baseline.values() for number in b["reads"]}
    scalar = [c for c in constants if c["id"] is not None]
    rows, file = [], None
    lists = {"nothing": [], "idle": [], "digits": [], "unread": [], "better": [], "worse": []}
    for c in (c for c in scalar if c["uses"]):
        place = f"{place_of(c)} {c['value']}"
        if str(c["id"]) not in read:
            lists["unread"].append(place)
            continue
        told, far = of_one(c, runs, factors)
        cells = {factor: cell(those) for factor, those in told.items()}
        everything = [t for those in told.values() for t in those]
        if everything and not any(t[1] for t in everything):
            lists["nothing"].append(f"{place}  ({len(everything)} runs)")
            if far and not any(t[1] for t in far):
                lists["idle"].append(place)
        elif everything and all(words in ([], ["digits"]) for _, words, _ in everything):
            lists["digits"].append(place)
        for factor, those in told.items():
            gains = [t for t in those if t[0] < -0.5]
            if gains and all(harm < 0.5 for harm, _, _ in those):
                words = "; ".join(f"{job}: {', '.join(w)}" for _, w, job in gains)
                text = f"×{factor:g} {place}: {words} ({len(those)} jobs ran)"
                lists["better"].append((sum(t[0] for t in gains), text))
            lists["worse"].append((-cells[factor][0], f"×{factor:g} {place}: {cells[factor][1]}"))
        if c["file"] != file:
            if file is None or Path(c["file"]).parent != Path(file).parent:
                rows += ["", f"## {Path(c['file']).parent}"]
            file = c["file"]
            rows += ["", f"**{file}**", ""]
            rows += HEAD
        rows.append(row(c, told, far))
    fixed = sum(not c["uses"] for c in scalar)
    found = sum(str(c["id"]) in read for c in scalar)
    summary = (
        f"{len(constants)} constants, {len(scalar)} of them of numbers. Of these {fixed} stand in constant expressions "
        f"only or cannot be varied, {len(lists['unread'])} are read by no job, and {found} are read: of those that ran, "
        f"{len(lists['nothing'])} change nothing at half and at double ({len(lists['idle'])} of them nothing far off "
        f"either), {len(lists['digits'])} only digits."
    )
    head = [
        "# What the constants do", "", summary, "",
        "Cells tell the worst over the jobs that ran: which, and in how many of them anything changed. `digits`: the "
        "report changes, but not the status, panels, seams, nor the bound by half a per cent of its limit. `far off`: at "
        "a thousandth and a thousand times the value, of what half and double leave alone. `—`: not varied, or not run. "
        "`†`: not varied where the length of an array or another constant is made of it.",
        "", "| job | command | exit | panels | bound / limit | exact seams | cpu-s | reads |",
        "|---|---|---|---|---|---|---|---|",
    ]
    head += [job_row(job, b) for job, b in baseline.items()]
    (work / "tuning.md").write_text("\n".join(head + rows) + "\n")
    for name, lines in lists.items():
        texts = [text for _, text in sorted(lines)] if lines and isinstance(lines[0], tuple) else lines
        (work / f"{name}.txt").write_text("".join(f"{text}\n" for text in texts))
    print(summary)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=Path, help="folder for the copy and the results")
    parser.add_argument("--workspace", type=Path, default=Path(__file__).resolve().parent.parent, help="the project")
    parser.add_argument("--stage", choices=["all", "build", "trace", "vary", "table", "page"], default="all")
    parser.add_argument("--jobs", type=int, default=3, help="at most so many jobs for each constant and factor")
    parser.add_argument("--factors", type=float, nargs="+", default=[2.0, 0.5])
    parser.add_argument("--only", nargs="+", default=[], help="a list that `table` wrote, such as nothing; or rowless")
    parser.add_argument("--minutes", type=float, default=60.0, help="how long to vary")
    parser.add_argument("--limit", type=float, default=20.0, help="seconds of the processor for one run")
    given = parser.parse_args()
    given.work.mkdir(parents=True, exist_ok=True)
    work = given.work.resolve()
    if given.stage in ("all", "build"):
        build(given.workspace.resolve(), work)
    if given.stage in ("all", "trace"):
        trace(work, given.limit)
    if given.stage in ("all", "vary"):
        vary(given.workspace.resolve(), work, given.limit, given.jobs, given.factors, given.minutes, given.only)
    if given.stage in ("all", "table"):
        table(work, given.limit, given.factors)
    if given.stage == "page":
        page(given.workspace.resolve(), work, given.limit, given.factors)


if __name__ == "__main__":
    main()
