#!/usr/bin/env python3
"""A tracker that is locked on before launch: holds what the boresight was on, and answers nothing else.

    pitviper fly SCENARIO --recogniser 'etc/examples/recognise_track.py --memory $PITVIPER_MEMORY'
    etc/examples/recognise_track.py OUT                   answers the frames of a run: OUT/answers.jsonl

A seeker is pointed at its target before it is launched: what is busiest near the middle of the first images, has an outline of
its own (roads and edges of fields run on) and is there twice becomes the target. From then on it is found by correlation:
its last images, enlarged as it comes nearer, are shifted over the new one. Where the best match is poor it counts as
hidden, and nothing is answered; also when it fills the image. It has no classes (`tracked`) and sees one band.
All of it: etc/reference/recognisers.md."""
import math

import numpy

import recognise
from recognise_hottest import bounds

REACH = 0.08       # of the image's width: farthest from the boresight that a target is taken
LEAST_PX = 6       # pixels of a target
BUSY = 4.0         # deviations above the median of its surroundings: how busy a pixel of a target is at least
AGREES = 6.0       # px: between two looks at a target before it is followed
MATCH = 0.5        # correlation below which it counts as hidden
SURE = 0.75        # and below which it is looked for farther away
STEP_PX = 5        # farthest from where it is expected
FAR_PX = 14        # and from where it was
FAR_MATCH = 0.65   # correlation that there is at least
SCALES = (0.985, 1.0, 1.015, 1.04, 1.08, 1.14)  # by which it may have grown since the last frame
VIEW_PX = 11        # least width and height of what is correlated: a part of a vehicle alone is like much else
LEARNS = 0.25      # share of the newest image in the template
SETTLES = 0.15     # share of the way to the outline of what is busy there, in each frame
GRID = 14          # px: larger targets are outlined in an image made smaller
PATIENCE = 12      # frames hidden, after which it is given up
FILLS = 1.0        # of the image's width or height: nothing is answered beyond


def shifted(plane):
    """A plane by each of the nine steps to a neighbour; the margin repeats."""
    wide = numpy.pad(plane, 1, mode='edge')
    height, width = plane.shape
    return [wide[y:y + height, x:x + width] for y in range(3) for x in range(3)]


def cleaned(plane):
    """Without single defective pixels: the median of 3 x 3."""
    return numpy.median(shifted(plane), axis=0)


def busy(plane):
    """Largest less least of 3 x 3."""
    near = shifted(plane)
    return numpy.max(near, axis=0) - numpy.min(near, axis=0)


def widened(values):
    """The largest of 5 x 5, of values from 0."""
    for axis in (0, 1):
        for _ in range(2):
            out = values.copy()
            to, of = (out.T, values.T) if axis else (out, values)
            numpy.maximum(to[1:], of[:-1], out=to[1:])
            numpy.maximum(to[:-1], of[1:], out=to[:-1])
            values = out
    return values


def labelled(mask):
    """A number for each part of a mask that is connected, across gaps of a pixel; 0 elsewhere."""
    label, last = numpy.where(mask, numpy.arange(1, mask.size + 1).reshape(mask.shape), 0), None
    while last is None or (label != last).any():
        last, label = label, widened(label) * mask
    return label


