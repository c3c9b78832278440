"""tests/tools/cigi_flight.py PITVIPER LOG OUT [--rough] [OPTION ...]: a CIGI host flies an eye through a replay of LOG, or with
`live` as LOG through a live exercise, frame by frame, and judges what comes: that a frame's file is there when its Start
of Frame comes (of a replay), time, place and attitude of each frame in OUT/truth.jsonl against pyproj and scipy, and
heights above ground against the range of the frame's own middle. With --rough it stops between frames, repeats itself,
and loses Start of Frame: the frames are the same."""
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import time

import numpy
import OpenEXR
import pyproj
from scipy.spatial.transform import Rotation

import cigi_host
from cigi_host import Host, OPERATE, STANDBY, TICKS

VIEW, EYE, CARRIER = 3, 9, 7
OFFSET = (1.5, -0.25, 0.75)  # of the view, on the eye's entity
CHILD = (-2., 3., -4.)       # of that entity, on its carrier
FRAMES = 6
START_S = 1350.5


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


def stamp(k):
    return round((START_S + 0.05 * k) * TICKS)


def carrier(k):
    """Latitude, longitude, height, yaw, pitch, roll of the carrier; the last frame looks straight down, from above itself."""
    if k == FRAMES - 1:
        return 35.9986, -123., 420., 0., 0., 0.
    return 35.9964 + 2e-6 * k, -123.0002, 350. - 0.5 * k, 10. + 0.25 * k, -2.5, 1.25


def view_turn(k):
    """Yaw, pitch, roll of the view on the eye's entity."""
    return (0., -90., 0.) if k == FRAMES - 1 else (5.5, -6.25, 0.5 * k)


def rotation(yaw, pitch, roll):
    return Rotation.from_euler('ZYX', [yaw, pitch, roll], degrees=True).as_matrix()


def wanted(k):
    """Place of the eye and r_ecef_from_cam."""
    lat, lon, h, yaw, pitch, roll = carrier(k)
    place = numpy.array(pyproj.Transformer.from_crs(4979, 4978).transform(lat, lon, h))
    p, l = numpy.radians([lat, lon])
    ned = numpy.array([[-numpy.sin(p) * numpy.cos(l), -numpy.sin(l), -numpy.cos(p) * numpy.cos(l)],
                       [-numpy.sin(p) * numpy.sin(l), numpy.cos(l), -numpy.cos(p) * numpy.sin(l)],
                       [numpy.cos(p), 0, -numpy.sin(p)]])
    body = ned @ rotation(yaw, pitch, roll)
    place = place + body @ CHILD
    body = body @ rotation(0., 0., 0.)
    place = place + body @ OFFSET
    view = body @ rotation(*view_turn(k))
    return place, view[:, [1, 2, 0]]  # right, down, along


def height_of(place):
    return pyproj.Transformer.from_crs(4978, 4979).transform(*place)[2]


TANK = 40  # of the host's own, under the last frame's eye


def fly(host, out, rough, live):
    answers = {}
    host.heartbeat(1)
    host.step(0, mode=STANDBY)
    sof, _ = host.next()
    if sof['mode'] != STANDBY:
        host.fail(f'mode {sof["mode"]} in standby')
    host.step(stamp(0))  # operate, before it has said where the eye is: no frame
    host.next()
    for k in range(FRAMES):
        lat, lon, h, yaw, pitch, roll = carrier(k)
        turn = view_turn(k)
        packets = [host.entity(CARRIER, lat, lon, h, yaw, pitch, roll), host.entity(EYE, *CHILD, parent=CARRIER),
                   host.view(VIEW, EYE, OFFSET, yaw=turn[0], pitch=turn[1], roll=turn[2])]
        if k == FRAMES - 1:
            packets += [host.hat_hot(1, 0, *OFFSET, entity=EYE), host.hat_hot(2, 1, *OFFSET, entity=EYE),
                        host.hat_hot(3, 2, lat, lon, h), host.hat_hot(4, 1, -10., 20., 0.),
                        host.hat_hot(5, 0, 0., 0., 0., entity=99), host.los_vector(6, (lat, lon, h), 0., -90., 0., 1e4),
                        host.sensor(VIEW, 2), host.user(220, 24), host.entity(TANK, 35.9986, -122.99989, 114., kind=1)]
        if k == 0:
            host.begun_s = time.monotonic()
        host.step(stamp(k), *packets)
        if rough:
            host.send(bytes(24))  # no CIGI
            host.send(host.control(stamp(k)), *packets)
        sof, rest = host.next()
        if (sof['stamp'], sof['host_frame'], sof['mode']) != (stamp(k), host.frame, OPERATE):
            host.fail(f'Start of Frame after frame {k}: {sof}')
        if not live and not os.path.exists(f'{out}/frames/lwir/{k:06d}.exr'):
            host.fail(f'Start of Frame {sof["ig_frame"]} came before the files of frame {k}')
        if rough:
            time.sleep(0.4)
            host.send(host.control(stamp(k)), *packets)
            host.heartbeat(host.ig_frame)
        if k % 2:
            host.step(stamp(k) + 3 * 3600 * TICKS)  # its time goes ahead by hours: answered, and no frame
            host.next()
        for number, order, data in rest:
            which, = struct.unpack(order + 'H', data[2:4])
            answers[number, which] = (data[4:8], *struct.unpack(order + 'dd', (data[8:] + bytes(16))[:16]))
    host.step(stamp(0), mode=OPERATE)  # its time goes back: answered, and no frame
    host.next()
    if live:
        later = round((time.monotonic() - host.begun_s + 4) * TICKS)  # a frame of a time that comes in four seconds
        host.last_s = (stamp(0) + later) / TICKS
        host.step(stamp(0) + later)
        host.next()
    else:
        host.step(round(1360 * TICKS))  # behind exercise.to_s: the end
    return answers


