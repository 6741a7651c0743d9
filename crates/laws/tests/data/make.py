"""Prints the energies and stresses that stresses.txt holds for the laws that have no other source.

Each law's first Piola-Kirchhoff stress is written here by hand as a formula of tensors: no automatic derivative and no
code of the program is involved. 40 digits; needs mpmath. Usage: python3 make.py > more.txt
"""

from mpmath import det, eigsy, exp, eye, inverse, log, matrix, mp, mpf, sqrt

mp.dps = 40
LAM, MU = mpf(10) ** 5 * 3 / 10 / (mpf(13) / 10 * mpf(4) / 10), mpf(10) ** 6 / 26

CASES = {
    "moderate": ["1.2 0.15 -0.1", "0.05 0.9 0.2", "-0.1 0.1 1.1"],
    "simple_shear": ["1 0.4 0", "0 1 0", "0 0 1"],
    "uniaxial_iso": ["1.25 0 0", "0 0.95 0", "0 0 0.95"],
    "crushed": ["0.4 0.1 0", "0 1.1 -0.2", "0.1 0 0.6"],
    "volumetric": ["1.3 0 0", "0 1.3 0", "0 0 1.3"],
    "inverted": ["-0.5 0.1 0.2", "0 1.1 -0.2", "0.1 0 0.9"],
}


def trace(A):
    return A[0, 0] + A[1, 1] + A[2, 2]


def green(F):
    return (F.T * F - eye(3)) / 2


def cofactors(F):
    return det(F) * inverse(F).T


def volumetric(F, bulk):
    J = det(F)
    return bulk / 2 * (J - 1) ** 2, bulk * (J - 1) * cofactors(F)


def stable_neo_hookean(F, young, poisson):
    m, l = 4 * MU / 3, LAM + 5 * MU / 6
    I1, J = trace(F.T * F), det(F)
    alpha = 1 + m / l - m / (4 * l)
    # The published form; its value at rest is subtracted.
    published = lambda I1, J: m / 2 * (I1 - 3) + l / 2 * (J - alpha) ** 2 - m / 2 * log(I1 + 1)
    stress = m * (1 - 1 / (I1 + 1)) * F + l * (J - alpha) * cofactors(F)
    return published(I1, J) - published(3, 1), stress


def arruda_boyce(F, mu, lambda_m, bulk):
    C = [mpf(1) / 2, mpf(1) / 20, mpf(11) / 1050, mpf(19) / 7000, mpf(519) / 673750]
    I1, J = trace(F.T * F), det(F)
    x = J ** (mpf(-2) / 3) * I1
    W = mu * sum(c / lambda_m ** (2 * i) * (x ** (i + 1) - 3 ** (i + 1)) for i, c in enumerate(C))
    slope = mu * sum((i + 1) * c / lambda_m ** (2 * i) * x**i for i, c in enumerate(C))
    V, P = volumetric(F, bulk)
    return W + V, P + 2 * slope * J ** (mpf(-2) / 3) * (F - I1 / 3 * inverse(F).T)


def fung(F, c, b1, b2, bulk):
    E = green(F)
    Q = b1 * trace(E * E) + b2 * trace(E) ** 2
    V, P = volumetric(F, bulk)
    return c / 2 * (exp(Q) - 1) + V, P + c * exp(Q) * F * (b1 * E + b2 * trace(E) * eye(3))


def transverse_stvk(F, young, poisson, young_fibre, direction_x, direction_y, direction_z):
    a = matrix([direction_x, direction_y, direction_z])
    a = a / sqrt((a.T * a)[0])
    E = green(F)
    along = (a.T * E * a)[0]
    W = LAM / 2 * trace(E) ** 2 + MU * trace(E * E) + (young_fibre - young) / 2 * along**2
    S = LAM * trace(E) * eye(3) + 2 * MU * E + (young_fibre - young) * along * (a * a.T)
    return W, F * S


def ogden(F, mu1, mu2, mu3, alpha1, alpha2, alpha3, bulk):
    # P = F Σᵢ (1/λᵢ) ∂W/∂λᵢ Nᵢ Nᵢᵀ in the principal axes of C.
    J = det(F)
    squares, N = eigsy(F.T * F)
    stretches = [sqrt(x) / J ** (mpf(1) / 3) for x in squares]
    W, S = mpf(0), matrix(3, 3)
    for mu, alpha in [(mu1, alpha1), (mu2, alpha2), (mu3, alpha3)]:
        powers = [x**alpha for x in stretches]
        W += 2 * mu / alpha**2 * (sum(powers) - 3)
        for i in range(3):
            S += 2 * mu / alpha * (powers[i] - sum(powers) / 3) / squares[i] * (N[:, i] * N[:, i].T)
    V, P = volumetric(F, bulk)
    return W + V, P + F * S


LAWS = {
    "stable-neo-hookean": (stable_neo_hookean, "young=1e5 poisson=0.3"),
    "arruda-boyce": (arruda_boyce, "mu=4e4 lambda_m=1.8 bulk=2e5"),
    "ogden": (ogden, "mu1=3.6e4 mu2=1.2e3 mu3=8e3 alpha1=1.3 alpha2=5.0 alpha3=-2.0 bulk=2e5"),
    "fung": (fung, "c=2e4 b1=3.5 b2=1.25 bulk=5e4"),
    "transverse-stvk": (
        transverse_stvk,
        "young=1e5 poisson=0.3 young_fibre=4e5 direction_x=2.0 direction_y=-1.0 direction_z=0.5",
    ),
}

for name, rows in CASES.items():
    F = matrix([[mpf(x) for x in row.split()] for row in rows])
    print("deformation", name, *[float(x) for x in F])
    for law, (stress, parameters) in LAWS.items():
        if law in ("arruda-boyce", "ogden") and det(F) <= 0:
            continue
        values = {k: mpf(v) for k, v in (p.split("=") for p in parameters.split())}
        W, P = stress(F, **values)
        print("law", law, float(W), *[float(x) for x in P], parameters)
