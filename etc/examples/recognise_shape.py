#!/usr/bin/env python3
"""Contrast and shape in two bands: what stands out of its surroundings is measured, and named by what it is most like.

    etc/examples/recognise_shape.py OUT                   answers the frames of a run or sweep: OUT/answers.jsonl
    etc/examples/recognise_shape.py --memory seeker       answers a living node (publish.detections_port)
    etc/examples/recognise_shape.py OUT --bands lwir,optical

Candidates are those of recognise_contrast.py in the first band, from a lower threshold on. Of each seven features are
measured; none needs the range. Classes are normal distributions of these features (naive Bayes), whose means and standard
deviations stand below: a class, `unknown` where two are about as likely, and clutter, which is not answered. The score is
the probability that it is no clutter. Without a second band its features do not count. All of it:
etc/reference/recognisers.md."""
import math

import numpy

import recognise
from recognise_contrast import Contrast, GUARD, noise_of

FEATURES = ('strength', 'size', 'elongation', 'contrast', 'edges', 'contrast_2', 'edges_2')
# mean and standard deviation of each feature, by class: over a sweep of vehicles in the open, by tests/scores/learn
CLASSES = {
    'clutter': ((-0.71, 0.20), (0.71, 0.52), (0.49, 0.36), (0.77, 0.39), (0.32, 0.35), (0.66, 0.53), (0.29, 0.40)),
    'tank': ((0.48, 0.59), (1.45, 0.65), (0.67, 0.29), (2.17, 0.80), (1.76, 0.44), (3.35, 1.00), (2.67, 0.71)),
    'truck': ((-0.27, 0.41), (1.17, 0.60), (0.73, 0.14), (1.33, 0.40), (1.02, 0.36), (1.68, 0.52), (1.27, 0.39)),
}
PRIOR = {'clutter': 0.979, 'tank': 0.016, 'truck': 0.005}
SURE = 2.0  # times as likely as the next class, else `unknown`


def features(look, planes, noises, detection):
    """The features of a candidate, natural logarithms: of few and of many times their size normal alike."""
    left, top, right, bottom = (int(v) for v in detection.box)
    width, height = right - left, bottom - top
    values = [math.log(detection.score / max(1 - detection.score, 1e-16)), math.log(1e3 * math.sqrt(width * height) / look.focal_px),
              math.log(width / height)]
    for plane, noise in zip(planes, noises):
        values += _in_band(plane, noise, left, top, right, bottom)
    return values


def _in_band(plane, noise, left, top, right, bottom):
    """How far the box differs from a frame about it, and how much more edges it has: in a band."""
    margin_x, margin_y = math.ceil(GUARD * (right - left) / 2) + 2, math.ceil(GUARD * (bottom - top) / 2) + 2
    x, y = max(left - margin_x, 0), max(top - margin_y, 0)
    near = plane[y:bottom + margin_y, x:right + margin_x]
    outside = numpy.ones(near.shape, bool)
    outside[top - y:bottom - y, left - x:right - x] = False
    inner, outer = near[~outside], near[outside]
    spread = math.hypot(float(outer.std()), noise)
    steps = numpy.hypot(*numpy.gradient(near))
    contrast = math.sqrt(float(numpy.mean((inner - outer.mean()) ** 2))) / spread
    return [math.log(contrast + 1e-3), math.log((float(steps[~outside].mean()) + noise) / (float(steps[outside].mean()) + noise))]


def likelihoods(values):
    """Natural logarithm of the probability density of features by class; of the first ones where the others are not given."""
    return {name: math.log(PRIOR[name]) - sum(((v - mean) / deviation) ** 2 / 2 + math.log(deviation)
                                              for v, (mean, deviation) in zip(values, rows))
            for name, rows in CLASSES.items()}


def judged(values):
    """Score and class of a candidate."""
    logs = likelihoods(values)
    clutter = logs.pop('clutter')
    (first, name), (second, _) = sorted(((v, k) for k, v in logs.items()), reverse=True)[:2]
    odds = first + math.log1p(math.exp(second - first)) - clutter  # of any class against clutter, natural logarithm
    score = 0.5 + 0.5 * math.tanh(odds / len(values) / 2)
    return score, name if first - second > math.log(SURE) else 'unknown'


class Shape:
    bands_wanted = 2

    def __init__(self, least_score=0.36):
        self.least_score, self.candidates = least_score, Contrast(threshold=4, most=20)

    def measured(self, look):
        """(candidate, features) of a frame."""
        seen = list(look.planes.values())[:2]
        planes, noises = [recognise.despeckled(plane) for plane in seen], [noise_of(plane) for plane in seen]
        return [(d, features(look, planes, noises, d)) for d in self.candidates.find(look)]

    def find(self, look):
        found = []
        for candidate, values in self.measured(look):
            score, name = judged(values)
            if score >= self.least_score:
                found.append(recognise.Detection(candidate.box, score, name))
        return found


if __name__ == '__main__':
    recognise.main(Shape(), __doc__)
