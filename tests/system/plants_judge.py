"""Plants as Pitviper sees them against Mitsuba 3 (scalar_rgb): the same quads, leaves' outlines, spectra, sun and rays.

    plants_judge.py FOLDER [PATHS]      FOLDER: of tests/tools/plants_scene.c; PATHS: a ray, for all orders (0: none)

First order (max_depth 2, sun alone): the means of blocks of 8 x 8 pixels. All orders, under sun and sky: means over the
leaves and over the ground. A line a band and a quantity, to be read by plants.sh:
    direct BLOCKS WORST_PERCENT: of blocks with a tenth of the mean light or more
    all WHAT BAND OURS THEIRS PERCENT ...
Of the scene "within", whose rays begin in a stand, all orders alone:
    within WHAT BAND OURS THEIRS PERCENT +- STANDARD_ERROR of RAYS ...
"""
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

BANDS = ("red", "green", "near infrared")
LEAF = 1
WITHIN = 512 * 16  # rays of that scene
HEIGHTS = (0, 5), (5, 8), (8, 11), (11, 20)  # m
GROUND_HIT, PLANT_HIT = 1, 3


def ears(corners):
    """Triangles, as corner indices, of a simple polygon, counter-clockwise: by cutting off ears."""
    def area(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    left, out = list(range(len(corners))), []
    if sum(corners[i][0] * corners[i - len(corners) + 1][1] - corners[i - len(corners) + 1][0] * corners[i][1] for i in left) < 0:
        left.reverse()
    while len(left) > 3:
        for k in range(len(left)):
            i, j, l = left[k - 1], left[k], left[(k + 1) % len(left)]
            a, b, c = corners[i], corners[j], corners[l]
            if area(a, b, c) <= 0: continue
            if any(area(a, b, corners[p]) >= 0 and area(b, c, corners[p]) >= 0 and area(c, a, corners[p]) >= 0
                   for p in left if p not in (i, j, l)): continue
            out.append((i, j, l))
            del left[k]
            break
        else:  # corners in a line
            del left[0]
    return np.array(out + [tuple(left)])


class Leaf(mi.BSDF):
    """Diffuse on either side: a share rho back, tau through; both times the leaf's own brightness."""
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.DiffuseTransmission | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        self.m_components = [flags]
        self.m_flags = flags
        self.key = props["key"]

    def both(self, si):
        rho, tau, albedo = TABLE[self.key]
        bright = np.minimum(albedo[si.prim_index], 1 / np.maximum(rho + tau, 1e-9))
        return rho * bright, tau * bright

    def value(self, si, wo):
        rho, tau = self.both(si)
        there = mi.Frame3f.cos_theta(wo)
        same = mi.Frame3f.cos_theta(si.wi) * there > 0
        return (rho if same else tau) * (abs(there) / np.pi)

    def chance(self, si):  # of going back
        rho, tau = self.both(si)
        return float(rho.sum() / max((rho + tau).sum(), 1e-9))

    def density(self, si, wo):
        there = mi.Frame3f.cos_theta(wo)
        back = self.chance(si)
        return (back if mi.Frame3f.cos_theta(si.wi) * there > 0 else 1 - back) * abs(there) / np.pi

    def sample(self, ctx, si, sample1, sample2, active=True):
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        if mi.Frame3f.cos_theta(si.wi) < 0: wo = -wo
        if sample1 > self.chance(si): wo = -wo
        bs = mi.BSDFSample3f()
        bs.wo, bs.eta, bs.sampled_type, bs.sampled_component = wo, 1.0, self.m_flags, 0
        bs.pdf = self.density(si, wo)
        if not bs.pdf > 0: return bs, mi.Color3f(0)
        return bs, mi.Color3f(*(self.value(si, wo) / bs.pdf))

    def eval(self, ctx, si, wo, active=True): return mi.Color3f(*self.value(si, wo))
    def pdf(self, ctx, si, wo, active=True): return self.density(si, wo)
    def eval_pdf(self, ctx, si, wo, active=True): return mi.Color3f(*self.value(si, wo)), self.density(si, wo)
    def to_string(self): return "Leaf[]"


mi.register_bsdf("leaf", lambda props: Leaf(props))
TABLE = {}


def mesh(name, vertices, faces, bsdf):
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf)
    out = mi.Mesh(name, len(vertices), len(faces), props=props)
    params = mi.traverse(out)
    params["vertex_positions"] = np.ravel(vertices).astype(np.float32)
    params["faces"] = np.ravel(faces).astype(np.uint32)
    params.update()
    return out


def read(folder):
    text = {}
    for line in open(f"{folder}/scene.txt"):
        word = line.split()
        if word[0] == "material": text[int(word[1]), int(word[2])] = np.array(word[3:], float).reshape(3, 2)
        else: text[word[0]] = np.array(word[1:], float)
    quads = np.fromfile(f"{folder}/quads", np.float32).reshape(-1, 16)
    outlines = np.fromfile(f"{folder}/outlines", np.float32).reshape(-1, 49)
    rays = np.fromfile(f"{folder}/rays", np.float32).reshape(-1, 15)
    return text, quads, outlines, rays


