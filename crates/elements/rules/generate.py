"""Writes the quadrature rules of this folder: `python generate.py` (needs mpmath only; same digits on every machine).

Each rule is either a closed form, a product of Gauss rules, or the root of its own moment equations: the exact
integrals of all monomials up to the degree, solved for orbit parameters and weights by Gauss-Newton in 60 digits from
a short guess.
The guess picks the root and carries no accuracy; the printed digits come from the equations.
Before writing, every rule is checked again in 60 digits: all monomials up to its degree, none of them left out, and
at least one of the next degree that it misses, so that the stated degree is sharp.

Cells: edge [-1, 1]; unit simplices; [-1, 1]^d; prism = unit triangle x [-1, 1]; pyramid with base [-1, 1]^2 at
zeta = 0 and apex at zeta = 1.
"""

from itertools import permutations, product
from pathlib import Path

from mpmath import mp, mpf, factorial, matrix, lu_solve, norm, nstr, polyroots, sqrt

mp.dps = 60
PRINTED_DIGITS = 25
FOLDER = Path(__file__).parent
DIMENSION = {"edge": 1, "triangle": 2, "quadrangle": 2, "tetrahedron": 3, "hexahedron": 3, "prism": 3, "pyramid": 3}


# Exact integrals over the reference cells.


def line(i):
    """Integral of x^i over [-1, 1]."""
    return mpf(2) / (i + 1) if i % 2 == 0 else mpf(0)


def beta(i, j):
    """Integral of x^i (1 - x)^j over [0, 1]."""
    return factorial(i) * factorial(j) / factorial(i + j + 1)


def moment(family, e):
    """Integral of the monomial with exponents e over the reference cell."""
    if family in ("edge", "quadrangle", "hexahedron"):
        value = mpf(1)
        for i in e:
            value *= line(i)
        return value
    if family in ("triangle", "tetrahedron"):
        value = mpf(1)
        for i in e:
            value *= factorial(i)
        return value / factorial(sum(e) + len(e))
    if family == "prism":
        return moment("triangle", e[:2]) * line(e[2])
    # xi = u w, eta = v w, w = 1 - zeta, d(xi, eta, zeta) = w^2 d(u, v, zeta).
    return line(e[0]) * line(e[1]) * beta(e[2], e[0] + e[1] + 2)


def monomials(dimension, degree):
    """Exponents of all monomials up to this total degree."""
    return [e for e in product(range(degree + 1), repeat=dimension) if sum(e) <= degree]


def applied(rule, e):
    """The rule's value for a monomial."""
    total = mpf(0)
    for point, weight in rule:
        term = weight
        for x, i in zip(point, e):
            term *= x**i
        total += term
    return total


# Gauss rules on intervals.


