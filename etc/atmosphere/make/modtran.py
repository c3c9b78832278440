#!/usr/bin/env python3
"""Makes a model's folder of one's own from MODTRAN's tape7 (.tp7) files: transmittance, path and sky radiance, sun.

    etc/atmosphere/make/modtran.py BASE OUT TAPE7... [--channels LIST] [--runs LIST.csv] [--temperature FILE.csv]
        [--vapour G_M3] [--longwave KM=W_M2 ...] [--etc FOLDER]

BASE, a model's name (us1976) or folder, has what the files do not have; OUT, a new folder, is that model with the channels of
LIST (those that the spectra cover) replaced. What is needed, and what stays BASE's: README.md, From MODTRAN. What is missing is
listed by visibility and geometry, and nothing is written. Needs numpy alone.
"""
import argparse
import csv
import os
import shutil
import struct
import sys

import numpy as np

import channel
import lowtran as lt
import tape7

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
STANDARD = ("b", "g", "r", "nir", "mwir", "lwir")
# the mean height of a path over the round Earth below that of the flat layers which the tables are of, m
SAG_M = 40
SUN_K = 5772
LISTED = ("file", "run", "visibility_km", "observer_m", "target_m", "range_m", "zenith_deg")


class Refused(Exception):
    pass


def number(text, what):
    try:
        return float(text)
    except ValueError:
        raise Refused(f"{what}: '{text}' is not a number") from None


def channels_in(etc):
    """{name: (low_um, high_um, kind, response)} of channels.csv."""
    path = os.path.join(etc, "channels.csv")
    with open(path, encoding="utf-8") as lines:
        rows = list(csv.DictReader(line for line in lines if line[0] != "#"))
    out = {}
    for row in rows:
        low, high = number(row["low_um"], path), number(row["high_um"], path)
        own = row.get("response")
        response = (channel.read_response(os.path.join(etc, own), low, high) if own else
                    (np.array([low, high]), np.array([1.0, 1.0])))
        if row["name"] != "pan":
            out[row["name"]] = (low, high, row["kind"], response)
    return out


def vapour_of(model):
    """Of a supplied model at its ground, g/m3."""
    with open(os.path.join(HERE, "vapour.bin"), "rb") as file:
        data = file.read(20000)
    count, profiles = struct.unpack_from("<II", data, 40)
    for k in range(profiles):
        name, _, vapour = struct.unpack_from("<32sdd", data, 88 + 136 * count + 56 * k)
        if name.rstrip(b"\0").decode() == model:
            return 1000 * vapour
    return None


# ---- runs, by what they are of


def geometry(run):
    """("path", observer_m, target_m, range_m) or ("sky" or "sun", observer_m, zenith_deg) of a run's card 3."""
    if run.kind is None:
        raise Refused(f"{run}: its cards 1 to 3 cannot be read; say in --runs what it is of")
    observer = round(1000 * run.h1_km, 1)
    if run.kind in ("space", "sun"):
        return "sun" if run.kind == "sun" else "sky", observer, round(run.angle_deg, 3)
    if run.kind == "level":
        return "path", observer, observer, round(1000 * run.range_km, 1)
    target, length = round(1000 * run.h2_km, 1), run.range_km
    up = np.cos(np.radians(run.angle_deg))
    if length == 0 and abs(up) > 1e-6:
        length = (run.h2_km - run.h1_km) / up
    if not length >= abs(run.h2_km - run.h1_km) * 0.999 or length <= 0:
        raise Refused(f"{run}: no path from {run.h1_km:g} to {run.h2_km:g} km of range {run.range_km:g}; say in --runs what "
                      "it is of")
    sag = 1e3 * length ** 2 / (12 * run.radius_km)
    if sag > SAG_M:
        raise Refused(f"{run}: on an Earth of {run.radius_km:g} km this path of {length:g} km lies {sag:.0f} m lower than in "
                      "flat layers, which the tables are of; set RO on card 3, the Earth's radius, to 99999")
    return "path", observer, target, round(1000 * length, 1)


