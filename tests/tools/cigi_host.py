"""tests/tools/cigi_host.py: a host of CIGI 3.3, written from the interface control document alone: its packets by the
order of their fields in the document, and a lockstep with an image generator over UDP, well-behaved and otherwise.

    cigi_host.py PROGRAM SCENARIO [COUNT] [--little]   with tests/tools/cigi_ig.c, whose account is judged, too
    cigi_host.py PORT SCENARIO [COUNT] [--little]      with another image generator

Prints `FAILED: ...` for what is against the document, and exits with 1."""
import json
import socket
import struct
import subprocess
import sys
import threading

IG_CONTROL, ENTITY, VIEW, SENSOR, VIEW_DEF, HAT_HOT, LOS_SEGMENT, LOS_VECTOR = 1, 2, 16, 17, 21, 24, 25, 26
SOF, HAT_HOT_ANSWER, HAT_HOT_EXTENDED, LOS_ANSWER = 101, 102, 103, 104
STANDBY, OPERATE, DEBUG = 0, 1, 2
TICKS = 100000  # a second


class Lost(Exception):
    """The image generator does not answer."""


class Host:
    def __init__(self, port, order='>', own=0):
        self.order = order
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(('127.0.0.1', own))
        self.udp.connect(('127.0.0.1', port))
        self.udp.settimeout(60)  # which only a hang reaches
        self.frame = 0
        self.ig_frame = 0
        self.failures = 0

    def fail(self, what):
        print('FAILED:', what)
        self.failures += 1

    def pack(self, layout, *values):
        return struct.pack(self.order + layout, *values)

    def control(self, stamp, frame=None, mode=OPERATE, valid=1, last=None, major=3, minor=3, smoothing=0):
        flags = mode | valid << 2 | smoothing << 3 | minor << 4
        return self.pack('BBBbBxHIIIxxxx', IG_CONTROL, 24, major, 0, flags, 0x8000,
                         (self.frame if frame is None else frame) % 2**32, stamp % 2**32,
                         self.ig_frame if last is None else last)

    def entity(self, number, lat, lon, alt, yaw=0., pitch=0., roll=0., state=1, kind=0, parent=None, alpha=255):
        flags = state | (parent is not None) << 2
        return self.pack('BBHBBBxHHfffddd', ENTITY, 48, number, flags, 0, alpha, kind, parent or 0, roll, pitch, yaw,
                         lat, lon, alt)

    def view(self, number, entity, offset=(0., 0., 0.), roll=0., pitch=0., yaw=0., group=0, enables=0x3F):
        return self.pack('BBHBBHffffff', VIEW, 32, number, group, enables, entity, *offset, roll, pitch, yaw)

    def view_definition(self, number, left, right, top, bottom, near=1., far=1e4, group=0, enables=0x3F):
        return self.pack('BBHBBBxffffff', VIEW_DEF, 32, number, group, enables, 0, near, far, left, right, top, bottom)

    def sensor(self, view, number, on=1, black_hot=0, mode=0, extended=0, gain=0., level=0., coupling=0., noise=0.):
        return self.pack('BBHBBBxffff', SENSOR, 24, view, number, on | black_hot << 1 | mode << 5, extended, gain, level,
                         coupling, noise)

    def hat_hot(self, number, kind, lat, lon, alt, entity=None, period=0):
        return self.pack('BBHBBHddd', HAT_HOT, 32, number, kind | (entity is not None) << 2, period, entity or 0, lat,
                         lon, alt)

    def los_segment(self, number, source, destination, extended=0, entity=0, mask=0xFFFFFFFF, alpha=0, period=0, other=0):
        return self.pack('BBHBBHddddddIBxH', LOS_SEGMENT, 64, number, extended, alpha, entity, *source, *destination,
                         mask, period, other)

    def los_vector(self, number, source, azimuth, elevation, least, most, extended=0, entity=0, mask=0xFFFFFFFF, alpha=0):
        return self.pack('BBHBBHffffdddIBxxx', LOS_VECTOR, 56, number, extended, alpha, entity, azimuth, elevation, least,
                         most, *source, mask, 0)

    def user(self, number, size):
        return bytes([number, size]) + bytes(size - 2)

    def send(self, *packets):
        self.udp.send(b''.join(packets))

    def step(self, stamp, *packets, **control):
        self.frame += 1
        self.send(self.control(stamp, **control), *packets)

    def receive(self):
        """The packets of the next datagram of the image generator, by id: Start of Frame as a dictionary first."""
        data = self.udp.recv(65536)
        if len(data) < 24 or data[0] != SOF or data[1] != 24:
            self.fail(f'a datagram that does not begin with Start of Frame: {data[:24].hex()}')
            return {}, []
        order = {b'\x80\x00': '>', b'\x00\x80': '<'}.get(data[6:8])
        if not order:
            self.fail(f'byte swap magic number {data[6:8].hex()}')
            return {}, []
        _, _, major, database, status, flags, _, ig, stamp, host = struct.unpack(order + 'BBBbBBHIIIxxxx', data[:24])
        if (major, flags >> 4) != (3, 3):
            self.fail(f'version {major}.{flags >> 4}')
        sof = {'ig_frame': ig, 'stamp': stamp, 'host_frame': host, 'mode': flags & 3, 'valid': flags >> 2 & 1,
               'status': status, 'database': database}
        rest, at = [], 24
        while at < len(data):
            size = data[at + 1]
            if size == 0 or size % 8 or at + size > len(data):
                self.fail(f'a packet of {size} octets, {len(data) - at} are left')
                break
            rest.append((data[at], order, data[at:at + size]))
            at += size
        return sof, rest

    def heartbeat(self, wanted):
        """Waits for Start of Frame of that number; those before it are repeats that were on their way."""
        sof, rest = {}, []
        while sof.get('ig_frame', 0) < wanted:
            try:
                sof, rest = self.receive()
            except socket.timeout:
                self.fail(f'no Start of Frame {wanted} within {self.udp.gettimeout():g} s')
                raise Lost from None
        if sof['ig_frame'] != wanted:
            self.fail(f"Start of Frame {sof['ig_frame']}, not {wanted}")
        self.ig_frame = sof['ig_frame']
        return sof, rest

    def next(self):
        return self.heartbeat(self.ig_frame + 1)


