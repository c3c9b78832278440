"""Temperatures of walls and roofs by finite volumes, for `pitviper probe heat-wall`.

    walls_judge.py weather DAYS              a CSV of weather: air, wind, sun and longwave that change from day to day
    walls_judge.py WEATHER.csv OURS.csv ETC [rough]

Prints of each construction, tilt and aspect of OURS.csv the largest and the rms difference over its last day, K. Rows of
OURS.csv give the ground's temperature at all times; all else is found here: the sun (pvlib), the balance outside, the film,
the room, conduction. Cells of at most 2 mm at the faces of layers (10 mm inside), their middles as nodes, backward Euler in
steps of a minute. rough: its twin, whose films are those of glass.
"""
import csv
import math
import sys

import numpy as np
import pvlib

SIGMA = 5.670374419184429e-8
LAT, LON = 50.0, 8.0
STEP_S = 60
BEGIN_S = 1774915200  # 2026-03-31 00:00 UTC


def write_weather(days):
    print("unix_s,air_temp_k,humidity_pct,pressure_hpa,wind_mps,wind_from_deg,direct_w_m2,diffuse_w_m2,longwave_w_m2,cloud")
    times = BEGIN_S + 600 * np.arange(144 * days + 1)
    up = np.sin(np.radians(sun_of(times)[1]))
    for t, s in zip(times, up):
        day = (t - BEGIN_S) / 86400
        air = 280 + 1.5 * math.sin(day * 0.9) - 5 * math.cos(2 * math.pi * (day - 0.1))
        wind = 3 + 2 * math.sin(2 * math.pi * day * 0.7) ** 2 * math.cos(2 * math.pi * day)
        clear = 0.5 + 0.5 * math.cos(day * 1.3) ** 2
        direct = 850 * clear * math.exp(-0.12 / max(s, 0.02)) if s > 0 else 0
        diffuse = 130 * math.sqrt(s) * (1.5 - 0.5 * clear) if s > 0 else 0
        sky = 0.80 * SIGMA * air ** 4
        print(f"{t:.0f},{air:.4f},60,1013,{wind:.4f},270,{direct:.3f},{diffuse:.3f},{sky:.3f},0")


def sun_of(times):
    import pandas as pd
    at = pvlib.solarposition.get_solarposition(pd.to_datetime(times, unit="s", utc=True), LAT, LON)
    return at["azimuth"].to_numpy(), at["elevation"].to_numpy()


def read_constructions(etc):
    def rows(name):
        lines = [line for line in open(f"{etc}/{name}", encoding="utf-8") if not line.startswith("#")]
        return list(csv.DictReader(lines))
    layers = {r["name"]: r for r in rows("construction_layers.csv")}
    optics = {r["name"]: r for r in rows("materials.csv")}
    return layers, {r["name"]: r for r in rows("constructions.csv")}, optics


def cells_of(text, layers):
    size, k, c = [], [], []
    for layer in text.split(";"):
        name, mm = layer.split()
        row, thick = layers[name], float(mm) / 1000
        w_mk = float(row["w_mk"] or 0) or thick / float(row["m2k_w"])
        # from both faces inwards: 1 mm, then ever larger
        widths, left, width = [], thick / 2, 0.001
        while left > 1e-12:
            here = min(width, left)
            widths.append(here)
            left -= here
            width = min(width * 1.25, 0.02)
        widths += widths[::-1]
        size += widths
        k += [w_mk] * len(widths)
        c += [float(row["kg_m3"]) * float(row["j_kgk"])] * len(widths)
    return np.array(size), np.array(k), np.array(c)


class Face:
    """One column behind one outer face."""

    def __init__(self, row, layers, up, start_k):
        size, k, c = cells_of(row["layers"], layers)
        self.inside, self.up = row["inside"], up
        self.film = float(row["inside_w_m2k"] or 0)
        n = len(size)
        g = 1 / (0.5 * size[1:] / k[1:] + 0.5 * size[:-1] / k[:-1])
        self.half = 0.5 * size[0] / k[0]
        self.inner = 1 / (0.5 * size[-1] / k[-1] + 1 / self.film) if self.film > 0 else 0.0
        self.inner_half = 0.5 * size[-1] / k[-1]
        a = np.diag(c * size / STEP_S)
        for i in range(n - 1):
            a[i, i] += g[i]
            a[i + 1, i + 1] += g[i]
            a[i, i + 1] -= g[i]
            a[i + 1, i] -= g[i]
        a[-1, -1] += self.inner
        self.inverse, self.stored = np.linalg.inv(a), c * size / STEP_S
        self.temp = np.full(n, start_k)
        self.surface = start_k

    def step(self, flux, behind):
        """flux(T): W/m2 into the outer face."""
        right = self.stored * self.temp
        right[-1] += self.inner * behind
        base, response = self.inverse @ right, self.inverse[:, 0]
        resist = response[0] + self.half
        t = self.surface
        for _ in range(50):  # T = base + resist q(T)
            q, e = flux(t), 0.01
            miss = base[0] + resist * q - t
            slope = resist * (flux(t + e) - q) / e - 1
            t -= miss / slope
            if abs(miss / slope) < 1e-6:
                break
        q = flux(t)
        self.surface, self.temp = t, base + response * q
        if self.film > 0:
            flow = (self.temp[-1] - behind) * self.inner
            self.inner_k = self.temp[-1] - flow * self.inner_half


def natural(over, up):
    root = abs(over) ** (1 / 3)
    if abs(up) < 1e-9:
        return 1.31 * root
    return 9.482 * root / (7.238 - abs(up)) if over * up > 0 else 1.810 * root / (1.382 + abs(up))