def read_list(path):
    """{(file's name, run): (geometry, visibility_km)} of --runs."""
    out = {}
    with open(path, encoding="utf-8") as lines:
        for row in csv.DictReader(line for line in lines if line[0] != "#"):
            where = f"{path}: {row.get('file')}, run {row.get('run')}"
            if None in row.values() or not set(LISTED) <= set(row):
                raise Refused(f"{path}: columns {', '.join(LISTED)} are needed")
            key = os.path.basename(row["file"]), int(number(row["run"], where))
            if key in out:
                raise Refused(f"{where}: is there twice")
            observer = round(number(row["observer_m"], where), 1)
            if row["zenith_deg"]:
                at = "sky", observer, round(number(row["zenith_deg"], where), 3)
            else:
                at = ("path", observer, round(number(row["target_m"], where), 1), round(number(row["range_m"], where), 1))
                if not at[3] >= abs(at[2] - at[1]) or at[3] <= 0:
                    raise Refused(f"{where}: range_m is less than the difference of the heights")
            out[key] = at, number(row["visibility_km"], where)
    return out


class Runs:
    """All runs: {(what, visibility_km): {geometry: [run]}}."""
    def __init__(self, paths, listed):
        self.of, self.models, used = {}, set(), set()
        for path in paths:
            for run in tape7.read(path):
                key = os.path.basename(path), run.number
                if key in listed:
                    at, visibility_km = listed[key]
                    used.add(key)
                    if at[0] == "sky" and run.kind == "sun":
                        at = ("sun",) + at[1:]
                else:
                    at, visibility_km = geometry(run), run.visibility_km
                self.models.add(run.model)
                self.of.setdefault((at[0], visibility_km), {}).setdefault(at[1:], []).append(run)
        for key in listed:
            if key not in used:
                raise Refused(f"--runs: there is no run {key[1]} of {key[0]}")

    def visibilities(self):
        return sorted({v for _, v in self.of if v > 0})

    def every(self):
        return (run for runs in self.of.values() for some in runs.values() for run in some)


def covers(run, low_um, high_um):
    v = run.wavenumber
    step = np.max(np.diff(v))
    return v[0] <= 1e4 / high_um + 0.5 * step and v[-1] >= 1e4 / low_um - 0.5 * step


# ---- one channel's figures


