#!/usr/bin/env python3
"""Makes etc/atmosphere/vapour.bin by LOWTRAN7: clear air by temperature and water vapour at the ground.

    etc/atmosphere/make/vapour.py [OUT] [--work FOLDER] [--between]

Nodes are the six atmospheres of LOWTRAN7, each with its water vapour times some factors. Needs numpy and gfortran, and
the network once (lowtran.py). Takes about five minutes of one processor; what a folder of --work has already is not
computed again. Heights, paths and angles are those of us1976's tables, channels those of CHANNELS. README.md has the
layout of the file.
"""
import argparse
import os
import re
import struct

import numpy as np

import lowtran as lt
import tables
from channel import rows_of

MAGIC, VERSION = b"PVVAPOUR", 1
LOWEST = 0.04
# in the order of their temperatures at the ground; factors of their vapour, the last beyond saturation at the
# temperature of the next
NODES = {"subarctic_winter": [LOWEST, 0.15, 0.4, 1, 2, 3.9], "midlat_winter": [LOWEST, 0.12, 0.4, 1, 2, 3.6],
         "subarctic_summer": [LOWEST, 0.1, 0.3, 1, 1.5], "us1976": [LOWEST, 0.12, 0.4, 1, 1.9, 3.2],
         "midlat_summer": [LOWEST, 0.1, 0.3, 1, 1.9], "tropical": [LOWEST, 0.1, 0.3, 1, 1.6, 2.5]}
# what is interpolated in the vapour itself, the others in its root: continuum, and lines
SELF = ("lwir",)
SPANS = {"lwir": (820, 1260, 5), "mwir": (2080, 2960, 5), "optical": (9080, 25000, 20), "swir": (5860, 10020, 20)}
SPAN_OF = {"b": "optical", "g": "optical", "r": "optical", "nir": "optical", "mwir": "mwir", "lwir": "lwir",
           "swir": "swir"}
CHANNELS = list(SPAN_OF)
lt.BANDS_UM["swir"] = (1.0, 1.7)
HUMIDITIES = [0, 30, 50, 60, 70, 75, 80, 85, 90, 93, 95, 97, 98, 99]
# visibilities of the sky, of which the first is also that of haze itself
HAZE_KM, THICK_KM = 23, 5
# where the share of haze that adds to a band's depth is taken, and of which emitter; and the path's own emission
HAZY_KM, HAZY_K, EMIT_K = 10, 300, 260


def thermal(channel):
    return channel in ("mwir", "lwir")


def profiles(folder):
    """Temperatures at LOWTRAN's levels and vapour at the ground, kg/m3, of its six atmospheres, from its source."""
    text = open(os.path.join(folder, "run.f"), encoding="latin-1").read()
    text = text[text.index("BLOCK DATA MLATMB"):text.index("END BLOCKDATA MLATMB")]

    def numbers(name):
        block = re.search(rf"DATA {name}/(.*?)/", text, re.S).group(1)
        lines = [line for line in block.split("\n") if not line.startswith("C")]
        return [float(x) for x in re.findall(r"[0-9.]+E?[+-]?[0-9]*", " ".join(line[6:] for line in lines))]
    level_km = numbers("ALT")
    out = {}
    for name, i in lt.MODELS.items():
        temp_k, mbar, ppmv = numbers(f"T{i}"), numbers(f"P{i}"), numbers(f"AMOL{i}1")
        vapour = ppmv[0] * 1e-6 * mbar[0] * 100 / (461.52 * temp_k[0])
        out[name] = (temp_k, vapour)
    return level_km, out


