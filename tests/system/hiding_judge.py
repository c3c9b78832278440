#!/usr/bin/env python3
"""What a recogniser could learn of where targets stand: over a sweep of a scenario with publish.planes entity,instance.
    hiding_judge.py about OUT      shares of plants within 6 px about targets and in frames; targets at the exact centre
    hiding_judge.py planned OUT    occlusion of the aim, planned by the scenario against truth, in nine bins of 0.1 .. 0.9
    hiding_judge.py context OUT    area under the curve of a classifier that sees the surroundings alone, the target blanked, of
                                   places with a vehicle and of others with as many plants (publish.pairs: all)
Prints names and values, one a line. Needs numpy and OpenEXR."""
import csv
import json
import pathlib
import sys

import numpy
import OpenEXR

NEAR_PX = 6


def frames(out):
    """Settings, line of truth, and folder and number of each frame of a sweep."""
    for line in (out / 'manifest.jsonl').read_text().splitlines():
        variant = json.loads(line)
        folder = out / variant['folder']
        for text in (folder / 'truth.jsonl').read_text().splitlines():
            frame = json.loads(text)
            yield variant, frame, folder


def plane(folder, group, number, name):
    return numpy.asarray(OpenEXR.File(str(folder / f'frames/{group}/{number:06}.exr')).channels()[name].pixels)


def grown(mask, by):
    """All places within `by` pixels of the mask, as a square."""
    for axis in (0, 1):
        one = mask.copy()
        for k in range(1, by + 1):
            shifted = numpy.zeros_like(mask)
            if axis == 0:
                shifted[k:] |= mask[:-k]
                shifted[:-k] |= mask[k:]
            else:
                shifted[:, k:] |= mask[:, :-k]
                shifted[:, :-k] |= mask[:, k:]
            one |= shifted
        mask = one
    return mask


def seen(frame, shape):
    """Targets whose middle is in the frame and of which something shows."""
    for t in frame['targets']:
        if 'box_px' not in t:
            continue
        left, top, right, bottom = t['amodal_box_px']
        x, y = (left + right) / 2, (top + bottom) / 2
        if 0 <= x < shape[1] and 0 <= y < shape[0]:
            yield t, x, y


def about(out):
    plants = near = all_plants = pixels = centred = targets = 0
    for _, frame, folder in frames(out):
        entity, instance = (plane(folder, 'truth', frame['frame'], name) for name in ('entity', 'instance'))
        plant = (instance > 0) & (entity == 0)
        all_plants += int(plant.sum())
        pixels += plant.size
        ring = grown(entity > 0, NEAR_PX) & (entity == 0)
        plants += int((ring & plant).sum())
        near += int(ring.sum())
        for _, x, y in seen(frame, plant.shape):
            targets += 1
            centred += abs(x - plant.shape[1] / 2) < 1 and abs(y - plant.shape[0] / 2) < 1
    print(f'frames_plants {all_plants / pixels:.4f}')
    print(f'near_plants {plants / max(near, 1):.4f}')
    print(f'near_pixels {near}')
    print(f'targets {targets}')
    print(f'centred {centred / max(targets, 1):.4f}')


def planned(out):
    found = []
    for variant, frame, _ in frames(out):
        aim = variant['settings']['exercise.aim']
        with open(out / f"exercises/{variant['exercise']}.csv", encoding='ascii') as file:
            rows = {r['entity']: r for r in csv.DictReader(line for line in file if not line.startswith('#'))}
        for t in frame['targets']:
            if t['entity'] == aim and aim in rows and 'visible_fraction' in t:
                found.append((float(rows[aim]['planned']), 1 - t['visible_fraction']))
    plan, got = numpy.array(found).T
    print(f'vehicles {len(plan)}')
    print(f'within {numpy.mean(numpy.abs(plan - got) <= 0.1):.3f}')
    print(f'rms {numpy.sqrt(numpy.mean((plan - got) ** 2)):.3f}')
    print(f'bias {numpy.mean(got - plan):+.3f}')
    for low in range(9):
        here = (plan >= 0.05 + 0.1 * low) & (plan < 0.15 + 0.1 * low)
        if here.any():
            print(f'bin_{0.1 * (low + 1):.1f} {here.sum()} planned {plan[here].mean():.3f} achieved {got[here].mean():.3f} '
                  f'.. {got[here].min():.3f} {got[here].max():.3f}')


BLANK_PX, NEAR_RING_PX, FAR_RING_PX = 1, 5, 14  # beyond the target's box, as in `pitviper bench woods`


