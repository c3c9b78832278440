#!/usr/bin/env python3
"""What the example recognisers share: frames of a run folder or of a living node, tracks, answers. Python with numpy.

A recogniser is an object with `find(look)`, which returns a list of Detection. It is given what a seeker has: the planes
of its bands and its focal length. Nothing here reads truth.

    import recognise
    class Mine:
        bands_wanted = 1                                  # how many bands it looks at; answers are given to the first
        def find(self, look):
            return [recognise.Detection((10, 20, 30, 40), 0.9, 'hot')]
    if __name__ == '__main__':
        recognise.main(Mine(), __doc__)

The reference is etc/reference/recognisers.md."""
import argparse
import collections
import json
import math
import os
import pathlib
import socket
import struct
import sys
import zlib

import numpy

# box: left, top, right, bottom in pixels, the last two beyond it; score 0 .. 1; class_name: printable ASCII, at most 31
Detection = collections.namedtuple('Detection', 'box score class_name')
# planes {band: float32 [height, width]}, in the order of preference; focal_px: focal length in pixels; axes [3, 3]: the camera's,
# right, down and ahead, as columns in axes that do not turn with it, as a seeker's gyros tell it (of the ring; of files None)
Look = collections.namedtuple('Look', 'planes focal_px axes', defaults=(None,))
PREFERRED = ('lwir', 'mwir', 'optical')  # an order of bands for who looks for warm things


# ---- files -----------------------------------------------------------------------------------------------------------

def read_png(path):
    """A PNG of 8 or 16 bits, grey or RGB, not interlaced: an array [height, width] or [height, width, 3]."""
    data = pathlib.Path(path).read_bytes()
    if data[:8] != b'\x89PNG\r\n\x1a\n':
        raise ValueError(f'{path}: not a PNG file')
    header, packed, at = None, b'', 8
    while at + 12 <= len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b'IHDR' and size == 13:
            header = struct.unpack('>IIBBBBB', body)
        elif kind == b'IDAT':
            packed += body
        at += 12 + size
    if header is None or header[2] not in (8, 16) or header[3] not in (0, 2) or header[6] != 0:
        raise ValueError(f'{path}: neither grey nor RGB of 8 or 16 bits without interlacing')
    width, height, bits, colour = header[:4]
    channels = 3 if colour == 2 else 1
    pixel = channels * bits // 8
    try:
        rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + width * pixel)
    except (zlib.error, ValueError):
        raise ValueError(f'{path}: its data are damaged or incomplete') from None
    octets = _unfiltered(rows[:, 1:].reshape(height, width, pixel), rows[:, 0])
    values = octets.reshape(height, -1).view('>u2' if bits == 16 else numpy.uint8)
    return values.reshape((height, width, 3) if channels == 3 else (height, width))


def _unfiltered(octets, how):
    """Undoes the filters of PNG, row by row: each octet was stored less a prediction, modulo 256."""
    out = numpy.empty_like(octets)
    above = numpy.zeros_like(octets[0])
    for row, (line, filter_) in enumerate(zip(octets, how)):
        if filter_ == 0:
            out[row] = line
        elif filter_ == 1:  # the octet to the left
            out[row] = numpy.cumsum(line, axis=0, dtype=numpy.uint8)
        elif filter_ == 2:  # the octet above
            out[row] = line + above
        elif filter_ in (3, 4):
            out[row] = _predicted(line, above, filter_)
        else:
            raise ValueError(f'filter {filter_} is none of PNG')
        above = out[row]
    return out


