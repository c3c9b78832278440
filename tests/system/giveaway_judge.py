"""tests/system/giveaway_judge.py: the figures of etc/giveaway against answers that are known: noise of a given spectrum, Gauss and
Laplace differences, counted blobs, areas under ROC curves, a run made by hand in which all that is measured follows from its drawing."""
import importlib.machinery
import importlib.util
import json
import math
import pathlib
import sys
import tempfile

import numpy

loader = importlib.machinery.SourceFileLoader('giveaway', sys.argv[1])
giveaway = importlib.util.module_from_spec(importlib.util.spec_from_loader('giveaway', loader))
loader.exec_module(giveaway)
random = numpy.random.default_rng(3)
failed = 0


def check(what, good):
    global failed
    failed += not good
    if not good:
        print(f'FAILED: {what}')


def noise_of(slope, side=256):
    frequency = numpy.hypot(numpy.fft.fftfreq(side)[:, None], numpy.fft.rfftfreq(side)[None, :])
    frequency[0, 0] = 1
    return numpy.fft.irfft2(numpy.fft.rfft2(random.normal(size=(side, side))) * frequency ** (slope / 2))


for slope in (0, -1.5, -2.5):
    found = numpy.mean([giveaway.slope_of(noise_of(slope)) for _ in range(8)])
    check(f'slope {slope}, found {found:.3f}', abs(found - slope) < 0.05)
gauss = giveaway.kurtosis_of(random.normal(size=(400, 400)))
check('normal differences have a kurtosis of 3', abs(gauss - 3) < 0.1)
check('sums of Laplace steps along both axes: 6', abs(giveaway.kurtosis_of(
    numpy.cumsum(random.laplace(size=500))[:, None] + numpy.cumsum(random.laplace(size=500))[None, :]) - 6) < 1)

mask = numpy.zeros((9, 9), bool)
mask[1, 1] = mask[2, 2] = mask[1, 3] = mask[6, 6:9] = mask[8, 0] = True
check('blobs by sides and corners', giveaway.blobs(mask) == 3)
check('none', giveaway.blobs(mask & False) == 0)

label = numpy.array([0, 0, 1, 1, 0])
check('area under the curve by hand', giveaway.area_under_curve(numpy.array([1, 2, 3, 4, 3.5]), label) == 5 / 6)
plain = [(f'v{k % 10}', k % 2, list(random.normal(size=7))) for k in range(400)]
check('surroundings that tell nothing', abs(giveaway.context_auc(plain)[0] - 0.5) < 0.08)
told = [(variant, one, [figure[0] + 2 * one] + figure[1:]) for variant, one, figure in plain]
check('surroundings that tell: of two normals 2 apart 0.92', abs(giveaway.context_auc(told)[0] - 0.921) < 0.05)

flat = random.normal(size=(80, 80))
flat[40:45, 40:45] += 8
found = giveaway.contrast(flat, 2)
check('the window stands out where it is', numpy.unravel_index(numpy.argmax(found), found.shape) == (42, 42))
check('by its height over the spread', abs(found[42, 42] - 8) < 2)
brute = flat[42 - 8:42 + 9, 42 - 8:42 + 9].copy()
inner = brute[6:11, 6:11].mean()
brute[6:11, 6:11] = numpy.nan
check('as counted by hand', abs(found[42, 42] - (inner - numpy.nanmean(brute)) / numpy.nanstd(brute)) < 1e-6)


def write_exr(path, planes):
    import Imath
    import OpenEXR
    height, width = next(iter(planes.values())).shape
    header = OpenEXR.Header(width, height)
    kinds = {name: Imath.PixelType(Imath.PixelType.UINT if plane.dtype == numpy.uint32 else Imath.PixelType.FLOAT)
             for name, plane in planes.items()}
    header['channels'] = {name: Imath.Channel(kind) for name, kind in kinds.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    file = OpenEXR.OutputFile(str(path), header)
    file.writePixels({name: plane.tobytes() for name, plane in planes.items()})
    file.close()


with tempfile.TemporaryDirectory() as folder:
    out, lines = pathlib.Path(folder), []
    for number in range(10):  # a target of 6 x 4 pixels that is hottest in five frames, a car in three, a fire that has a box alone in one, the ground in one
        lwir = numpy.full((60, 80), 10, numpy.float32) + 0.01 * random.random((60, 80)).astype(numpy.float32)
        zero = numpy.zeros((60, 80), numpy.uint32)
        entity, part, instance = zero.copy(), zero.copy(), zero.copy()
        entity[30:34, 40:46] = 1
        lwir[30:34, 40:46] = 12
        instance[10:12, 10:14], part[10:12, 10:14] = 5, 2
        lwir[10:12, 10:14] = 13 if number < 3 else 11
        lwir[50, 70] = 14 if number == 9 else 10
        lwir[21, 21] = 14 if number == 8 else 10
        instance[32, 0:80] = 7
        instance[entity > 0], part[entity > 0] = 0, 1
        write_exr(out / f'frames/lwir/{number:06d}.exr', {'Y': lwir})
        write_exr(out / f'frames/truth/{number:06d}.exr', {'entity': entity, 'part': part, 'instance': instance, 'material': zero + 1})
        lines.append(json.dumps({'frame': number, 'targets': [], 'clutter': [{'instance': 5, 'class': 'car'}, {'instance': 6, 'class': 'fire', 'box_px': [20, 21, 22, 22]}],
                                 'sensors': [{'width_px': 80, 'hfov_deg': 8}]}))
    (out / 'truth.jsonl').write_text('\n'.join(lines))
    (out / 'run.json').write_text('{}')
    of = {(band, what): values[0] for band, what, *values in giveaway.measure([out], ['lwir'])}
    check('hottest: targets', of[('lwir', 'hottest_target')] == 0.5)
    check('hottest: cars', of[('lwir', 'hottest_car')] == 0.3)
    check('hottest: a fire between the middles of pixels', of[('lwir', 'hottest_fire')] == 0.1)
    check('hottest: the ground', of[('lwir', 'hottest_ground')] == 0.1)
    check('a threshold at 12 takes the cars and the spots: 5 alarms in 10 frames', of[('lwir', 'fixed_false_a_frame')] == 0.5)
    check('targets', of[('all', 'targets')] == 10 and of[('all', 'centred')] == 0)
    near = 12 / (16 * 18 - 24)  # a row of plants through the ring of 6 pixels about the target
    check('plants beside targets', abs(of[('all', 'plants_beside_targets')] - near) < 0.01)
    check('plants in the frame', abs(of[('all', 'plants_in_frame')] - 74 / (60 * 80 - 24)) < 1e-6)
    deg2 = (2 * math.degrees(math.atan(40 / (40 / math.tan(math.radians(4)))))) * math.degrees(2 * math.atan(30 * math.tan(math.radians(4)) / 40))
    check('square degrees', abs(of[('lwir', 'contrast_false_a_frame')] / max(of[('lwir', 'contrast_false_a_deg2')], 1e-9) - deg2) < 1e-3)
sys.exit(failed > 0)
