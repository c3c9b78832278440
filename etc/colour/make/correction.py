#!/usr/bin/env python3
"""Fits how displayed colours follow from the visible bands (sensor/detector/display_values.c).

    build/judges/bin/python3 etc/colour/make/correction.py                        the coefficients, and how wrong they are
    build/judges/bin/python3 etc/colour/make/correction.py 400 500 570 620 700    the same for bands with these edges, nm

Needs colour-science and prosail (etc/setup --tests); half a minute. Root polynomial of degree 2 (Finlayson, Mackiewicz &
Hurlbert, IEEE Trans. Image Process. 24, 1460, 2015): linear sRGB from R, G, B and the square roots of RG, GB, RB, each over
white's. The coefficients of an output add up to 1, so that grey stays grey. They minimise the weighted mean of
sqrt(9 + CIEDE2000^2) - 3, close to the mean of CIEDE2000 with less weight on small differences, over

    surfaces   0.42  the 190 patches of the rawtoaces training set (A.M.P.A.S.), as colour-science has them
    leaves     0.09  PROSPECT-D, chlorophyll 2 to 60 ug/cm2, brown pigments 0 to 0.9
    mixtures   0.23  half of a leaf, half of dry or wet soil (prosail)
    sky        0.25  CIE daylight of 4500 to 25000 K over D65
    lamps      0.01  black bodies of 1500 to 4000 K over D65: fires, flares

under CIE D65, observer CIE 1931 (2 degrees). Roots of values that are mostly noise are too low on average, which would give
the dark a hue: so the square of the sum of an output's coefficients of roots, times STEADY, is minimised with it. Weights and
STEADY are such that the materials of tests/sensor/colour_spectra.h are shown as well as by a matrix fitted to the ColorChecker; of
these the fit itself knows none, nor of the 99 test surfaces (CIE 224:2017), nor of the ColorChecker.
"""
import csv
import itertools
import os
import re
import sys
import warnings

import numpy as np
from scipy.optimize import least_squares

warnings.filterwarnings("ignore")
import colour  # noqa: E402
import prosail  # noqa: E402
from prosail.spectral_library import get_spectra  # noqa: E402

NM = np.arange(380, 781.0)
HERE = os.path.dirname(os.path.abspath(__file__))
EDGES_NM = (400, 500, 600, 700)
STEADY = 0.1
RGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])  # IEC 61966-2-1


def at_nm(wavelength, values):
    """Rows of spectra at NM; beyond their ends as at them."""
    return np.array([np.interp(NM, wavelength, row) for row in np.atleast_2d(values)])


def of(distribution):
    return at_nm(distribution.wavelengths, distribution.values)[0]


D65 = of(colour.SDS_ILLUMINANTS["D65"])
OBSERVER = at_nm(*(lambda o: (o.wavelengths, o.values.T))(colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]))


# ---- spectra -------------------------------------------------------------------------------------------

def test_surfaces():
    table = colour.quality.cfi2017.load_TCS_CIE2017(colour.SpectralShape(380, 780, 5))
    return at_nm(table.wavelengths, table.values.T)


def checker():
    return np.array([of(s) for s in colour.SDS_COLOURCHECKERS["ColorChecker N Ohta"].values()])


def materials():
    with open(os.path.join(HERE, "../../../tests/sensor/colour_spectra.h"), encoding="ascii") as file:
        text = file.read().split("matter[matter_count]")[1]
    rows = re.findall(r'\{"[\w ]+",\s*\{([^}]*)\}', text)
    return at_nm(np.arange(400, 701, 10), [[float(x) for x in row.split(",")] for row in rows])


def patches():
    path = os.path.join(os.path.dirname(colour.__file__), "characterisation/datasets/rawtoaces/190_Patches.csv")
    with open(path, encoding="ascii") as file:
        table = np.array(list(csv.reader(file))[1:], float)
    return np.maximum(at_nm(table[:, 0], table[:, 1:].T), 0)


def leaf(layers, chlorophyll, brown):
    rho = prosail.run_prospect(layers, chlorophyll, 0.2 * chlorophyll + 2, brown, 0.01, 0.008, ant=1, prospect_version="D")[1]
    return at_nm(np.arange(400, 2501), rho)[0]


def leaves():
    green = [leaf(n, c, 0) for n in (1.4, 2.0) for c in (5, 15, 30, 45, 60)]
    return np.array(green + [leaf(1.7, c, b) for c in (2, 8) for b in (0.3, 0.6, 0.9)])


def mixtures():
    soil = get_spectra().soil
    return np.array([0.5 * (x + at_nm(np.arange(400, 2501), s)[0]) for x in leaves() for s in (soil.rsoil1, soil.rsoil2)])


def over_daylight(light):
    """A light as a surface under D65, at most 0.6 over the visible."""
    ratio = light / D65
    return 0.6 * ratio / ratio[(NM >= 400) & (NM <= 700)].max()


def sky():
    kelvins = (4500, 5500, 8000, 10000, 15000, 20000, 25000)
    xy = [colour.temperature.CCT_to_xy_CIE_D(k) for k in kelvins]
    return np.array([over_daylight(of(colour.sd_CIE_illuminant_D_series(p))) for p in xy])


