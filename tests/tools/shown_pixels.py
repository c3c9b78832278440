"""tests/tools/shown_pixels.py: what an X server without a screen shows (Xvfb -fbdir), held against the images it should show.

    shown_pixels.py TRIES FRAMEBUFFER OUT BAND TABLE|display|counts BITS SCALE [WIDTHxHEIGHT]

The framebuffer file is in the form of xwd (X11/XWDFile.h), read here by that header alone. TABLE: CSV of drive levels, by numpy's
interpolation of the planes of the EXR file, or of the raw PNG file, of the first frame. SCALE: one, whole, fit; then a window's size, which
is in the middle of the screen. Looks so many times, until they are the same. Prints `FAILED: ...` and exits with 1
where a pixel differs."""
import glob
import struct
import sys
import time

import numpy


def screen(path):
    """[height, width, 3] of the root window."""
    octets = open(path, 'rb').read()
    head = struct.unpack('>25I', octets[:100])
    size, version, _, depth, width, height, _, order, _, _, _, bits, line = head[:13]
    colours = head[19]
    assert version == 7 and bits == 32 and depth == 24, (version, bits, depth)
    rows = numpy.frombuffer(octets, numpy.uint8, line * height, size + 12 * colours).reshape(height, line)
    pixels = rows[:, :4 * width].reshape(height, width, 4)
    return pixels[..., 2::-1] if order == 0 else pixels[..., 1:]


def first(out, folder, ending):
    return sorted(glob.glob(f'{out}/{folder}/*.{ending}'))[0]


def planes(path):
    """[height, width, channels] of radiance."""
    import OpenEXR
    with OpenEXR.File(path, separate_channels=True) as file:
        channels = file.channels()
        names = [name for name in ('R', 'G', 'B', 'Y') if name in channels]
        return numpy.stack([channels[name].pixels for name in names], axis=-1)


def image(path):
    from PIL import Image
    pixels = numpy.asarray(Image.open(path))
    return pixels if pixels.ndim == 3 else pixels[..., None]


def levels(out, band, source):
    if source == 'display':
        return image(first(out, f'frames/{band}', 'png'))
    if source == 'counts':
        return image(first(out, f'raw/{band}', 'png'))
    with open(source) as file:
        names = file.readline().strip().split(',')
        rows = numpy.loadtxt(file, delimiter=',')
    column = {name: rows[:, k] for k, name in enumerate(names)}
    counts = 'counts' in column
    values = image(first(out, f'raw/{band}', 'png')) if counts else planes(first(out, f'frames/{band}', 'exr'))
    value = column['counts' if counts else 'radiance']
    exact = numpy.interp(values.astype(float), value, column['level'])
    return numpy.floor(exact + 0.5).astype(int)


def compare(path, out, band, source, bits, scale, window='', last=True):
    shown = screen(path).astype(int)
    level = levels(out, band, source).astype(int)
    if bits == '16':
        assert level.shape[2] == 1
        level = numpy.concatenate([level >> 8, level & 255, 0 * level], axis=-1)
    elif level.shape[2] == 1:
        level = numpy.repeat(level, 3, axis=-1)
    height, width = level.shape[:2]
    across, down = map(int, window.split('x')) if window else (shown.shape[1], shown.shape[0])
    room = min(down / height, across / width)
    times = {'one': 1, 'whole': int(room), 'fit': room}[scale]
    rows, columns = int(height * times + 0.5), int(width * times + 0.5)
    top, left = [(whole - of) // 2 + (of - n) // 2
                 for whole, of, n in ((shown.shape[0], down, rows), (shown.shape[1], across, columns))]
    part = shown[top:top + rows, left:left + columns]
    wrong = 0
    if scale != 'fit':
        wrong = int((part != level.repeat(times, 0).repeat(times, 1)).any(-1).sum())
    else:  # each is that of the nearest pixel, or at an edge between two of either
        near = numpy.zeros(part.shape[:2], bool)
        for y in (-0.02, 0.02):
            for x in (-0.02, 0.02):
                at = [numpy.clip(((numpy.arange(n) + 0.5) / n * m + d).astype(int), 0, m - 1)
                      for n, m, d in ((rows, height, y), (columns, width, x))]
                near |= (part == level[at[0]][:, at[1]]).all(-1)
        wrong = int((~near).sum())
    around = shown.copy()
    around[top:top + rows, left:left + columns] = 0
    beside = int(around.any(-1).sum())
    different = len(numpy.unique(level.reshape(-1, 3), axis=0))
    good = not (wrong or beside or different < 8)
    if not good and not last:
        return False
    print(f'{band} {source.split("/")[-1]} {bits} bits, {scale}: {wrong} of {part[..., 0].size} pixels differ, '
          f'{beside} beside it are not black; {different} levels')
    if not good:
        print('FAILED: what is shown')
    return good


waits_s, tries = 0.3, int(sys.argv[1])
for k in range(tries):
    try:
        if compare(*sys.argv[2:], last=k == tries - 1):
            sys.exit(0)
    except (IndexError, OSError, ValueError, RuntimeError) as reason:  # the files are not there yet, or not whole
        if k == tries - 1:
            print('FAILED:', reason)
    time.sleep(waits_s)
sys.exit(1)