def gauss_legendre(n):
    """Gauss rule on [-1, 1] with weight 1: roots of P_n, w = 2 / ((1 - x^2) P_n'(x)^2)."""
    coefficients = [
        (-1) ** k * factorial(2 * n - 2 * k) / (2**n * factorial(k) * factorial(n - k) * factorial(n - 2 * k))
        for k in range(n // 2 + 1)
    ]
    dense = [mpf(0)] * (n + 1)
    for k, c in enumerate(coefficients):
        dense[2 * k] = c  # highest power first
    derivative = [c * (n - i) for i, c in enumerate(dense[:-1])]
    rule = []
    for x in sorted(polyroots(dense, maxsteps=200, extraprec=200)):
        x = mpf(0) if abs(x) < mpf(10) ** -50 else x.real
        slope = mpf(0)
        for c in derivative:
            slope = slope * x + c
        rule.append(((x,), 2 / ((1 - x**2) * slope**2)))
    return rule


def gauss_jacobi_apex(n):
    """Gauss rule on [0, 1] with weight (1 - x)^2, the measure of a pyramid's slices.

    The orthogonal polynomial of degree n follows from its moments, the weights from the moment equations.
    """
    m = [beta(i, 2) for i in range(2 * n)]
    lower = matrix(n, n)
    right = matrix(n, 1)
    for i in range(n):
        right[i] = -m[i + n]
        for j in range(n):
            lower[i, j] = m[i + j]
    c = lu_solve(lower, right)
    roots = sorted(r.real for r in polyroots([mpf(1)] + [c[i] for i in reversed(range(n))], maxsteps=200, extraprec=200))
    vandermonde = matrix(n, n)
    for i in range(n):
        for j in range(n):
            vandermonde[i, j] = roots[j] ** i
    w = lu_solve(vandermonde, matrix(m[:n]))
    return [((roots[i],), w[i]) for i in range(n)]


def times(first, second):
    """Product rule; the first factor's points vary fastest."""
    return [(p + q, a * b) for q, b in second for p, a in first]


def collapsed(n, along):
    """Pyramid: n x n Gauss-Legendre points in (u, v) on each of `along` slices, shrunk towards the apex."""
    square = times(gauss_legendre(n), gauss_legendre(n))
    return [
        ((u * (1 - z), v * (1 - z), z), weight * slice_weight)
        for (z,), slice_weight in gauss_jacobi_apex(along)
        for (u, v), weight in square
    ]


# Symmetric rules on simplices: orbits of barycentric coordinates.


def orbit(barycentric):
    """Distinct permutations of barycentric coordinates, as reference points (the first coordinate is dropped)."""
    seen = []
    for p in permutations(range(len(barycentric))):
        point = tuple(barycentric[i] for i in p)
        if all(max(abs(x - y) for x, y in zip(point, q)) > mpf(10) ** -6 for q in seen):
            seen.append(point)
    return [q[1:] for q in seen]


# What an orbit's parameters mean, per letter pattern: equal letters are equal coordinates, which sum to one.
PATTERNS = {
    "aab": lambda a: (a, a, 1 - 2 * a),
    "abc": lambda a, b: (a, b, 1 - a - b),
    "aaab": lambda a: (a, a, a, 1 - 3 * a),
    "aabb": lambda a: (a, a, (1 - 2 * a) / 2, (1 - 2 * a) / 2),
    "aabc": lambda a, b: (a, a, b, 1 - 2 * a - b),
}


def solved(family, degree, orbits):
    """Gauss-Newton on the moment equations; `orbits` lists (pattern, guessed parameters, guessed weight)."""
    exponents = monomials(DIMENSION[family], degree)
    exact = [moment(family, e) for e in exponents]

    def expand(x):
        rule, at = [], 0
        for pattern, parameters, _ in orbits:
            n = len(parameters)
            points = orbit(PATTERNS[pattern](*x[at : at + n]))
            rule += [(p, x[at + n]) for p in points]
            at += n + 1
        return rule

    def residual(x):
        rule = expand(x)
        return matrix([applied(rule, e) - m for e, m in zip(exponents, exact)])

    x = [mpf(value) for _, parameters, weight in orbits for value in (*parameters, weight)]
    step = mpf(10) ** -30
    for _ in range(50):
        r = residual(x)
        if norm(r, mp.inf) < mpf(10) ** -50:
            return expand(x)
        jacobian = matrix(len(exponents), len(x))
        for j in range(len(x)):
            moved = list(x)
            moved[j] += step
            column = (residual(moved) - r) / step
            for i in range(len(exponents)):
                jacobian[i, j] = column[i]
        delta = lu_solve(jacobian, -r)  # least squares: the equations outnumber the unknowns but agree
        x = [a + delta[j] for j, a in enumerate(x)]
    raise SystemExit(f"{family}, degree {degree}: no convergence from the guess, residual {nstr(norm(r, mp.inf), 5)}")


# The rules.


def triangle(count):
    third = mpf(1) / 3
    if count == 1:
        return [((third, third), mpf(1) / 2)]
    if count == 3:
        return [(p, mpf(1) / 6) for p in orbit((mpf(1) / 6, mpf(1) / 6, mpf(2) / 3))]
    if count == 6:
        return solved("triangle", 4, [("aab", ["0.446"], "0.112"), ("aab", ["0.0916"], "0.055")])
    if count == 7:
        a, b = (6 - sqrt(15)) / 21, (6 + sqrt(15)) / 21
        rule = [((third, third), mpf(9) / 80)]
        rule += [(p, (155 - sqrt(15)) / 2400) for p in orbit((a, a, 1 - 2 * a))]
        rule += [(p, (155 + sqrt(15)) / 2400) for p in orbit((b, b, 1 - 2 * b))]
        return rule
    return solved(
        "triangle", 6, [("aab", ["0.063"], "0.025"), ("aab", ["0.249"], "0.058"), ("abc", ["0.053", "0.310"], "0.041")]
    )


def tetrahedron(count):
    if count == 1:
        return [((mpf(1) / 4,) * 3, mpf(1) / 6)]
    if count == 4:
        a = (5 - sqrt(5)) / 20
        return [(p, mpf(1) / 24) for p in orbit((a, a, a, 1 - 3 * a))]
    if count == 14:
        return solved(
            "tetrahedron",
            5,
            [("aaab", ["0.0927"], "0.0122"), ("aaab", ["0.311"], "0.0188"), ("aabb", ["0.0455"], "0.0071")],
        )
    return solved(
        "tetrahedron",
        6,
        [
            ("aaab", ["0.2146"], "0.00665"),
            ("aaab", ["0.0407"], "0.00168"),
            ("aaab", ["0.3223"], "0.00923"),
            ("aabc", ["0.0637", "0.2697"], "0.00804"),
        ],
    )


def pyramid_5():
    """Four points (+-a, +-a, 1/6) and one on the axis.

    The moments of 1, zeta, zeta^2, xi^2 leave one parameter free; it is spent on xi^2 zeta, which makes all but
    the root rational: a^2 = 32/135, weights 9/32 and 5/24, the last point at 7/10.
    """
    a = sqrt(mpf(32) / 135)
    rule = [((x * a, y * a, mpf(1) / 6), mpf(9) / 32) for y in (-1, 1) for x in (-1, 1)]
    return rule + [((mpf(0), mpf(0), mpf(7) / 10), mpf(5) / 24)]


GAUSS = "Gauss-Legendre"
RULES = [
    ("edge", 1, GAUSS, gauss_legendre(1)),
    ("edge", 3, GAUSS, gauss_legendre(2)),
    ("edge", 5, GAUSS, gauss_legendre(3)),
    ("edge", 7, GAUSS, gauss_legendre(4)),
    ("triangle", 1, "centroid", triangle(1)),
    ("triangle", 2, "Strang and Fix 1973, interior points; closed form", triangle(3)),
    ("triangle", 4, "orbits of Dunavant 1985; moment equations", triangle(6)),
    ("triangle", 5, "Radon 1948; closed form", triangle(7)),
    ("triangle", 6, "orbits of Dunavant 1985; moment equations", triangle(12)),
    ("tetrahedron", 1, "centroid", tetrahedron(1)),
    ("tetrahedron", 2, "Hammer and Stroud 1956; closed form", tetrahedron(4)),
    ("tetrahedron", 5, "orbits of Grundmann and Moeller 1978; moment equations", tetrahedron(14)),
    ("tetrahedron", 6, "orbits of Keast 1986; moment equations", tetrahedron(24)),
    ("pyramid", 1, "Gauss-Legendre 2 x 2 on the slice of the Gauss-Jacobi point, collapsed", collapsed(2, 1)),
    ("pyramid", 2, "moment equations; closed form", pyramid_5()),
    ("pyramid", 3, "Gauss-Legendre 2 x 2 on 2 Gauss-Jacobi slices, collapsed", collapsed(2, 2)),
    ("pyramid", 3, "Gauss-Legendre 3 x 3 on 2 Gauss-Jacobi slices, collapsed", collapsed(3, 2)),
    ("pyramid", 5, "Gauss-Legendre 3 x 3 on 3 Gauss-Jacobi slices, collapsed", collapsed(3, 3)),
]
for n in (1, 2, 3):
    g = gauss_legendre(n)
    RULES.append(("quadrangle", 2 * n - 1, f"{GAUSS}, {n} x {n}", times(g, g)))
    RULES.append(("hexahedron", 2 * n - 1, f"{GAUSS}, {n} x {n} x {n}", times(times(g, g), g)))
for degree, flat, along in ((1, 1, 2), (2, 3, 2), (2, 3, 3), (4, 6, 3)):
    source = f"triangle-{flat} x {GAUSS} {along}"
    RULES.append(("prism", degree, source, times(triangle(flat), gauss_legendre(along))))

NOTES = {
    "hexahedron-1": [
        "On a hexahedron one point sees none of the hourglass modes (u proportional to xi eta, eta zeta, zeta xi or",
        "xi eta zeta: 12 of them), which then deform without energy: use it with hourglass control.",
        "Opposite faces must be parallel for the patch test to pass.",
    ],
    "quadrangle-1": [
        "On a quadrangle one point sees neither of the two hourglass modes (u proportional to xi eta), which then",
        "deform without energy: use it with hourglass control.",
    ],
    "pyramid-4": [
        "In (u, v) = (xi, eta) / (1 - zeta) the forces of the 5-node pyramid depend on u and v only, so that this rule",
        "gives the same ones as 2 x 2 x 2 points.",
    ],
}


def check(family, degree, rule):
    """All monomials up to the degree to 1e-45, and not all of the next."""
    d = DIMENSION[family]
    error = lambda e: abs(applied(rule, e) - moment(family, e))
    worst = max(error(e) for e in monomials(d, degree))
    if worst > mpf(10) ** -45:
        raise SystemExit(f"{family}-{len(rule)}: error {nstr(worst, 5)} below degree {degree}")
    if max(error(e) for e in monomials(d, degree + 1)) < mpf(10) ** -6:
        raise SystemExit(f"{family}-{len(rule)}: degree {degree} is not sharp")
    if min(weight for _, weight in rule) <= 0:
        raise SystemExit(f"{family}-{len(rule)}: a weight is not positive")


def printed(x):
    text = nstr(x, PRINTED_DIGITS, strip_zeros=False, min_fixed=-10, max_fixed=10) if x != 0 else "0.0"
    return text.rjust(PRINTED_DIGITS + 6)


for family, degree, source, rule in RULES:
    check(family, degree, rule)
    name = f"{family}-{len(rule)}"
    lines = ["# Written by generate.py; do not edit."]
    lines += [f"# {note}" for note in NOTES.get(name, [])]
    lines += [f"family {family}", f"degree {degree}", f"source {source}"]
    lines += ["".join(printed(x) for x in (*point, weight)) for point, weight in rule]
    (FOLDER / f"{name}.rule").write_text("\n".join(lines) + "\n")
    print(f"{name}: degree {degree}")
