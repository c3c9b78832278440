"""Mie's series over the drops of render/air/droplets_table.c by miepython, with the refractive index of water of Hale & Querry,
Applied Optics 12 (1973) 555, at some of its wavelengths. Prints for each kind how far the table is off, largest."""
import re

import miepython
import numpy as np

# um, n, k
INDEX = np.array([
    (0.4, 1.339, 1.86e-9), (0.55, 1.333, 1.96e-9), (0.9, 1.328, 4.86e-7), (1.6, 1.317, 8.55e-5), (2.8, 1.142, 0.115),
    (3.4, 1.420, 0.0195), (3.8, 1.364, 0.00340), (4.4, 1.334, 0.0103), (4.8, 1.330, 0.0150), (8.0, 1.291, 0.0343),
    (9.6, 1.239, 0.0454), (10.0, 1.218, 0.0508), (11.0, 1.153, 0.0968), (12.0, 1.111, 0.199)])
DROPS = {  # radii in um, number by radius
    'radiation': (np.geomspace(0.1, 30, 160), lambda r: r**6 * np.exp(-3 * r)),
    'advection': (np.geomspace(0.3, 100, 160), lambda r: r**3 * np.exp(-0.3 * r)),
    'rain': (np.geomspace(50, 3000, 24), lambda r: np.exp(-4.1 * 10**-0.21 * 2e-3 * r))}


def mean_optics(radius, number, row):
    """Extinction, scattered share, mean cosine; the sums by the logarithm of the radius, evenly spaced."""
    wavelength, n, k = row
    lost, scattered, _, cosine = np.array(
        [miepython.efficiencies_mx(complex(n, -k), x) for x in 2 * np.pi * radius / wavelength]).T
    area = number * radius**3
    return (area * lost).sum(), (area * scattered).sum() / (area * lost).sum(), \
        (area * scattered * cosine).sum() / (area * scattered).sum()


with open('render/air/droplets_table.c', encoding='utf-8') as file:
    text = file.read()
print('miepython', miepython.__version__)
for kind, (radius, law) in DROPS.items():
    rows = re.search(r'\[droplet_%s\] =\s*\{(.*?)\n\s*\},\n\s*(?:\[|\};)' % kind, text, re.S).group(1)
    table = {float(r[0]) * 1e6: [float(v) for v in r[1:]]
             for r in re.findall(r'\{([\d.]+e-6|[\d.]+), ([\d.]+), ([\d.]+), ([\d.]+)\}', rows)}
    table = {round(w, 6): v for w, v in table.items()}
    visible = mean_optics(radius, law(radius), INDEX[1])[0]
    worst = 0
    for row in INDEX[1::4] if kind == 'rain' else INDEX:  # large spheres take long
        extinction, albedo, cosine = mean_optics(radius, law(radius), row)
        for got, want in zip(table[round(row[0], 6)], (extinction / visible, albedo, cosine)):
            worst = max(worst, abs(got / want - 1))
    print(kind, len(table), worst)