class Maker:
    def __init__(self, work):
        self.work = work
        lt.build(work)
        folder = os.path.join(tables.HERE, "us1976", "clear")
        head, rows = rows_of(os.path.join(folder, "paths_b.csv"))
        keys = {}
        for row in rows:
            keys.setdefault((row[0], row[1]), []).append(row[2])
        self.ends = sorted({a for a, _ in keys})
        for (a, b), ranges in keys.items():
            assert keys[b, a] == ranges
        self.pairs = [(a, b) for a in self.ends for b in self.ends if b >= a]
        self.paths = [(a, b, r) for a, b in self.pairs for r in keys[a, b]]
        self.ranges = [keys[pair] for pair in self.pairs]
        self.both_ways = [(a, b, r) for a in self.ends for b in self.ends for r in keys[a, b]]
        self.temps = {}
        for channel in CHANNELS:
            head, _ = rows_of(os.path.join(folder, f"paths_{channel}.csv"))
            self.temps[channel] = [float(c[6:-1]) for c in head if re.fullmatch(r"depth_\d+k", c)]
        light = [self.spectrum("us1976", 1, dict(kind=3, emission=3), span, 0)[:, 5] for span in SPANS]
        self.light = dict(zip(SPANS, light))

    def spectra(self, model, vapour, cases, span, visibility_km):
        low, high, step = SPANS[span] if isinstance(span, str) else span
        return lt.run(self.work, [lt.case(model, visibility_km, vapour=vapour, low=low, high=high, step=step, **c)
                                  for c in cases])

    def spectrum(self, model, vapour, case, span, visibility_km):
        return self.spectra(model, vapour, [case], span, visibility_km)[0]

    def depths(self, spectrum, channel, temps):
        """Of sunlight, then of emitters of these temperatures."""
        v = spectrum[:, 0]
        ln_tau = np.log(np.maximum(spectrum[:, 1], 1e-300))
        out = []
        for weight in [self.light[SPAN_OF[channel]]] + [lt.planck(v, t) for t in temps]:
            total = lt.integral(v, weight, channel)
            lost = lt.integral(v, weight * -np.expm1(ln_tau), channel) / total
            kept = lt.integral(v, weight * spectrum[:, 1], channel) / total
            out.append(-np.log1p(-lost) if lost < 0.5 else -np.log(max(kept, 1e-300)))
        return out

    def all_depths(self, model, vapour, cases, temps):
        """{channel: [case][weight]}"""
        out = {}
        for span in SPANS:
            got = self.spectra(model, vapour, cases, span, 0)
            for channel in CHANNELS:
                if SPAN_OF[channel] == span:
                    out[channel] = np.array([self.depths(s, channel, temps[channel]) for s in got])
        return out

    def node(self, model, vapour):
        """All that a node of the file has; {name: array}, kept in the work folder."""
        kept = os.path.join(self.work, f"node_{model}_{vapour:g}.npz")
        if os.path.exists(kept):
            return dict(np.load(kept))
        none = {c: [] for c in CHANNELS}
        out = {}
        cases = [dict(kind=1, h1=a / 1000, range_km=r / 1000) if a == b else
                 dict(kind=2, h1=a / 1000, h2=b / 1000, angle=0.0, stretch=r / (b - a)) for a, b, r in self.paths]
        for channel, depth in self.all_depths(model, vapour, cases, self.temps).items():
            out["path_" + channel] = depth
        # of level air the mean over a band weighted by sunlight or by a black body of 300 K
        cases = [dict(kind=1, h1=h / 1000, range_km=0.1) for h in tables.HEIGHTS_M]
        weights = {c: [300.0] if thermal(c) else [] for c in CHANNELS}
        for channel, depth in self.all_depths(model, vapour, cases, weights).items():
            out["air_" + channel] = depth[:, -1] / 0.1
        cases = [dict(kind=3, h1=h, angle=z) for h in tables.SUN_HEIGHTS_KM for z in tables.SUN_ZENITHS]
        for channel, depth in self.all_depths(model, vapour, cases, none).items():
            out["sun_" + channel] = depth[:, 0]
        cases = [dict(kind=3, emission=1, h1=h / 1000, angle=z) for h in tables.SKY_HEIGHTS_M for z in tables.SKY_ZENITHS]
        for channel in ("mwir", "lwir"):
            out["sky_" + channel] = np.array([lt.integral(s[:, 0], s[:, 2], channel) * 1e4 for s in
                                              self.spectra(model, vapour, cases, channel, HAZE_KM)])
        gauss, weight = np.polynomial.legendre.leggauss(tables.GAUSS)
        cosine = (1 + gauss) / 2
        cases = [dict(kind=3, emission=1, angle=float(np.degrees(np.arccos(c)))) for c in cosine]
        radiances = [np.sum((s[1:, 2] + s[:-1, 2]) * np.diff(s[:, 0])) / 2 * 1e4
                     for s in self.spectra(model, vapour, cases, (50, 3000, 5), HAZE_KM)]
        out["longwave"] = np.sum(np.pi * weight * cosine * radiances)
        np.savez(kept, **out)
        print(model, vapour, float(out["longwave"]), flush=True)
        return out

    def hazy(self, model, vapour):
        """Of paths with haze, observer first: depths for HAZY_K and EMIT_K and the path's own radiance; of mwir, lwir."""
        kept = os.path.join(self.work, f"hazy_{model}_{vapour:g}.npz")
        if os.path.exists(kept):
            return dict(np.load(kept))
        out = {}
        cases = [dict(kind=1, h1=a / 1000, range_km=r / 1000) if a == b else
                 dict(kind=2, h1=a / 1000, h2=b / 1000, angle=0.0 if b > a else 180.0, stretch=r / abs(b - a))
                 for a, b, r in self.both_ways]
        for channel in ("mwir", "lwir"):
            got = self.spectra(model, vapour, [c | dict(emission=1) for c in cases], channel, HAZY_KM)
            out["depth_" + channel] = np.array([self.depths(s, channel, [HAZY_K, EMIT_K])[1:] for s in got])
            out["light_" + channel] = np.array([lt.integral(s[:, 0], s[:, 2], channel) * 1e4 for s in got])
        np.savez(kept, **out)
        print("hazy", model, vapour, flush=True)
        return out

    def thick_sky(self, model, vapour):
        """The sky through haze of THICK_KM."""
        kept = os.path.join(self.work, f"sky_{model}_{vapour:g}.npz")
        if os.path.exists(kept):
            return dict(np.load(kept))
        out = {}
        cases = [dict(kind=3, emission=1, h1=h / 1000, angle=z) for h in tables.SKY_HEIGHTS_M for z in tables.SKY_ZENITHS]
        for channel in ("mwir", "lwir"):
            out["sky_" + channel] = np.array([lt.integral(s[:, 0], s[:, 2], channel) * 1e4 for s in
                                              self.spectra(model, vapour, cases, channel, THICK_KM)])
        np.savez(kept, **out)
        print("sky", model, vapour, flush=True)
        return out

    def haze_of(self, model, vapour, heights_m, visibility_km=HAZE_KM):
        """Extinction and scattering of haze, 1/km: {channel: [height][2]}"""
        out = {}
        cases = [dict(kind=1, h1=h / 1000, range_km=0.1) for h in heights_m]
        for span in SPANS:
            for s in self.spectra(model, vapour, cases, span, visibility_km):
                for channel in CHANNELS:
                    if SPAN_OF[channel] != span:
                        continue
                    weight = lt.planck(s[:, 0], 300) if thermal(channel) else self.light[span]
                    total = lt.integral(s[:, 0], weight, channel)
                    both = [-np.log1p(-lt.integral(s[:, 0], weight * -np.expm1(np.log(part)), channel) / total) / 0.1
                            for part in (s[:, 6], s[:, 6] / (1 - s[:, 7]))]
                    out.setdefault(channel, []).append(both)
        return {c: np.array(v) for c, v in out.items()}

    def haze(self):
        """Of the six atmospheres by height; of us1976 at the ground by relative humidity."""
        kept = os.path.join(self.work, "haze.npz")
        if os.path.exists(kept):
            return dict(np.load(kept))
        out = {}
        for model in NODES:
            for channel, value in self.haze_of(model, 1, tables.HEIGHTS_M).items():
                out[f"haze_{model}_{channel}"] = value
            for channel, value in self.haze_of(model, 1, tables.HEIGHTS_M, HAZY_KM).items():
                out[f"hazy_{model}_{channel}"] = value
        # LOWTRAN's own saturation, g/m3
        temp_k, vapour = profiles(self.work)[1]["us1976"]
        a = 273.15 / temp_k[0]
        full = a * np.exp(18.9766 - 14.9595 * a - 2.43882 * a * a) * 1e-3
        for humidity in HUMIDITIES:
            for channel, value in self.haze_of("us1976", max(humidity / 100 * full / vapour, 1e-3), [0]).items():
                out[f"humid_{humidity}_{channel}"] = value[0]
        np.savez(kept, **out)
        return out