# What the image generator says of itself after a scenario of COUNT rounds: 0 where it is not named. Start of Frame may
# always have been sent again, on a busy machine.
def expected(name, n):
    words = {
        'packets': {'frames': 1, 'skipped': {'210': 1}},
        'lockstep': {'frames': n}, 'lost_answers': {'frames': n}, 'repeats': {'frames': n, 'repeated': n},
        'jumps': {'frames': n, 'lost': 3 * n, 'old': n}, 'runs_ahead': {'frames': n, 'extra': n},
        'garbage': {'frames': n, 'skipped': {'99': n}, 'dropped': {
            'fewer octets than the first packet needs': 2 * n,
            'a first packet other than IG Control or Start of Frame': 3 * n,
            'a version of CIGI other than 3': 3 * n, 'a packet size beyond the end of the datagram': n,
            'a byte swap magic number other than 0x8000 and 0x0080': n, 'a field that is not a number': n,
            'a packet size of 0, or not a multiple of 8': n}},
        'restarts': {'frames': 3 * n, 'idle': n, 'restarts': n}, 'wraps': {'frames': n},
        'time_back': {'frames': n, 'idle': 2 * n, 'time_back': n, 'unstamped': n},
        'time_ahead': {'frames': 4 * n, 'idle': 2 * n, 'time_ahead': n},
        'silent': {'frames': 3, 'silences': 1},
    }[name]
    return {'idle': 0, 'repeated': 0, 'old': 0, 'extra': 0, 'lost': 0, 'restarts': 0, 'silences': 0, 'time_back': 0,
            'time_ahead': 0, 'unstamped': 0, 'unanswered': 0, 'dropped': {}, 'skipped': {}, **words,
            'idle': words.get('idle', 0) + 1}  # begin()


def begin(host, stamp=0):
    """The host is heard first; the image generator's Start of Frame after this frame is the second."""
    host.step(stamp, mode=STANDBY)
    sof, _ = host.heartbeat(2)
    if sof['mode'] != STANDBY or sof['host_frame'] != host.frame:
        host.fail(f'Start of Frame after the first frame: {sof}')


