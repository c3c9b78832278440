"""Ground beside a box that stands in the sun: heat in two dimensions by finite differences, from the sun's circle and the
material's figures alone. usage: stand_judge.py PROFILE HOUR [FLOW]; FLOW 0: without conduction sideways. Prints, for the
edge of the shadow north of the box and the box's own southern edge: how far ours is from theirs (m, where the fall is half),
widths from a quarter to three quarters of the fall (m, ours and theirs), and the root mean square of the difference of the
falls, of 1."""
import sys

import numpy as np

STEFAN = 5.670374e-8
HALF_M, HIGH_M, FROM_H = 1.7, 2.4, 9.0
FILM_W_M2K = 14.0  # of 3 m/s of wind over sand: what a fall of 1 has of it is little
profile, hour = sys.argv[1], float(sys.argv[2])
flow = float(sys.argv[3]) if len(sys.argv) > 3 else 1.0
with open(profile) as lines:
    k, c, absorbs, emits = map(float, lines.readline().split())
    ours = np.array([list(map(float, line.split())) for line in lines])


def sky(t_h):
    """East, north, up of the sun; its light, facing it; diffuse light; air. As in tests/scenes/paper_day.h."""
    turn, tilt, lat = (t_h % 24 - 12) / 12 * np.pi, 0.36, 0.785
    d = np.array([-np.cos(tilt) * np.sin(turn),
                  np.cos(lat) * np.sin(tilt) - np.sin(lat) * np.cos(tilt) * np.cos(turn),
                  np.sin(lat) * np.sin(tilt) + np.cos(lat) * np.cos(tilt) * np.cos(turn)])
    air = 288 + 5 * np.cos((t_h % 24 - 15) / 12 * np.pi)
    if d[2] <= 0:
        return d, 0.0, 0.0, air
    return d, 900 * np.exp(-0.15 / (d[2] + 0.05)) / np.exp(-0.15 / 1.05), 100 * np.sqrt(d[2]), air


def shaded(y, d):
    """Whether the ray from (0, y, 0) towards d enters the box, by its slabs; five rays over the sun's disc."""
    hit = np.zeros_like(y)
    for off in np.linspace(-0.0039, 0.0039, 5):
        up = d[2] + off
        near, far = np.zeros_like(y), np.full_like(y, HIGH_M / up)
        for at, along in ((np.zeros_like(y), d[0]), (y, d[1])):
            with np.errstate(divide="ignore"):
                a, b = (-HALF_M - at) / (along or 1e-12), (HALF_M - at) / (along or 1e-12)
            near, far = np.maximum(near, np.minimum(a, b)), np.minimum(far, np.maximum(a, b))
        hit += (near < far) / 5
    return hit


def open_sky(y):
    """Share of an even sky that the box leaves: 20000 directions."""
    n = 20000
    flat, turn = np.sqrt((np.arange(n) + 0.5) / n), np.arange(n) * 2.399963229728653
    d = np.stack([flat * np.cos(turn), flat * np.sin(turn), np.sqrt(1 - flat**2)])
    share = np.empty_like(y)
    for i, at in enumerate(y):
        near, far = np.zeros(n), HIGH_M / d[2]
        for place, along in ((0.0, d[0]), (at, d[1])):
            with np.errstate(divide="ignore"):
                a, b = (-HALF_M - place) / along, (HALF_M - place) / along
            near, far = np.maximum(near, np.minimum(a, b)), np.minimum(far, np.maximum(a, b))
        share[i] = 1 - np.mean(near < far)
    return share


dy, dz, dt = 0.02, 0.005, 15.0
y = np.arange(-3.5, 3.5 + dy / 2, dy)
depth = np.arange(60) * dz


def march(temp, from_h, to_h, box):
    hides = open_sky(y) if box else np.ones(temp.shape[0])
    face = temp[:, 0].copy()
    for step in range(int(round((to_h - from_h) * 3600 / dt))):
        d, direct, diffuse, air = sky(from_h + (step + 0.5) * dt / 3600)
        lit = 1 - shaded(y, d) if box and d[2] > 0 else 1.0
        sun = absorbs * (direct * max(d[2], 0) * lit + diffuse * hides)
        warm = emits * STEFAN * (hides * 0.78 + (1 - hides)) * air**4
        for _ in range(3):  # the face's own balance
            flux = sun + warm - emits * STEFAN * face**4 + FILM_W_M2K * (air - face)
            slope = 4 * emits * STEFAN * face**3 + FILM_W_M2K + 2 * k / dz
            face += (flux - 2 * k / dz * (face - temp[:, 0])) / slope
        down = np.diff(temp, axis=1)
        change = np.zeros_like(temp)
        change[:, :-1] += down
        change[:, 1:] -= down
        change[:, 0] += 2 * (face - temp[:, 0])
        change /= dz * dz
        if temp.shape[0] > 1 and flow:
            side = np.diff(temp, axis=0) / (dy * dy) * flow
            change[:-1] += side
            change[1:] -= side
        temp += dt * k / c * change
    return face


start = np.full((1, depth.size), 293.0)
march(start, -48, FROM_H, False)
box = np.repeat(start, y.size, axis=0)
theirs = march(box, FROM_H, hour, True)


def fall(places, kelvins, cold, warm):
    """Share of the way from the cold place to the warm one."""
    a, b = np.interp(cold, places, kelvins), np.interp(warm, places, kelvins)
    return (kelvins - a) / (b - a)


def crossing(places, share, level):
    at = np.flatnonzero((share[:-1] < level) != (share[1:] < level))[0]
    return np.interp(level, sorted(share[at:at + 2]),
                     places[at:at + 2] if share[at] < share[at + 1] else places[at:at + 2][::-1])


for name, cold, warm in (("shadow", 2.1, 3.3), ("box", -1.4, -2.2)):
    inside = lambda p: (p >= min(cold, warm) - 1e-9) & (p <= max(cold, warm) + 1e-9)
    mine, fd = fall(ours[:, 0], ours[:, 1], cold, warm), fall(y, theirs, cold, warm)
    grid = np.linspace(min(cold, warm), max(cold, warm), 101)
    rms = np.sqrt(np.mean((np.interp(grid, ours[:, 0], mine) - np.interp(grid, y, fd)) ** 2))
    cross = {}
    for who, places, share in (("mine", ours[:, 0], mine), ("fd", y, fd)):
        keep = inside(places)
        cross[who] = [crossing(places[keep], share[keep], level) for level in (0.25, 0.5, 0.75)]
    print(name, "%.4f %.4f %.4f %.4f" % (abs(cross["mine"][1] - cross["fd"][1]),
                                         abs(cross["mine"][2] - cross["mine"][0]),
                                         abs(cross["fd"][2] - cross["fd"][0]), rms))
