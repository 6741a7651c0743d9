#!/usr/bin/env python3
"""Prints the tables of docs/validation.md about the first thesis' measurements from a database of campaigns.

    souple campaign run campaigns/bending --jobs 2 --db campaign.db
    python3 tools/thesis_tables.py campaign.db bending        # any group of campaigns/, by its name

Of several databases with the same group, times are medians; everything else must be the same in all of them and is
printed once:

    for i in 1 2 3; do souple campaign run campaigns/time_per_element --jobs 1 --threads 1 --db $i.db; done
    python3 tools/thesis_tables.py 1.db 2.db 3.db "time per element"

Bending: the deflection curve of a bar is the mean vertical displacement of the nodes of each section. Its mean distance
from

    Bernoulli   y(x) = -rho g/(2 E H^2) (6 L^2 x^2 - 4 L x^3 + x^4)           [m]
    continuum   the curve of CalculiX with 3072 hex20, whose end is within 2e-6 m of the three-dimensional solution

is the mean over all sections between cells, both ends included. The continuum is interpolated as Bernoulli plus the
difference, which is smooth, piecewise linearly.

Torsion: distances between nodes on five lines along the bar, at the sections of both meshes.
"""

import math
import re
import sqlite3
import statistics
import sys
from pathlib import Path

CAMPAIGN = Path(__file__).resolve().parent.parent / "campaigns" / "bending"
LENGTH, HEIGHT, DENSITY, YOUNG, GRAVITY = 8.0, 1.0, 1000.0, 1e8, 9.81
# Table 6.6 of the thesis: mean distances from Bernoulli [m] by number of elements.
THESIS = {
    "hex8": [0.0007906, 0.0006380, 0.0005798, 0.0004615],
    "prism6": [0.0012905, 0.0012286, 0.0011668, 0.0010429],
    "pyramid5": [0.0053035, 0.0043081, 0.0033639, 0.0032380],
    "tet4": [0.0446796, 0.0323418, 0.0202163, 0.0105572],
}


def bernoulli(x):
    scale = -DENSITY * GRAVITY / (2 * YOUNG * HEIGHT**2)
    return scale * (6 * LENGTH**2 * x**2 - 4 * LENGTH * x**3 + x**4)


def sections(curve):
    """Rest position and displacement of each section; sections are at equal distances."""
    return [(LENGTH * i / (len(curve) - 1), u) for i, u in enumerate(curve)]


def mean_distance(curve, of):
    return sum(abs(u - of(x)) for x, u in sections(curve)) / len(curve)


def references():
    """{(element, cells): displacements}"""
    found = {}
    for line in (CAMPAIGN / "reference.csv").read_text().splitlines():
        if not line.startswith("#"):
            element, cells, _mean, *values = line.split(",")
            found[element, cells] = [float(v) for v in values]
    return found


def continuum(reference):
    extra = [u - bernoulli(x) for x, u in sections(reference)]

    def at(x):
        place = x / LENGTH * (len(extra) - 1)
        i = min(int(place), len(extra) - 2)
        return bernoulli(x) + extra[i] + (place - i) * (extra[i + 1] - extra[i])

    return at


class Run:
    """One simulation of a group."""

    def __init__(self, base, case, values, simulation, status, reason):
        self.base, self.case, self.values = base, case, values
        self.simulation, self.status, self.reason = simulation, status, reason
        self.elements = self.one("SELECT SUM(count) FROM element_counts WHERE simulation_id = ?")
        # The same simulation in every database that was given, itself included.
        self.repetitions = [self]

    def one(self, sql, *more):
        row = self.base.execute(sql, [self.simulation, *more]).fetchone()
        return row[0] if row else None

    def ms(self, phase):
        """The median over all repetitions, in ms."""
        times = [run.own_ms(phase) for run in self.repetitions]
        return None if None in times else statistics.median(times)

    def own_ms(self, phase):
        return self.one("SELECT ms_per_step FROM timings WHERE simulation_id = ? AND phase = ?", phase)

    def measured(self, probe, quantity, component=""):
        sql = "SELECT value FROM measurements WHERE simulation_id = ? AND probe = ? AND quantity = ? AND component = ?"
        return self.one(sql, probe, quantity, component)

    def curve(self, probe):
        sql = """SELECT x, y, z FROM points JOIN curves ON curves.id = curve_id
                 WHERE simulation_id = ? AND probe = ? ORDER BY position"""
        return self.base.execute(sql, [self.simulation, probe]).fetchall()


