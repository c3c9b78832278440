#!/usr/bin/env python3
"""loop_recogniser.py TARGET [--dies N] [--mute] [--slow N,S] [--box]: a recogniser that knows the truth, for tests of `pitviper fly`:
answers each frame of the ring $PITVIPER_MEMORY (publish.memory_record=truth) with the line of sight to TARGET
(site:application:entity), by UDP to $PITVIPER_PORT.

--box: a box of a pixel where TARGET's place falls in the image, by the record's camera and the pinhole's formula alone.
--dies N: kills itself (SIGKILL) at frame N in place of an answer; --mute: never answers; --slow N,S: sleeps S seconds
before it answers frame N, then answers all the same."""
import argparse
import math
import os
import pathlib
import signal
import socket
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / 'etc' / 'examples'))
from read_memory import Ring, send_answer

options = argparse.ArgumentParser()
options.add_argument('target')
options.add_argument('--dies', type=int)
options.add_argument('--mute', action='store_true')
options.add_argument('--slow')
options.add_argument('--box', action='store_true')
o = options.parse_args()
target = tuple(map(int, o.target.split(':')))
slow_frame, slow_s = (float(v) for v in o.slow.split(',')) if o.slow else (-1, 0)
begun = None


def box_of(frame, place):
    """left, top, right, bottom; None: not in the image."""
    r, plane = frame.record, next(iter(frame.planes.values()))
    off = [place[k] - r.p_ecef[k] for k in range(3)]
    x, y, z = (sum(r.r_ecef_from_cam[3 * k + axis] * off[k] for k in range(3)) for axis in range(3))
    column, row = plane.shape[1] / 2 + r.focal_px * x / z, plane.shape[0] / 2 + r.focal_px * y / z
    box = [column - 0.5, row - 0.5, column + 0.5, row + 0.5]
    return box if z > 0 and min(box) >= 0 and box[2] <= plane.shape[1] and box[3] <= plane.shape[0] else None


with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as to:
    for frame in Ring(os.environ['PITVIPER_MEMORY'], 20).frames(in_order=True):
        number = frame.record.frame
        begun = number if begun is None else begun
        if o.dies is not None and number - begun == o.dies:
            os.kill(os.getpid(), signal.SIGKILL)
        if number - begun == slow_frame:
            time.sleep(slow_s)
        if o.mute:
            continue
        seen = [t for t in frame.targets if (t.site, t.application, t.entity) == target]
        if o.box:
            found = [{'class': 'truth', 'score': 1.0, 'box_px': box} for t in seen if (box := box_of(frame, t.p_ecef))]
        else:
            found = [{'class': 'truth', 'score': 1.0, 'los_deg': [math.degrees(t.los_az_rad), math.degrees(t.los_el_rad)]}
                     for t in seen]
        send_answer(to, int(os.environ['PITVIPER_PORT']), number, 'lwir', found)