def csv_of(model, channel):
    """The rows of a model's own tables: {(a, b, range): depths}, extinction and scattering by height."""
    folder = os.path.join(tables.HERE, model, "clear")
    head, rows = rows_of(os.path.join(folder, f"paths_{channel}.csv"))
    first = head.index("depth_sun")
    beside = "_swir" if channel == "swir" else ""
    air_head, air = rows_of(os.path.join(folder, f"air{beside}.csv"))
    columns = [air_head.index("extinction_" + channel), air_head.index("scatter_" + channel)]
    return {tuple(r[:3]): r[first:] for r in rows}, np.array([[r[c] for c in columns] for r in air])


def mean(heights_m, value, a, b):
    """Of straight lines between heights; at a height where both are it."""
    if abs(a - b) < 1:
        return float(np.interp(a, heights_m, value))
    low, high = min(a, b), max(a, b)
    at = np.concatenate(([low], [h for h in heights_m if low < h < high], [high]))
    y = np.interp(at, heights_m, value)
    return float(np.sum((y[1:] + y[:-1]) * np.diff(at)) / 2 / (high - low))


def black(channel, temps_k):
    low, high = lt.BANDS_UM[channel]
    v = np.linspace(1e4 / high, 1e4 / low, 400)
    return np.array([np.sum(1.191042972e-8 * (lt.planck(v, t)[1:] + lt.planck(v, t)[:-1]) * np.diff(v)) / 2
                     for t in temps_k])


