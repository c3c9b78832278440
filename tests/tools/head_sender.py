"""tests/tools/head_sender.py: a head tracker, written from etc/reference/head.md alone; and a judge of the poses in truth.jsonl, with
pyproj and scipy.

    head_sender.py send ADDRESS:PORT OUT COUNT [garbage]   moves after each frame of OUT/truth.jsonl; then holds still
    head_sender.py judge OUT [absolute|relative]           the camera of each frame, from the pose that its line says"""
import json
import math
import random
import socket
import struct
import sys
import time


def datagram(sequence, yaw, pitch, roll, zoom=1., buttons=0, place=None, relative=False, stamp=0):
    flags = (place is not None) | relative << 1
    octets = struct.pack('>4sHHIIQ4f', b'PVHD', 1, flags, sequence % 2**32, buttons, stamp, yaw, pitch, roll, zoom)
    return octets + (struct.pack('>3d', *place) if place is not None else b'')


def lines(out):
    try:
        return [json.loads(line) for line in open(f'{out}/truth.jsonl') if line.endswith('\n')]
    except OSError:
        return []


def spoilt(good, k):
    """Octets that no tracker sends."""
    kind = k % 8
    if kind == 0:
        return good[:-1]
    if kind == 1:
        return b'PVHE' + good[4:]
    if kind == 2:
        return good[:5] + b'\2' + good[6:]
    if kind == 3:
        return good[:7] + b'\4' + good[8:]
    if kind == 4:
        return good[:24] + struct.pack('>f', math.nan) + good[28:]
    if kind == 5:
        return good[:28] + struct.pack('>f', 90.5) + good[32:]
    if kind == 6:
        return good + bytes(1500)
    return b''


def send(to, out, count, garbage):
    address, port = to.rsplit(':', 1)
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.connect((address, int(port)))
    rnd = random.Random(5)
    seen, k, sequence = 0, 0, 2**32 - 3  # it wraps
    while k < count:
        for _ in range(20):  # newer ones all the time, as a tracker does
            sequence += 1
            place = (47.001 + 1e-5 * k, 13.002, 950. + k) if k % 4 == 3 else None
            good = datagram(sequence, 10 * math.sin(k) + rnd.random(), 5 * math.cos(k) - 8, 3. * (k % 3), 1 + 0.5 * (k % 2), k,
                            place, k % 4 == 1, 1000 * sequence)
            try:
                udp.send(good)
                if garbage:
                    udp.send(spoilt(good, sequence))
                    udp.send(good)  # repeated
            except ConnectionRefusedError:
                pass
            time.sleep(0.005)
        now = len(lines(out))
        if now > seen:
            seen, k = now, k + 1


def judge(out):
    import numpy
    import pyproj
    from scipy.spatial.transform import Rotation
    to_geodetic = pyproj.Transformer.from_crs('EPSG:4978', 'EPSG:4979', always_xy=True)
    from_geodetic = pyproj.Transformer.from_crs('EPSG:4979', 'EPSG:4978', always_xy=True)
    worst, kinds, zooms, wide = 0, set(), set(), None
    frames = [line for line in lines(out)]
    for line in frames:
        head, sensor, host = line.get('head'), line['sensors'][0], line['host']
        if not head:
            wide = sensor['hfov_deg']
            continue
        look = Rotation.from_euler('ZYX', [head['yaw_deg'], head['pitch_deg'], head['roll_deg']], degrees=True)
        p = numpy.array(host['ecef_m'])
        if head['relative']:
            if host['entity'] == 'observer':
                continue
            base = Rotation.from_euler('ZYX', [host['psi_deg'], host['theta_deg'], host['phi_deg']], degrees=True)
        else:
            lon, lat, _ = numpy.radians(to_geodetic.transform(*p))
            north = [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
            down = [-math.cos(lat) * math.cos(lon), -math.cos(lat) * math.sin(lon), -math.sin(lat)]
            base = Rotation.from_matrix(numpy.array([north, numpy.cross(down, north), down]).T)
        axes = (base * look).as_matrix()
        camera = numpy.array(sensor['ecef_from_cam']).reshape(3, 3)
        expected = axes[:, [1, 2, 0]]
        worst = max(worst, float(numpy.abs(camera - expected).max()))
        kinds.add((head['relative'], head['zoom']))
        zooms.add(head['zoom'])
        if wide:
            narrow = 2 * math.degrees(math.atan(math.tan(math.radians(wide / 2)) / head['zoom']))
            worst = max(worst, abs(narrow - sensor['hfov_deg']) / 10)
        at = 47.001 + 1e-5 * head['buttons'], 13.002, 950. + head['buttons']
        if head['buttons'] % 4 == 3:
            there = numpy.array(from_geodetic.transform(at[1], at[0], at[2]))
            worst = max(worst, float(numpy.abs(there - p).max()) * 1e-3)
    turned = sum('head' in line for line in frames)
    print(f'{turned} of {len(frames)} frames were turned, {len(kinds)} kinds; the worst differs by {worst:.1e}')
    if turned < 5 or len(kinds) < 3 or worst > 1e-8:
        print('FAILED: poses')
        sys.exit(1)


if sys.argv[1] == 'send':
    send(sys.argv[2], sys.argv[3], int(sys.argv[4]), len(sys.argv) > 5)
else:
    judge(sys.argv[2])
