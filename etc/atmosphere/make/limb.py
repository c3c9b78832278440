#!/usr/bin/env python3
"""Writes a model's limb.csv: factors on what the program makes of long paths that go down from an eye.

    etc/atmosphere/make/limb.py MODEL PITVIPER [OUT] [--work FOLDER] [--visibilities KM,KM] [--eyes M,M] [--sums]

Needs numpy, gfortran and the built program, and the network once (lowtran.py). The true radiance is a sum over shells of
the round air: Planck's radiance at the shell's temperature (temperature.csv, straight lines) times what LOWTRAN7 loses of
its transmittance over it, per 5 1/cm, of refracted rays; so without LOWTRAN's single temperature a kilometre. What
the program makes of the same rays it is asked (`probe sky`, `probe atmosphere`) while the model has no limb.csv: remove
that first. Of a ray that ends on the ground the factor brings air and a black ground of the air's temperature together to
the true sum. --sums prints sums instead, for tests: of skies by the lowest point, and of black ground by the range.
"""
import argparse
import csv
import io
import os
import subprocess

import numpy as np

import lowtran as lt

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
REFRACTED_KM, EARTH_KM = 6371.23, 6371.0  # LOWTRAN's radius in middle latitudes, and the program's
EYES_M = [200, 500, 1000, 1250, 1500, 2000, 2500, 3000, 3500, 4000, 4500, 5000, 5500, 6500, 7500, 8500, 9500, 10500, 11500, 12500,
          13500, 15000, 16000, 18000, 20000, 22000, 25000, 30000, 35000, 40000, 50000, 60000, 70000, 80000, 99900]
SKY_PLACES = [0.02, *np.arange(0.05, 0.96, 0.05).round(2), 0.975, 1]
GROUND_PLACES = [1.03, 1.07, 1.13, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9]
VISIBILITIES_KM = [5, 23]  # with tables of paths
UNCHANGED_M, UNCHANGED_PLACE, LOW_M = 200, 1.8, 20000  # as they were: eyes to there; near ground from below 20 km
SPANS = {"mwir": (2080, 2960), "lwir": (820, 1260)}
PLANCK_C1 = 1.19104297e-8  # W cm2/sr


class Air:
    def __init__(self, model, visibility_km, work):
        self.model, self.visibility_km, self.work = model, visibility_km, work
        with open(os.path.join(HERE, model, "temperature.csv"), encoding="ascii") as lines:
            rows = np.array([r for r in csv.reader(lines) if r and r[0][0].isdigit()], dtype=float)
        self.at_km, self.temp_k = rows[:, 0] / 1000, rows[:, 1]
        # refractivity of dry air in balance at rest, for rays' angles alone
        self.step_km = np.arange(0, 100.01, 0.05)
        kelvin = self.kelvin(self.step_km)
        ln_pressure = np.concatenate(([0], -np.cumsum(0.05 * 34.163 * 2 / (kelvin[1:] + kelvin[:-1]))))
        self.ln_more = np.log(77.46e-6 * 1013.25 / kelvin) + ln_pressure

    def kelvin(self, km):
        return np.interp(km, self.at_km, self.temp_k)

    def index(self, km):
        return 1 + np.exp(np.interp(km, self.step_km, self.ln_more))

    def zenith(self, eye_km, low_km, sine=1.0):
        """Of the refracted ray that has this sine of its zenith angle at low_km."""
        sine *= (REFRACTED_KM + low_km) / (REFRACTED_KM + eye_km) * self.index(low_km) / self.index(eye_km)
        return 180 - np.degrees(np.arcsin(min(sine, 1)))

    def spectra(self, cases, band, **more):
        low, high = SPANS[band]
        return lt.run(self.work, [lt.case(self.model, self.visibility_km, low=low, high=high, **c, **more)
                                  for c in cases])

    def radiance(self, cases, edges_km, band):
        """Of the shells between heights, the eye's first; and what passes of the radiance of air at the ground."""
        total, before = 0, 1
        near_km = edges_km[0]
        for spectrum, far_km in zip(self.spectra(cases, band), edges_km[1:]):
            if spectrum is None:  # LOWTRAN refuses ends too near the lowest point: the next shell has it
                continue
            wavenumber, passed = spectrum[:, 0], np.minimum(spectrum[:, 1], before)
            total = total + PLANCK_C1 * lt.planck(wavenumber, self.kelvin((near_km + far_km) / 2)) * (before - passed)
            near_km, before = far_km, passed
        ground = PLANCK_C1 * lt.planck(wavenumber, self.temp_k[0])
        return lt.integral(wavenumber, total, band), lt.integral(wavenumber, before * ground, band)

    def sky(self, eye_km, low_km):
        zenith = self.zenith(eye_km, low_km)
        down, up = shells(low_km, eye_km)[::-1], shells(low_km, 100.0)[1:]
        up = np.where(np.abs(up - eye_km) < 1e-6, up + 1e-4, up)
        cases = [dict(kind=2, h1=eye_km, h2=h, angle=zenith) for h in down[1:-1]]
        cases += [dict(kind=2, h1=eye_km, h2=h, angle=zenith, length=int(h < eye_km)) for h in up]
        edges = [*down[:-1], *up]
        return [self.radiance(cases, edges, band)[0] for band in SPANS]

    def ground(self, eye_km, place):
        """Air, and air with black ground behind it."""
        sine = np.sqrt(1 - straight_up(eye_km, place) ** 2) * (EARTH_KM + eye_km) / EARTH_KM
        zenith = self.zenith(eye_km, 0.0, min(sine, 1))
        down = shells(0.0, eye_km)[::-1]
        cases = [dict(kind=2, h1=eye_km, h2=h, angle=zenith) for h in down[1:]]
        return [self.radiance(cases, down, band) for band in SPANS]