class Channel:
    """Figures of one channel, and what is missing for it."""
    def __init__(self, name, about, runs, temps):
        self.name, self.temps, self.missing, self.runs = name, temps, [], runs
        self.low_um, self.high_um, self.kind, self.response = about
        suns = [r for r in runs.every() if r.sun_top is not None and covers(r, self.low_um, self.high_um)]
        self.sun = suns[0] if suns else None
        self.thermal = self.kind != "reflective"

    def integral(self, v, value):
        return channel.seen(v, value, self.response)

    def light(self, v):
        """Sunlight above the air, to a factor."""
        return lt.planck(v, SUN_K) if self.sun is None else np.interp(v, self.sun.wavenumber, self.sun.sun_top)

    def depth(self, run, temp_k=None):
        v = run.wavenumber
        weight = self.light(v) if temp_k is None else lt.planck(v, temp_k)
        total = self.integral(v, weight)
        lost = self.integral(v, weight * -np.expm1(-run.depth)) / total
        kept = self.integral(v, weight * np.exp(-run.depth)) / total
        return -np.log1p(-lost) if lost < 0.5 else -np.log(max(kept, 1e-300))

    def radiance(self, run):
        return self.integral(run.wavenumber, run.thermal) * 1e4

    def own(self, what, visibility_km, emission=False):
        """{geometry: run} of those that cover the channel, with emission where that is wanted; each once."""
        out = {}
        for at, some in self.runs.of.get((what, visibility_km), {}).items():
            some = [r for r in some if covers(r, self.low_um, self.high_um) and (r.thermal is not None or not emission)]
            if len(some) > 1:
                raise Refused(f"{self.name}: {what} {at} of {visibility_km:g} km is there twice: {some[0]} and {some[1]}")
            if some:
                out[at] = some[0]
        return out

    def lack(self, text):
        self.missing.append(f"{self.name}: {text}")

    def paths(self, visibilities):
        """{visibility_km: {(observer, target, range): run}}, 0 first; every pair of heights both ways, each with the ranges that
        any visibility has for it. Without haze, where the way does not matter, one way is enough."""
        got = {v: self.own("path", v, self.thermal and v > 0) for v in [0.0, *visibilities]}
        for (a, b, r), run in list(got[0.0].items()):
            got[0.0].setdefault((b, a, r), run)
        heights = sorted({h for some in got.values() for a, b, _ in some for h in (a, b)})
        ranges = {}
        for some in got.values():
            for a, b, r in some:
                ranges.setdefault((min(a, b), max(a, b)), set()).add(r)
        if not heights:
            self.lack("paths: none (ITYPE 1 and 2)")
        for v, some in got.items():
            for a in heights:
                for b in heights:
                    wanted = sorted(ranges.get((min(a, b), max(a, b)), ()))
                    what = f"{f'visibility {v:g} km' if v else 'no haze'}: from {a:g} to {b:g} m"
                    if len(wanted) < 2:
                        self.lack(f"{what}: {len(wanted)} ranges, of two at least")
                    for r in wanted:
                        if (a, b, r) not in some:
                            self.lack(f"{what}: range {r:g} m{' with emission (IEMSCT 1 or 2)' if self.thermal and v else ''}")
        order = [(a, b, r) for a in heights for b in heights for r in sorted(ranges.get((min(a, b), max(a, b)), ()))]
        return {v: {at: some.get(at) for at in order} for v, some in got.items()}

    def grid(self, what, visibility_km, runs):
        """Heights, angles and runs [height][angle] of a whole grid that begins at the ground."""
        heights, angles = (sorted({at[k] for at in runs}) for k in (0, 1))
        if len(angles) < 2 or 0.0 not in heights:
            self.lack(f"{what} of visibility {visibility_km:g} km: from 0 m, at two angles from the zenith at least")
        for h in heights:
            for z in angles:
                if (h, z) not in runs:
                    self.lack(f"{what} of visibility {visibility_km:g} km: from {h:g} m, {z:g} degrees from the zenith")
        return heights, angles, [[runs.get((h, z)) for z in angles] for h in heights]

    def sky(self, visibility_km):
        return self.grid("sky (ITYPE 3, IEMSCT 1 or 2)", visibility_km, self.own("sky", visibility_km, True))

    def to_sun(self, visibility_km):
        """The sun's paths, or where there are none the sky's, whose transmittance is the same."""
        runs = self.own("sun", visibility_km) or self.own("sky", visibility_km)
        runs = {at: run for at, run in runs.items() if at[1] <= 90}
        if not runs and self.kind == "emissive":
            return None
        return self.grid("paths to space (IEMSCT 3, or ITYPE 3)", visibility_km, runs)


# ---- tables


class Table:
    """A file of BASE's copy whose columns of one channel are replaced."""
    def __init__(self, folder, file, name):
        own = os.path.join(folder, f"{file}_{name}.csv")
        self.path = own if name not in STANDARD else os.path.join(folder, file + ".csv")
        if not os.path.exists(self.path):
            raise Refused(f"{os.path.basename(self.path)}: BASE does not have it; make it with channel.py first")
        with open(self.path, encoding="ascii") as lines:
            self.comment = [line for line in lines if line[0] == "#"]
        self.head, self.rows = channel.rows_of(self.path)

    def column(self, name):
        return np.array([row[self.head.index(name)] for row in self.rows])

    def put(self, name, values, note):
        for row, value in zip(self.rows, values):
            row[self.head.index(name)] = value
        self.comment.append(f"# {name}: {note}\n")

    def write(self):
        with open(self.path, "w", encoding="ascii") as out:
            out.writelines(self.comment)
            out.write(",".join(self.head) + "\n")
            for row in self.rows:
                out.write(",".join(f"{x:.9g}" for x in row) + "\n")