def saturation_pa(temp_k):
    """As terrain/weather/weather.h has it."""
    c = temp_k - 273.15
    return 611 * np.exp(17.502 * c / (240.97 + c))


def under_haze(maker, haze, profile, level_km, model, vapour, channel, clear):
    """What render/air/atmosphere_weather.c makes of a node's paths in haze: the ratio of the depth that haze adds to
    its column's, and that of the path's radiance, were it opaque, to the black air of the column."""
    temp_k, ground = profile[model]
    got, emit = maker.hazy(model, vapour), maker.temps[channel].index(HAZY_K) + 1
    own = min(ground * 461.52 * temp_k[0] / saturation_pa(temp_k[0]), 1)
    humid = [haze[f"humid_{h}_{channel}"][0] for h in HUMIDITIES]
    swell = np.interp([min(own * vapour, 1), own], [h / 100 for h in HUMIDITIES], humid)
    heights = np.array(tables.HEIGHTS_M)
    column = haze[f"hazy_{model}_{channel}"][:, 0] * (
        1 + np.clip((3000 - heights) / 1000, 0, 1) * (swell[0] / swell[1] - 1))
    air = clear["air_" + channel]
    shine = air * black(channel, np.interp(heights / 1000, level_km, temp_k))
    row = {p: k for k, p in enumerate(maker.paths)}
    ratio, opaque = np.zeros(len(maker.paths)), []
    for (a, b, r), depth, light in zip(maker.both_ways, got["depth_" + channel], got["light_" + channel]):
        if b >= a:
            at = row[a, b, r]
            ratio[at] = (depth[0] - clear["path_" + channel][at, emit]) / (r / 1000 * mean(heights, column, a, b))
        opaque.append(light / -np.expm1(-depth[1]) * mean(heights, air, a, b) / mean(heights, shine, a, b))
    return np.clip(ratio, 1e-3, 10), np.array(opaque)


def pack(maker, out):
    level_km, profile = profiles(maker.work)
    nodes = [(model, f) for model in NODES for f in NODES[model]]
    value = {(model, f): maker.node(model, f) for model, f in nodes}
    haze = maker.haze()
    # coarser steps and rounding: the depths of us1976 and midlat_summer are those of their own tables
    scale, scatter = {}, {}
    for channel in CHANNELS:
        for model in ("us1976", "midlat_summer"):
            own, air = csv_of(model, channel)
            scale[model, channel] = (np.array([own[p] for p in maker.paths]) / value[model, 1]["path_" + channel],
                                     air[:, 0] / value[model, 1]["air_" + channel])
            scatter[model, channel] = air[:, 1]
            print(channel, model, "depths of this run are the tables' within",
                  [float(np.abs(s - 1).max()) for s in scale[model, channel]])
    body = bytearray()

    def put(array, kind="<f4"):
        body.extend(np.ascontiguousarray(array, dtype=kind).tobytes())
    for channel in CHANNELS:
        low, high = lt.BANDS_UM[channel]
        body.extend(channel.encode().ljust(16, b"\0") + struct.pack("<ddII", low, high, 1 + len(maker.temps[channel]),
                                                                     channel in SELF))
        put((maker.temps[channel] + [0] * 12)[:12], "<f8")
    first = 0
    for model in NODES:
        body.extend(model.encode().ljust(32, b"\0") + struct.pack("<ddII", profile[model][0][0], profile[model][1],
                                                                   first, len(NODES[model])))
        first += len(NODES[model])
    put([f for _, f in nodes], "<f8")
    levels = [k for k, z in enumerate(level_km) if any(abs(z * 1000 - h) < 1e-6 for h in
                                                       [r[0] for r in rows_of(os.path.join(tables.HERE, "us1976", "temperature.csv"))[1]])]
    put([level_km[k] * 1000 for k in levels], "<f8")
    put(tables.HEIGHTS_M, "<f8")
    put(maker.ends, "<f8")
    put([len(r) for r in maker.ranges], "<f8")
    put([x for r in maker.ranges for x in r], "<f8")
    put(tables.SKY_HEIGHTS_M, "<f8")
    put(tables.SKY_ZENITHS, "<f8")
    put([1000 * h for h in tables.SUN_HEIGHTS_KM], "<f8")
    put(tables.SUN_ZENITHS, "<f8")
    put([h / 100 for h in HUMIDITIES], "<f8")
    for model in NODES:
        put([profile[model][0][k] for k in levels])
    for model in NODES:
        for channel in CHANNELS:
            put(haze[f"haze_{model}_{channel}"].T)
    for channel in CHANNELS:
        put(np.array([haze[f"humid_{h}_{channel}"] for h in HUMIDITIES]).T)
    for model, f in nodes:
        v = value[model, f]
        of = model if model == "midlat_summer" else "us1976"
        put(v["longwave"])
        for channel in ("mwir", "lwir"):
            put(v["sky_" + channel])
        for channel in ("mwir", "lwir"):
            put(maker.thick_sky(model, f)["sky_" + channel])
        both = [under_haze(maker, haze, profile, level_km, model, f, channel, v) for channel in ("mwir", "lwir")]
        for ratio, _ in both:
            put(ratio)
        for _, opaque in both:
            put(opaque)
        for channel in CHANNELS:
            path, air = scale[of, channel]
            thinner = v["air_b"] / value[of, 1]["air_b"] # of Rayleigh's scattering, all of what b loses
            put(np.maximum(v["air_" + channel] * air, 1e-9))
            put(scatter[of, channel] * thinner)
            put(np.maximum(v["sun_" + channel], 1e-9))
            put(np.maximum(v["path_" + channel] * path, 1e-12))
    counts = [len(CHANNELS), len(NODES), len(nodes), len(levels), len(tables.HEIGHTS_M), len(maker.ends), len(maker.paths),
              len(tables.SKY_HEIGHTS_M), len(tables.SKY_ZENITHS), len(tables.SUN_HEIGHTS_KM), len(tables.SUN_ZENITHS),
              len(HUMIDITIES)]
    checked = struct.pack("<12I", *counts) + bytes(body)
    word = np.frombuffer(checked, dtype="<u4").astype(np.uint64)
    with np.errstate(over="ignore"):
        sums = np.sum(word), np.sum(word * np.arange(len(word), 0, -1, dtype=np.uint64))
    head = MAGIC + struct.pack("<IIQQQ", VERSION, 0, 40 + len(checked), int(sums[0]), int(sums[1]))
    body = checked
    with open(out + ".part", "wb") as file:
        file.write(head + body)
    os.rename(out + ".part", out)
    print(out, os.path.getsize(out), "octets")


