"""Panes of a house's windows as Pitviper shows them against Mitsuba 3 (scalar_spectral_polarized): slabs of glass before black.

    window_judge.py FOLDER [TIMES]      FOLDER: of tests/tools/scenery_scene.c with panes; TIMES as many samples

A line a view: VIEW PIXELS share PERCENT quick PERCENT [sampled PERCENT]: of the pixels that all show window, what the pane mirrors
(mean radiance over the sky's), and the deviation of their mean from Mitsuba's, as frames have it by default and, where FOLDER
has it, with light sampled over the hemisphere."""
import os
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_spectral_polarized")
T = mi.ScalarTransform4f
folder, times = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1
sun_rad, gap_m, thick_m = 4.65e-3, 0.004, 0.008


def scene_of(view):
    found = {}
    for line in open(f"{folder}/{view}.txt"):
        word = line.split()
        if word[0] == "part": found[word[1]] = float(word[2])
        else: found[word[0]] = [float(x) for x in word[1:]]
    return found


def even(value): return {"type": "uniform", "value": value}
def diffuse(rho): return {"type": "twosided", "b": {"type": "diffuse", "reflectance": even(rho)}}


def boxes():
    """Bounds of each window, twelve triangles of three corners."""
    corners = np.array([line.split()[1:] for line in open(f"{folder}/window.obj") if line[0] == "v"], float)
    return [(c.min(0), c.max(0)) for c in corners.reshape(-1, 36, 3)]


def block(low, high, bsdf):
    return {"type": "cube", "to_world": T().translate(list((low + high) / 2)) @ T().scale(list((high - low) / 2)), "bsdf": bsdf}


def panes(middle):
    """Of each window a slab at its outer side, and black from a gap behind it on."""
    parts = {}
    for k, (low, high) in enumerate(boxes()):
        out, slab_low, slab_high, low, high = low[0] > middle, low.copy(), high.copy(), low.copy(), high.copy()
        if out: slab_low[0], high[0] = high[0] - thick_m, high[0] - thick_m - gap_m
        else: slab_high[0], low[0] = low[0] + thick_m, low[0] + thick_m + gap_m
        parts[f"pane{k}"] = block(slab_low, slab_high, {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0})
        parts[f"black{k}"] = block(low, high, diffuse(0))
    return parts


def world(scene, samples, depth, crop=(16, 16), sun=True):
    width, height = map(int, scene["size"])
    parts = {n: {"type": "obj", "filename": f"{folder}/{n}.obj", "face_normals": True, "bsdf": diffuse(scene[n])} for n in ("wall", "roof")}
    towards, far_m = np.array(scene["sun"][:3]), 1e4
    radius_m = far_m * np.sin(sun_rad)
    disc = {"sun": {"type": "sphere", "center": list(far_m * towards), "radius": float(radius_m), "bsdf": diffuse(0),
                    "emitter": {"type": "area", "radiance": even(scene["sun"][3] / (np.pi * np.sin(sun_rad) ** 2))}}}
    return mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": depth, "rr_depth": 50}, **parts, **panes(-3), **(disc if sun else {}),
        "ground": {"type": "rectangle", "to_world": T().scale([2000, 2000, 1]), "bsdf": diffuse(scene["ground"][0])},
        "sky": {"type": "constant", "radiance": even(scene["sky"][0])},
        "sensor": {"type": "perspective", "fov_axis": "x", "fov": float(np.degrees(2 * np.arctan(width / 2 / scene["focal_px"][0]))),
                   "to_world": T().look_at(origin=scene["eye"], target=scene["at"], up=[0, 0, 1]),
                   "film": {"type": "hdrfilm", "width": width, "height": height, "crop_width": crop[0], "crop_height": crop[1],
                            "crop_offset_x": (width - crop[0]) // 2, "crop_offset_y": (height - crop[1]) // 2, "rfilter": {"type": "box"}, "pixel_format": "luminance"},
                   "sampler": {"type": "independent", "sample_count": samples}}})


def shown(of): return np.array(mi.render(of, seed=0), float)[..., 0]


def window_pixels(scene):
    """Pixels all of whose neighbours show the front of one window, not its edges: nothing stands before any."""
    (width, height), eye = map(int, scene["size"]), np.array(scene["eye"])
    f = np.array(scene["at"]) - eye
    f /= np.linalg.norm(f)
    right = np.cross(f, [0, 0, 1])
    right /= np.linalg.norm(right)
    down = np.cross(f, right)
    y, x = np.mgrid[0:height, 0:width] + 0.5
    d = f + ((x - width / 2)[..., None] * right + (y - height / 2)[..., None] * down) / scene["focal_px"][0]
    index = np.zeros((height, width), int)
    for k, (low, high) in enumerate(boxes()):
        front = high[0] if low[0] > -3 else low[0]
        if (eye[0] > front) != (front > -3): continue
        at = eye + (front - eye[0]) / d[..., :1] * d
        index[((at > low - 1e-6) & (at < high + 1e-6))[..., 1:].all(-1) & ((front - eye[0]) / d[..., 0] > 0)] = k + 1
    same = index > 0
    for dy in (-2, -1, 0, 1, 2):
        for dx in (-2, -1, 0, 1, 2): same &= np.roll(index, (dy, dx), (0, 1)) == index
    same[:2] = same[-2:] = same[:, :2] = same[:, -2:] = False
    return same


def calibrated(scene):
    """What a film of this variant has for the sky's radiance: looking straight up."""
    up = dict(scene, size=[16, 16], eye=[300, 300, 1], at=[300, 301, 1000])
    return shown(world(up, 4, 2, sun=False)).mean() / scene["sky"][0]


def middle(plane, crop):
    y, x = (plane.shape[0] - crop[1]) // 2, (plane.shape[1] - crop[0]) // 2
    return plane[y:y + crop[1], x:x + crop[0]]


scale = calibrated(scene_of("sky"))
# of the middle of each view alone, so that few of Mitsuba's rays decide: of a hundred that meet a pane some eight are mirrored
for view, crop, samples in (("glint", (22, 22), 2500), ("sky", (60, 40), 150), ("grazing", (30, 20), 200), ("shade", (60, 40), 150),
                            ("ground", (40, 30), 200), ("foot", (40, 30), 600)):
    scene = scene_of(view)
    width, height = map(int, scene["size"])
    same = middle(window_pixels(scene), crop)
    want = shown(world(scene, times * samples, 12, crop)) / scale

    def off(name):
        got = np.fromfile(f"{folder}/{name}.bin", np.float32).reshape(3, height, width)[0].astype(float)
        return 100 * (middle(got, crop)[same].mean() / want[same].mean() - 1)
    print(view, same.sum(), "share %.2f" % (100 * want[same].mean() / scene["sky"][0]), "quick %.2f" % off(view),
          *(["sampled %.2f" % off(view + "_sampled")] if os.path.exists(f"{folder}/{view}_sampled.bin") else []), flush=True)
