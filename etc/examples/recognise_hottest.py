#!/usr/bin/env python3
"""The hottest pixel: the least that a recogniser must beat. Always one detection a frame, of the class `hot`.

    etc/examples/recognise_hottest.py OUT                 answers the frames of a run or sweep: OUT/answers.jsonl
    etc/examples/recognise_hottest.py --memory seeker     answers a living node (publish.detections_port)

Of medians of 5 x 5, so that no defective pixel is the hottest. The box holds what is connected with it and warmer than its
surroundings; the score says how far it stands out of them. etc/examples/recognise_hottest.c is the same in C. All of it:
etc/reference/recognisers.md."""
import numpy

import recognise

REACH_PX = 32  # surroundings of the brightest pixel on each side, and the farthest that a box reaches
LEVEL = 0.1    # of the way from their median to it: what is above belongs to the box


def connected(mask, row, column):
    """Of a mask, what is connected with one of its pixels, by sides: grown until nothing is added."""
    grown = numpy.zeros_like(mask)
    grown[row, column] = mask[row, column]
    count = 0
    while count != (count := int(grown.sum())):
        wider = grown.copy()
        wider[1:] |= grown[:-1]
        wider[:-1] |= grown[1:]
        wider[:, 1:] |= grown[:, :-1]
        wider[:, :-1] |= grown[:, 1:]
        grown = wider & mask
    return grown


def bounds(mask):
    """Left, top, right, bottom of what is set in a mask, the last two beyond it."""
    rows, columns = numpy.flatnonzero(mask.any(axis=1)), numpy.flatnonzero(mask.any(axis=0))
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


class Hottest:
    bands_wanted = 1

    def find(self, look):
        plane = recognise.despeckled(next(iter(look.planes.values())))
        row, column = numpy.unravel_index(numpy.argmax(plane), plane.shape)
        top, left = max(row - REACH_PX, 0), max(column - REACH_PX, 0)
        near = plane[top:row + REACH_PX + 1, left:column + REACH_PX + 1]
        peak, median = float(plane[row, column]), float(numpy.median(near))
        if not peak > median:
            return []  # an image of one value
        box = bounds(connected(near > median + LEVEL * (peak - median), row - top, column - left))
        spread = float(numpy.median(numpy.abs(near - median)))  # half of the pixels are within it
        score = (peak - median) / (peak - median + 10 * spread)
        return [recognise.Detection((box[0] + left, box[1] + top, box[2] + left, box[3] + top), score, 'hot')]


if __name__ == '__main__':
    recognise.main(Hottest(), __doc__)