def runs(path, name):
    """The simulations of the newest group of this name, in its order."""
    if not Path(path).is_file():
        sys.exit(f"there is no database {path}; say which one, after: souple campaign run FOLDER --db {path}")
    base = sqlite3.connect(path)
    newest = base.execute("SELECT MAX(id) FROM groups WHERE name = ?", [name]).fetchone()[0]
    if newest is None:
        sys.exit(f'{path} has no group "{name}"; see: souple campaign list --db {path}')
    found = []
    for number, *simulation in base.execute(
        """SELECT m.number, s.id, s.status, s.reason FROM members m LEFT JOIN simulations s ON s.hash = m.hash
           WHERE m.group_id = ? ORDER BY m.number""",
        [newest],
    ).fetchall():
        sql = """SELECT p.name, v.value FROM member_values v JOIN parameters p ON p.id = v.parameter_id
                 WHERE v.group_id = ? AND v.number = ?"""
        values = dict(base.execute(sql, [newest, number]).fetchall())
        case = values.pop("case").strip('"')
        if simulation[1] not in ("finished", "at rest", "invalid"):
            sys.exit(f"{case} is {simulation[1] or 'to do'}; run the campaign again, it goes on where it was")
        found.append(Run(base, case, values, *simulation))
    return found


def table(heads, rows):
    print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def metres(x):
    return "–" if x is None else f"{x:.7f}"


def bending(found):
    reference = references()
    exact = continuum(reference["hex20", "48x8x8"])
    seen, rows, times, worst, largest = {}, [], [], 0.0, 0.0
    for run in found:
        element, cells = run.case.rsplit(" ", 1)
        seen[element] = seen.get(element, -1) + 1
        thesis = THESIS[element][seen[element]] if element in THESIS else None
        heights = [y for _, y, _ in run.curve("axis")]
        # Nodes in the middle of cells, which some elements have, are left out.
        stride = (len(heights) - 1) // int(cells.split("x")[0])
        curve = [y - HEIGHT / 2 for y in heights[::stride]]
        other = reference.get((element, cells))
        if other:
            worst = max([worst] + [abs(a - b) for a, b in zip(curve, other, strict=True)])
            largest = max(largest, abs(curve[-1] - other[-1]) / abs(other[-1]))
        near, far = mean_distance(curve, exact), mean_distance(curve, bernoulli)
        others = mean_distance(other, bernoulli) if other else None
        rows.append([f"{run.elements} {element}", cells, *map(metres, [thesis, far, others, near, curve[-1]])])
        times.append([f"{run.elements} {element}", cells, f"{run.ms('step') / 1000:.2f}", f"{near:.1e}"])
    table(["elements", "cells", "thesis", "Souple", "CalculiX", "Souple from the continuum", "end"], rows)
    print(f"\nLargest difference of a section from the same mesh: {worst:.1e} m; of the end: {largest:.1e} of it")
    print(f"Distance of the continuum from Bernoulli: {metres(mean_distance(reference['hex20', '48x8x8'], bernoulli))} m\n")
    table(["elements", "cells", "seconds", "mean distance from the continuum [m]"], times)


def mixed(found):
    exact = continuum(references()["hex20", "48x8x8"])
    rows = []
    for run in found:
        # Sections with a layer of pyramids have nodes between the cells; curves are compared at the nodes' own rest
        # positions only where those are at equal distances, so here it is the end.
        end = run.measured("end", "mean displacement", "y")
        off = end - exact(LENGTH)
        rows.append([run.case, str(run.elements), metres(end), f"{off:.5f}", f"{abs(off) / LENGTH * 1000:.2f} : 1000"])
    table(["bar", "elements", "end [m]", "from the continuum [m]", "by length"], rows)