def lamps():
    return np.array([over_daylight(NM**-5 / np.expm1(1.4387769e7 / (NM * k))) for k in (1500, 2000, 2500, 3000, 4000)])


# ---- colours -------------------------------------------------------------------------------------------

def bands(reflectance, edges_nm):
    """What bands hold over what they hold of white, the reddest first; trapezoidal rule."""
    out = []
    for low, high in reversed(list(zip(edges_nm[:-1], edges_nm[1:]))):
        weight = D65 * ((NM >= low) & (NM <= high)) * np.where((NM == low) | (NM == high), 0.5, 1)
        out.append(reflectance @ weight / weight.sum())
    return np.array(out).T


def terms(b, roots):
    """b, and the square roots of products of two: of three bands RG, GB, RB, as colour-science orders them."""
    pairs = sorted(itertools.combinations(range(b.shape[1]), 2), key=lambda p: (p[1] - p[0], p)) if roots else []
    return np.array([*b.T] + [np.sqrt(b[:, i] * b[:, j]) for i, j in pairs]).T


def lab(xyz, white):
    return colour.XYZ_to_Lab(xyz / white, colour.XYZ_to_xy(np.ones(3)))


def lab_of_spectra(reflectance):
    weight = D65 * OBSERVER
    return lab(reflectance @ weight.T, weight.sum(axis=1))


def lab_of_rgb(rgb):
    return lab(rgb @ RGB_TO_XYZ.T, RGB_TO_XYZ.sum(axis=1))


def on_screen(rgb):
    """Mixed with the grey of the same luminance until no component is negative; at most 1."""
    grey, least = rgb @ RGB_TO_XYZ[1], rgb.min(axis=1)
    share = np.where((grey > 0) & (least < 0), grey / np.where(least < 0, grey - least, 1), 1)
    return np.minimum(grey[:, None] + share[:, None] * (rgb - grey[:, None]), 1)


def fit(classes, edges_nm, roots, steady=STEADY):
    reflectance = np.concatenate([r for _, r in classes])
    weight = np.sqrt(np.concatenate([np.full(len(r), share / len(r)) for share, r in classes]))
    b = bands(reflectance, edges_nm)
    inputs, want, count = terms(b, roots), lab_of_spectra(reflectance), b.shape[1]

    def rows(x):
        x = x.reshape(3, -1)
        return np.concatenate([x, 1 - x.sum(axis=1, keepdims=True)], axis=1)

    def residual(x):
        shown = lab_of_rgb(np.maximum(inputs @ rows(x).T, 1e-9))
        apart = colour.delta_E(want, shown, method="CIE 2000")
        curved = rows(x)[:, count:].sum(axis=1)
        return np.concatenate([weight * np.sqrt(2 * np.maximum(np.hypot(3, apart) - 3, 0)), np.sqrt(steady) * curved])

    start = np.zeros((3, inputs.shape[1]))
    for c, first in enumerate(np.linspace(0, count - 1, 3)):
        start[c, [int(np.floor(first)), int(np.ceil(first))]] += 0.5
    return rows(least_squares(residual, start[:, :-1].ravel(), max_nfev=500).x)


def rounded(coefficients):
    """Four decimals that still add up to 1: the greatest takes what is missing."""
    out = np.round(coefficients, 4)
    for row in out:
        row[np.argmax(row)] += 1 - row.sum()
    return np.round(out, 4)


def main():
    edges_nm = tuple(int(x) for x in sys.argv[1:]) or EDGES_NM
    classes = [(0.42, patches()), (0.09, leaves()), (0.23, mixtures()), (0.25, sky()), (0.01, lamps())]
    sets = {"CIE 99": test_surfaces(), "ColorChecker": checker(), "materials": materials(), "patches": patches(),
            "leaves": leaves(), "sky": sky(), "lamps": lamps()}
    for roots in (False, True):
        coefficients = rounded(fit(classes, edges_nm, roots))
        print("root polynomial" if roots else "matrix", "of bands with edges at", *edges_nm, "nm")
        half = np.array([[1, 0, 1], [1, 1, 0], [0, 1, 1]]) / 2  # how a root changes with either of its two
        if coefficients.shape[1] in (3, 6):
            slope = coefficients[:, :3] + (coefficients[:, 3:] @ half.T if roots else 0)
            print("  noise of a grey, of that of one band:", np.sqrt((slope**2).sum(axis=1)).round(2))
        print("\n".join("    {" + ", ".join(f"{x:.4f}" for x in row) + "}," for row in coefficients))
        for name, reflectance in sets.items():
            shown = on_screen(terms(bands(reflectance, edges_nm), roots) @ coefficients.T)
            d = colour.delta_E(lab_of_spectra(reflectance), lab_of_rgb(shown), method="CIE 2000")
            print(f"  {name:13s} CIEDE2000 {d.mean():5.2f} on average, 95 % below {np.percentile(d, 95):5.2f},"
                  f" at most {d.max():5.2f}")


if __name__ == "__main__":
    main()
