"""Faces of a box as Pitviper lights them against Mitsuba 3 (scalar_rgb): the same box, ground, sky by direction, sun and rays.

    faces_judge.py FOLDER PERCENT [all]      FOLDER: of tests/tools/faces_scene.c; PERCENT: standard error of Mitsuba's, at most;
                                             all: lit faces and tops, too

The sky is an environment map of 1024 x 513, the sun a directional light, depth unlimited. Each path begins on a face with a
direction of that face's own reflection, here in NumPy: diffuse and a lobe of Beckmann slopes; what arrives from there is
Mitsuba's, whose surfaces are diffuse. A line a face and channel:
    FACE CHANNEL COSINE_TO_SUN theirs RADIANCE error PERCENT contact PERCENT sampled PERCENT
the error is Mitsuba's standard error, the others are of contact shadows (the default) and of light sampled over the hemisphere,
over Mitsuba's.
"""
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f
BATCH, LEAST, MOST = 4000, 8, 400  # paths of a batch; batches


def read(folder):
    text, channels = {}, []
    for line in open(f"{folder}/scene.txt"):
        word = line.split()
        if word[0] == "channel": channels.append((word[1], *map(float, word[3::2])))
        else: text[word[0]] = np.array(word[1:], float)
    return text, channels


def rgb(values): return {"type": "rgb", "value": [float(v) for v in values]}


def scene_of(text, channels, sky):
    """Of three channels: name, sun, sky, ground, box."""
    def diffuse(k): return {"type": "twosided", "b": {"type": "diffuse", "reflectance": rgb(c[k] for c in channels)}}
    turn = 90 - float(np.degrees(text["heading"][0]))
    return mi.load_dict({
        "type": "scene",
        "sun": {"type": "directional", "direction": [float(-x) for x in text["sun"]], "irradiance": rgb(c[1] for c in channels)},
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(sky.transpose(1, 2, 0))),
                "to_world": T().rotate([1, 0, 0], 90)},
        "ground": {"type": "disk", "to_world": T().scale([20000, 20000, 1]), "bsdf": diffuse(3)},
        "box": {"type": "cube", "bsdf": diffuse(4),
                "to_world": T().translate([0, 0, float(text["lift"][0]) + 0.75]).rotate([0, 0, 1], turn).scale([2, 1, 0.75])}})


def dielectric(index2, cosine):
    inside = np.sqrt(index2 - 1 + cosine**2)
    return 0.5 * (((cosine - inside) / (cosine + inside))**2 + ((index2 * cosine - inside) / (index2 * cosine + inside))**2)


def fresnel(lobe_rho, roughness, cosine):
    """Reflectance of the lobe at an angle, of a normal one below 0.2: a dielectric, of which a share is bare below 0.02."""
    normal = max(lobe_rho, 0.02)
    index = (1 + np.sqrt(normal)) / (1 - np.sqrt(normal))
    return lobe_rho + min(lobe_rho / 0.02, 1) * (1 - min(roughness, 1))**2 * (dielectric(index**2, cosine) - normal)


def smith(slope, cosine):  # Walter et al. 2007
    a = cosine / (slope * np.sqrt(np.maximum(1 - cosine**2, 1e-12)))
    return np.where(a < 1.6, (3.535 * a + 2.181 * a**2) / (1 + 2.276 * a + 2.577 * a**2), 1)


def slopes(slope, n_half):
    tangent2 = 1 / n_half**2 - 1
    return np.exp(-tangent2 / slope**2) / (np.pi * slope**2 * n_half**4)


def reflection(rho, gloss, slope, n, eye, d):
    """BRDF times the cosine of directions d [paths][3]; eye likewise."""
    n_eye, n_d = eye @ n, d @ n
    diffuse = rho / np.pi * np.ones(len(d))
    if gloss > 0:
        half = eye + d
        half /= np.linalg.norm(half, axis=1)[:, None]
        lobe_rho = rho * gloss
        diffuse = (rho - lobe_rho) * (1 - fresnel(lobe_rho, slope, n_eye)) / (1 - lobe_rho) / np.pi
        n_half = np.maximum(half @ n, 1e-6)
        seen = smith(slope, n_eye) * smith(slope, np.maximum(n_d, 1e-6))
        lobe = fresnel(lobe_rho, slope, (eye * half).sum(1)) * slopes(slope, n_half) * seen / (4 * n_eye)
        return np.where(n_d > 0, diffuse * n_d + lobe, 0)
    return np.where(n_d > 0, diffuse * n_d, 0)


def even(count, random):
    """Points of a cube of four dimensions, evenly spread from a random start: multiples of powers of the root of x^5 = x + 1."""
    return (np.arange(1, count + 1)[:, None] / 1.1673039782614187**np.arange(1, 5) + random.random(4)) % 1


