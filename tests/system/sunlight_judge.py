"""Sunlight of a band on level ground by SPECTRL2 (Bird & Riordan 1984; pvlib), of the air of us1976 with LOWTRAN7's rural haze.

    sunlight_judge.py SUNLIGHT.csv       of `pitviper probe sunlight`

Prints BAND VISIBILITY ELEVATION, and ours over the judge's less 1 in percent: direct, global light.

Haze's depths are those of a LOWTRAN7 run straight up: a power law through that of a band's middle, as steep as between
its edges. Its scattered share and
mean cosine are LOWTRAN7's (haze.csv, phase.csv), water is 1.42 cm, ozone 0.344 cm, the ground reflects 0.2.
"""
import csv
import sys

import numpy as np
import pvlib

EDGES_UM = (0.4, 0.5, 0.6, 0.7, 1.0, 1.1, 1.7)
DEPTHS = {50: (0.2313, 0.1840, 0.1460, 0.1180, 0.0723, 0.0606, 0.0279),
          23: (0.4669, 0.3722, 0.2961, 0.2402, 0.1488, 0.1255, 0.0599)}
# in the middle: the root of the product of a band's edges
MIDDLE_DEPTHS = {50: (0.2090, 0.1614, 0.1321, 0.0909, 0.0478), 23: (0.4222, 0.3270, 0.2685, 0.1861, 0.0999)}
BANDS = {"b": (0.4, 0.5, 0.953, 0.683), "g": (0.5, 0.6, 0.950, 0.671), "r": (0.6, 0.7, 0.945, 0.671),
         "nir": (0.7, 1.1, 0.921, 0.660), "swir": (1.0, 1.7, 0.861, 0.684)}


def within(um, value, low, high):
    at = np.concatenate(([low], um[(um > low) & (um < high)], [high]))
    y = np.interp(at, um, value)
    return np.sum((y[1:] + y[:-1]) * np.diff(at)) / 2


for row in csv.DictReader(open(sys.argv[1], encoding="ascii")):
    low, high, scattered, cosine = BANDS[row["band"]]
    zenith = float(row["sun_zenith_deg"])
    depth = dict(zip(EDGES_UM, DEPTHS[float(row["visibility_km"])]))
    middle = MIDDLE_DEPTHS[float(row["visibility_km"])][list(BANDS).index(row["band"])]
    alpha = np.log(depth[low] / depth[high]) / np.log(high / low)
    sky = pvlib.spectrum.spectrl2(
        apparent_zenith=zenith, aoi=zenith, surface_tilt=0, ground_albedo=0.2, surface_pressure=101325, dayofyear=93,
        relative_airmass=pvlib.atmosphere.get_relative_airmass(zenith, "kasten1966"), precipitable_water=1.42, ozone=0.344,
        aerosol_turbidity_500nm=middle * (np.sqrt(low * high) / 0.5)**alpha, alpha=alpha, aerosol_asymmetry_factor=cosine,
        scattering_albedo_400nm=scattered, wavelength_variation_factor=0.0)
    um = sky["wavelength"] / 1000
    direct, diffuse = (within(um, np.ravel(sky[name]) * 1000, low, high) for name in ("dni", "dhi"))
    ours = float(row["direct_w_m2"]), float(row["diffuse_w_m2"])
    level = np.cos(np.radians(zenith))
    print(row["band"], row["visibility_km"], f"{90 - zenith:g}", f"{100 * (ours[0] / direct - 1):.2f}",
          f"{100 * ((ours[0] * level + ours[1]) / (direct * level + diffuse) - 1):.2f}")