def shells(low_km, high_km):
    """Heights between the two, close to each other at both and where the air is thick."""
    near = [0.02, 0.06, 0.12, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0]
    at = [low_km + d for d in near] + [high_km - d for d in near]
    height = low_km
    while height < high_km:
        at.append(height)
        height += 0.5 if height < 12 else 1 if height < 25 else 2.5 if height < 60 else 5
    out = [low_km]
    for height in sorted(at):
        if height - out[-1] > 0.015 and high_km - height > 0.015:
            out.append(height)
    return np.array(out + [high_km])


def edge_km(eye_km):
    return np.sqrt(eye_km * (2 * EARTH_KM + eye_km))


def lowest_km(eye_km, place):
    square = eye_km * (2 * EARTH_KM + eye_km) * (1 - place) ** 2
    return max(square / (EARTH_KM + np.sqrt(EARTH_KM ** 2 + square)), 0.0005)


def straight_up(eye_km, place):
    """Cosine of the zenith angle at the eye of the straight line to the ground."""
    range_km = (2 - place) * edge_km(eye_km)
    return -(eye_km * (2 * EARTH_KM + eye_km) / range_km + range_km) / (2 * (EARTH_KM + eye_km))


def probe(program, what, head, rows):
    text = head + "\n" + "".join(",".join(f"{x:.9f}" if isinstance(x, float) else str(x) for x in r) + "\n" for r in rows)
    done = subprocess.run([program, "probe", what], input=text, capture_output=True, text=True, check=True)
    out = list(csv.DictReader(io.StringIO(done.stdout)))
    if any(r.get("error") for r in out):
        raise SystemExit(next(r["error"] for r in out if r.get("error")))
    return out


def made(air, program, eyes_km):
    """What the program makes of the places: skies, then air before the ground and black ground behind it."""
    model, visibility = air.model, air.visibility_km
    skies, grounds = {}, {}
    for band in SPANS:
        places = [(e, p) for e in eyes_km for p in SKY_PLACES]
        rows = [(model, visibility, band, e * 1000.0,
                 float(90 + np.degrees(np.arccos((EARTH_KM + lowest_km(e, p)) / (EARTH_KM + e)))), 180, 0) for e, p in places]
        head = "model,visibility_km,band,observer_m,zenith_deg,sun_zenith_deg,rel_azimuth_deg"
        for at, row in zip(places, probe(program, "sky", head, rows)):
            skies[(band, *at)] = float(row["radiance"])
        places = [(e, p) for e in eyes_km for p in GROUND_PLACES]
        kelvin = float(air.temp_k[0])
        edges = [float(x) for x in lt.BANDS_UM[band]]
        black = float(probe(program, "planck", "lo_um,hi_um,temp_k", [(*edges, kelvin)])[0]["radiance_w_m2_sr"])
        rows = [(model, visibility, band, e * 1000.0, 0, float((2 - p) * edge_km(e)), kelvin) for e, p in places]
        head = "model,visibility_km,band,observer_m,target_m,range_km,temp_k"
        for at, row in zip(places, probe(program, "atmosphere", head, rows)):
            grounds[(band, *at)] = float(row["path_radiance"]), float(row["tau"]) * black
    return skies, grounds


