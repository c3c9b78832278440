#!/usr/bin/env python3
"""Double-window contrast: what differs from its surroundings, warm or cold, of the class `contrast`.

    etc/examples/recognise_contrast.py OUT                answers the frames of a run or sweep: OUT/answers.jsonl
    etc/examples/recognise_contrast.py --memory seeker    answers a living node (publish.detections_port)

An inner window slides over the image, about it a guard, which belongs to neither, and an outer window. The contrast is the
mean of the inner less that of the outer, over the standard deviation of the outer. It is normalised once more by how much
that varies over the whole image, so that one threshold holds for calm and for cluttered scenes (a constant rate of false
alarms); of windows that overlap one is kept. All of it: etc/reference/recognisers.md."""
import math

import numpy

import recognise
from recognise_hottest import bounds, connected

WINDOWS = ((3, 2), (6, 3), (12, 6), (24, 10), (48, 20))  # half widths and half heights of the inner window, px
GUARD, OUTER = 1.5, 2.2  # of these windows over the inner one
SHARE = 0.6              # of the outer window that must lie within the image
THRESHOLD = 5.0          # in standard deviations over the image
EDGE = 3.0               # in standard deviations of the surroundings: what belongs to a box
SHARED = 0.5             # of the smaller box, above which two detections are one
LARGER = 0.5             # share of the best score with which a larger box counts for more


class Sums:
    """Sums over any rectangle in four look-ups."""

    def __init__(self, plane):
        self.table = numpy.zeros((plane.shape[0] + 1, plane.shape[1] + 1))
        numpy.cumsum(numpy.cumsum(plane, axis=0), axis=1, out=self.table[1:, 1:])
        self.rows, self.columns = numpy.arange(plane.shape[0])[:, None], numpy.arange(plane.shape[1])[None, :]

    def window(self, half_width, half_height):
        """About each pixel the sum over a window, and its count of pixels: less at the margin of the image."""
        height, width = self.table.shape
        top, bottom = numpy.maximum(self.rows - half_height, 0), numpy.minimum(self.rows + half_height + 1, height - 1)
        left = numpy.maximum(self.columns - half_width, 0)
        right = numpy.minimum(self.columns + half_width + 1, width - 1)
        t = self.table
        return t[bottom, right] - t[top, right] - t[bottom, left] + t[top, left], (bottom - top) * (right - left)


def noise_of(plane):
    """Standard deviation of the noise of a pixel: from the differences of neighbours, half of which are small."""
    return 1.4826 / math.sqrt(2) * float(numpy.median(numpy.abs(numpy.diff(plane, axis=1)))) + 1e-30


def contrast(plane, noise, half_width, half_height):
    """Of each pixel: mean of the inner window less that of the outer one, over the standard deviation of the outer, which
    is not less than the noise: the median has taken most of that. NaN at the margin of the image."""
    values, squares = Sums(plane), Sums(plane * plane)

    def ring(sums):
        outer, count = sums.window(math.ceil(OUTER * half_width), math.ceil(OUTER * half_height))
        guard, less = sums.window(math.ceil(GUARD * half_width), math.ceil(GUARD * half_height))
        return (outer - guard) / (count - less), count - less
    inner, count = values.window(half_width, half_height)
    mean, around = ring(values)
    variance = numpy.maximum(ring(squares)[0] - mean * mean, 0)
    whole = around >= SHARE * around.max()  # not where the margin of the image cuts off most of the surroundings
    return numpy.where(whole, (inner / count - mean) / numpy.sqrt(variance + noise * noise), numpy.nan)


def normalised(values):
    """In robust standard deviations from the median of the image."""
    median = numpy.nanmedian(values)
    spread = 1.4826 * numpy.nanmedian(numpy.abs(values - median))
    return (values - median) / (spread + 1e-30)


def shared(a, b):
    """Intersection over the smaller of two boxes: 1 where one holds the other."""
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return width * height / min((c[2] - c[0]) * (c[3] - c[1]) for c in (a, b))


def suppressed(found):
    """One of those that share most of the smaller one's area: with the best score, and the largest box of those at least
    LARGER times as good, since the best window often fits a hot part of a vehicle."""
    kept = []
    for one in sorted(found, key=lambda d: -d.score):
        for i, other in enumerate(kept):
            if shared(one.box, other.box) > SHARED:
                if one.score >= LARGER * other.score:
                    kept[i] = other._replace(box=max(one.box, other.box, key=_area))
                break
        else:
            kept.append(one)
    return kept


def _area(box):
    return (box[2] - box[0]) * (box[3] - box[1])


def fitted(plane, noise, row, column, half_width, half_height):
    """The box of what is connected within a window and differs, warm or cold, from the surroundings by more than
    EDGE of their own standard deviation. At most that of the guard window; None where nothing does."""
    guard_w, guard_h = math.ceil(GUARD * half_width), math.ceil(GUARD * half_height)
    wide_w, wide_h = math.ceil(OUTER * half_width), math.ceil(OUTER * half_height)
    left, top = max(column - wide_w, 0), max(row - wide_h, 0)
    near = plane[top:row + wide_h + 1, left:column + wide_w + 1]
    rows, columns = abs(numpy.arange(near.shape[0]) + top - row), abs(numpy.arange(near.shape[1]) + left - column)
    guard = (rows <= guard_h)[:, None] & (columns <= guard_w)[None, :]
    inner = (rows <= half_height)[:, None] & (columns <= half_width)[None, :]
    ring = near[~guard]
    median = numpy.median(ring)
    differs = numpy.abs(near - median) / max(1.4826 * numpy.median(numpy.abs(ring - median)), noise)
    at = numpy.unravel_index(numpy.argmax(numpy.where(inner, differs, -1)), near.shape)
    if not differs[at] > EDGE:
        return None
    box = bounds(connected((differs > EDGE) & guard, *at))
    return box[0] + left, box[1] + top, box[2] + left, box[3] + top


class Contrast:
    bands_wanted = 1

    def __init__(self, threshold=THRESHOLD, most=20):
        self.threshold, self.most = threshold, most

    def find(self, look):
        seen = next(iter(look.planes.values()))
        plane, noise = recognise.despeckled(seen), noise_of(seen)
        found = []
        for half_width, half_height in WINDOWS:
            if 2 * OUTER * half_width < plane.shape[1] and 2 * OUTER * half_height < plane.shape[0]:
                found += self._peaks(plane, noise, half_width, half_height)
        return suppressed(found)[:self.most]

    def _peaks(self, plane, noise, half_width, half_height):
        strength = numpy.nan_to_num(numpy.abs(normalised(contrast(plane, noise, half_width, half_height))))
        for _ in range(self.most):
            row, column = numpy.unravel_index(numpy.argmax(strength), strength.shape)
            z = float(strength[row, column])
            if not z > self.threshold:
                return
            box = fitted(plane, noise, row, column, half_width, half_height)
            if box:
                yield recognise.Detection(box, z / (z + 10), 'contrast')
            strength[max(row - 2 * half_height, 0):row + 2 * half_height + 1,
                     max(column - 2 * half_width, 0):column + 2 * half_width + 1] = 0


if __name__ == '__main__':
    recognise.main(Contrast(), __doc__)