def packets(host, _):
    begin(host)
    host.step(123456, host.entity(300, 48.25, 11.5, 612.5, yaw=271.5, pitch=-3.25, roll=1.5, kind=7),
              host.entity(301, 1.5, -2.5, 3.5, yaw=10., parent=300, state=2, alpha=128),
              host.view(4, 300, (1.5, -0.25, 0.75), roll=2., pitch=-5., yaw=33.),
              host.view_definition(4, -1.5, 1.5, 1.125, -1.125), host.user(210, 40),
              host.sensor(4, 2, black_hot=1, mode=3, extended=1, gain=.5, level=.25, coupling=12., noise=.125),
              host.hat_hot(11, 0, 40., 2.5, 900.), host.hat_hot(12, 1, 40., 2.5, 900.), host.hat_hot(13, 2, 40., 2.5, 900.),
              host.hat_hot(14, 1, 5., 6., -7., entity=300, period=3),
              host.los_segment(21, (48., 11., 700.), (48.5, 11.5, 500.), extended=1),
              host.los_vector(22, (48., 11., 700.), 45.5, -12.25, 10., 20000.), smoothing=1)
    sof, rest = host.heartbeat(3)
    if sof['host_frame'] != host.frame or sof['mode'] != OPERATE or sof['stamp'] != 123456 or not sof['valid']:
        host.fail(f'Start of Frame after the packets: {sof}')
    heights = {}
    for number, order, data in rest:
        which, = struct.unpack(order + 'H', data[2:4])
        if number in (HAT_HOT_ANSWER, HAT_HOT_EXTENDED) and data[4] >> 4 != host.frame & 15:
            host.fail(f'answer {which} is of another host frame')
        if number == HAT_HOT_ANSWER:
            heights[which] = (data[4] & 3, *struct.unpack(order + 'd', data[8:16]))
        elif number == HAT_HOT_EXTENDED:
            heights[which] = (data[4] & 3, *struct.unpack(order + 'dd', data[8:24]))
    if heights != {11: (1, 857.5), 12: (3, 42.5), 13: (1, 857.5, 42.5), 14: (3, 11.)}:
        host.fail(f'heights {heights}')
    if [n for n, _, _ in rest].count(LOS_ANSWER) != 2:
        host.fail('two requests of lines of sight are not answered')


# The packets of `packets` that the image generator reads, by the document's names: what a flag or a number was above.
SENT = [
    ('Entity Control', {'entity id': 300, 'entity state': 1, 'attach state': 0, 'collision detection enable': 0,
                        'inherit alpha': 0, 'ground/ocean clamp': 0, 'animation direction': 0, 'animation loop mode': 0,
                        'animation state': 0, 'linear extrapolation/interpolation enable': 0, 'alpha': 255,
                        'entity type': 7, 'parent id': 0, 'roll': 1.5, 'pitch': -3.25, 'yaw': 271.5,
                        'latitude/x offset': 48.25, 'longitude/y offset': 11.5, 'altitude/z offset': 612.5}),
    ('Entity Control', {'entity id': 301, 'entity state': 2, 'attach state': 1, 'collision detection enable': 0,
                        'inherit alpha': 0, 'ground/ocean clamp': 0, 'animation direction': 0, 'animation loop mode': 0,
                        'animation state': 0, 'linear extrapolation/interpolation enable': 0, 'alpha': 128,
                        'entity type': 0, 'parent id': 300, 'roll': 0, 'pitch': 0, 'yaw': 10, 'latitude/x offset': 1.5,
                        'longitude/y offset': -2.5, 'altitude/z offset': 3.5}),
    ('View Control', {'view id': 4, 'group id': 0, 'x offset enable': 1, 'y offset enable': 1, 'z offset enable': 1,
                      'roll enable': 1, 'pitch enable': 1, 'yaw enable': 1, 'entity id': 300, 'x offset': 1.5,
                      'y offset': -0.25, 'z offset': 0.75, 'roll': 2, 'pitch': -5, 'yaw': 33}),
    ('View Definition', {'view id': 4, 'group id': 0, 'near enable': 1, 'far enable': 1, 'left enable': 1,
                         'right enable': 1, 'top enable': 1, 'bottom enable': 1, 'mirror mode': 0,
                         'pixel replication mode': 0, 'projection type': 0, 'reorder': 0, 'view type': 0, 'near': 1,
                         'far': 10000, 'left': -1.5, 'right': 1.5, 'top': 1.125, 'bottom': -1.125}),
    ('Sensor Control', {'view id': 4, 'sensor id': 2, 'sensor on/off': 1, 'polarity': 1, 'line-by-line dropout enable': 0,
                        'automatic gain': 0, 'track white/black': 0, 'track mode': 3, 'response type': 1, 'gain': 0.5,
                        'level': 0.25, 'ac coupling': 12, 'noise': 0.125}),
] + [
    ('HAT/HOT Request', {'hat/hot id': number, 'request type': kind, 'coordinate system': 0, 'update period': 0,
                         'entity id': 0, 'latitude/x offset': 40, 'longitude/y offset': 2.5, 'altitude/z offset': 900})
    for number, kind in ((11, 0), (12, 1), (13, 2))
] + [
    ('HAT/HOT Request', {'hat/hot id': 14, 'request type': 1, 'coordinate system': 1, 'update period': 3,
                         'entity id': 300, 'latitude/x offset': 5, 'longitude/y offset': 6, 'altitude/z offset': -7}),
    ('Line of Sight Segment Request', {
        'los id': 21, 'request type': 1, 'source point coordinate system': 0, 'destination point coordinate system': 0,
        'response coordinate system': 0, 'destination entity id valid': 0, 'alpha threshold': 0, 'source entity id': 0,
        'source latitude/x offset': 48, 'source longitude/y offset': 11, 'source altitude/z offset': 700,
        'destination latitude/x offset': 48.5, 'destination longitude/y offset': 11.5,
        'destination altitude/z offset': 500, 'material mask': 4294967295, 'update period': 0,
        'destination entity id': 0}),
    ('Line of Sight Vector Request', {
        'los id': 22, 'request type': 0, 'source point coordinate system': 0, 'response coordinate system': 0,
        'alpha threshold': 0, 'entity id': 0, 'azimuth': 45.5, 'elevation': -12.25, 'minimum range': 10,
        'maximum range': 20000, 'source latitude/x offset': 48, 'source longitude/y offset': 11,
        'source altitude/z offset': 700, 'material mask': 4294967295, 'update period': 0}),
]


