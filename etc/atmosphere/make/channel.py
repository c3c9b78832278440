#!/usr/bin/env python3
"""Fills a model's folders with the files of one more channel, <file>_<channel>.csv, by LOWTRAN7.

    etc/atmosphere/make/channel.py MODEL NAME LOW_UM HIGH_UM [--kind reflective|emissive|both] [--only METRES]
        [--response FILE]

The heights, angles and paths are those of the files beside them. Needs numpy and gfortran, and the network once
(lowtran.py). What is there already is not made again. A reflective channel takes some minutes a model. --response: the
file of etc/channels.csv (wavelength_um, response); every figure, the sunlight above the air too, is weighted by it.

Haze's phase function is drawn between those of the channels beside in the logarithms of both; clear air's scattering
is that of nir times the ratio of Rayleigh's law. Scattered sunlight of an emissive channel alone is not computed.
"""
import argparse
import csv
import os

import numpy as np

import lowtran as lt
import tables

# where the phase functions of phase.csv were taken, um
PHASE_UM = {"b": 0.45, "g": 0.55, "r": 0.65, "nir": 0.87, "mwir": 4, "lwir": 10}


def rows_of(path):
    with open(path, encoding="ascii") as lines:
        rows = csv.reader(line for line in lines if line[0] != "#")
        head = next(rows)
        return head, [[float(x) for x in row] for row in rows]


def slant(zenith_deg):
    """Logarithm of the length of a path to space."""
    c = np.cos(np.radians(zenith_deg))
    return -np.log(c + 0.025 * np.exp(-11 * c))


def keys_of(path, count):
    return list(dict.fromkeys(tuple(row[:count]) for row in rows_of(path)[1]))


def read_response(path, low_um, high_um):
    """Wavelengths, um, and response; what pitviper_response.c refuses is refused."""
    head, rows = rows_of(path)
    if "wavelength_um" not in head or "response" not in head:
        raise SystemExit(f"{path}: columns wavelength_um and response are needed")
    w, r = (np.array([row[head.index(c)] for row in rows]) for c in ("wavelength_um", "response"))
    if len(w) < 2 or not np.all(np.diff(w) > 0) or not np.all((r >= 0) & (r <= 1)) or abs(r.max() - 1) > 1e-3:
        raise SystemExit(f"{path}: rising wavelengths and a response of 0 to 1 are needed, whose greatest is 1")
    if abs(w[0] / low_um - 1) > 1e-9 or abs(w[-1] / high_um - 1) > 1e-9:
        raise SystemExit(f"{path}: goes from {w[0]:g} to {w[-1]:g} um, the channel from {low_um:g} to {high_um:g}")
    return w, r


def seen(wavenumber, value, response):
    """Integral of straight lines between the points times the response's straight lines between its own."""
    own = 1e4 / response[0][::-1]
    at = np.union1d(wavenumber[(wavenumber > own[0]) & (wavenumber < own[-1])], own)
    # twice as fine as both: the product of two straight lines is no straight line
    at = np.union1d(at, (at[1:] + at[:-1]) / 2)
    y = np.interp(at, wavenumber, value) * np.interp(1e4 / at, *response)
    return float(np.sum((y[1:] + y[:-1]) * np.diff(at)) / 2)