def directions(n, eye, gloss, slope, u):
    """Directions and their density: by the cosine, and where there is gloss three in ten by its lobe; u [paths][3], even."""
    t = np.array([-n[1], n[0], 0]) if abs(n[2]) < 0.9 else np.array([1.0, 0, 0])
    t /= np.linalg.norm(t)
    b = np.cross(n, t)
    share = 0.3 if gloss > 0 else 0
    by_lobe = u[:, 2] < share
    turn = 2 * np.pi * u[:, 1]
    tangent2 = -slope**2 * np.log1p(-u[:, 0])
    sine = np.where(by_lobe, np.sqrt(tangent2 / (1 + tangent2)), np.sqrt(u[:, 0]))
    d = np.sqrt(1 - sine**2)[:, None] * n + (sine * np.cos(turn))[:, None] * t + (sine * np.sin(turn))[:, None] * b
    mirrored = 2 * (eye * d).sum(1)[:, None] * d - eye
    d = np.where(by_lobe[:, None], mirrored, d)
    half = eye + d
    half /= np.linalg.norm(half, axis=1)[:, None]
    n_half = np.maximum(half @ n, 1e-6)
    density = (1 - share) * np.maximum(d @ n, 0) / np.pi
    if share: density += share * slopes(slope, n_half) * n_half / (4 * np.maximum((eye * half).sum(1), 1e-6))
    return d, density


def arrives(scene, p, d, seed):
    """Radiance from directions d at points p, [paths][3]."""
    integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 4})
    sampler = mi.load_dict({"type": "independent", "sample_count": 1})
    sampler.seed(seed)
    out = np.zeros((len(p), 3))
    for i in range(len(p)):
        ray = mi.RayDifferential3f(mi.Point3f(p[i]), mi.Vector3f(d[i]))
        out[i] = integrator.sample(scene, sampler, ray)[0]
    return out


def face_light(scene, channels, text, n, p, eye, paths, random):
    """Radiances of three channels towards the eye, [paths][3]: of a face's visible points p [points][3]."""
    gloss, slope = text["gloss"]
    u = even(paths, random)
    pick = (u[:, 0] * len(p)).astype(int)
    d, density = directions(n, eye[pick], gloss, slope, u[:, 1:])
    met = np.zeros((paths, 3))
    some = (d @ n > 0) & (density > 0)
    met[some] = arrives(scene, p[pick[some]] + 1e-4 * n, d[some], int(random.integers(1 << 30)))
    radiance = np.empty((paths, 3))
    for c, (_, sun, _, _, rho) in enumerate(channels):
        radiance[:, c] = reflection(rho, gloss, slope, n, eye[pick], d) * met[:, c] / np.maximum(density, 1e-12)
        if n @ text["sun"] > 0:
            radiance[:, c] += sun * reflection(rho, gloss, slope, n, eye[pick], np.tile(text["sun"], (paths, 1)))
    return radiance


def to_error(batch, percent):
    """Mean of batches, as many as it takes, and its standard error."""
    runs = [batch() for _ in range(LEAST)]
    while True:
        mean, error = np.mean(runs, 0), np.std(runs, 0, ddof=1) / np.sqrt(len(runs))
        if (100 * error <= percent * mean).all() or len(runs) >= MOST: return mean, error
        runs += [batch() for _ in range(LEAST // 2)]


def main(folder, percent, whole):
    text, channels = read(folder)
    columns, rows = text["sky_size"].astype(int)
    width, height = text["image_size"].astype(int)
    count = len(channels)
    sky = np.fromfile(f"{folder}/sky", np.float32).reshape(count, rows, columns)
    parts = [[0, 1, 2], [3, 3, 3]]
    scenes = [scene_of(text, [channels[k] for k in part], sky[part]) for part in parts]
    random = np.random.default_rng(1)
    for v in range(2):
        planes = np.fromfile(f"{folder}/view{v}", np.float32).reshape(-1, height, width)
        ours, sampled, normal, entity, place = planes[:count], planes[count:2 * count], planes[-7:-4], planes[-4], planes[-3:]
        faces = np.round(100 * normal[0]) + 1000 * np.round(100 * normal[1])
        for face in np.unique(faces[entity > 0]):
            at = (entity > 0) & (faces == face)
            if at.sum() < 200: continue
            n = normal[:, at].mean(1).astype(float)
            n /= np.linalg.norm(n)
            p = place[:, at].T.astype(float)
            eye = text[f"view{v}"][1:4] - p
            eye /= np.linalg.norm(eye, axis=1)[:, None]
            what = "top" if n[2] > 0.9 else "lit" if n @ text["sun"] > 0 else "unlit"
            if what != "unlit" and not whole: continue
            for scene, part in zip(scenes, parts):
                of = [channels[k] for k in part]
                mean, error = to_error(lambda: face_light(scene, of, text, n, p, eye, BATCH, random).mean(0), percent)
                for i, k in enumerate(sorted(set(part))):
                    theirs = mean[i]
                    over = [100 * (made[k][at].mean() / theirs - 1) for made in (ours, sampled)]
                    print(f"{what} {channels[k][0]} {n @ text['sun']:+.2f} theirs {theirs:.5g} "
                          f"error {100 * error[i] / theirs:.2f} contact {over[0]:+.2f} sampled {over[1]:+.2f}")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3:] == ["all"])
