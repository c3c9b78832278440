"""explain_judge.py OUT FRAME COMMAND: judges what `pitviper explain --json` says of pixels of OUT.

With `pixels`: prints pixels of each kind, a line each: KIND X Y, found in the truth planes. With `judge KIND X Y`: reads the
JSON on standard input and holds it against files that explain did not write: radiance of the EXR, to the bit; grey of the
PNG; counts of the raw PNG. It adds the terms up by itself, with fractions for the fused products, and finds Planck's
radiance of the told temperatures by its own integral over the band of etc/channels.csv. With `twin`: the same JSON with one
figure moved by a part in a million must be refused."""
import csv
import json
import os
import sys
from fractions import Fraction

import Imath
import numpy as np
import OpenEXR
from PIL import Image

OUT, FRAME, COMMAND = sys.argv[1], int(sys.argv[2]), sys.argv[3]
FLOAT, UINT = Imath.PixelType(Imath.PixelType.FLOAT), Imath.PixelType(Imath.PixelType.UINT)
f32, f64 = np.float32, np.float64


def exr(group, name, kind=FLOAT):
    f = OpenEXR.InputFile(f'{OUT}/frames/{group}/{FRAME:06d}.exr')
    header = f.header()
    if name not in header['channels']:
        return None
    box = header['dataWindow']
    shape = box.max.y + 1, box.max.x + 1
    return np.frombuffer(f.channel(name, kind), f32 if kind == FLOAT else np.uint32).reshape(shape)


def table(path, *columns):
    lines = [line for line in open(path) if not line.startswith('#')]
    return {row['name']: [float(row[c] or 0) if c in row else 0.0 for c in columns] for row in csv.DictReader(lines)}


def truth_line():
    return next(t for t in map(json.loads, open(f'{OUT}/truth.jsonl')) if t['frame'] == FRAME)


# ---- which pixels ----------------------------------------------------------------------------------