def busiest(plane, middle, reach, spread_out):
    """Centre and size of the busiest blob, for its distance from a place, that has an outline of its own within 2 `reach`; else
    None. spread_out: power of its area by which size counts beside how busy it is."""
    height, width = plane.shape
    x0, y0 = (int(max(v - 2 * reach, 0)) for v in middle)
    active = busy(plane[y0:int(middle[1] + 2 * reach) + 1, x0:int(middle[0] + 2 * reach) + 1])
    rows, columns = numpy.indices(active.shape)
    across, down = columns + x0 + 0.5 - middle[0], rows + y0 + 0.5 - middle[1]
    around = active[numpy.hypot(across, down) > reach]
    if around.size < 30:
        return None
    median = float(numpy.median(around))
    spread = 1.4826 * float(numpy.median(numpy.abs(around - median))) + 1e-12
    level, best, found = BUSY, 0.0, None
    while (active > median + level * spread).any():
        label = labelled(active > median + level * spread)
        runs_on = set(numpy.concatenate((label[0], label[-1], label[:, 0], label[:, -1])))
        for number, count in zip(*numpy.unique(label, return_counts=True)):
            if number in runs_on or number == 0 or count < LEAST_PX:
                continue
            one = label == number
            off = math.hypot(across[one].mean(), down[one].mean())
            worth = float((active[one] - median).mean()) * count ** spread_out * math.exp(-(2 * off / reach) ** 2)
            if off <= reach and worth > best:
                best, found = worth, one
        level *= 1.4
    if found is None:
        return None
    left, top, right, bottom = bounds(found)  # a pixel less on each side: what is busy reaches beyond
    return (numpy.array(((left + right) / 2 + x0, (top + bottom) / 2 + y0)),
            numpy.maximum(numpy.array((right - left - 2, bottom - top - 2), float), 3))


def weights(at, size, count, most):
    """Of `count` places over a length about each of the places `at`: the pixel before, and the share of the next one."""
    where = numpy.clip(numpy.asarray(at)[:, None] - 0.5 + ((numpy.arange(count) + 0.5) / count - 0.5) * size, 0, most - 1.001)
    return where.astype(int), where - where.astype(int)


def sampled(plane, columns, rows, size, shape):
    """Boxes of a plane about each of some places [rows, columns], as images of `shape`: bilinear, the margin repeated."""
    (top, v), (left, u) = weights(rows, size[1], shape[0], plane.shape[0]), weights(columns, size[0], shape[1], plane.shape[1])
    v, u = v[:, :, None], u[None, None]
    lines = (1 - v) * plane[top] + v * plane[top + 1]                        # [rows, height, all columns]
    images = (1 - u) * lines[:, :, left] + u * lines[:, :, left + 1]         # [rows, height, columns, width]
    return images.transpose(0, 2, 1, 3)


def box_of(plane, centre, size, shape):
    return sampled(plane, centre[:1], centre[1:], size, shape)[0, 0]


def unit(image):
    """Less its mean, of length 1: the sum of the product of two is their correlation. Of images in the last two axes."""
    image = image - image.mean(axis=(-2, -1), keepdims=True)
    return image / (numpy.sqrt((image * image).sum(axis=(-2, -1), keepdims=True)) + 1e-12)


class Target:
    """What is followed: px of the image. template: an image of its box and a margin about it."""

    def __init__(self, plane, centre, size):
        self.centre, self.size, self.velocity, self.hidden = numpy.array(centre), numpy.array(size), numpy.zeros(2), 0
        self.template = None
        self.learn(plane, 1)

    def view(self):
        return numpy.maximum(self.size * 1.2 + 2, VIEW_PX)

    def learn(self, plane, share):
        """Takes a share of how it looks now; the template has about a sample a pixel, at most 48 x 48."""
        shape = tuple(int(min(max(round(v), 5), 48)) for v in self.view()[::-1])
        now = unit(box_of(plane, self.centre, self.view(), shape))
        if self.template is not None:
            size = numpy.array(self.template.shape[::-1], float)
            was = box_of(self.template, size / 2, size, shape)
            now = unit(share * now + (1 - share) * unit(was))
        self.template = now

    def box(self):
        return (*(self.centre - self.size / 2), *(self.centre + self.size / 2))