def film(over, up, wind, rough):
    v = wind * math.log(30) / math.log(100)
    glass = (3.26 * v ** 0.89 + 3.55 * v ** 0.617) / 2
    n = natural(over, up)
    return n + rough * (math.hypot(n, glass) - n)


def normal_of(tilt, aspect):
    s = math.sin(math.radians(tilt))
    return np.array([s * math.sin(math.radians(aspect)), s * math.cos(math.radians(aspect)),
                     math.cos(math.radians(tilt))])


def judge(weather_path, ours_path, etc, twin):
    layers, constructions, optics = read_constructions(etc)
    w = {k: np.array(v, float) for k, v in zip(*(lambda r: (r[0], zip(*r[1:])))(list(csv.reader(open(weather_path)))))}
    ours = list(csv.DictReader(open(ours_path)))
    groups = {}
    for r in ours:
        groups.setdefault((r["construction"], r["material"], float(r["tilt_deg"]), float(r["aspect_deg"])), []).append(r)
    ground_t = np.array([float(r["unix_s"]) for r in ours if r["construction"] == ours[0]["construction"]])
    ground_k = np.array([float(r["ground_k"]) for r in ours if r["construction"] == ours[0]["construction"]])
    # half grass, half concrete; albedos by the tables
    surface = {}
    for line in open(f"{etc}/surfaces.csv"):
        if not line.startswith("#") and "," in line:
            surface[line.split(",")[0]] = line.split(",")[1].strip()
    albedo = 1 - 0.5 * sum(float(optics[surface[s]]["solar_absorptance"]) for s in ("grass", "built"))

    times = np.arange(w["unix_s"][0], w["unix_s"][-1] + 1, STEP_S)
    at = {k: np.interp(times, w["unix_s"], v) for k, v in w.items()}
    ground = np.interp(times, ground_t, ground_k)
    azimuth, elevation = (np.radians(x) for x in sun_of(times))
    sun = np.stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)])
    level = at["direct_w_m2"] * np.maximum(sun[2], 0) + at["diffuse_w_m2"]
    hours = ((times / 86400 + LON / 360) % 1) * 24
    day_mean = np.empty(len(times))
    day_mean[0] = at["air_temp_k"][:1440].mean()
    for i in range(1, len(times)):
        day_mean[i] = day_mean[i - 1] + (at["air_temp_k"][i] - day_mean[i - 1]) * (1 - math.exp(-STEP_S / 86400))

    def absorbs(n, a, e):
        sky = (1 + n[2]) / 2
        low = 1 - math.sqrt(sky)
        light = np.maximum(n @ sun, 0) * at["direct_w_m2"] + sky * at["diffuse_w_m2"] + (1 - sky) * albedo * level
        return a * light + e * (sky * ((1 - low) * at["longwave_w_m2"] + low * SIGMA * at["air_temp_k"] ** 4) +
                                (1 - sky) * SIGMA * ground ** 4)

    def run(row, a, e, normals):
        rough = 1.0 if twin else float(row["rough"])
        faces = [Face(row, layers, n[2], day_mean[0] + 2) for n in normals]
        two = row["inside"] == "back"
        take = [absorbs(n, a, e) + (absorbs(-n, a, e) if two else 0) for n in normals]
        behind, out = day_mean[0] + 2, np.empty((len(times), len(normals)))
        for i, air in enumerate(at["air_temp_k"]):
            wind = at["wind_mps"][i]
            if row["inside"] == "heated":
                c = float(row["day_c"] if 6 <= hours[i] < 22 else row["night_c"])
                behind = max(c + 273.15, day_mean[i] + 3)
            elif row["inside"] == "flue":
                c = float(row["day_c"] if 6 <= hours[i] < 22 else row["night_c"])
                behind = c + 273.15 if day_mean[i] < 288.15 else air
            for f, face in enumerate(faces):
                def flux(t, up=face.up, absorbed=take[f][i]):
                    q = absorbed - e * SIGMA * t ** 4 - film(t - air, up, wind, rough) * (t - air)
                    return q - e * SIGMA * t ** 4 - film(t - air, -up, wind, rough) * (t - air) if two else q
                face.step(flux, behind)
                out[i, f] = face.surface
            if row["inside"] == "unheated":
                c, h, v = float(row["room_kj_m2k"]) * 1e3 / STEP_S, float(row["inside_w_m2k"]), float(row["room_w_m2k"])
                behind = (c * behind + h * np.mean([f.inner_k for f in faces[-5:]]) + v * air) / (c + h + v)
        return out

    for (name, material, tilt, aspect), rows in groups.items():
        row, m = constructions[name], optics[material]
        a, e = float(row["absorptance"] or m["solar_absorptance"]), 1 - float(m["rho_lwir"])
        normals = [normal_of(tilt, aspect)]
        if row["inside"] == "unheated":
            normals += [normal_of(90, x) for x in (0, 90, 180, 270)] + [np.array([0, 0, 1.0])]
        found = run(row, a, e, normals)[:, 0]
        t = np.array([float(r["unix_s"]) for r in rows])
        last = t >= t[-1] - 86400
        miss = np.array([float(r["temp_k"]) for r in rows])[last] - np.interp(t[last], times, found)
        swing = np.ptp(np.interp(t[last], times, found))
        print(f"{name} {tilt:.0f} {aspect:.0f} {np.abs(miss).max():.3f} {math.sqrt((miss ** 2).mean()):.3f} {swing:.1f}",
              flush=True)


if sys.argv[1] == "weather":
    write_weather(int(sys.argv[2]))
else:
    judge(sys.argv[1], sys.argv[2], sys.argv[3], len(sys.argv) > 4)