def rings(shape, box):
    """Masks of the ring about a box, and of a wider one about that; the box with what is just beside it is in neither."""
    rows, columns = numpy.mgrid[0:shape[0], 0:shape[1]] + 0.5
    off = numpy.maximum(numpy.maximum(box[0] - columns, columns - box[2]), numpy.maximum(box[1] - rows, rows - box[3]))
    return (off >= BLANK_PX) & (off < NEAR_RING_PX), (off >= NEAR_RING_PX) & (off < FAR_RING_PX)


def features(image, box):
    """What the near ring differs by from the far one: mean, variance, energy of gradients; None: beyond the image."""
    if box[0] < FAR_RING_PX + 1 or box[1] < FAR_RING_PX + 1 or box[2] > image.shape[1] - FAR_RING_PX - 1 or \
            box[3] > image.shape[0] - FAR_RING_PX - 1:
        return None
    near, far = rings(image.shape, box)
    step = numpy.zeros_like(image)
    step[:-1, :-1] = (image[1:, :-1] - image[:-1, :-1]) ** 2 + (image[:-1, 1:] - image[:-1, :-1]) ** 2
    spread = image[far].std() + 1e-12
    return [(image[near].mean() - image[far].mean()) / spread, numpy.log((image[near].std() + 1e-12) / spread),
            numpy.log((step[near].mean() + 1e-18) / (step[far].mean() + 1e-18))]


def plants_about(plant, box):
    """Share of plants in both rings about a box, and in the box."""
    near, far = rings(plant.shape, box)
    return plant[near | far].mean()


def context(out):
    """Places where vehicles hide, and others of the same image with as many plants about them: as they are without any vehicle
    (publish.pairs: all), a box of the vehicle's size blanked. Logistic regression on what is around, of places in turn learnt and
    judged."""
    rows, labels, groups = [], [], []
    draw = numpy.random.default_rng(1)
    for number, (variant, frame, folder) in enumerate(frames(out)):
        band = variant['settings']['sensor.bands'].split(',')[0]
        image = plane(folder / 'pairs/background', band, frame['frame'], 'Y').astype(float)
        plant = plane(folder / 'pairs/background', 'truth', frame['frame'], 'instance') > 0
        occupied = plane(folder, 'truth', frame['frame'], 'entity') > 0
        for t in frame['targets']:
            box = numpy.array(t['amodal_box_px'])
            here = features(image, box)
            if t['pixels'] <= 0 or here is None:
                continue
            want, others = plants_about(plant, box), []
            for _ in range(200):
                moved = box + numpy.tile(draw.uniform((-image.shape[1], -image.shape[0]), image.shape[::-1]), 2).round()
                there = features(image, moved)
                if there is None or occupied[numpy.logical_or(*rings(image.shape, moved))].any():
                    continue
                others.append((abs(plants_about(plant, moved) - want), there))
            others = [there for off, there in sorted(others, key=lambda o: o[0])[:5] if off <= 0.15]
            if others:
                rows += [here] + others
                labels += [1] + [0] * len(others)
                groups += [number] * (1 + len(others))
    rows, labels, groups = numpy.array(rows), numpy.array(labels), numpy.array(groups)
    score = numpy.zeros(len(labels))
    for fold in range(5):
        learn, judged = groups % 5 != fold, groups % 5 == fold
        mean, spread = rows[learn].mean(axis=0), rows[learn].std(axis=0) + 1e-9
        x = numpy.c_[numpy.clip((rows - mean) / spread, -5, 5), numpy.ones(len(rows))]
        w = numpy.zeros(x.shape[1])
        for _ in range(400):
            p = 1 / (1 + numpy.exp(-x[learn] @ w))
            even = numpy.where(labels[learn] == 1, (labels[learn] == 0).sum() / max((labels[learn] == 1).sum(), 1), 1)
            w += 0.5 * (x[learn].T @ (even * (labels[learn] - p)) / even.sum() - 0.01 * w)
        score[judged] = x[judged] @ w
    rank = numpy.empty(len(score))
    rank[numpy.argsort(score, kind='stable')] = numpy.arange(1, len(score) + 1)
    ones = labels == 1
    area = (rank[ones].sum() - ones.sum() * (ones.sum() + 1) / 2) / (ones.sum() * (~ones).sum())
    print(f'places {ones.sum()}')
    # Hanley and McNeil, Radiology 143 (1982)
    q1, q2, n, m = area / (2 - area), 2 * area ** 2 / (1 + area), ones.sum(), (~ones).sum()
    error = numpy.sqrt((area * (1 - area) + (n - 1) * (q1 - area ** 2) + (m - 1) * (q2 - area ** 2)) / (n * m))
    print(f'auc {area:.3f}')
    print(f'auc_error {error:.3f}')


{'about': about, 'planned': planned, 'context': context}[sys.argv[1]](pathlib.Path(sys.argv[2]))
