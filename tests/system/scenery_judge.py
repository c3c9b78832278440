"""A gabled house on level ground as Pitviper shows it against Mitsuba 3 (scalar_rgb): the same meshes, reflectances, sun and sky.

    scenery_judge.py FOLDER      FOLDER: of tests/tools/scenery_scene.c

A line a region (of pixels all of whose neighbours are in it): REGION PIXELS direct PERCENT sampled PERCENT quick PERCENT, the
deviation of the region's mean from Mitsuba's: of the sun alone, one bounce; of sun and sky, all bounces, with light sampled
over the hemisphere, and as frames have it by default. Ground in shade within a metre of the walls is a region, `close`.
"""
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f
folder = sys.argv[1]
scene = {}
for line in open(f"{folder}/scene.txt"):
    word = line.split()
    if word[0] == "part": scene[word[1]] = float(word[2])
    else: scene[word[0]] = [float(x) for x in word[1:]]
width, height = map(int, scene["size"])


def diffuse(rho): return {"type": "twosided", "b": {"type": "diffuse", "reflectance": {"type": "rgb", "value": rho}}}


def world(integrator, sky, samples):
    parts = {n: {"type": "obj", "filename": f"{folder}/{n}.obj", "face_normals": True, "bsdf": diffuse(scene[n])}
             for n in ("wall", "roof", "window")}
    sun = scene["sun"]
    return mi.load_dict({
        "type": "scene", "integrator": integrator, **parts,
        "ground": {"type": "rectangle", "to_world": T().scale([2000, 2000, 1]), "bsdf": diffuse(scene["ground"][0])},
        "sun": {"type": "directional", "direction": [-x for x in sun[:3]], "irradiance": {"type": "rgb", "value": sun[3]}},
        **({"sky": {"type": "constant", "radiance": {"type": "rgb", "value": scene["sky"][0]}}} if sky else {}),
        "sensor": {"type": "perspective", "fov_axis": "x", "fov": float(np.degrees(2 * np.arctan(width / 2 / scene["focal_px"][0]))),
                   "to_world": T().look_at(origin=scene["eye"], target=scene["at"], up=[0, 0, 1]),
                   "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
                   "sampler": {"type": "independent", "sample_count": samples}}})


def shown(integrator, sky, samples): return np.array(mi.render(world(integrator, sky, samples)), float)[..., 0]


def ours(name): return np.fromfile(f"{folder}/{name}.bin", np.float32).reshape(3, height, width)[0].astype(float)


direct = shown({"type": "path", "max_depth": 2}, False, 16)
full = shown({"type": "path", "max_depth": 12}, True, 400)
# what each pixel shows, by Mitsuba's own rays
index = np.zeros((height, width), int)
close = np.zeros((height, width), bool)
corners = np.array([line.split()[1:3] for line in open(f"{folder}/wall.obj") if line[0] == "v"], float)
low, high = corners.min(0), corners.max(0)
look = world({"type": "path"}, False, 1)
named = {s.id(): k for k, s in enumerate(look.shapes())}
sensor = look.sensors()[0]
for y in range(height):
    for x in range(width):
        ray, _ = sensor.sample_ray(0, 0, [(x + 0.5) / width, (y + 0.5) / height], [0, 0])
        hit = look.ray_intersect(ray)
        index[y, x] = 0 if not hit.is_valid() else 1 + 2 * named[hit.shape.id()]
        at = np.array(hit.p).ravel()[:2]
        close[y, x] = hit.is_valid() and np.hypot(*np.maximum(np.maximum(low - at, at - high), 0)) < 1
lit = direct > 1e-6
index += (index > 0) & lit
same = np.ones_like(index, bool)
for dy in (-1, 0, 1):
    for dx in (-1, 0, 1):
        same &= np.roll(index, (dy, dx), (0, 1)) == index
same[[0, -1]] = same[:, [0, -1]] = False
names = {1 + 2 * k: n for n, k in named.items()}


def compare(name, light, of):
    if of.sum() < 20: return
    def off(a, b): return 100 * (a[of].mean() / b[of].mean() - 1) if b[of].mean() > 1e-6 else 100 * float(a[of].mean() > 1e-3)
    print(name, light, of.sum(), "direct %.2f" % off(ours("direct"), direct), "sampled %.2f" % off(ours("sampled"), full),
          "quick %.2f" % off(ours("quick"), full))


for value in np.unique(index[index > 0]):
    compare(names[value - (value % 2 == 0)], "lit" if value % 2 == 0 else "shade", same & (index == value))
compare("ground", "close", same & close & ~lit & np.isin(index, [k for k, n in names.items() if n == "ground"]))