def factors(air, program, eyes_m):
    skies, grounds = made(air, program, [e / 1000 for e in eyes_m])
    for eye_m in eyes_m:
        eye_km = eye_m / 1000
        yield eye_m, 0, 1, 1
        for place in SKY_PLACES:
            true = air.sky(eye_km, lowest_km(eye_km, place))
            yield eye_m, place, *(t / skies[(band, eye_km, place)] for t, band in zip(true, SPANS))
        for place in GROUND_PLACES:
            true = air.ground(eye_km, place)
            as_it_was = eye_m <= LOW_M and place >= UNCHANGED_PLACE
            yield eye_m, place, *(1 if as_it_was else (own + behind - grounds[(band, eye_km, place)][1]) /
                                  grounds[(band, eye_km, place)][0] for (own, behind), band in zip(true, SPANS))
        yield eye_m, 2, 1, 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("model", choices=sorted(lt.MODELS))
    parser.add_argument("program")
    parser.add_argument("out", nargs="?", default=HERE)
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    parser.add_argument("--visibilities", default=",".join(map(str, VISIBILITIES_KM)))
    parser.add_argument("--eyes", default=",".join(map(str, EYES_M)))
    parser.add_argument("--sums", action="store_true")
    a = parser.parse_args()
    eyes_m = [int(e) for e in a.eyes.split(",")]
    airs = [Air(a.model, float(v), a.work) for v in a.visibilities.split(",")]
    if a.sums:
        print("model,visibility_m,observer_m,tangent_m,range_m,mwir,lwir")
        for air, eye_m in ((air, eye_m) for air in airs for eye_m in eyes_m):
            eye_km, lead = eye_m / 1000, f"{a.model},{air.visibility_km * 1000:.0f},{eye_m}"
            for place in (0.08, 0.28, 0.48, 0.68, 0.88, 0.99):
                low_km = lowest_km(eye_km, place)
                print(f"{lead},{low_km * 1000:.1f},0," + ",".join(f"{x:.5g}" for x in air.sky(eye_km, low_km)), flush=True)
            for range_km in [edge_km(eye_km) * x for x in (0.9, 0.75, 0.55, 0.35)] + [eye_km * 1.0001]:
                true = air.ground(eye_km, 2 - range_km / edge_km(eye_km))
                print(f"{lead},0,{range_km * 1000:.1f}," + ",".join(f"{own + behind:.5g}" for own, behind in true), flush=True)
        return
    if os.path.exists(os.path.join(HERE, a.model, "limb.csv")):
        raise SystemExit("limb.py: the program has to answer without limb.csv: remove it first")
    path = os.path.join(a.out, a.model, "limb.csv")
    with open(path + ".part", "w", encoding="ascii") as out:
        out.write("# Thermal radiance over what tables of flat layers make of it: sums over shells of LOWTRAN7's transmittance, "
                  "rural haze\nvisibility_m,observer_m,place,mwir,lwir\n")
        for air in airs:
            visibility = f"{air.visibility_km * 1000:.0f}"
            for eye in (0, UNCHANGED_M):
                for place in (0, *SKY_PLACES, *GROUND_PLACES, 2):
                    out.write(f"{visibility},{eye},{place:g},1,1\n")
            for row in factors(air, a.program, [e for e in eyes_m if e > UNCHANGED_M]):
                out.write(f"{visibility},{row[0]},{row[1]:g},{row[2]:.4g},{row[3]:.4g}\n")
    os.rename(path + ".part", path)


if __name__ == "__main__":
    main()
