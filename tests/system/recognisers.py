"""The recognisers of etc/examples on images made by hand, whose targets are known: test_recognisers.sh calls it."""
import io
import json
import os
import pathlib
import socket
import sys
import tempfile
import types
import zlib

import numpy
from PIL import Image

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '../../etc/examples'))
import read_memory  # noqa: E402
import recognise  # noqa: E402
import recognise_shape  # noqa: E402
from recognise_contrast import Contrast, Sums, contrast, noise_of, shared, suppressed  # noqa: E402
from recognise_hottest import Hottest  # noqa: E402
from recognise_shape import Shape  # noqa: E402
from recognise_track import Track  # noqa: E402

failures = 0
FOCAL_PX = 2000
BLOCK = (90, 60, 114, 72)  # left, top, right, bottom


def check(what, holds):
    global failures
    if not holds:
        failures += 1
        print(f'FAILED: {what}')


def scene(seed, strength=0.0, block=BLOCK, size=(144, 192)):
    """Noise of 5 counts about 1000, with a block that is warmer or colder."""
    plane = numpy.random.default_rng(seed).normal(1000, 5, size)
    plane[block[1]:block[3], block[0]:block[2]] += strength
    return numpy.rint(plane).astype(numpy.float32)


def found(recogniser, *planes):
    return recogniser.find(recognise.Look(dict(zip(('lwir', 'mwir'), planes)), FOCAL_PX))


def near(box, want, px):
    return max(abs(a - b) for a, b in zip(box, want)) <= px


# ---- files: Pillow wrote them, with whatever filter it took for best ---------------------------------------------------

def filters_of(data, octets_a_row):
    packed, at = b'', 8
    while at < len(data):
        size = int.from_bytes(data[at:at + 4], 'big')
        packed += data[at + 8:at + 8 + size] if data[at + 4:at + 8] == b'IDAT' else b''
        at += size + 12
    return set(zlib.decompress(packed)[::octets_a_row + 1])


