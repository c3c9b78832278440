#!/usr/bin/env python3
"""Fills a visibility's folder with LOWTRAN7: haze.csv, sun.csv, sky_thermal.csv and its row of visibilities.csv.

    etc/atmosphere/make/tables.py MODEL VISIBILITY_KM [OUT] [--paths] [--work FOLDER]

Needs numpy and gfortran, and the network once (lowtran.py). Writes OUT/MODEL/METRES/*.csv and prints the row; what is
there already is not made again. sun.csv takes half a minute, the others some seconds, --paths (paths_<band>.csv too)
two minutes. Heights and angles are those of the committed tables, paths those of clear/paths_b.csv.
"""
import argparse
import csv
import os

import numpy as np

import lowtran as lt

HEIGHTS_M = [*range(0, 4001, 100), *range(4250, 12001, 250), 12500, 13000, *range(14000, 20001, 1000), 22500, 25000,
             27500, 30000, 35000, 40000, 50000]
SUN_HEIGHTS_KM = [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16]
SUN_ZENITHS = [0, 20, 30, 40, 50, 60, 65, 70, 75, 78, 80, 82, 84, 85, 86, 87, 88, 89, 90]
SKY_HEIGHTS_M = [0, 250, 500, 750, 1000, 1500, 2000, 2500, 3000, 3500, 4500, 5500, 6500, 7500, 8500, 9500, 10500, 11500,
                 12500, 13500, 16000, 20000, 25000, 30000, 40000, 50000, 60000, 80000]
SKY_ZENITHS = [0, 30, 45, 60, 70, 75, 80, 83, 85, 86.5, 88, 89, 89.5, 90]
SPANS = [(820, 1260), (2080, 2960), (9080, 25000)]  # 1/cm, what the bands need
GAUSS = 6
HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SHINE_K = [200, 260, 300, 450, 1000, 3000]