def bilinear(heights, angles, value, at_heights, at_angles):
    """Straight in height and in the logarithm of the slanted path's length; the end's beyond."""
    x = channel.slant(np.array(angles))
    rows = np.array([np.interp(channel.slant(np.array(at_angles)), x, row) for row in value])
    return np.array([np.interp(h, heights, rows[:, k]) for k, h in enumerate(at_heights)])


def scaled_by(table, keys, column, at, value):
    """ln of the ratio of values on a grid to a table's column, at the table's own points."""
    first, second = (table.column(k) for k in keys)
    own_heights, own_angles = (np.unique(c) for c in (first, second))
    own = {(a, b): x for a, b, x in zip(first, second, column)}
    grid = [[own[a, b] for b in own_angles] for a in own_heights]
    heights, angles = at
    base = np.array([bilinear(own_heights, own_angles, grid, [h] * len(angles), angles) for h in heights])
    return bilinear(heights, angles, value - base, first, second)


def put_paths(c, folder, visibility_km, runs, note):
    keys = ["observer_m", "target_m", "range_m", "depth_sun"] + [f"depth_{t:g}k" for t in c.temps]
    thermal = c.thermal and visibility_km > 0
    with open(os.path.join(folder, f"paths_{c.name}.csv"), "w", encoding="ascii") as out:
        out.write(f"# {note}\n" + ",".join(keys + (["thermal_w_m2_sr"] if thermal else [])) + "\n")
        for at, run in runs.items():
            row = [max(c.depth(run, t), 1e-9) for t in [None, *c.temps]] + ([c.radiance(run)] if thermal else [])
            out.write(",".join(f"{x:.9g}" for x in at) + "," + ",".join(f"{x:.5g}" for x in row) + "\n")


def put_columns(c, out, paths, note):
    """Extinction by height: BASE's, times the ratio that level paths of the shortest range have to it at their heights. Of
    what is scattered the share stays."""
    weight = 300.0 if c.thermal else None
    shortest = {}
    for a, b, r in paths[0.0]:
        if a == b:
            shortest[a] = min(r, shortest.get(a, r))
    heights = sorted(shortest)
    per_km = {v: np.array([1000 * c.depth(runs[h, h, shortest[h]], weight) / shortest[h] for h in heights])
              for v, runs in paths.items()}
    for v in paths:
        table = (Table(os.path.join(out, "clear"), "air", c.name) if v == 0 else
                 Table(os.path.join(out, f"{1000 * v:.0f}"), "haze", c.name))
        at, own = table.column("height_m"), table.column("extinction_" + c.name)
        value = per_km[v] if v == 0 else per_km[v] - per_km[0.0]
        # haze of high air is less than the digits of a depth
        ratio = np.maximum(value, 1e-9) / np.maximum(np.interp(heights, at, own), 1e-9)
        if v > 0:
            ratio = np.where(value > 0.02 * per_km[0.0], ratio, 1.0)
        ratio = np.exp(np.interp(at, heights, np.log(ratio)))
        table.put("extinction_" + c.name, own * ratio, note)
        scatter = table.column("scatter_" + c.name)
        table.put("scatter_" + c.name, np.minimum(scatter * (ratio if v > 0 else 1), own * ratio), note)
        table.write()


def put_sky(c, folder, sky, note):
    table = Table(folder, "sky_thermal", c.name)
    own = np.log(table.column(c.name))
    value = np.log([[max(c.radiance(r), 1e-30) for r in row] for row in sky[2]])
    more = scaled_by(table, ("observer_m", "zenith_deg"), own, sky[:2], value)
    table.put(c.name, np.exp(own + more), note)
    table.write()