def between(maker, out):
    """Figures between the nodes for tests/render/test_atmosphere_weather.c: transmittance of paths in haze of HAZE_KM."""
    factors = {"subarctic_winter": [0.25, 1.4], "midlat_winter": [0.07, 0.22, 0.65, 1.5, 2.7],
               "us1976": [0.22, 0.65, 1.4, 2.5], "tropical": [0.06, 0.18, 0.6, 1.3, 2]}
    paths = [(0, 0, 1000), (0, 0, 5000), (0, 0, 20000), (1000, 1000, 5000), (0, 2000, 2000), (0, 2000, 8000)]
    profile = profiles(maker.work)[1]
    bands = [c for c in CHANNELS if c != "swir"]
    with open(out, "w", encoding="ascii") as file:
        file.write("# etc/atmosphere/make/vapour.py --between: LOWTRAN7, rural haze of 23 km; thermal bands for 300 K\n"
                   "temp_k,vapour_g_m3,observer_m,target_m,range_m," + ",".join(bands) + "\n")
        for model in factors:
            for factor in factors[model]:
                cases = [dict(kind=1, h1=a / 1000, range_km=r / 1000) if a == b else
                         dict(kind=2, h1=a / 1000, h2=b / 1000, angle=0.0, stretch=r / (b - a)) for a, b, r in paths]
                tau = {}
                for channel in bands:
                    got = maker.spectra(model, factor, cases, SPAN_OF[channel], HAZE_KM)
                    tau[channel] = [np.exp(-maker.depths(s, channel, [300] if thermal(channel) else [])[-1]) for s in got]
                for k, path in enumerate(paths):
                    file.write(f"{profile[model][0][0]:g},{1000 * factor * profile[model][1]:.6g},{path[0]},{path[1]},"
                               f"{path[2]}," + ",".join(f"{tau[c][k]:.6f}" for c in bands) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("out", nargs="?", help="vapour.bin in etc/atmosphere; with --between a file that must be named")
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    parser.add_argument("--between", action="store_true", help="not that file, but figures between its nodes for a test")
    a = parser.parse_args()
    if a.between and not a.out:
        parser.error("--between: which file? vapour.py FILE --between")
    (between if a.between else pack)(Maker(a.work), a.out or os.path.join(tables.HERE, "vapour.bin"))


if __name__ == "__main__":
    main()
