#!/usr/bin/env python3
"""Measures figures of etc/ground_detail.csv from an orthophoto, a surface model and a cover raster of one grid of 1 m.

usage: measure_ground_detail.py PHOTO.tif COVER.tif TERRAIN.tif SURFACE.tif   (needs numpy and Pillow)

A line a class: standard deviation over mean of the linear reflectance (green), skew, and autocorrelation at 1 .. 32 m
within windows of 64 m of mostly one class, each less its own mean plane; then a fit of two exponentials. A pixel is the
mean of 1 m: the fit is of the covariance filtered by that square, so that sigma is that of the unfiltered ground.
Paved: bare of the cover raster, dark and grey, no water. The height is the surface model over the terrain model."""
import sys

import numpy as np
from PIL import Image

LAGS = np.array([1, 2, 3, 4, 6, 8, 12, 16, 24])


def raster(path):
    return np.asarray(Image.open(path)).astype(float)


def linear(v):
    v = v / 255
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def box_filtered(lag, length, pixel=1.0, steps=24):
    """Covariance exp(-d / length) of means over squares at a distance along x."""
    u = (np.arange(steps) + 0.5) / steps * 2 - 1
    w = 1 - np.abs(u)
    w2 = np.outer(w, w) / np.outer(w, w).sum()
    x, y = np.meshgrid(u * pixel, u * pixel)
    return np.array([(w2 * np.exp(-np.hypot(d + x, y) / length)).sum() for d in lag])


def windows(value, mask, size=64, least=0.6):
    for j in range(0, value.shape[0] - size, size):
        for i in range(0, value.shape[1] - size, size):
            m = mask[j:j + size, i:i + size]
            if m.mean() >= least:
                yield value[j:j + size, i:i + size], m


def measure(value, mask, relative, least):
    cov = np.zeros(len(LAGS) + 1)
    pairs = np.zeros(len(LAGS) + 1)
    cube = count = 0
    used = 0
    for v, m in windows(value, mask, least=least):
        y, x = np.mgrid[0:v.shape[0], 0:v.shape[1]]
        a = np.stack([np.ones(m.sum()), x[m], y[m]], 1)
        plane, *_ = np.linalg.lstsq(a, v[m], rcond=None)
        r = v - (plane[0] + plane[1] * x + plane[2] * y)
        if relative:
            r = r / v[m].mean()
        low, high = np.percentile(r[m], [0.2, 99.8])  # single wrong cells
        m = m & (r >= low) & (r <= high)
        r = np.where(m, r, 0)
        for k, d in enumerate([0, *LAGS]):
            for s in ((slice(None), slice(d, None)), (slice(d, None), slice(None))):
                t = (s[0], slice(None, -d or None)) if s[0] == slice(None) else (slice(None, -d or None), s[1])
                both = m[s] & m[t]
                cov[k] += (r[s] * r[t])[both].sum()
                pairs[k] += both.sum()
        cube += (r[m] ** 3).sum()
        count += m.sum()
        used += 1
    if used < 3:
        return None
    cov /= pairs
    skew = cube / count / cov[0] ** 1.5
    best = None
    lengths = np.geomspace(0.2, 30, 22)
    kernel = {a: box_filtered(np.array([0, *LAGS]), a) for a in lengths}
    for i, a in enumerate(lengths):
        for b in lengths[i + 1:]:
            k = np.stack([kernel[a], kernel[b]], 1)
            w, *_ = np.linalg.lstsq(k, cov, rcond=None)
            if (w < 0).any():
                continue
            e = ((k @ w - cov) ** 2).sum()
            if best is None or e < best[0]:
                best = (e, a, b, w)
    return used, count, cov, skew, best


def main():
    photo, cover, terrain, surface = sys.argv[1:5]
    rgb = np.moveaxis(raster(photo), 2, 0)[:3]
    code = raster(cover)
    height = raster(surface) - raster(terrain)
    green, all_bands = linear(rgb[1]), linear(rgb).mean(0)
    grey = rgb.max(0) - rgb.min(0) < 30
    bare = code == 60
    ground = {"grass": (code == 30) & (height < 0.5), "bare or paved": bare & (height < 0.5),
              "paved": bare & grey & (height < 0.3) & (rgb.mean(0) > 70), "scrub": code == 20, "trees": code == 10}
    for name, mask in ground.items():
        for what, value, relative in (("albedo", green, True), ("brightness", all_bands, True), ("height m", height, False)):
            found = measure(value, mask, relative, 0.6 if name in ("grass", "trees") else 0.35)
            if not found:
                print(f"{name} {what}: too little of it")
                continue
            used, count, cov, skew, best = found
            line = " ".join(f"{c / cov[0]:.2f}" for c in cov[1:])
            print(f"{name} {what}: {used} windows, {count} cells, sigma {np.sqrt(cov[0]):.3f} skew {skew:.2f} autocorrelation {line}")
            if best:
                w = best[3]
                print(f"    unfiltered: sigma {np.sqrt(w.sum()):.3f} length {best[1]:.2f} m far_share {w[1] / w.sum():.2f} far_length {best[2]:.1f} m")


if __name__ == "__main__":
    main()