def meshes(text, quads, outlines):
    out = {}
    for kind in np.unique(quads[:, 13]).astype(int):
        of = quads[quads[:, 13] == kind]
        bark = of[of[:, 12] != LEAF]
        if len(bark):
            at = 4 * np.arange(len(bark))[:, None, None]
            rho = text[kind, 0][:, 0]
            out[f"bark{kind}"] = mesh(f"bark{kind}", bark[:, :12].reshape(-1, 3),
                                      (at + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3),
                                      {"type": "twosided", "b": {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(rho)}}})
        vertices, faces, albedo, base = [], [], [], 0
        for o in np.unique(of[of[:, 12] == LEAF][:, 14]).astype(int):
            cards = of[(of[:, 12] == LEAF) & (of[:, 14] == o)]
            count = int(outlines[o, 0])
            uv = outlines[o, 1:1 + 2 * count].reshape(count, 2)
            cut = ears(uv)
            a, b, d = cards[:, 0:3], cards[:, 3:6], cards[:, 9:12]
            corner = a[:, None] + uv[None, :, :1] * (b - a)[:, None] + uv[None, :, 1:] * (d - a)[:, None]
            vertices.append(corner.reshape(-1, 3))
            faces.append((base + count * np.arange(len(cards))[:, None, None] + cut[None]).reshape(-1, 3))
            albedo.append(np.repeat(cards[:, 15], len(cut)))
            base += count * len(cards)
        if base:
            key = f"leaf{kind}"
            TABLE[key] = (text[kind, 1][:, 0], text[kind, 1][:, 1], np.concatenate(albedo).astype(float))
            out[key] = mesh(key, np.concatenate(vertices), np.concatenate(faces), {"type": "leaf", "key": key})
    return out


def scene_of(text, plants, sky):
    sun = text["sun"]
    scene = {"type": "scene", **plants,
             "ground": {"type": "disk", "to_world": mi.ScalarTransform4f().scale([3000, 3000, 1]),
                        "bsdf": {"type": "twosided", "b": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [float(text["ground"][0])] * 3}}}}}
    if sun[3] > 0:
        scene["sun"] = {"type": "directional", "direction": [float(-x) for x in sun[:3]], "irradiance": {"type": "rgb", "value": [float(sun[3])] * 3}}
    if sky: scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": [float(text["sky"][0])] * 3}}
    return mi.load_dict(scene)


def render(scene, rays, depth, paths):
    """Radiance of each ray, [rays][3], the mean of its paths."""
    integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 1000})
    sampler = mi.load_dict({"type": "independent", "sample_count": 1})
    sampler.seed(1)
    out = np.zeros((len(rays), paths, 3))
    for i, r in enumerate(rays):
        ray = mi.RayDifferential3f(mi.Point3f(*map(float, r[:3])), mi.Vector3f(*map(float, r[3:6])))
        for k in range(paths): out[i, k] = np.array(integrator.sample(scene, sampler, ray)[0]).ravel()
    return out.mean(1)


def blocks(values, width):
    """Sums over blocks of 8 x 8 pixels, of 4 x 4 rays each."""
    height = len(values) // width
    return values.reshape(height // 32, 32, width // 32, 32).sum((1, 3))


def errors(rays, full):
    """Means of ours and theirs over rays, by band, with the standard error of their ratio, percent."""
    for b in range(3):
        ours, theirs = rays[:, 12 + b].astype(float), full[:, b]
        ratio = ours.mean() / theirs.mean()
        spread = np.std(ours - ratio * theirs) / np.sqrt(len(ours)) / theirs.mean()
        yield BANDS[b].replace(" ", "_"), ours.mean(), theirs.mean(), 100 * (ratio - 1), 100 * spread


def within(text, rays, plants, paths):
    """Ground and leaves of rays that begin in a stand, leaves by their height over the ground."""
    full = render(scene_of(text, plants, True), rays, -1, paths)
    first = render(scene_of(text, plants, True), rays, 2, 4)
    z = rays[:, 2] + rays[:, 6] * rays[:, 5]
    leaf = (rays[:, 7] == PLANT_HIT) & (rays[:, 8] == LEAF)
    of = {"ground": rays[:, 7] == GROUND_HIT, "bark": (rays[:, 7] == PLANT_HIT) & ~leaf, "leaves": leaf}
    for low, high in HEIGHTS: of[f"leaves_{low}_{high}_m"] = leaf & (z >= low) & (z < high)
    for what, some in of.items():
        for b, (band, ours, theirs, percent, spread) in enumerate(errors(rays[some], full[some])):
            print(f"within {what} {band} {ours:.4g} {theirs:.4g} {percent:+.2f} +- {spread:.2f} of {some.sum()} "
                  f"first order {100 * first[some, b].mean() / theirs:.0f} %")


def main(folder, paths):
    text, quads, outlines, rays = read(folder)
    plants = meshes(text, quads, outlines)
    if len(rays) == WITHIN: return within(text, rays, plants, paths)
    scene = scene_of(text, plants, False)
    direct = render(scene, rays, 2, 1)
    width = 384
    bands = []
    for b in range(3):
        ours, theirs = blocks(rays[:, 9 + b].astype(float), width), blocks(direct[:, b], width)
        known = theirs > 0.2 * theirs.mean()  # of 200 lit rays or more: one on the border of a shadow is 0.5 %
        bands.append(100 * np.abs(ours - theirs)[known] / theirs[known])
    print(f"direct {len(bands[0])} {max(b.max() for b in bands):.2f}")
    if not paths: return
    some = np.arange(0, len(rays), 4)  # of the rays
    rays, direct = rays[some], direct[some]
    full = render(scene_of(text, plants, True), rays, -1, paths)
    for what, of in (("leaves", (rays[:, 7] == PLANT_HIT) & (rays[:, 8] == LEAF)), ("ground", rays[:, 7] == GROUND_HIT)):
        for b in range(3):
            ours, theirs = rays[of, 12 + b].mean(), full[of, b].mean()
            print(f"all {what} {BANDS[b].replace(' ', '_')} {ours:.4g} {theirs:.4g} {100 * (ours / theirs - 1):+.2f} "
                  f"first order {100 * direct[of, b].mean() / theirs:.0f} %")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 0)