def explicit(found):
    rows = []
    for combination in dict.fromkeys(tuple(run.values.items()) for run in found):
        own = [run for run in found if tuple(run.values.items()) == combination]
        kinds = {kind: [r for r in own if r.case.startswith(kind)] for kind in ("explicit", "implicit")}
        limits = [re.search(r"critical step of (\S+) s", r.reason) for r in kinds["explicit"] if r.status == "invalid"]
        limit = limits[0].group(1) if limits else "–"
        row = [value for _, value in combination] + [limit]
        for kind in kinds.values():
            done = [r for r in kind if r.status != "invalid"]
            step = max(float(r.case.split()[1]) for r in done)
            ms = sorted(r.ms("step") for r in done)[len(done) // 2]
            row += [f"{step:g}", f"{ms:.2f}", f"{math.ceil(0.9 / step) * ms / 1000:.3f}"]
        reached = [[r.measured("middle of an edge", "mean displacement", c) for c in "xyz"] for r in own if r.status != "invalid"]
        centre = [sum(p[i] for p in reached) / len(reached) for i in range(3)]
        row.append(f"{max(math.dist(p, centre) for p in reached):.1e}")
        rows.append(row)
    table(
        ["density", "Young", "critical step [s]", "explicit: largest step [s]", "ms per step", "0.9 s take [s]"]
        + ["implicit: largest step [s]", "ms per step", "0.9 s take [s]", "final states differ by [m]"],
        rows,
    )


def torsion(found):
    lines = ["edge", "next edge", "middle of a face", "middle of the next face", "axis"]
    reference = {line: found[0].curve(line) for line in lines}
    rows = []
    for run in found[1:]:
        distances = []
        for line in lines:
            curve, finest = run.curve(line), reference[line]
            # Both have a node in every section of the coarser one; the clamped and the turned end agree by prescription.
            coarse, fine = sorted([curve, finest], key=len)
            stride, rest = divmod(len(fine) - 1, len(coarse) - 1)
            if rest:
                sys.exit(f"{run.case}: {len(coarse)} and {len(fine)} nodes along {line} do not share their sections")
            distances += [math.dist(p, fine[i * stride]) for i, p in enumerate(coarse)][1:-1]
        mean = sum(distances) / len(distances)
        energy = run.measured("all", "strain energy")
        rows.append([run.case, str(run.elements), f"{energy:.0f}", *(f"{x:.2e}" for x in (mean, max(distances), min(distances)))])
    table(["bar", "elements", "strain energy [J]", "mean [m]", "largest [m]", "smallest [m]"], rows)


def time_per_element(found):
    rows = []
    for run in found:
        tangent, force = run.ms("linearise"), run.ms("force")
        per = [f"{ms * 1000 / run.elements:.2f}" for ms in (force, tangent)]
        end = run.measured("end", "mean displacement", "y")
        rows.append([run.case, str(run.elements), *per, f"{run.ms('step'):.1f}", metres(end)])
    table(["element", "elements", "force [µs each]", "tangent [µs each]", "step [ms]", "end at 3 s [m]"], rows)


TABLES = {
    "bending": bending,
    "explicit against implicit": explicit,
    "mixed bars": mixed,
    "torsion": torsion,
    "time per element": time_per_element,
}


def repeated(paths, name):
    """The simulations of the first database, each with its counterparts in the others."""
    first, *others = [runs(path, name) for path in paths]
    results = """SELECT probe, quantity, component, value FROM measurements WHERE simulation_id = ?
                 ORDER BY probe, quantity, component"""
    for path, other in zip(paths[1:], others):
        if [run.case for run in other] != [run.case for run in first]:
            sys.exit(f"{path} has other cases than {paths[0]}; both must be of one description")
        for run, again in zip(first, other):
            if again.base.execute(results, [again.simulation]).fetchall() != run.base.execute(results, [run.simulation]).fetchall():
                sys.exit(f"{path} has other results of {run.case} than {paths[0]}; both must be of one program and processor")
            run.repetitions.append(again)
    return first


def main():
    if len(sys.argv) < 3 or sys.argv[-1] not in TABLES:
        sys.exit(f"{__doc__}\nGroups: {', '.join(TABLES)}")
    TABLES[sys.argv[-1]](repeated(sys.argv[1:-1], sys.argv[-1]))


if __name__ == "__main__":
    main()