class Channel:
    def __init__(self, model, name, low_um, high_um, kind, work, response=None):
        self.response = response
        self.model, self.name, self.kind, self.work = model, name, kind, work
        self.low_um, self.high_um = low_um, high_um
        self.folder = os.path.join(tables.HERE, model)
        self.span = [(np.floor(1e4 / high_um / 20) * 20 - 20, np.ceil(1e4 / low_um / 20) * 20 + 20)]
        lt.BANDS_UM[name] = (low_um, high_um)
        sun = self.spectra(0, [dict(kind=3, emission=3)])[0]
        self.wavenumber, self.light = sun[:, 0], sun[:, 5]
        self.shine = tables.SHINE_K if kind != "reflective" else []

    def spectra(self, visibility_km, cases, **more):
        low, high = self.span[0]
        return lt.run(self.work, [lt.case(self.model, visibility_km, low=low, high=high, **c, **more) for c in cases])

    def integral(self, wavenumber, value):
        if self.response is None:
            return lt.integral(wavenumber, value, self.name)
        return seen(wavenumber, value, self.response)

    def write(self, folder, file, note, head, rows):
        keys = sum(not c.endswith(self.name) and not c.startswith(("depth_", "thermal_")) for c in head.split(","))
        path = os.path.join(folder, f"{file}_{self.name}.csv")
        with open(path + ".part", "w", encoding="ascii") as out:
            how = "" if self.response is None else " by a response"
            out.write(f"# LOWTRAN7 rev. 4.2 in double precision, {self.low_um:g}-{self.high_um:g} um{how}{note}\n{head}\n")
            for row in rows:
                # what stands first is a key of the file beside, to the last digit
                out.write(",".join(f"{x:.9g}" if i < keys else f"{x:.5g}" for i, x in enumerate(row)) + "\n")
        os.rename(path + ".part", path)

    def column(self, visibility_km, heights_m):
        """Extinction and scattering of level air by height: of haze alone, or of air without haze."""
        weight = lt.planck(self.wavenumber, 300) if self.kind != "reflective" else self.light
        total = self.integral(self.wavenumber, weight)
        length_km = 0.1 * min(1, visibility_km / 5) if visibility_km else 0.1
        rows = []
        cases = [dict(kind=1, h1=h / 1000, range_km=length_km) for h in heights_m]
        for height, s in zip(heights_m, self.spectra(visibility_km, cases)):
            parts = (s[:, 6], s[:, 6] / (1 - s[:, 7])) if visibility_km else (s[:, 1],)
            row = [height]
            for part in parts:
                mean = self.integral(s[:, 0], weight * -np.expm1(np.log(np.maximum(part, 1e-300)))) / total
                row.append(-np.log1p(-mean) / length_km)
            rows.append(row)
        return rows

    def rayleigh(self, low_um, high_um, light_um=None):
        v = np.linspace(1e4 / high_um, 1e4 / low_um, 400)
        weight = lt.planck(v, 5800) if light_um is None else lt.planck(v, 300)
        if self.response is not None and (low_um, high_um) == (self.low_um, self.high_um):
            weight = weight * np.interp(1e4 / v, *self.response)
        return np.sum(weight * v ** 4 / (9.38076e18 - 1.08426e9 * v ** 2)) / np.sum(weight)

    def air(self):
        folder = os.path.join(self.folder, "clear")
        head, old = rows_of(os.path.join(folder, "air.csv"))
        nir = head.index("scatter_nir")
        ratio = (self.rayleigh(self.low_um, self.high_um, None if self.kind == "reflective" else 1) /
                 self.rayleigh(*lt.BANDS_UM["nir"]))
        rows = self.column(0, [row[0] for row in old])
        self.write(folder, "air", ", no haze; 1/km", f"height_m,extinction_{self.name},scatter_{self.name}",
                   [(h, max(e, 1e-9), o[nir] * ratio) for (h, e), o in zip(rows, old)])

    def haze(self, folder, visibility_km):
        heights = [row[0] for row in rows_of(os.path.join(folder, "haze.csv"))[1]]
        self.write(folder, "haze", f", rural aerosol, {visibility_km:g} km; 1/km",
                   f"height_m,extinction_{self.name},scatter_{self.name}", self.column(visibility_km, heights))

    def phase(self):
        head, old = rows_of(os.path.join(self.folder, "phase.csv"))
        middle = np.sqrt(self.low_um * self.high_um)
        if self.response is not None:
            w = np.linspace(self.low_um, self.high_um, 400)
            middle = np.average(w, weights=np.interp(w, *self.response))
        known = sorted(PHASE_UM, key=PHASE_UM.get)
        x = [np.log(PHASE_UM[k]) for k in known]
        rows = []
        for row in old:
            value = np.exp(np.interp(np.log(middle), x, [np.log(row[head.index(k)]) for k in known]))
            rows.append([row[0], row[1], value])
        for height in dict.fromkeys(r[0] for r in rows):
            own = [r for r in rows if r[0] == height]
            c = np.cos(np.radians([r[1] for r in own]))
            mean = abs(np.trapezoid([r[2] for r in own], c)) / 2
            reference = abs(np.trapezoid([r[head.index("nir")] for r in old if r[0] == height], c)) / 2
            for r in own:
                r[2] *= reference / mean
        self.write(self.folder, "phase", f", haze's phase function at {middle:.3g} um", f"height_m,angle_deg,{self.name}", rows)

    def paths(self, folder, visibility_km):
        keys = keys_of(os.path.join(folder, "paths_b.csv"), 3)
        weights = [self.light] + [lt.planck(self.wavenumber, t) for t in self.shine]
        totals = [self.integral(self.wavenumber, w) for w in weights]
        cases = [dict(kind=1, h1=a / 1000, range_km=r / 1000) if a == b else
                 dict(kind=2, h1=a / 1000, h2=b / 1000, angle=0.0 if b > a else 180.0, stretch=r / abs(b - a))
                 for a, b, r in keys]
        rows = []
        for start in range(0, len(cases), 100):
            spectra = self.spectra(visibility_km, cases[start:start + 100], emission=1)
            for key, s in zip(keys[start:start + 100], spectra):
                ln_tau, row = np.log(np.maximum(s[:, 1], 1e-300)), list(key)
                for weight, total in zip(weights, totals):
                    lost = self.integral(self.wavenumber, weight * -np.expm1(ln_tau)) / total
                    kept = self.integral(self.wavenumber, weight * s[:, 1]) / total
                    row.append(-np.log1p(-lost) if lost < 0.5 else -np.log(max(kept, 1e-300)))
                if self.shine and visibility_km:
                    row.append(self.integral(s[:, 0], s[:, 2]) * 1e4)
                rows.append(row)
        columns = [f"depth_{t}k" for t in self.shine] + (["thermal_w_m2_sr"] if self.shine and visibility_km else [])
        self.write(folder, "paths", f", {visibility_km:g} km" if visibility_km else ", no haze",
                   ",".join(["observer_m,target_m,range_m,depth_sun"] + columns), rows)

    def sky_thermal(self, folder, visibility_km):
        places = keys_of(os.path.join(folder, "sky_thermal.csv"), 2)
        spectra = self.spectra(visibility_km, [dict(kind=3, emission=1, h1=h / 1000, angle=z) for h, z in places])
        self.write(folder, "sky_thermal", f", {visibility_km:g} km", f"observer_m,zenith_deg,{self.name}",
                   [(h, z, self.integral(s[:, 0], s[:, 2]) * 1e4) for (h, z), s in zip(places, spectra)])

    def sun(self, folder, visibility_km):
        places = keys_of(os.path.join(folder, "sun.csv"), 2)
        direct = self.spectra(visibility_km, [dict(kind=3, emission=3, h1=h / 1000, angle=z) for h, z in places])
        zeniths = list(dict.fromkeys(z for _, z in places))
        cases = [dict(kind=3, emission=2, scatter=True, angle=30, sun_zenith=z) for z in zeniths]
        fluxes = self.spectra(visibility_km, cases, step=20)
        rows = []
        for (h, z), d in zip(places, direct):
            flux = fluxes[zeniths.index(z)]
            per_wavenumber = flux[:, 8 + 32 - round(h / 1000)] * 1e4 / flux[:, 0] ** 2
            rows.append((h, z, self.integral(d[:, 0], d[:, 4]) * 1e4, self.integral(flux[:, 0], per_wavenumber) * 1e4))
        self.write(folder, "sun", f", {visibility_km:g} km",
                   f"observer_m,sun_zenith_deg,direct_{self.name},diffuse_{self.name}", rows)

    def scattered_light(self, visibility_km, keys, case_of):
        """Radiance by key. Every seventh step of LOWTRAN's resolution: within 0.5 % of all of them; a view or a sun at the
        zenith has no azimuth."""
        cases = {}
        for key in keys:
            c = case_of(key)
            if c["angle"] in (0, 180) or c["sun_zenith"] == 0:
                c["azimuth"] = 0.0
            cases[key] = tuple(c.items())
        known = dict.fromkeys(cases.values())
        some = [dict(k) for k in known]
        for start in range(0, len(some), 100):
            for c, s in zip(some[start:start + 100], self.spectra(visibility_km, some[start:start + 100], emission=2,
                                                                  scatter=True, step=140)):
                known[tuple(c.items())] = self.integral(s[:, 0], s[:, 3]) * 1e4
        return {key: known[cases[key]] for key in keys}

    def by_ratio(self, rows, axes, visibility_km, case_of):
        """Scattered light of all rows from that of some: its ratio to nir's is smooth. rows: {key: nir}; axes: for each
        part of a key (None: that it must have in common) the nodes computed and what to draw straight lines over."""
        def brackets(key):
            corners = [((), 1.0)]
            for k, (x, axis) in enumerate(zip(key, axes)):
                if axis is None:
                    ways = [(x, 1.0)]
                else:
                    nodes, over = axis(key) if callable(axis) else axis
                    high = min(int(np.searchsorted(nodes, x)), len(nodes) - 1)
                    low = max(high - 1, 0) if nodes[high] != x else high
                    t = 1.0 if low == high else (over(x) - over(nodes[low])) / (over(nodes[high]) - over(nodes[low]))
                    ways = [(nodes[low], 1 - t), (nodes[high], t)]
                corners = [(c + (x,), w * v) for c, w in corners for x, v in ways if v]
            return corners
        wanted = dict.fromkeys(c for key in rows for c, _ in brackets(key))
        got = self.scattered_light(visibility_km, list(wanted), case_of)
        ratio = {c: np.log(max(got[c], 1e-30) / max(rows[c], 1e-30)) for c in wanted}
        return [(*key, rows[key] * np.exp(sum(w * ratio[c] for c, w in brackets(key)))) for key in rows]

    def sky_scattered(self, folder, visibility_km):
        head, old = rows_of(os.path.join(folder, "sky_scattered.csv"))
        rows = {tuple(r[:4]): r[head.index("nir")] for r in old}
        rows_out = self.by_ratio(
            rows, [None, ([0, 45, 70, 85, 89.5], slant), ([0, 45, 70, 86], slant), ([0, 20, 90, 180], float)], visibility_km,
            lambda k: dict(kind=3, h1=k[0] / 1000, angle=k[1], sun_zenith=k[2], azimuth=k[3]))
        self.write(folder, "sky_scattered", f", {visibility_km:g} km, by its ratio to nir", "observer_m,zenith_deg,"
                   f"sun_zenith_deg,rel_azimuth_deg,{self.name}", rows_out)

    def scattered(self, folder, visibility_km):
        head, old = rows_of(os.path.join(folder, "scattered.csv"))
        rows = {tuple(r[:5]): r[head.index("nir")] for r in old}
        ranges = {}
        for o, z, r, _, _ in rows:
            ranges.setdefault((o, z), set()).add(r)
        ranges = {pair: sorted(r) for pair, r in ranges.items()}
        some = {pair: (sorted({r[0], r[-1]}), np.log) for pair, r in ranges.items()}
        rows_out = self.by_ratio(
            rows, [None, None, lambda k: some[k[:2]], ([0, 82], slant), ([0, 180], float)], visibility_km,
            lambda k: self.ray(k[0], k[1], k[2]) | dict(sun_zenith=k[3], azimuth=k[4]))
        self.write(folder, "scattered", f", {visibility_km:g} km, by its ratio to nir", "observer_m,zenith_deg,range_m,"
                   f"sun_zenith_deg,rel_azimuth_deg,{self.name}", rows_out)

    @staticmethod
    def ray(observer_m, zenith_deg, range_m):
        """From the ground downwards there is no path: that of 100 m up."""
        up = np.cos(np.radians(zenith_deg))
        if observer_m == 0 and up < 0:
            observer_m = 100.0
        return dict(kind=2, h1=observer_m / 1000, angle=zenith_deg, range_km=range_m / 1000)

    def make(self, only):
        def wants(folder, file):
            return not os.path.exists(os.path.join(folder, f"{file}_{self.name}.csv"))
        clear = os.path.join(self.folder, "clear")
        if only is None:
            print("sun_top_w_m2", f"{self.integral(self.wavenumber, self.light) * 1e4:.3f}", flush=True)
            if wants(self.folder, "phase"):
                self.phase()
            if wants(clear, "air"):
                self.air()
            if wants(clear, "paths"):
                self.paths(clear, 0)
        for file in ("haze", "sun", "sky_thermal", "paths", "sky_scattered", "scattered"):
            for name in sorted(os.listdir(self.folder), reverse=True):
                if not name.isdigit() or (only is not None and name != only):
                    continue
                folder, km = os.path.join(self.folder, name), int(name) / 1000
                beside = file + ("_b.csv" if file == "paths" else ".csv")
                if not os.path.exists(os.path.join(folder, beside)) or not wants(folder, file):
                    continue
                if file == "sky_thermal" and self.kind == "reflective" or "scattered" in file and self.kind == "emissive":
                    continue
                getattr(self, file)(folder, km)
                print(os.path.join(folder, file), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("model", choices=sorted(lt.MODELS))
    parser.add_argument("name")
    parser.add_argument("low_um", type=float)
    parser.add_argument("high_um", type=float)
    parser.add_argument("--kind", default="reflective", choices=["reflective", "emissive", "both"])
    parser.add_argument("--only", help="one visibility's folder, in metres")
    parser.add_argument("--response", help="a CSV file of wavelength_um and response")
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    a = parser.parse_args()
    response = read_response(a.response, a.low_um, a.high_um) if a.response else None
    Channel(a.model, a.name, a.low_um, a.high_um, a.kind, a.work, response).make(a.only)


if __name__ == "__main__":
    main()
