#!/usr/bin/env python3
"""flight_octets.py RECORDING SENT TRUTH ID THRESHOLD_M: what a node's own missile sent (IEEE 1278.1, read here from the
standard's layout alone). RECORDING: a live node's pcapng, which heard it; SENT: its flight.pcapng; TRUTH: truth.jsonl of frames
from the missile's nose; ID: of the first missile.

Fails unless the datagrams of ID's site and application that were heard are those sent, in order; each missile's are Fire, Entity
States, Detonation, and an Entity State that deactivates it; time stamps are those of the datagrams' times; and at each frame
dead reckoning of the latest Entity State (FVW) is within THRESHOLD_M of where the frame was seen from."""
import json
import struct
import sys

recording, sent, truth, first, threshold_m = sys.argv[1:]
threshold_m = float(threshold_m)
site, application, number = map(int, first.split(':'))


def datagrams(path):
    """(time in s, octets of UDP) of enhanced packet blocks, raw IPv4 and IPv6, ns."""
    data, at = open(path, 'rb').read(), 0
    while at < len(data):
        kind, size = struct.unpack_from('<II', data, at)
        if kind == 6:
            high, low, caught = struct.unpack_from('<III', data, at + 12)
            packet = data[at + 28:at + 28 + caught]
            head = 4 * (packet[0] & 15) if packet[0] >> 4 == 4 else 40
            yield ((high << 32) + low) * 1e-9, packet[head + 8:]
        at += size


def own(pdu):
    """The munition's id, where the PDU is of this node's missiles."""
    at = {1: 12, 2: 24, 3: 24}.get(pdu[2])
    of = struct.unpack_from('>3H', pdu, at) if at else (0, 0, 0)
    return of if of[:2] == (site, application) else None


said = [(t, pdu) for t, pdu in datagrams(sent)]
heard = [pdu for _, pdu in datagrams(recording) if own(pdu)]
assert said and all(own(pdu) for _, pdu in said), 'not all that was sent is of its missiles'
assert heard == [pdu for _, pdu in said], f'{len(heard)} heard, {len(said)} sent, or others'
frames = [json.loads(line) for line in open(truth)]
begun = said[0][0]
offset = next(f['time_s'] for f in frames if f['host']['entity'] == first) - begun  # launched at a frame
worst = 0
for missile in sorted({own(pdu)[2] for _, pdu in said}):
    of = [(t, pdu) for t, pdu in said if own(pdu)[2] == missile]
    kinds = [pdu[2] for _, pdu in of]
    assert kinds[0] == 2 and kinds[-2:] == [3, 1] and set(kinds[1:-2]) == {1}, kinds
    assert struct.unpack_from('>I', of[-1][1], 84)[0] >> 23 & 1, 'the last does not deactivate'
    for t, pdu in of:
        stamp = struct.unpack_from('>I', pdu, 4)[0]
        off = ((stamp >> 1) * 3600 / 2 ** 31 - t) % 3600
        assert min(off, 3600 - off) < 5e-6, f'a stamp is {off} s off'
    states = [(t + offset, pdu) for t, pdu in of if pdu[2] == 1]
    seen = [f for f in frames if f['host']['entity'] == f'{site}:{application}:{missile}']
    for frame in seen:
        t, pdu = [s for s in states[:-1] if s[0] <= frame['time_s'] + 1e-6][-1]
        v, p, a = struct.unpack_from('>3f', pdu, 36), struct.unpack_from('>3d', pdu, 48), struct.unpack_from('>3f', pdu, 104)
        assert pdu[88] == 5
        dt = frame['time_s'] - t
        believed = [p[k] + dt * (v[k] + 0.5 * dt * a[k]) for k in range(3)]
        worst = max(worst, sum((x - y) ** 2 for x, y in zip(believed, frame['host']['ecef_m'])) ** 0.5)
    print(f'missile {missile}: {len(states)} Entity States, {len(seen)} frames;', end=' ')
print(f'dead reckoning off by {worst:.3f} m at most')
assert worst < threshold_m + 0.01, worst