def lockstep(host, count):
    """Neither side goes on before the other; the time is the host's, whatever the wall says."""
    begin(host)
    for k in range(count):
        host.step(k * 1000, host.entity(1, 48., 11., 600. + k))
        sof, _ = host.next()
        if (sof['host_frame'], sof['stamp'], sof['mode'], sof['valid']) != (host.frame, k * 1000, OPERATE, 1):
            host.fail(f'frame {k}: {sof}')


def lost_answers(host, count):
    """The network loses what the host says: Start of Frame comes again with the same number, and all goes on."""
    begin(host)
    for k in range(count):
        host.heartbeat(2 + k)  # again: the step before has received it
        host.step(k * 1000)
        host.next()


def repeats(host, count):
    """The network loses Start of Frame: the host says the same again, and gets it again; no frame is made twice."""
    begin(host)
    for k in range(count):
        host.step(k * 1000)
        host.next()
        host.send(host.control(k * 1000))
        host.heartbeat(3 + k)


def jumps(host, count):
    """Frames of the host that never arrive, and old ones that come late."""
    begin(host)
    for k in range(count):
        host.frame += 3
        host.step(k * 1000)
        host.next()
        host.send(host.control(0, frame=host.frame - 2))


def runs_ahead(host, count):
    """A host that does not wait: its further datagrams are used, and make no frames."""
    begin(host)
    for k in range(count):
        host.step(k * 1000)
        host.step(k * 1000 + 100, host.entity(5, 1., 2., 3.))
        host.next()


def garbage(host, count):
    """What is no CIGI, or of another version, changes nothing."""
    begin(host)
    rubbish = [b'', b'x', bytes(24), bytes(65000), host.control(0)[:23], host.control(0, major=2),
               host.control(0, major=4), host.entity(1, 0., 0., 0.),
               bytes([1, 24, 3, 0, 0x35, 0, 0x12, 0x34]) + bytes(16),
               struct.pack('>HHBBBBIIII', 24, 0, 4, 0, 0, 5, 1, 0, 0, 0)]
    for k in range(count):
        for r in rubbish:
            host.send(r)
        host.step(k * 1000, b'\x02\x30' + b'\xff' * 46, host.user(99, 16), b'\x02\x00')
        host.next()


def restarts(host, count):
    """The host ends and begins anew, with other numbers and times."""
    begin(host)
    for k in range(count):
        for n in range(3):
            host.step((7 - k) * TICKS + n * 1000)
            host.next()
        last = host.ig_frame
        host.frame = host.ig_frame = 0
        host.step(0, mode=STANDBY)
        sof, _ = host.heartbeat(last + 1)
        if sof['host_frame'] != 1 or sof['mode'] != STANDBY:
            host.fail(f'after a restart: {sof}')