def put_sun(c, folder, sun, top_w_m2, note):
    """Direct light by its depth; what is diffuse comes through as much more or less absorbing air, about."""
    table = Table(folder, "sun", c.name)
    direct = np.log(np.clip(-np.log(np.maximum(table.column("direct_" + c.name), 1e-300) / top_w_m2), 1e-9, 690))
    value = np.log([[np.clip(c.depth(r), 1e-9, 690) for r in row] for row in sun[2]])
    now = direct + scaled_by(table, ("observer_m", "sun_zenith_deg"), direct, sun[:2], value)
    table.put("direct_" + c.name, top_w_m2 * np.exp(-np.exp(now)), note)
    change = np.clip(np.exp(now) - np.exp(direct), -1, 5)
    diffuse = np.minimum(table.column("diffuse_" + c.name) * np.exp(-change), top_w_m2)
    table.put("diffuse_" + c.name, diffuse, note)
    table.write()


# ---- the folder


def open_base(name):
    folder = name if os.path.isdir(name) else os.path.join(HERE, name)
    if not os.path.exists(os.path.join(folder, "visibilities.csv")):
        raise Refused(f"there is no model {name}")
    return folder


def begin(out, base, a, runs):
    """Copies of BASE what OUT has of it, and writes what says which air this is."""
    model = os.path.basename(os.path.normpath(base))
    visibilities = runs.visibilities()
    same = runs.models == {lt.MODELS.get(model)}
    longwave = {}
    for text in a.longwave:
        km, _, w_m2 = text.partition("=")
        longwave[number(km, "--longwave")] = number(w_m2, "--longwave")
    head, rows = channel.rows_of(os.path.join(base, "visibilities.csv"))
    known = {row[head.index("visibility_m")] / 1000: row[head.index("longwave_down_w_m2")] for row in rows}
    def has(v, file):
        return os.path.exists(os.path.join(base, f"{1000 * v:.0f}", file))
    for v in visibilities:
        if v not in known or not has(v, "paths_b.csv"):
            whole = [f"{k:g}" for k in known if has(k, "paths_b.csv")]
            raise Refused(f"visibility {v:g} km (VIS on card 2): BASE has paths of {', '.join(whole)} km alone")
    if not any(has(v, "scattered.csv") for v in visibilities):
        light = [f"{k:g}" for k in known if has(k, "scattered.csv")]
        raise Refused(f"one of the visibilities must be {' or '.join(light)} km, of which BASE has scattered light")
    if not same:
        for option, given in (("--temperature", a.temperature), ("--vapour", a.vapour is not None),
                              ("--longwave", set(visibilities) <= set(longwave))):
            if not given:
                raise Refused(f"these runs are of another air (MODEL on card 1) than {model}: {option} is needed")
    vapour = a.vapour if a.vapour is not None else vapour_of(model)
    os.makedirs(out)
    for file in sorted(os.listdir(base)):
        if file.startswith("phase") or file == "temperature.csv":
            shutil.copy(os.path.join(base, file), out)
    for folder in ["clear"] + [f"{1000 * v:.0f}" for v in visibilities]:
        shutil.copytree(os.path.join(base, folder), os.path.join(out, folder))
    if a.temperature:
        head, rows = channel.rows_of(a.temperature)
        if head != ["height_m", "temp_k"] or rows[0][0] != 0:
            raise Refused(f"{a.temperature}: columns height_m (from 0) and temp_k are needed")
        shutil.copy(a.temperature, os.path.join(out, "temperature.csv"))
    if vapour is not None:
        with open(os.path.join(out, "ground.csv"), "w", encoding="ascii") as file:
            file.write(f"vapour_g_m3\n{vapour:.6g}\n")
    with open(os.path.join(out, "visibilities.csv"), "w", encoding="ascii") as file:
        file.write("visibility_m,longwave_down_w_m2\n")
        for v in visibilities:
            file.write(f"{1000 * v:.0f},{longwave.get(v, known[v]):.2f}\n")