def _predicted(line, above, filter_):
    """Of a row with the filters Average and Paeth, which need the pixel before: one at a time."""
    out, left, corner = numpy.empty_like(line), [0] * line.shape[1], [0] * line.shape[1]
    for column in range(line.shape[0]):
        for k in range(line.shape[1]):
            a, b, c = left[k], int(above[column, k]), corner[k]
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            left[k] = (int(line[column, k]) + ((a + b) // 2 if filter_ == 3 else paeth)) % 256
            corner[k] = b
        out[column] = left
    return out


def grey(values):
    """One float32 plane of a picture: of RGB the mean of its channels."""
    values = values.astype(numpy.float32)
    return values.mean(axis=2) if values.ndim == 3 else values


def despeckled(plane):
    """The median of 5 x 5: defective pixels, and small clumps of them, are hotter than any target."""
    wide = numpy.pad(plane, 2, mode='edge')
    height, width = plane.shape
    return numpy.median([wide[y:y + height, x:x + width] for y in range(5) for x in range(5)], axis=0)


class Folder:
    """Frames of a run: raw/BAND of the bands with a sensor, else the display images frames/BAND."""

    def __init__(self, out, bands=None):
        self.out = pathlib.Path(out)
        if not (self.out / 'run.json').exists():
            raise FileNotFoundError(f'{self.out}: no run.json; name the folder that `pitviper replay LOG --out OUT` wrote')
        settings = json.loads((self.out / 'run.json').read_text())['settings']
        half = math.radians(float(settings['sensor.hfov_deg'])) / 2  # the seeker's own field of view
        self.focal_px = float(settings['sensor.width_px']) / 2 / math.tan(half)
        self.at = {}
        for band in bands or PREFERRED:
            for kind in ('raw', 'frames'):
                folder = self.out / kind / band
                if band not in self.at and any(folder.glob('*.png')):
                    self.at[band] = folder
        missing = [band for band in bands or () if band not in self.at]
        if missing or not self.at:
            raise FileNotFoundError(f"{self.out}: no images of {', '.join(missing or PREFERRED)} in raw or frames; "
                                    'was it rendered with --no-png?')

    def frames(self, wanted):
        """(number, Look) of frame after frame, with the first `wanted` bands."""
        chosen = dict(list(self.at.items())[:wanted])
        for path in sorted(next(iter(chosen.values())).glob('*.png')):
            planes = {band: grey(read_png(folder / path.name)) for band, folder in chosen.items()}
            yield int(path.stem), Look(planes, self.focal_px)


# ---- tracks ----------------------------------------------------------------------------------------------------------

class Tracks:
    """Numbers from 1: a detection continues the track whose last one was nearest, within `gate` of the width of the
    image; a track that was not seen for `patience` frames ends."""

    def __init__(self, gate=0.08, patience=5):
        self.gate, self.patience, self.last, self.count = gate, patience, {}, 0

    def number(self, frame, found, width):
        """The track of each detection of a frame."""
        self.last = {t: (f, c) for t, (f, c) in self.last.items() if frame - f <= self.patience}
        centres = [((d.box[0] + d.box[2]) / 2, (d.box[1] + d.box[3]) / 2) for d in found]
        pairs = sorted((math.dist(c, last), i, t) for i, c in enumerate(centres) for t, (_, last) in self.last.items())
        tracks, taken = [0] * len(found), set()
        for distance, i, track in pairs:
            if distance <= self.gate * width and not tracks[i] and track not in taken:
                tracks[i] = track
                taken.add(track)
        for i, centre in enumerate(centres):
            if not tracks[i]:
                self.count += 1
                tracks[i] = self.count
            self.last[tracks[i]] = (frame, centre)
        return tracks


# ---- two drivers -----------------------------------------------------------------------------------------------------

def said(found, tracks):
    """Detections as JSON has them, in a file and on the way to a node."""
    return [{'class': d.class_name, 'box_px': [round(float(v), 2) for v in d.box], 'score': round(float(d.score), 4),
             'track': int(t)} for d, t in zip(found, tracks)]


def lines(frame, band, found, tracks):
    """Lines of answers.jsonl (`pitviper help answers`), without the times that only a node knows."""
    if not found:
        return [{'frame': frame, 'band': band, 'answer': 0, 'of': 0}]
    return [{'frame': frame, 'band': band, 'answer': i + 1, 'of': len(found), **d} for i, d in enumerate(said(found, tracks))]


MOST = 64  # detections of an answer


def best(found):
    return sorted(found, key=lambda d: -d.score)[:MOST]


class Whole:
    """A file of JSON lines that has its name only when it is complete."""

    def __init__(self, path):
        self.path, self.part = os.fspath(path), os.fspath(path) + '.part'

    def __enter__(self):
        self.file = open(self.part, 'w', encoding='ascii')
        return self

    def put(self, line):
        self.file.write(json.dumps(line) + '\n')

    def __exit__(self, error, *_):
        self.file.close()
        if error:
            os.unlink(self.part)
        else:
            os.replace(self.part, self.path)


def answer_frames(recogniser, folder, file, sequence=None):
    """Answers all frames of a Folder. Returns the count of frames and of detections."""
    tracks, frames, detections = Tracks(), 0, 0
    for frame, look in folder.frames(recogniser.bands_wanted):
        band, plane = next(iter(look.planes.items()))
        found = best(recogniser.find(look))
        for line in lines(frame, band, found, tracks.number(frame, found, plane.shape[1])):
            file.put({**line, 'sequence': sequence} if sequence else line)
        frames, detections = frames + 1, detections + len(found)
    return frames, detections


def run_folder(recogniser, out, answers=None, bands=None):
    """Answers a run, or each variant of a sweep: into answers.jsonl of its folder, or all into the file `answers`, where
    the lines of a sweep say which variant they are of (`sequence`). Returns the count of frames and of detections."""
    out = pathlib.Path(out)
    manifest, variants = out / 'manifest.jsonl', [None]
    if manifest.exists():
        made = (json.loads(line) for line in manifest.read_text().splitlines())
        variants = [v['folder'] for v in made if v['status'] != 'failed']
    folders = [(v, Folder(out / v if v else out, bands)) for v in variants]
    counts = []
    if answers:
        with Whole(answers) as file:
            counts = [answer_frames(recogniser, folder, file, v) for v, folder in folders]
    else:
        for _, folder in folders:
            with Whole(folder.out / 'answers.jsonl') as file:
                counts.append(answer_frames(recogniser, folder, file))
    return tuple(map(sum, zip(*counts))) if counts else (0, 0)


def ring_look(frame, wanted, bands=None):
    """The Look of a frame of the ring: channels of a band (optical/R, G, B) as their mean."""
    planes = {}
    for band in bands or PREFERRED:
        channels = [plane for name, plane in frame.planes.items() if name.split('/')[0] == band]
        if channels and len(planes) < wanted:
            planes[band] = numpy.mean(channels, axis=0, dtype=numpy.float32)
    axes = getattr(frame.record, 'r_ecef_from_cam', None)
    return Look(planes, frame.record.focal_px, None if axes is None else numpy.array(axes, float).reshape(3, 3))


def run_ring(recogniser, name, wait_s, bands=None, in_order=False):
    """Answers a living node, frame after frame, until it ends. Returns the count of frames and of detections."""
    from read_memory import Ring, send_answer
    ring = Ring(name, wait_s)
    if not ring.header.detections_port:
        print('the node takes no detections; set publish.detections_port', file=sys.stderr)
    # answers name a band; a plane has the name of the channel that is in its place
    named = {plane.band_name.decode(): ('optical', 'mwir', 'lwir', 'radar')[plane.band] for plane in ring.planes}
    tracks, frames, detections = Tracks(), 0, 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as to:
        for frame in ring.frames(in_order):
            look = ring_look(frame, recogniser.bands_wanted, bands)
            if not look.planes:
                raise FileNotFoundError(f'/dev/shm/{name} has none of the bands {", ".join(bands or PREFERRED)}')
            band, plane = next(iter(look.planes.items()))
            found = best(recogniser.find(look))
            numbers = tracks.number(frame.record.frame, found, plane.shape[1])
            if ring.header.detections_port:
                send_answer(to, ring.header.detections_port, frame.record.frame, named[band], said(found, numbers))
            frames, detections = frames + 1, detections + len(found)
    return frames, detections


def main(recogniser, about):
    options = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument('out', metavar='OUT', nargs='?', help='folder of a run or sweep; answers go into it')
    options.add_argument('--memory', metavar='NAME', help='answers a living node by its ring of frames instead')
    options.add_argument('--answers', metavar='FILE', help='one file for all answers; default: answers.jsonl in OUT, of a '
                         'sweep in the folder of each variant')
    options.add_argument('--bands', type=lambda s: s.split(','), help='bands to look at, the first of which is answered; '
                         f"default: the first that are there of {','.join(PREFERRED)}")
    options.add_argument('--wait', type=float, default=60, metavar='S', help='gives up when there is no node by then')
    options.add_argument('--in-order', action='store_true', help='takes every frame of the ring, for a node that waits for each '
                         'answer, rather than the newest')
    o = options.parse_args()
    if (o.out is None) == (o.memory is None):
        options.error('expected OUT, or --memory NAME')
    try:
        if o.memory:
            frames, detections = run_ring(recogniser, o.memory, o.wait, o.bands, o.in_order)
        else:
            frames, detections = run_folder(recogniser, o.out, o.answers, o.bands)
    except (OSError, ValueError, KeyError) as reason:
        sys.exit(f'{os.path.basename(sys.argv[0])}: {reason}')
    print(f'{frames} frames, {detections} detections')