def judge_frames(host, out, live):
    lines = [json.loads(line) for line in open(f'{out}/truth.jsonl', encoding='utf-8')]
    if [line['frame'] for line in lines] != list(range(FRAMES + live)):
        host.fail(f'frames {[line["frame"] for line in lines]}')
    if live and abs(lines.pop()['time_s'] - lines[0]['time_s'] - host.last_s + stamp(0) / TICKS) > 1e-9:
        host.fail('the last frame is not that of four seconds later')
    before = None
    shift_s = lines[0]['time_s'] - stamp(0) / TICKS if live else 0  # a live exercise has a time of its own
    own = [sorted(t['entity'] for t in line['targets'] if t['entity'].startswith('4711:')) for line in lines]
    if own != [[]] * (FRAMES - 1) + [[f'4711:1:{TANK}']]:
        host.fail(f'entities of the host: {own}')
    for k, line in enumerate(lines):
        place, cam = wanted(k)
        got = numpy.array(line['host']['ecef_m'])
        if abs(line['time_s'] - shift_s - stamp(k) / TICKS) > 1e-9:
            host.fail(f'frame {k} at {line["time_s"]} s')
        if numpy.abs(got - place).max() > 1e-6:
            host.fail(f'frame {k}: eye at {got}, not {place}')
        turned = numpy.array(line['sensors'][0]['ecef_from_cam']).reshape(3, 3)
        if numpy.abs(turned - cam).max() > 1e-9:
            host.fail(f'frame {k}: camera {turned}, not {cam}')
        speed = 0 if before is None else numpy.linalg.norm(place - before) / 0.05
        if abs(line['host']['speed_mps'] - speed) > 1e-4:
            host.fail(f'frame {k}: {line["host"]["speed_mps"]} m/s, not {speed}')
        before = place
    return lines


def judge_heights(host, out, answers):
    place, _ = wanted(FRAMES - 1)
    eye_m = height_of(place)
    truth = OpenEXR.File(f'{out}/frames/truth/{FRAMES - 1:06d}.exr', separate_channels=True)
    range_m = truth.channels()['range_m'].pixels
    rows, columns = range_m.shape
    middle = range_m[rows // 2 - 1:rows // 2 + 1, columns // 2 - 1:columns // 2 + 1].mean()
    valid = {which: answers[number, which][0][0] & 1 for number, which in answers if number in (102, 103)}
    if valid != {1: 1, 2: 1, 3: 1, 4: 0, 5: 0}:
        host.fail(f'valid heights {valid}')
        return
    hat, hot = answers[102, 1][1], answers[102, 2][1]
    carrier_hat, carrier_hot = answers[103, 3][1:]
    if abs(hat - middle) > 0.05:
        host.fail(f'{hat} m above ground, the picture has {middle}')
    if abs(hat + hot - eye_m) > 1e-6 or abs(carrier_hat + carrier_hot - carrier(FRAMES - 1)[2]) > 1e-6:
        host.fail(f'heights above and of terrain, {hat} and {hot}, do not add up to {eye_m}')
    if not answers[104, 6][0][0] & 1 or abs(answers[104, 6][1] - carrier_hat) > 0.01:
        host.fail(f'straight down the ground is {answers[104, 6][1]} m away, not {carrier_hat}')
    if not any(number == 106 for number, _ in answers):
        host.fail('no Sensor Response')
    print(f'{hat:.3f} m above ground, the picture has {middle:.3f}')


def main():
    rough = '--rough' in sys.argv
    program, log, out, *options = [w for w in sys.argv[1:] if w != '--rough']
    live = log == 'live'
    ours, theirs = free_port(), free_port()
    host = Host(theirs, own=ours)
    command = [program, 'run'] if live else [program, 'replay', log, '--to', '1355']
    command += ['--out', out, '--cigi', f'127.0.0.1:{ours}', '--set', f'exercise.cigi_port={theirs}', '--set',
                f'exercise.cigi_view={VIEW}', *options]
    with subprocess.Popen(command) as node:
        try:
            answers = fly(host, out, rough, live)
        except cigi_host.Lost:
            node.kill()
            return 1
        if live:
            node.send_signal(signal.SIGINT)
        if node.wait(60) != 0:
            host.fail(f'pitviper ended with {node.returncode}')
    judge_frames(host, out, live)
    judge_heights(host, out, answers)
    print(f'{host.failures} failures')
    return bool(host.failures)


if __name__ == '__main__':
    sys.exit(main())
