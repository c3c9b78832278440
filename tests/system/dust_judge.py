"""Mass extinction, albedo and asymmetry of dust by Mie theory (Bohren & Huffman 1983, their recurrences), against the rows of
etc/effects.csv. Prints a line a figure: name, table, Mie, ratio; first the theory itself against a published sphere."""
import csv
import sys

import numpy as np


def mie(x, m):
    """Efficiencies of extinction and scattering, and mean cosine, of a sphere of size x and index m = n + ik."""
    terms, z = int(x + 4 * x ** (1 / 3) + 10), m * x
    down = int(max(terms, abs(z)) + 16)
    log_slope = np.zeros(down + 1, complex)
    for n in range(down, 0, -1):
        log_slope[n - 1] = n / z - 1 / (log_slope[n] + n / z)
    psi0, psi1, chi0, chi1 = np.cos(x), np.sin(x), -np.sin(x), np.cos(x)
    xi1, ext, sca, cosine, a1, b1 = complex(psi1, -chi1), 0.0, 0.0, 0.0, 0, 0
    for n in range(1, terms + 1):
        psi, chi = (2 * n - 1) * psi1 / x - psi0, (2 * n - 1) * chi1 / x - chi0
        xi = complex(psi, -chi)
        of_a, of_b = log_slope[n] / m + n / x, log_slope[n] * m + n / x
        a, b = (of_a * psi - psi1) / (of_a * xi - xi1), (of_b * psi - psi1) / (of_b * xi - xi1)
        ext += (2 * n + 1) * (a + b).real
        sca += (2 * n + 1) * (abs(a) ** 2 + abs(b) ** 2)
        cosine += (2 * n + 1) / (n * (n + 1)) * (a * np.conj(b)).real
        if n > 1:
            cosine += (n - 1) * (n + 1) / n * (a1 * np.conj(a) + b1 * np.conj(b)).real
        a1, b1, psi0, psi1, chi0, chi1, xi1 = a, b, psi1, psi, chi1, chi, xi
    ext, sca = ext * 2 / x**2, sca * 2 / x**2
    return ext, sca, 4 * cosine / (x**2 * sca)


def of_mass(wavelength_um, m, median_um=6.0, deviation=2.0, kg_m3=2600.0):
    """m2/kg, albedo and mean cosine of grains whose mass is distributed by the logarithm of diameter."""
    width = np.log(deviation)
    d = np.exp(np.linspace(np.log(median_um) - 3 * width, np.log(median_um) + 2.5 * width, 60))
    mass = np.exp(-np.log(d / median_um) ** 2 / (2 * width**2))
    mass /= mass.sum()
    ext = sca = cosine = 0.0
    for diameter, share in zip(d, mass):
        e, s, g = mie(np.pi * diameter / wavelength_um, m)
        per_kg = share * 1.5 / (kg_m3 * diameter * 1e-6)
        ext, sca, cosine = ext + per_kg * e, sca + per_kg * s, cosine + per_kg * s * g
    return ext, sca / ext, cosine / sca


e, s, g = mie(2 * np.pi * 0.525 / 0.6328, 1.55 + 0j)  # Bohren & Huffman, appendix A
print("sphere 3.10543 %.5f %.6f" % (e, e / 3.10543))

index = {"b": [(0.45, 1.54 + 0.006j)], "g": [(0.55, 1.53 + 0.004j)], "r": [(0.65, 1.53 + 0.003j)], "nir": [(0.9, 1.53 + 0.003j)],
         "swir": [(1.35, 1.5 + 0.003j)], "mwir": [(4.0, 1.5 + 0.01j)],
         "lwir": [(8.5, 1.3 + 0.3j), (9.5, 2.2 + 0.8j), (10.5, 1.9 + 0.3j), (11.5, 1.75 + 0.2j)]}
with open(sys.argv[1]) as file:
    rows = {row["name"]: row for row in csv.DictReader(line for line in file if not line.startswith("#"))}
cosine = {band: np.mean([of_mass(*place)[2] for place in places]) for band, places in index.items()}
for name in ("dust", "burst_dust"):
    row = rows[name]
    for band, places in index.items():
        found = np.array([of_mass(*place) for place in places])
        ext, sca = found[:, 0].mean(), (found[:, 0] * found[:, 1]).mean()
        for what, mine, theirs in (("ext", float(row["ext_" + band]), ext), ("albedo", float(row["albedo_" + band]), sca / ext)):
            print("%s_%s_%s %.4g %.4g %.3f" % (name, what, band, mine, theirs, mine / theirs))
    for column, theirs in (("asymmetry", cosine["g"]), ("asymmetry_ir", 0.5 * (cosine["mwir"] + cosine["lwir"]))):
        print("%s_%s %.3g %.3g %.3f" % (name, column, float(row[column]), theirs, float(row[column]) / theirs))