def files(folder):
    rng = numpy.random.default_rng(1)
    y, x = numpy.mgrid[0:64, 0:48]
    smooth = 90 + 60 * numpy.sin(x / 9) + 60 * numpy.cos((x + 2 * y) / 13)
    noisy = rng.integers(0, 256, (64, 48))
    mixed = numpy.where(y < 20, smooth, numpy.where(y < 40, 5 * x, numpy.where(y < 52, 3 * y, noisy))).astype(numpy.uint8)
    for row in range(57, 64):  # as Average predicts
        for column in range(1, 48):
            mixed[row, column] = (int(mixed[row, column - 1]) + int(mixed[row - 1, column])) // 2 + column % 3
    seen = set()
    for name, values in (('grey8', mixed), ('rgb8', numpy.dstack([mixed, mixed[::-1], 255 - mixed])),
                         ('grey16', (mixed.astype(numpy.uint16) * 257 + noisy.astype(numpy.uint16) % 3))):
        path = folder / f'{name}.png'
        Image.fromarray(values).save(path, optimize=True)
        seen |= filters_of(path.read_bytes(), values[0].nbytes)
        check(f'{name}: as Pillow has it', numpy.array_equal(recognise.read_png(path), values))
    check(f'all filters of PNG are met, not {sorted(seen)}', seen == {0, 1, 2, 3, 4})
    data = (folder / 'grey16.png').read_bytes()
    for what, spoilt in (('cut short', data[:len(data) // 2]), ('another file', b'GIF89a' + data), ('empty', b'')):
        (folder / 'bad.png').write_bytes(spoilt)
        try:
            recognise.read_png(folder / 'bad.png')
            check(f'a file that is {what} is refused', False)
        except ValueError as reason:
            check(f'{what}: the file is named', 'bad.png' in str(reason))


# ---- recognisers ---------------------------------------------------------------------------------------------------------

def hottest():
    plane = scene(1, 100)
    plane[20, 30] = plane[100, 150] = plane[100, 151] = 16383  # defective pixels
    one = found(Hottest(), plane)
    check('hottest: one, a box about the block', len(one) == 1 and near(one[0].box, BLOCK, 1) and one[0].class_name == 'hot')
    check('hottest: scores rise with contrast', found(Hottest(), scene(1, 400))[0].score > one[0].score > 0.5)
    check('hottest: of an image of one value nothing', found(Hottest(), numpy.full((40, 50), 7, numpy.float32)) == [])


def contrasts():
    # the sums of any window are those of numpy
    plane = numpy.random.default_rng(3).normal(0, 1, (30, 40))
    sums, counts = Sums(plane).window(5, 3)
    check('windows: sum', numpy.isclose(sums[10, 20], plane[7:14, 15:26].sum()) and numpy.isclose(sums[0, 0], plane[:4, :6].sum()))
    check('windows: count', counts[10, 20] == 77 and counts[0, 0] == 24)
    # a block that fills the inner window, on ground of known spread: contrast over spread
    plane = numpy.indices((80, 120)).sum(axis=0) % 2 * 20.0  # 0 and 20: a standard deviation of 10
    plane[37:44, 54:67] = 10 + 60
    check('contrast: by paper', abs(contrast(plane, 1e-9, 6, 3)[40, 60] - 60 / 10) < 0.05)
    for what, strength in (('warm', 40), ('cold', -40)):
        one = found(Contrast(), scene(4, strength))
        check(f'contrast: a {what} block is the first', one and near(one[0].box, BLOCK, 2))
    ramp = numpy.linspace(0, 100, 192, dtype=numpy.float32)[None, :]
    sloped = found(Contrast(), scene(4, 60) + ramp)
    check('contrast: on a slope, too', sloped and near(sloped[0].box, BLOCK, 6))
    a, b = found(Contrast(), scene(4, 40)), found(Contrast(), 4 * scene(4, 40) + 256)
    check('contrast: gain and level of the camera do not count',
          [d.box for d in a] == [d.box for d in b] and all(abs(p.score - q.score) < 1e-3 for p, q in zip(a, b)))
    false = sum(len(found(Contrast(), scene(seed))) for seed in range(10, 16))
    check(f'contrast: of noise alone at most one false alarm in an image, not {false} in 6', false <= 6)
    check('noise: as it was made', abs(noise_of(scene(5)) - 5) < 0.5)
    check('shared: of the smaller', shared((0, 0, 10, 10), (5, 5, 9, 15)) == 4 * 5 / 40 and shared((0, 0, 1, 1), (1, 0, 2, 1)) == 0)
    kept = suppressed([recognise.Detection((0, 0, 10, 10), 0.3, 'a'), recognise.Detection((1, 0, 8, 8), 0.9, 'b'),
                       recognise.Detection((0, 0, 12, 9), 0.5, 'd'), recognise.Detection((30, 0, 40, 10), 0.1, 'c')])
    check('of those that overlap one is kept: the best, with the box of a larger that is half as good',
          [(d.class_name, d.score, d.box) for d in kept] == [('b', 0.9, (0, 0, 12, 9)), ('c', 0.1, (30, 0, 40, 10))])


def shape():
    values = recognise_shape.features(recognise.Look({}, FOCAL_PX), [scene(6, 80)] * 2, [5.0] * 2,
                                      recognise.Detection(BLOCK, 0.5, ''))
    check('shape: a candidate at even odds has strength 0', abs(values[0]) < 1e-12)
    check('shape: size in mrad', abs(numpy.exp(values[1]) - 1e3 * numpy.sqrt(24 * 12) / FOCAL_PX) < 1e-9)
    check('shape: elongation', abs(numpy.exp(values[2]) - 2) < 1e-9)
    check('shape: contrast over spread and noise', abs(numpy.exp(values[3]) - 80 / numpy.hypot(5, 5)) < 1)
    for name, rows in recognise_shape.CLASSES.items():
        score, word = recognise_shape.judged([mean for mean, _ in rows])
        check(f'shape: the middle of {name}', (word == name and score > 0.5) if name != 'clutter' else score < 0.2)
    seen = found(Shape(), scene(6, 40), scene(7, 40))
    check('shape: a block is found', any(near(d.box, BLOCK, 1) and d.score > 0.8 for d in seen))
    tank, clutter = ([mean for mean, _ in recognise_shape.CLASSES[name]] for name in ('tank', 'clutter'))
    half = [(a + b) / 2 for a, b in zip(tank, clutter)]
    one, both = (recognise_shape.judged(half[:5] + second[5:])[0] for second in (clutter, tank))
    check('shape: seen in both bands it counts for more', both > one + 0.1)
    check('shape: without a second band its features do not count', 0 < recognise_shape.judged(half[:5])[0] < 1)
    check('shape: one band is enough to run', found(Shape(), scene(6, 40)) != [])
    kept, recognise_shape.CLASSES = recognise_shape.CLASSES, {'tank': ((0, 1),), 'truck': ((2, 1),), 'clutter': ((9, 1),)}
    prior, recognise_shape.PRIOR = recognise_shape.PRIOR, dict.fromkeys(('tank', 'truck', 'clutter'), 1 / 3)
    check('shape: half way between two classes is unknown',
          [recognise_shape.judged([v])[1] for v in (0, 1, 2)] == ['tank', 'unknown', 'truck'])
    # at 4: exp(-8) of tank, exp(-2) of truck, exp(-12.5) of clutter
    odds = (numpy.exp(-8) + numpy.exp(-2)) / numpy.exp(-12.5)
    check('shape: the score by paper', abs(recognise_shape.judged([4.0])[0] - odds / (1 + odds)) < 1e-12)
    recognise_shape.CLASSES, recognise_shape.PRIOR = kept, prior


def tracks():
    def at(x, y):
        return recognise.Detection((x - 5, y - 5, x + 5, y + 5), 0.5, 'a')
    t = recognise.Tracks(gate=0.1, patience=3)
    check('tracks: two from 1', t.number(0, [at(20, 20), at(80, 20)], 100) == [1, 2])
    check('tracks: by the nearest, in any order', t.number(1, [at(77, 22), at(23, 21)], 100) == [2, 1])
    check('tracks: a third is new', t.number(2, [at(26, 22), at(50, 50)], 100) == [1, 3])
    check('tracks: one that jumps is another', t.number(3, [at(26, 60)], 100) == [4])
    check('tracks: kept over a gap', t.number(5, [at(29, 23)], 100) == [1])
    check('tracks: but not over a long one', t.number(9, [at(30, 23)], 100) == [5])


# ---- a run folder, without truth -------------------------------------------------------------------------------------------

def folder_of(folder, frames):
    for band in ('lwir', 'mwir'):
        (folder / 'raw' / band).mkdir(parents=True)
    (folder / 'run.json').write_text(json.dumps({'settings': {'sensor.hfov_deg': '5.5', 'sensor.width_px': '192'}}))
    for number, planes in frames.items():
        for band, plane in zip(('lwir', 'mwir'), planes):
            Image.fromarray(plane.astype(numpy.uint16)).save(folder / 'raw' / band / f'{number:06d}.png')


def runs(folder):
    moved = (94, 62, 118, 74)
    empty = numpy.full((144, 192), 9, numpy.float32)
    folder_of(folder / 'a', {3: [scene(1, 100)] * 2, 4: [scene(2, 100, moved)] * 2, 7: [empty] * 2})
    check('folder: frames and detections', recognise.run_folder(Hottest(), folder / 'a') == (3, 2))
    lines = [json.loads(line) for line in (folder / 'a/answers.jsonl').read_text().splitlines()]
    check('folder: frames by their numbers', [line['frame'] for line in lines] == [3, 4, 7])
    check('folder: of a frame without one, that', lines[2] == {'frame': 7, 'band': 'lwir', 'answer': 0, 'of': 0})
    check('folder: boxes', near(lines[0]['box_px'], BLOCK, 1) and near(lines[1]['box_px'], moved, 1))
    check('folder: one track', [line['track'] for line in lines[:2]] == [1, 1])
    recognise.run_folder(Hottest(), folder / 'a', folder / 'mwir.jsonl', ['mwir'])
    check('folder: the band that is asked for', '"band": "mwir"' in (folder / 'mwir.jsonl').read_text())
    check('folder: focal length', abs(recognise.Folder(folder / 'a').focal_px - 96 / numpy.tan(numpy.radians(2.75))) < 1e-9)
    # a sweep
    folder_of(folder / 'sweep/v1', {0: [scene(1, 100)] * 2})
    folder_of(folder / 'sweep/v2', {0: [scene(2, 100, moved)] * 2})
    manifest = [{'folder': 'v1', 'status': 'made'}, {'folder': 'v0', 'status': 'failed'}, {'folder': 'v2', 'status': 'kept'}]
    (folder / 'sweep/manifest.jsonl').write_text(''.join(json.dumps(m) + '\n' for m in manifest))
    recognise.run_folder(Hottest(), folder / 'sweep', folder / 'sweep.jsonl')
    lines = [json.loads(line) for line in (folder / 'sweep.jsonl').read_text().splitlines()]
    check('sweep: lines say which variant', [line['sequence'] for line in lines] == ['v1', 'v2'])
    recognise.run_folder(Hottest(), folder / 'sweep')
    check('sweep: or each its own', (folder / 'sweep/v2/answers.jsonl').exists() and not list(folder.rglob('*.part')))
    try:
        recognise.Folder(folder / 'a', ['optical'])
        check('folder: a band that is not there', False)
    except FileNotFoundError as reason:
        check('folder: a band that is not there is named', 'optical' in str(reason))


# ---- a ring: what is sent is what is found -------------------------------------------------------------------------------
def ring():
    """A ring of one frame, of swir in the place of lwir, and the datagram that answers it."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.bind(('127.0.0.1', 0))
    listener.settimeout(10)
    plane = scene(3, 100)

    class Ring:
        def __init__(self, name, wait_s):
            self.header = types.SimpleNamespace(detections_port=listener.getsockname()[1])
            self.planes = [types.SimpleNamespace(band_name=b'swir', band=2)]

        def frames(self, in_order):
            yield types.SimpleNamespace(record=types.SimpleNamespace(frame=7, focal_px=FOCAL_PX), planes={'swir/Y': plane})

    read_memory.Ring = Ring
    for recogniser in (Hottest(), Contrast(), Shape()):
        name = type(recogniser).__name__
        counts = recognise.run_ring(recogniser, 'none', 1, ['swir'])
        answer = json.loads(listener.recv(65536))
        want = recognise.best(recogniser.find(recognise.Look({'swir': plane}, FOCAL_PX)))
        check(f'ring: {name} answers its frame and band', (answer['frame'], answer['band']) == (7, 'lwir') and counts[0] == 1)
        check(f'ring: {name}, all that it found', want and [(tuple(d['box_px']), d['class'], d['track']) for d in answer['detections']] ==
              [(d.box, d.class_name, k + 1) for k, d in enumerate(want)])
        check(f'ring: {name}, scores', all(abs(d['score'] - w.score) < 1e-4 for d, w in zip(answer['detections'], want)))


# ---- the tracker: where the target is, how large and what is about it, is known -------------------------------------------

PATTERN = numpy.array([[90, 10, -60, -60, 20, 80], [90, 90, -60, 10, 20, -40], [20, 70, 70, 10, 60, 60]], float)


def film(frames, seed=5, target=True, decoy=None, hidden=(), jump=None):
    """Images of 128 x 96: noise, a road across them; a patterned target that moves, grows by 2 % a frame and begins in the middle.
    Yields the image and the target's centre."""
    rng, x, y, width = numpy.random.default_rng(seed), 64.0, 48.0, 12.0
    rows, columns = numpy.mgrid[0:96, 0:128] + 0.5
    for k in range(frames):
        plane = rng.normal(1000, 2, (96, 128))
        plane[abs(rows - 62 - 0.1 * columns) < 1.5] += 40
        if decoy is not None and k >= decoy:
            plane[20:26, 30:42] += 3 * numpy.kron(PATTERN, numpy.ones((2, 2)))
        if target and k not in hidden:
            u, v = numpy.floor((columns - x) / width * 6 + 3), numpy.floor((rows - y) / width * 6 + 1.5)
            on = (u >= 0) & (u < 6) & (v >= 0) & (v < 3)
            plane[on] += PATTERN[v[on].astype(int), u[on].astype(int)]
        yield numpy.rint(plane).astype(numpy.float32), (x, y)
        x, y, width = x + 0.5, y - 0.2, width * 1.02
        if jump and k == jump[0]:
            x, y = x + jump[1], y + jump[2]


def off(film_):
    """Of each frame of a film the distance from the target to the answer; None: there was none."""
    tracker, out = Track(), []
    for plane, (x, y) in film_:
        answer = found(tracker, plane)
        check('track: one answer at most', len(answer) <= 1)
        out.append(numpy.hypot((answer[0].box[0] + answer[0].box[2]) / 2 - x, (answer[0].box[1] + answer[0].box[3]) / 2 - y)
                   if answer else None)
    return out


def tracker():
    held = off(film(50))
    check(f'track: held from the second frame on, within 2 px: {held}', all(d is not None and d < 2 for d in held[1:]))
    check('track: nothing where there is no target', all(d is None for d in off(film(20, target=False))))
    check('track: not what appears beside it, and is busier', all(d is not None and d < 2 for d in off(film(30, decoy=10))[1:]))
    turned = off(film(30, jump=(12, -9, 4)))
    check(f'track: found again when the seeker turns: {turned}', all(d is not None and d < 2 for d in turned[1:]))
    again = off(film(30, hidden=range(10, 15)))
    check(f'track: nothing while it is hidden, and the same again after that: {again}',
          all(d is None for d in again[10:15]) and all(d is not None and d < 2.5 for d in again[15:]))


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        files(folder)
        hottest()
        contrasts()
        shape()
        tracks()
        tracker()
        runs(folder)
        ring()
    print(f'{failures} failed')
    sys.exit(failures > 0)


main()