class Maker:
    def __init__(self, model, visibility_km, out, work):
        self.model, self.visibility_km, self.work = model, visibility_km, work
        self.folder = os.path.join(out, model, f"{visibility_km * 1000:.0f}")
        os.makedirs(self.folder, exist_ok=True)
        self.beside = os.path.join(HERE, model, "clear")

    def runs(self, cases, spans=SPANS, **more):
        """Arguments of lowtran.case to spectra over all spans."""
        cards = [lt.case(self.model, self.visibility_km, low=low, high=high, **c, **more)
                 for c in cases for low, high in spans]
        got = lt.run(self.work, cards)
        return [np.concatenate(got[i:i + len(spans)]) for i in range(0, len(got), len(spans))]

    def write(self, name, head, rows):
        path = os.path.join(self.folder, name)
        with open(path + ".part", "w", encoding="ascii") as out:
            out.write("# LOWTRAN7 rev. 4.2 in double precision, rural aerosol, meteorological range "
                      f"{self.visibility_km:g} km{'; 1/km' if name == 'haze.csv' else ''}\n{head}\n")
            for row in rows:
                out.write(",".join(f"{x:.5g}" if abs(x) < 1e4 else f"{x:.0f}" for x in row) + "\n")
        os.rename(path + ".part", path)

    def haze(self):
        sun = self.runs([dict(kind=3, emission=3)])[0]
        wavenumber, light = sun[:, 0], sun[:, 5]
        # 100 m, or less where haze is thick: of a thin layer the mean over a band is that of extinction itself
        length_km = 0.1 * min(1, self.visibility_km / 5)
        rows = []
        cases = [dict(kind=1, h1=h / 1000, range_km=length_km) for h in HEIGHTS_M]
        for height, spectrum in zip(HEIGHTS_M, self.runs(cases)):
            row = [height]
            for band in lt.BANDS_UM:
                weight = lt.planck(wavenumber, 300) if band in ("mwir", "lwir") else light
                total = lt.integral(wavenumber, weight, band)
                through, absorbed = spectrum[:, 6], spectrum[:, 7]
                for part in (through, through / (1 - absorbed)):
                    mean = lt.integral(wavenumber, weight * -np.expm1(np.log(part)), band) / total
                    row.append(-np.log1p(-mean) / length_km)
            rows.append(row)
        self.write("haze.csv", "height_m," + ",".join(f"extinction_{b},scatter_{b}" for b in lt.BANDS_UM), rows)

    def sky_thermal(self):
        places = [(h, z) for h in SKY_HEIGHTS_M for z in SKY_ZENITHS]
        spectra = self.runs([dict(kind=3, emission=1, h1=h / 1000, angle=z) for h, z in places], SPANS[:2])
        self.write("sky_thermal.csv", "observer_m,zenith_deg,mwir,lwir",
                   [(h, z, *(lt.integral(s[:, 0], s[:, 2], b) * 1e4 for b in ("mwir", "lwir")))
                    for (h, z), s in zip(places, spectra)])

    def sun(self):
        places = [(h, z) for h in SUN_HEIGHTS_KM for z in SUN_ZENITHS]
        direct = self.runs([dict(kind=3, emission=3, h1=h, angle=z) for h, z in places])
        # fluxes of the whole air, whatever the path; by levels downwards, the ground is the 33rd
        cases = [dict(kind=3, emission=2, scatter=True, angle=30, sun_zenith=z) for z in SUN_ZENITHS]
        fluxes = self.runs(cases, step=20)
        rows = []
        for (h, z), d in zip(places, direct):
            flux = fluxes[SUN_ZENITHS.index(z)]
            per_wavenumber = flux[:, 8 + 32 - h] * 1e4 / flux[:, 0] ** 2
            rows.append((h * 1000, z, *(lt.integral(d[:, 0], d[:, 4], b) * 1e4 for b in lt.BANDS_UM),
                         *(lt.integral(flux[:, 0], per_wavenumber, b) * 1e4 for b in lt.BANDS_UM)))
        self.write("sun.csv", "observer_m,sun_zenith_deg," + ",".join(f"direct_{b}" for b in lt.BANDS_UM) + "," +
                   ",".join(f"diffuse_{b}" for b in lt.BANDS_UM), rows)

    def paths(self):
        """paths_<band>.csv, of the same paths as those of clear air."""
        keys = {}
        with open(os.path.join(self.beside, "paths_b.csv"), encoding="ascii") as lines:
            for row in csv.reader(line for line in lines if line[0].isdigit()):
                keys[tuple(float(x) for x in row[:3])] = None
        sun = self.runs([dict(kind=3, emission=3)])[0]
        wavenumber, light = sun[:, 0], sun[:, 5]
        cases = [dict(kind=1, h1=a / 1000, range_km=r / 1000) if a == b else
                 dict(kind=2, h1=a / 1000, h2=b / 1000, angle=0.0 if b > a else 180.0, stretch=r / abs(b - a))
                 for a, b, r in keys]
        kelvin = {band: SHINE_K if band in ("mwir", "lwir") else [] for band in lt.BANDS_UM}
        weights = {band: [light] + [lt.planck(wavenumber, t) for t in kelvin[band]] for band in lt.BANDS_UM}
        totals = {band: [lt.integral(wavenumber, w, band) for w in weights[band]] for band in lt.BANDS_UM}
        rows = {band: [] for band in lt.BANDS_UM}
        for start in range(0, len(cases), 100):
            spectra = self.runs(cases[start:start + 100], emission=1)
            for (a, b, r), s in zip(list(keys)[start:start + 100], spectra):
                # depths, of which a transmittance of nothing has none: 1000 is as good as any
                ln_tau = np.log(np.maximum(s[:, 1], 1e-300))
                for band in lt.BANDS_UM:
                    row = [a, b, r]
                    for weight, total in zip(weights[band], totals[band]):
                        lost = lt.integral(wavenumber, weight * -np.expm1(ln_tau), band) / total
                        kept = lt.integral(wavenumber, weight * s[:, 1], band) / total
                        row.append(-np.log1p(-lost) if lost < 0.5 else -np.log(max(kept, 1e-300)))
                    if kelvin[band]:
                        row.append(lt.integral(s[:, 0], s[:, 2], band) * 1e4)
                    rows[band].append(row)
        for band in lt.BANDS_UM:
            columns = [f"depth_{t}k" for t in kelvin[band]] + (["thermal_w_m2_sr"] if kelvin[band] else [])
            self.write(f"paths_{band}.csv", ",".join(["observer_m,target_m,range_m,depth_sun"] + columns), rows[band])

    def longwave(self):
        node, weight = np.polynomial.legendre.leggauss(GAUSS)
        cosine = (1 + node) / 2
        spectra = self.runs([dict(kind=3, emission=1, angle=float(np.degrees(np.arccos(c)))) for c in cosine],
                            [(50, 3000)])
        return sum(2 * np.pi * w / 2 * c * np.trapezoid(s[:, 2], s[:, 0]) * 1e4
                   for w, c, s in zip(weight, cosine, spectra))

    def make(self, with_paths):
        for name in ("haze", "sky_thermal", "sun"):
            if not os.path.exists(os.path.join(self.folder, name + ".csv")):
                getattr(self, name)()
        if with_paths and not os.path.exists(os.path.join(self.folder, "paths_lwir.csv")):
            self.paths()
        print(f"{self.visibility_km * 1000:.0f},{self.longwave():.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("model", choices=sorted(lt.MODELS))
    parser.add_argument("visibility_km", type=float)
    parser.add_argument("out", nargs="?", default=HERE)
    parser.add_argument("--paths", action="store_true")
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    a = parser.parse_args()
    Maker(a.model, a.visibility_km, a.out, a.work).make(a.paths)


if __name__ == "__main__":
    main()