class Track:
    bands_wanted = 1

    def __init__(self):
        self.target = self.candidate = self.last = None

    def find(self, look):
        plane = cleaned(next(iter(look.planes.values())))
        if self.target:
            self.target.centre = self._turned(self.target.centre, look, plane)
        elif self.candidate:
            self.candidate = self._turned(self.candidate[0], look, plane), self.candidate[1]
        self.last = look
        seen = self._follow(plane) if self.target else self._lock(plane)
        if not seen:
            return []
        height, width = plane.shape
        left, top, right, bottom = self.target.box()
        if right - left > FILLS * width or bottom - top > FILLS * height:
            return []
        box = max(left, 0), max(top, 0), min(right, width), min(bottom, height)
        return [recognise.Detection(box, 0.9, 'tracked')] if box[0] < box[2] and box[1] < box[3] else []

    def _turned(self, at, look, plane):
        """Where a place of the last image is in this one, as far as the camera has turned since."""
        if look.axes is None or self.last is None or self.last.axes is None:
            return at
        middle = numpy.array(plane.shape[::-1]) / 2
        d = look.axes.T @ self.last.axes @ numpy.append((at - middle) / self.last.focal_px, 1)
        return middle + look.focal_px * d[:2] / d[2] if d[2] > 0 else at

    # ---- before

    def _lock(self, plane):
        """Whether there is a target: what was near the boresight in the last image and is in this one."""
        middle, reach = numpy.array(plane.shape[::-1]) / 2, REACH * plane.shape[1]
        before, self.candidate = self.candidate, busiest(plane, middle, reach, 0.5)
        if before is None or self.candidate is None:
            return False
        (a, size_a), (b, size_b) = before, self.candidate
        ratio = size_a.prod() / size_b.prod()
        if math.dist(a, b) > AGREES or not 0.2 <= ratio <= 5:
            return False
        self.target = Target(plane, b, numpy.maximum(size_a, size_b))
        return True

    # ---- after

    def _follow(self, plane):
        """Whether the target was seen; else it is where it is expected."""
        t = self.target
        expected = t.centre + t.velocity
        best, centre, scale = self._matched(plane, expected, STEP_PX)
        near = best > SURE
        if not near:  # the seeker has turned: anywhere near the last place
            wider = self._matched(plane, t.centre, FAR_PX)
            if wider[0] > max(best, FAR_MATCH):
                best, centre, scale = wider
        if best < MATCH:
            t.centre, t.velocity, t.hidden = expected, 0.9 * t.velocity, t.hidden + 1
            if t.hidden > PATIENCE:
                self.target = None
            return False
        t.size = t.size * scale
        t.centre = centre
        self._settle(plane)
        t.velocity = t.velocity + 0.4 * (t.centre - expected) if near else numpy.zeros(2)
        t.hidden = 0
        t.learn(plane, LEARNS)
        return True

    def _matched(self, plane, expected, reach):
        """The best correlation, where, and by which scale: steps of a pixel, then of a quarter."""
        t, reach = self.target, reach + self.target.hidden

        def most(centre, steps, scale):
            images = sampled(plane, centre[0] + steps, centre[1] + steps, t.view() * scale, t.template.shape)
            match = (unit(images) * t.template).sum(axis=(-2, -1))
            row, column = numpy.unravel_index(numpy.argmax(match), match.shape)
            return float(match[row, column]), centre + (steps[column], steps[row])
        _, at = most(expected, numpy.arange(-reach, reach + 1), 1.01)
        _, scale = max((most(at, numpy.zeros(1), s)[0], s) for s in SCALES)
        best, at = most(at, numpy.arange(-3, 4) / 4, scale)
        return best, at, scale

    def _settle(self, plane):
        """A little towards the outline of what is busy there, if it has one: against drift, and for the whole of a target."""
        t = self.target
        step = max(float(max(t.size)) / GRID, 1)  # px: gaps within a vehicle grow with it
        half = numpy.ceil(1.5 * t.size / step + 5)
        grid = box_of(plane, t.centre, 2 * half * step, tuple(int(2 * v) for v in half[::-1]))
        seen = busiest(grid, half, float(max(t.size)) / step * 0.6 + 4, 0.75)
        if seen is None or not 0.4 <= (seen[1] * step).prod() / t.size.prod() <= 4:
            return
        seen = t.centre + (seen[0] - half) * step, seen[1] * step
        t.centre = t.centre + SETTLES * (seen[0] - t.centre)
        t.size = t.size * (seen[1] / t.size) ** SETTLES


if __name__ == '__main__':
    recognise.main(Track(), __doc__)
