#!/usr/bin/env python3
"""Colour of twilight: light of the whole sky on level ground, scattered once, with the sun below the horizon.

    etc/atmosphere/make/twilight.py [--work FOLDER]

Prints, for depressions of the sun, decades of light of 0.55 um over that with the sun at the horizon, of us1976 at 23 km,
and for wavelengths what render/air/twilight.c has of it: decades over those of 0.55 um. The sun's light passes a round
Earth's air along straight lines, past ozone (Chappuis), molecules and haze, or is cut off by the ground, is scattered once
and comes down. The level is within 0.2 decades of measured illuminance to -9 degrees; below -6, where more and more is
scattered repeatedly, the colour is not used.
"""
import argparse
import os

import numpy as np

import diffuse as df

MICRONS = np.array([.45, .55, .65, .87, 1.35])
DEPRESSIONS = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
TOP_KM, STEP_KM = 110.0, 0.5


class Shells:
    def __init__(self, work):
        air = df.Air(df.HERE, "us1976", 23, work)
        depth, albedo, _ = air.layers()
        rayleigh = air.molecules()
        scattered = depth * albedo - rayleigh
        order = np.argsort(df.MICRONS, kind="stable")

        def along(values):
            return np.array([np.interp(MICRONS, df.MICRONS[order], column[order]) for column in values.T])  # [layer, micron]

        z = np.arange(STEP_KM / 2, TOP_KM, STEP_KM)
        rise = df.LEVELS_KM[:-1] - df.LEVELS_KM[1:]
        layer = np.searchsorted(-df.LEVELS_KM, -z, side="left").clip(1, len(rise)) - 1
        haze, lost = along(scattered) / rise[:, None], along(depth * (1 - albedo)) / rise[:, None]
        rows = df.table(df.HERE, "us1976", "temperature.csv")
        kelvin = np.interp(z, [float(r["height_m"]) / 1000 for r in rows], [float(r["temp_k"]) for r in rows])
        pull = 9.80665 * (df.RADIUS_KM / (df.RADIUS_KM + z)) ** 2 / 287.053 / kelvin * 1000 * STEP_KM
        density = np.exp(-(np.cumsum(pull) - pull / 2)) * 273.15 / kelvin
        wavenumber = 1e4 / MICRONS
        self.molecules = density[:, None] * wavenumber ** 4 / (9.38076e18 - 1.08426e9 * wavenumber ** 2)
        self.haze, self.extinction = haze[layer], self.molecules + (haze + lost)[layer]

    def at(self, values, height_km):
        return values[np.clip((height_km / STEP_KM).astype(int), 0, len(values) - 1)] * (height_km < TOP_KM)[..., None]

    def to_space(self, height_km, cosine, points=1500):
        """Transmittance of straight rays; 0 where the ground is in the way."""
        r = df.RADIUS_KM + height_km
        reach = -r * cosine + np.sqrt(np.maximum((df.RADIUS_KM + TOP_KM) ** 2 - r ** 2 * (1 - cosine ** 2), 0))
        depth = 0
        for k in range(points):
            s = reach * ((k + 0.5) / points)
            there = np.sqrt(r ** 2 + s ** 2 + 2 * r * s * cosine) - df.RADIUS_KM
            depth = depth + self.at(self.extinction, np.maximum(there, 0)) * (reach / points)[..., None]
        lowest = r * np.sqrt(1 - cosine ** 2)
        return np.exp(-depth) * ((cosine >= 0) | (lowest > df.RADIUS_KM))[..., None]


def irradiance(shells, depressions):
    heights, cosines = np.arange(0, TOP_KM + 0.1, 1.0), np.cos(np.radians(np.arange(70, 112.01, 0.25)))
    sun = np.array([shells.to_space(np.full(len(cosines), h), cosines) for h in heights])
    node, weight = np.polynomial.legendre.leggauss(24)
    ups, up_weights = (node + 1) / 2, weight / 2
    azimuths = (np.arange(18) + 0.5) * np.pi / 18
    out = np.zeros((len(depressions), len(MICRONS)))
    for up, up_weight in zip(ups, up_weights):
        reach = -df.RADIUS_KM * up + np.sqrt((df.RADIUS_KM * up) ** 2 + TOP_KM ** 2 + 2 * df.RADIUS_KM * TOP_KM)
        u = (np.arange(500) + 0.5) / 500
        s, ds = reach * u ** 2, reach * 2 * u / 500
        r = np.sqrt(df.RADIUS_KM ** 2 + s ** 2 + 2 * df.RADIUS_KM * s * up)
        h = r - df.RADIUS_KM
        ext, mol, haze = (shells.at(v, h) for v in (shells.extinction, shells.molecules, shells.haze))
        depth = np.cumsum(ext * ds[:, None], axis=0) - ext * ds[:, None] / 2
        flat = np.sqrt(1 - up ** 2)
        for i, depression in enumerate(np.radians(depressions)):
            for azimuth in azimuths:
                d = np.array([flat * np.cos(azimuth), up])  # level towards the sun's side, and up
                cos_sun = d[0] * np.cos(depression) - d[1] * np.sin(depression)
                local = (df.RADIUS_KM * -np.sin(depression) + s * cos_sun) / r  # cosine of the sun's zenith angle there
                x = (np.degrees(np.arccos(np.clip(local, -1, 1))) - 70) / 0.25
                y = np.clip(h, 0, heights[-1] - 1e-9)
                a, b = np.clip(x.astype(int), 0, len(cosines) - 2), y.astype(int)
                fa, fb = np.clip(x - a, 0, 1)[:, None], (y - b)[:, None]
                light = ((1 - fb) * ((1 - fa) * sun[b, a] + fa * sun[b, a + 1]) +
                         fb * ((1 - fa) * sun[b + 1, a] + fa * sun[b + 1, a + 1]))
                g = 0.68
                lobe = (1 - g * g) / (1 + g * g - 2 * g * cos_sun) ** 1.5
                source = mol * 0.75 * (1 + cos_sun ** 2) + haze * lobe
                radiance = np.sum(light * source * np.exp(-depth) * ds[:, None], axis=0) / 4 / np.pi
                out[i] += radiance * up * up_weight * 2 * np.pi / len(azimuths)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    got = irradiance(Shells(parser.parse_args().work), DEPRESSIONS)
    print("um", *MICRONS)
    for depression, row in zip(DEPRESSIONS, got / got[0]):
        print(f"{-depression:3d} {np.log10(row[1]):8.3f}  " + ", ".join(f"{np.log10(v / row[1]):.3f}" for v in row))


if __name__ == "__main__":
    main()
