"""tests/tools/cigi_entities.py PITVIPER LOG OUT OPTIONS...: a CIGI host with entities of its own: a tank that stands, drives and is
gone, by the truth of each frame: who is there, where it is by pyproj, how fast it goes, and where it is in the picture."""
import json
import signal
import struct
import subprocess
import sys

import numpy
import pyproj

from cigi_flight import free_port
from cigi_host import Host, TICKS

START_S, STEP_S, SITE = 1350.5, 0.1, '4711:1'
EYE = (35.9937, -123.000684, 371.)
TANK, LOST, EYES, CHILD = 20, 21, 9, 22
PLACE = (35.99885, -123.00045)  # of the tank
NORTH = 2e-6                    # degrees a frame, when it drives
TO_ECEF = pyproj.Transformer.from_crs(4979, 4978)
ACTIVE, STANDBY, GONE = 1, 0, 2


def rate(host, entity, v, w=(0., 0., 0.), local=1):
    return host.pack('BBHBBxxffffff', 8, 32, entity, 0, local << 1, *v, *w)


def step(host, k, *packets):
    host.step(round((START_S + k * STEP_S) * TICKS), host.entity(EYES, *EYE, yaw=2., pitch=-22.4, kind=1), host.view(0, EYES), *packets)
    return host.next()[1]


def fly(host):
    host.heartbeat(1)
    answers = step(host, 0, host.hat_hot(1, 1, *PLACE, 0.))
    ground = next(struct.unpack(order + 'd', data[8:16])[0] for number, order, data in answers if number == 102)
    heading = 30.
    at = lambda k: (PLACE[0] + NORTH * k, PLACE[1], ground)
    step(host, 1, host.entity(TANK, *at(0), yaw=heading, kind=1), host.entity(LOST, *at(9), kind=999),
         host.entity(CHILD, 0., 12., 0., kind=6, parent=TANK))
    step(host, 2, host.entity(TANK, *at(1), yaw=heading, kind=1))
    step(host, 3, host.entity(TANK, *at(2), yaw=heading, kind=1))
    step(host, 4, host.entity(TANK, *at(3), yaw=heading, kind=1), rate(host, TANK, (12., 0., 0.)))
    step(host, 5, host.entity(TANK, *at(3), yaw=heading, kind=1, state=STANDBY))
    step(host, 6, host.entity(TANK, *at(4), yaw=heading, kind=1), rate(host, TANK, (0., 0., 0.)))
    step(host, 7, host.entity(TANK, *at(4), kind=1, state=GONE), host.entity(CHILD, 0., 0., 0., kind=6, state=GONE))
    return [at(k) for k in (0, 1, 2, 3, 3, 4)], ground


def judge(host, out, places):
    lines = [json.loads(line) for line in open(f'{out}/truth.jsonl', encoding='utf-8')]
    if len(lines) != 8:
        host.fail(f'{len(lines)} frames')
        return
    eye = numpy.array(TO_ECEF.transform(*EYE))
    who = [sorted(t['entity'] for t in line['targets'] if t['entity'].startswith(SITE)) for line in lines]
    tank, child = f'{SITE}:{TANK}', f'{SITE}:{CHILD}'
    wanted = [[], [tank, child], [tank, child], [tank, child], [tank, child], [child], [tank, child], []]
    if who != wanted:
        host.fail(f'who is there: {who}, not {wanted}')
        return
    line_of = dict(zip((1, 2, 3, 4, 5, 6), places))
    north = numpy.array(TO_ECEF.transform(PLACE[0] + 1e-4, PLACE[1], EYE[2])) - numpy.array(TO_ECEF.transform(*PLACE, EYE[2]))
    north /= numpy.linalg.norm(north)
    p, l = numpy.radians(PLACE)
    east = numpy.array([-numpy.sin(l), numpy.cos(l), 0])
    speed = NORTH * numpy.linalg.norm(numpy.array(TO_ECEF.transform(PLACE[0] + 1, PLACE[1], 0)) - numpy.array(TO_ECEF.transform(*PLACE, 0))) / STEP_S
    heading = numpy.radians(30)
    moves = {1: 0 * north, 2: speed * north, 3: speed * north, 4: 12 * (numpy.cos(heading) * north + numpy.sin(heading) * east), 6: 0 * north}
    for k, v in moves.items():
        t = next(t for t in lines[k]['targets'] if t['entity'] == tank)
        place = numpy.array(TO_ECEF.transform(*line_of[k]))
        sight = place - eye
        distance = numpy.linalg.norm(sight)
        if t['class'] != 'tank' or t['type'] != '1.1.222.1.1.1.0' or t['marking'] != f'CIGI {TANK}':
            host.fail(f'frame {k}: {t["class"]} {t["type"]} {t["marking"]}')
        if abs(t['range_m'] - distance) > 2.5:  # to its middle, 1.1 m above its place
            host.fail(f'frame {k}: {t["range_m"]} m away, not {distance}')
        closing = -v @ sight / distance
        if abs(t['closing_mps'] - closing) > 0.02 * max(abs(closing), 0.5):
            host.fail(f'frame {k}: closes with {t["closing_mps"]} m/s, not {closing}')
        if not t['pixels'] > 4 or t['visible_fraction'] < 0.9:
            host.fail(f'frame {k}: {t["pixels"]} pixels, {t["visible_fraction"]} of it')
        sensor = lines[k]['sensors'][0]
        cam = numpy.array(sensor['ecef_from_cam']).reshape(3, 3).T @ sight
        focal = 0.5 * sensor['width_px'] / numpy.tan(numpy.radians(sensor['hfov_deg'] / 2))
        at = focal * cam[:2] / cam[2] + [sensor['width_px'] / 2, sensor['height_px'] / 2]
        left, top, right, bottom = t['box_px']
        if not (left - 1 <= at[0] <= right + 1 and top - 1 <= at[1] <= bottom + 2):
            host.fail(f'frame {k}: its box is {t["box_px"]}, its place at {at}')
    print('hulls in', sum(len(w) for w in who), 'places;', f'{speed:.2f} m/s')


def main():
    program, log, out, *options = sys.argv[1:]
    ours, theirs = free_port(), free_port()
    host = Host(theirs, own=ours)
    command = [program, 'replay', log, '--out', out, '--cigi', f'127.0.0.1:{ours}', '--set', f'exercise.cigi_port={theirs}', *options]
    with subprocess.Popen(command) as node:
        places, _ = fly(host)
        node.send_signal(signal.SIGINT)
        node.wait(60)
    judge(host, out, places)
    print(f'{host.failures} failures')
    return bool(host.failures)


if __name__ == '__main__':
    sys.exit(main())