def wraps(host, count):
    """Time stamps and frame numbers beyond their 32 bits."""
    host.frame = 2**32 - 4
    begin(host, stamp=2**32 - 2500)
    for k in range(count):
        host.step(2**32 - 2500 + k * 1000)
        sof, _ = host.next()
        if sof['host_frame'] != host.frame % 2**32 or sof['stamp'] != (2**32 - 2500 + k * 1000) % 2**32:
            host.fail(f'frame {k}: {sof}')


def time_back(host, count):
    """Time that goes back, and frames without a time, are answered and not made."""
    begin(host)
    for k in range(count):
        for stamp, valid in (50000 + k * 1000, 1), (1000, 1), (0, 0):
            host.step(stamp, valid=valid)
            host.next()


def time_ahead(host, count):
    """A stamp that is hours ahead is answered, and nothing is made of it; time goes on from before. After Reset/Standby such
    a time is meant."""
    begin(host)
    at = 0
    for _ in range(count):
        for stamp, mode in ((at, OPERATE), (at + 3 * 3600 * TICKS, OPERATE), (at + 600 * TICKS, OPERATE), (0, STANDBY),
                            (at + 4000 * TICKS, OPERATE), (at + 4001 * TICKS, OPERATE)):
            host.step(stamp, mode=mode)
            host.next()
        at += 4002 * TICKS


def silent(host, _):
    """The host stops for a while, and comes back."""
    begin(host)
    host.step(0)
    host.next()
    for _ in range(8):
        host.heartbeat(3)
    for stamp in 1000, 2000:
        host.step(stamp)
        host.next()


SCENARIOS = {f.__name__: f for f in (packets, lockstep, lost_answers, repeats, jumps, runs_ahead, garbage, restarts, wraps,
                                     time_back, time_ahead, silent)}


def judge_account(host, name, count, lines):
    """What cigi_ig.c prints: the time of each frame, the packets of `packets`, and what it counted."""
    account = lines[-1]
    wanted = expected(name, count)
    for key, value in wanted.items():
        got = account.get(key)
        if isinstance(got, dict):
            got = {k: v for k, v in got.items() if v}
        if got != value:
            host.fail(f'{name}: {key}: {got}, not {value}')
    times = [line['t_s'] for line in lines if line.get('event') == 'due']
    if name == 'wraps' and times != [(2**32 - 2500 + k * 1000) / TICKS for k in range(count)]:
        host.fail(f'times {times}')
    if name == 'time_ahead' and times != [4002. * k + t for k in range(count) for t in (0, 600, 4000, 4001)]:
        host.fail(f'times {times}')
    if name == 'lockstep' and times != [k * 1000 / TICKS for k in range(count)]:
        host.fail(f'times {times}')
    if name != 'packets':
        return
    read = [(line['packet'], line['fields']) for line in lines if 'packet' in line]
    if [p for p, _ in read] != [p for p, _ in SENT]:
        host.fail(f'packets {[p for p, _ in read]}')
    for (packet, fields), (_, sent) in zip(read, SENT):
        if fields != sent:
            host.fail(f'{packet}: read {fields}, sent {sent}')


def main():
    little = '--little' in sys.argv
    words = [w for w in sys.argv[1:] if w != '--little']
    name, count = words[1], int(words[2]) if len(words) > 2 else 5
    ig = None
    if not words[0].isdigit():
        ig = subprocess.Popen([words[0], '0', '100'], stdout=subprocess.PIPE, text=True)
    port = json.loads(ig.stdout.readline())['port'] if ig else int(words[0])
    lines = []
    listener = threading.Thread(target=lambda: lines.extend(ig.stdout)) if ig else None
    if listener:
        listener.start()  # a full pipe would stop the image generator
    host = Host(port, '<' if little else '>')
    try:
        SCENARIOS[name](host, count)
    except Lost:
        pass
    host.udp.send(b'end')
    if ig:
        listener.join()
        ig.wait()
        judge_account(host, name, count, [json.loads(line) for line in lines])
    print(f'{name}: {host.frame} frames, {host.failures} failures')
    return bool(host.failures)


if __name__ == '__main__':
    sys.exit(main())