def convert(a):
    base, etc = open_base(a.base), a.etc
    if os.path.exists(a.out):
        raise Refused(f"{a.out} exists; OUT is a new folder")
    runs = Runs(a.tape7, read_list(a.runs) if a.runs else {})
    about = channels_in(etc)
    names = a.channels.split(",") if a.channels else [
        n for n in about if (n in STANDARD) and any(covers(r, *about[n][:2]) for r in runs.every())]
    visibilities = runs.visibilities()
    if not visibilities:
        raise Refused("no run has haze (IHAZE on card 2), of which a visibility's tables are made")
    head, rows = [], []
    with open(os.path.join(etc, "atmosphere", "bands.csv"), encoding="ascii") as lines:
        head, *rows = csv.reader(line for line in lines if line[0] != "#")
    top = {row[head.index("band")]: float(row[head.index("sun_top_w_m2")]) for row in rows}
    work, missing = [], []
    for name in names:
        if name not in about or name not in top:
            raise Refused(f"--channels: {name} is no row of channels.csv and of atmosphere/bands.csv")
        path = os.path.join(base, "clear", f"paths_{name}.csv")
        if not os.path.exists(path):
            raise Refused(f"BASE has no channel {name}; make it with channel.py first")
        temps = [float(c[6:-1]) for c in channel.rows_of(path)[0] if c.startswith("depth_") and c != "depth_sun"]
        c = Channel(name, about[name], runs, temps)
        paths = c.paths(visibilities)
        sky = {v: c.sky(v) for v in visibilities} if c.thermal else {}
        sun = {v: c.to_sun(v) for v in visibilities}
        work.append((c, paths, sky, sun))
        missing += c.missing
    if not names:
        raise Refused("no channel lies within these spectra")
    if missing:
        raise Refused("\n".join([f"{len(missing)} things are missing:"] + missing[:40] + (["..."] if len(missing) > 40 else [])))
    part = a.out.rstrip("/") + ".part"
    shutil.rmtree(part, ignore_errors=True)
    try:
        begin(part, base, a, runs)
        for c, paths, sky, sun in work:
            note = f"of {os.path.basename(a.tape7[0])}{' and others' if len(a.tape7) > 1 else ''} by modtran.py"
            for v, some in paths.items():
                put_paths(c, os.path.join(part, f"{1000 * v:.0f}" if v else "clear"), v, some, note)
            put_columns(c, part, paths, note)
            for v in visibilities:
                folder = os.path.join(part, f"{1000 * v:.0f}")
                if c.thermal:
                    put_sky(c, folder, sky[v], note)
                if sun[v]:
                    put_sun(c, folder, sun[v], top[c.name], note)
            print(f"{c.name}: {len(paths[0.0])} paths, visibility {', '.join(f'{v:g}' for v in visibilities)} km"
                  + ("" if c.sun else f"; sunlight as of a black body of {SUN_K} K: no run has that above the air"))
        os.rename(part, a.out)
    finally:
        shutil.rmtree(part, ignore_errors=True)
    rest = [n for n in about if n not in names and n in STANDARD]
    print(f"of {os.path.basename(os.path.normpath(base))}: scattered light and phase functions"
          + (f"; all of {', '.join(rest)}" if rest else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("base")
    parser.add_argument("out")
    parser.add_argument("tape7", nargs="+")
    parser.add_argument("--channels", help="names, separated by commas")
    parser.add_argument("--runs", help="a CSV file: file,run,visibility_km,observer_m,target_m,range_m,zenith_deg")
    parser.add_argument("--temperature", help="a CSV file: height_m,temp_k")
    parser.add_argument("--vapour", type=float, help="water vapour at the ground, g/m3")
    parser.add_argument("--longwave", action="append", default=[], help="KM=W_M2: thermal light of the sky at a visibility")
    parser.add_argument("--etc", default=os.path.dirname(HERE), help="the folder of channels.csv and atmosphere/bands.csv")
    try:
        convert(parser.parse_args())
    except (Refused, tape7.Tape7Error, OSError) as error:
        sys.exit(f"modtran.py: {error}")


if __name__ == "__main__":
    main()
