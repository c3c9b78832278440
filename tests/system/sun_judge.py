"""The sides of a box in a clear day's sun by an independent network: a plate each, by NumPy, under pvlib's sun.

    sun_judge.py NODES.csv COLUMN...       of `pitviper heat`, 21 June, 45 N 0 E, heading west, 23 km; columns of
                                           sides that face east, west, ... as FACING:COLUMN, degrees clockwise from north

Prints HOUR ours judge, of the first column less the second.

The sun is Bird's (1981), with the optical depths of LOWTRAN7's rural haze of 23 km at 380 and 500 nm, its ozone, and
water vapour of 60 % at 288.15 K times 2.25 km. A plate of 10 mm of steel with olive paint (etc/materials.csv) sees half
of an even sky and half of the ground, which reflects 0.2, and gives heat to the air by Nu = 0.037 Re^0.8 Pr^(1/3) over
free convection, in wind of 3 m/s at 10 m, which falls with the logarithm of height over grass (roughness 0.03 m) to 1.5 m.
Air and ground are as warm as the file says; the sky by Brutsaert (1975).
"""
import csv
import sys

import numpy as np
import pandas
import pvlib

SIGMA = 5.670374419184429e-8
ABSORBS, EMITS, STORES = 0.5952, 1 - 0.0523, 7824 * 500 * 0.01  # J/(m2 K)
WIND_MPS = 3 * np.log(1.5 / 0.03) / np.log(10 / 0.03)
FILM = 4 + 6.1 * WIND_MPS**0.8  # W/(m2 K)
VAPOUR_KPA, WATER_CM = 0.6 * 1.705, 1.73
STEP_S = 60

rows = list(csv.DictReader(open(sys.argv[1])))
sides = [(float(name.split(":")[0]), name.split(":")[1]) for name in sys.argv[2:]]
hour = np.array([float(row["hour"]) for row in rows])
air, ground = (np.array([float(row[name]) for row in rows]) for name in ("air_k", "ground_k"))

at = np.arange(0, 48 * 3600, STEP_S)
place = pvlib.solarposition.get_solarposition(
    pandas.Timestamp("2026-06-21", tz="UTC") + pandas.to_timedelta(at % 86400, unit="s"), 45, 0)
zenith = place["apparent_zenith"].to_numpy()
sun = pvlib.clearsky.bird(zenith, pvlib.atmosphere.get_relative_airmass(zenith, "kasten1966"), 0.4858, 0.3722, WATER_CM,
                          ozone=0.344, dni_extra=pvlib.irradiance.get_extra_radiation(172))
direct, diffuse, level = (np.where(zenith < 90, np.nan_to_num(sun[k]), 0) for k in ("dni", "dhi", "ghi"))
air_k, ground_k = (np.interp(at % 86400 / 3600, hour, k) for k in (air, ground))
sky_w_m2 = 1.24 * (10 * VAPOUR_KPA / air_k)**(1 / 7) * SIGMA * air_k**4


def plate(facing_deg):
    turn = np.radians(place["azimuth"].to_numpy() - facing_deg)
    faces = np.maximum(np.sin(np.radians(zenith)) * np.cos(turn), 0)
    gains = ABSORBS * (direct * faces + diffuse / 2 + 0.2 * level / 2) + EMITS * (sky_w_m2 + SIGMA * ground_k**4) / 2
    temp = np.empty(len(at))
    temp[0] = air_k[0]
    for i in range(len(at) - 1):
        heat = gains[i] + FILM * (air_k[i] - temp[i]) - EMITS * SIGMA * temp[i]**4
        temp[i + 1] = temp[i] + STEP_S / STORES * heat
    return temp


judge = [plate(facing) for facing, _ in sides]
for h in (6, 8, 10, 14, 16, 18):
    row = rows[int(np.flatnonzero(hour == h)[0])]
    then = 86400 // STEP_S + h * 3600 // STEP_S
    print(h, f"{float(row[sides[0][1]]) - float(row[sides[1][1]]):.2f} {judge[0][then] - judge[1][then]:.2f}")