def pixels():
    entity, cover = exr('truth', 'entity', UINT), exr('truth', 'cover', UINT)
    range_m, instance = exr('truth', 'range_m'), exr('truth', 'instance', UINT)
    part = exr('truth', 'part', UINT)
    scenery = (part > 0) & (entity == 0) if part is not None else np.zeros_like(entity, bool)
    plant = instance > 0 if instance is not None else np.zeros_like(entity, bool)
    plant &= ~scenery
    grown = np.zeros_like(plant)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            grown |= np.roll(plant, (dy, dx), (0, 1))
    edge = np.zeros_like(plant)
    for axis in (0, 1):
        for step in (1, -1):
            edge |= np.roll(entity, step, axis) != entity
    if cover is None:
        cover = (entity == 0) & np.isfinite(range_m)
    kinds = {
        'sky': np.isinf(range_m) & (entity == 0),
        'plant': plant & (entity == 0),
        'ground': (cover > 0) & (entity == 0) & ~grown & ~edge & ~scenery,
        'scenery': scenery,
        'inside': (entity > 0) & ~edge,
        'edge': (entity > 0) & edge,
        'beside': (entity == 0) & edge & np.isfinite(range_m),
    }
    if scenery.any():  # buildings by how much of them is seen, the most first; clutter likewise
        clutter = {c['instance'] for c in truth_line().get('clutter', ())}
        for kind, wanted in (('building', False), ('clutter', True)):
            numbers, count = np.unique(instance[scenery], return_counts=True)
            for k in sorted((k for k, n in zip(count, numbers) if (int(n) in clutter) == wanted), reverse=True)[:1]:
                kinds[kind] = scenery & (instance == numbers[list(count).index(k)])
    for kind, where in kinds.items():
        found = np.argwhere(where)
        for k in {len(found) // 3} if len(found) else ():
            print(kind, found[k][1], found[k][0])


# ---- added up again --------------------------------------------------------------------------------

def fma(a, b, c):
    """a b + c, rounded once: from the exact sum to double, and on to float."""
    return f32(float(Fraction(float(a)) * Fraction(float(b)) + Fraction(float(c))))


def light(l, thermal):
    if 'beyond' in l:
        seen = f32(f64(l['beyond']) * f64(l['beyond_transmittance']) + f64(l['path']) + f64(l['disc']))
    else:
        seen = fma(l['reflected'], l['air_transmittance'], l['path'])
        seen = fma(l['sunlit'], l['sun_transmittance'], seen)
        if thermal:
            seen = fma(l['emitted'], l['transmittance'], seen)
        if 'lamps' in l:
            seen = fma(l['lamps'], l['air_transmittance'], seen)
    if 'smoke' in l:
        seen = f32(f32(seen * f32(l['smoke_transmittance'])) + f32(l['smoke']))
    return seen


def value(plane, samples):
    channel = plane.get('channel')

    def of(sample):
        if channel is None:
            return f32(sum(f64(p) for p in sample['radar']))
        return light(sample['light'][channel], channel in ('mwir', 'lwir'))

    now = f32('nan')
    for step in plane['steps']:
        mine = [s for s in samples if s['group'] == step.get('group')]
        total = f64(0)
        if step['kind'] == 'mean':
            n = step['rays_a_side']
            for s in mine:
                total += f64(of(s)) if not step['split'] else f64(s['share']) * f64(of(s))
            if not step['split']:
                total *= f64(1) / f64(n * n)
            share = f64(step['share'])
            now = f32(total) if share == 1 else f32((f64(1) - share) * f64(now) + share * total)
        elif step['kind'] == 'smoothed':
            weights = [f32(w) for w in step['weights']]
            mean = f32(weights[4] * now)
            for k in range(9):
                if k != 4 and weights[k] > 0:
                    mean = f32(mean + f32(weights[k] * f32(step['values'][k])))
            now = mean
        elif step['kind'] == 'beside':
            now = f32(now * f32(step['share']))
        else:
            for s in mine:
                total += f64(s['share']) * f64(of(s))
            now = f32(now + f32(f64(step.get('share', 1)) * total))
        if f32(step['value']) != now:
            return f'after {step["kind"]} it says {step["value"]!r}, and is {now!r}'
    return now


# ---- Planck ----------------------------------------------------------------------------------------

h, c, k_b = 6.62607015e-34, 299792458.0, 1.380649e-23


def planck(low_um, high_um, temp_k):
    """W/(m2 sr) of a black body over the band: Simpson's rule in 2000 steps."""
    w = np.linspace(low_um, high_um, 2001) * 1e-6
    of = 2 * h * c * c / w**5 / np.expm1(h * c / (w * k_b * temp_k))
    simpson = np.ones(2001)
    simpson[1:-1:2], simpson[2:-1:2] = 4, 2
    return float((of * simpson).sum() * (w[1] - w[0]) / 3)


def check_construction(s, t, wrong):
    """The row of etc/constructions.csv that has this name is of such a part; its room is as warm as it says."""
    part = s['surface'].rsplit(', ', 1)[1]
    rows = [r for r in csv.DictReader(line for line in open('etc/constructions.csv') if not line.startswith('#'))
            if r['name'] == t['construction'] and r['part'] in ('', part)]
    if not rows:
        wrong.append(f'no construction {t["construction"]} of a {part}')
    inside = {'a heated room': 'heated', 'an unheated room': 'unheated', 'a flue': 'flue',
              'the open on its other side': 'back', 'nothing that gives or takes heat': 'none'}[t['behind']]
    if inside not in {r['inside'] for r in rows}:
        wrong.append(f'behind it is {t["behind"]}')
    if inside == 'heated' and not any(abs(t['behind_k'] - 273.15 - float(r[c])) < 0.01 or t['behind_k'] > t['air_k']
                                      for r in rows for c in ('day_c', 'night_c')):
        wrong.append(f'its room has {t["behind_k"]} K')
    if not 0 <= t['shaded'] <= 1:
        wrong.append(f'{t["shaded"]} of its sun was taken')
    # over the weather's thermometer; at a height of its own up to 0.2 K beside
    told = t['in_sun_k'] + t['shaded'] * (t['in_shade_k'] - t['in_sun_k'])
    if abs(told - t['temp_k']) > 0.2:
        wrong.append(f'{t["temp_k"]} K, by sun and shade {told}')


def check_heat(all_samples, wrong):
    bands = table('etc/channels.csv', 'low_um', 'high_um')
    materials = table('etc/materials.csv', 'gloss', 'rho_mwir', 'rho_lwir', 'tau_mwir', 'tau_lwir')
    materials.update(table('etc/plant_optics.csv', 'gloss', 'rho_mwir', 'rho_lwir', 'tau_mwir', 'tau_lwir'))
    matte = 0
    for s in all_samples:
        t = s.get('temperature')
        if not t or 'material' not in s:
            continue
        parts = t['air_k'] + t['heat_k'] + t['sun_or_photograph_k'] + t['detail_k'] + t['far_woods_k']
        if parts != t['temp_k']:
            wrong.append(f'its temperature is {t["temp_k"]}, the terms {parts}')
        if 'construction' in t:
            check_construction(s, t, wrong)
        for p in t.get('patches', ()):
            if not 150 < p['temp_k'] < 1500 or not 0 < p['share'] < 1.000001:
                wrong.append(f'a patch of {p}')
        for n, band in enumerate(('mwir', 'lwir')):
            if band not in s['light'] or 'emitted' not in s['light'][band]:
                continue
            gloss, *optics = materials[s['material']]
            black = planck(*bands[band], t['temp_k'])
            emissivity = s['light'][band]['emitted'] / black
            if not 0 < emissivity < 1 + 2e-5:
                wrong.append(f'{band}: emissivity {emissivity} of {s["material"]}')
            told = 1 - optics[n] - optics[2 + n]
            if gloss == 0:  # else it depends on the angle; 2e-5: the table of Planck's function, etc/reference/accuracy.md
                matte += 1
                if abs(emissivity - told) > 2e-5 * told:
                    wrong.append(f'{band}: {s["material"]} emits {emissivity} of a black body, told {told}')
            elif told - emissivity > 0.7 or emissivity - told > 1e-4:
                wrong.append(f'{band}: {s["material"]} emits {emissivity} of a black body, by its reflectance {told}')
    return matte


# ---- all of it -------------------------------------------------------------------------------------

def judge(e, x, y):
    wrong = []
    if not e['as_saved'] or (e['x'], e['y'], e['frame']) != (x, y, FRAME):
        wrong.append('another pixel, or not as saved')
    for p in e['planes']:
        group, name = p['plane'].split('/')
        was = exr(group, name)[y, x]
        if f32(p['value']).tobytes() != was.tobytes():
            wrong.append(f'{p["plane"]}: {p["value"]!r}, the file has {was!r}')
        mine = value(p, e['samples'][p['samples_of']])
        if isinstance(mine, str) or mine.tobytes() != was.tobytes() or not p['same']:
            wrong.append(f'{p["plane"]}: its terms add up to {mine!r}, the file has {was!r}')
        total = sum(p['terms'].values())
        if abs(total - p['value']) > 3e-6 * abs(p['value']):
            wrong.append(f'{p["plane"]}: its terms in the text are {total!r} in all')
        if group in ('mwir', 'lwir'):
            bands = table('etc/channels.csv', 'low_um', 'high_um')
            again = planck(*bands[group], p['apparent_temp_k'])
            if abs(again / p['value'] - 1) > 1e-4:
                wrong.append(f'{group}: apparent temperature {p["apparent_temp_k"]} is of {again}')
    for band, d in e['detector'].items():
        path = f'{OUT}/frames/{band}/{FRAME:06d}.png'
        shown = np.asarray(Image.open(path))[y, x]
        shown = [int(v) for v in np.atleast_1d(shown)][:3]
        said = [ch['grey'] for ch in d['channels']]
        if said != shown[:len(said)]:
            wrong.append(f'{band}: displayed {said}, the PNG has {shown}')
        raw = f'{OUT}/raw/{band}/{FRAME:06d}.png'
        if os.path.exists(raw):
            counts = int(np.asarray(Image.open(raw))[y, x])
            if d['channels'][0].get('counts') != counts:
                wrong.append(f'{band}: counts {d["channels"][0].get("counts")}, the raw image has {counts}')
        elif 'counts' in d['channels'][0]:
            wrong.append(f'{band}: counts, and no raw image')
    matte = check_heat([s for list_ in e['samples'] for s in list_], wrong)
    return wrong, matte


def main():
    if COMMAND == 'pixels':
        return pixels()
    x, y = int(sys.argv[5]), int(sys.argv[6])
    e = json.load(sys.stdin)
    if COMMAND == 'twin':
        moved = next(s for s in e['samples'][0] if s['weight'].get('lwir/Y') and 'emitted' in s['light']['lwir'])
        moved['light']['lwir']['emitted'] *= 1 + 1e-3
        wrong, _ = judge(e, x, y)
        print(len(wrong), 'refused')
        return sys.exit(not any('add up' in w or 'after' in w for w in wrong))
    wrong, matte = judge(e, x, y)
    for w in wrong:
        print(w)
    samples = [s for list_ in e['samples'] for s in list_]
    of = {s['surface'].split(',')[0] for s in samples}
    smoky = any('smoke' in l and l['smoke_transmittance'] < 0.99 for s in samples for l in s['light'].values())
    steps = [s['kind'] + (str(s['rays_a_side']) if s['kind'] == 'mean' else '') for p in e['planes'] for s in p['steps']]
    print('FACTS', sys.argv[4], len(samples), 'rays', 'matte' if matte else '', 'smoke' if smoky else '', *sorted(set(steps)),
          '|', *sorted(of))
    sys.exit(bool(wrong))


main()
