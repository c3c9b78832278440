"""tests/tools/gamepad_judge.py PROJECTOR VIRTUAL_PAD_SO FOLDER level|body: is the node of a window's program that has a gamepad, and
judges the datagrams by etc/reference/head.md and projector.md alone: pairs of poses against the time between them and the sticks."""
import os
import socket
import struct
import subprocess
import sys
import time

program, preload, folder, axes = sys.argv[1:]
WIDTH, HEIGHT = 32, 24
OPENED, NOTED, CLOSED = 1, 5, 4
DEAD, RATE, FULL = 0.08, 30.0, 32767
failures = 0


def check(what, good):
    global failures
    if not good:
        print('FAILED:', what)
        failures += 1


def hold(text):
    """What the sticks are at from now on."""
    with open(f'{folder}/pad.new', 'w') as file:
        file.write(text + '\n')
    os.rename(f'{folder}/pad.new', f'{folder}/pad')


class Pose:
    def __init__(self, octets):
        (magic, version, self.flags, self.sequence, self.buttons, us, self.yaw, self.pitch, self.roll,
         self.zoom) = struct.unpack('>4sHHIIQ4f', octets)
        self.t = us * 1e-6
        check('a datagram of the page', (magic, version, self.flags) == (b'PVHD', 1, 2 if axes == 'body' else 0))


def poses(count):
    """Those sampled after the sticks were set, but for the first, which may not know it yet."""
    set_s, got = time.monotonic(), []
    while len(got) < count + 3:
        pose = Pose(udp.recv(100))
        if pose.t > set_s:
            got.append(pose)
    check('sequences', all(b.sequence == a.sequence + 1 for a, b in zip(got, got[1:])))
    return got[3:]


def share(value):
    size = min(abs(value) / FULL, 1)
    return 0 if size <= DEAD else (size - DEAD) / (1 - DEAD) * (1 if value > 0 else -1)


def off_by(got, step):
    """Largest deviation of what step says of the second of two poses, by the first and the time between; of at least 5 pairs."""
    off = [step(a, b, b.t - a.t) for a, b in zip(got, got[1:]) if b.t - a.t < 0.25]
    return max(off) if len(off) >= 5 else 9e9


def turned(deg):
    return abs((deg + 180) % 360 - 180)


udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
udp.bind(('127.0.0.1', 0))
udp.settimeout(60)
ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
ours.settimeout(60)
memory = os.memfd_create('images')
os.write(memory, struct.pack('=I3Iii', 1, 0, 0, 0, WIDTH, HEIGHT))
os.ftruncate(memory, 4096 + 3 * WIDTH * HEIGHT * 4)
hold('2000 -2000 0 2000 0')  # within the dead zone
environment = dict(os.environ, LD_PRELOAD=preload, VIRTUAL_PAD=f'{folder}/pad', SDL_VIDEODRIVER='dummy', SDL_RENDER_DRIVER='software')
window = subprocess.Popen(['bash', '-c', f'exec "$@" 3<&{theirs.fileno()} 4<&{memory}', 'bash', program, '0', '64x48', 'whole', 'off', axes,
                           f'127.0.0.1:{udp.getsockname()[1]}'], env=environment, pass_fds=[theirs.fileno(), memory])
theirs.close()


def said(event, text):
    """The next message but flips; what it says."""
    while True:
        got = struct.unpack('=IIIIq200s', ours.recv(1000))
        if got[0] != 2:
            words = got[5].split(b'\0')[0].decode()
            check(f'said: {words}', got[0] == event and text in words)
            return


said(OPENED, 'dummy')
said(NOTED, 'turns the eye')
rest = poses(8)
check('at rest', all((p.yaw, p.pitch, p.roll, p.zoom, p.buttons) == (0, 0, 0, 1, 0) for p in rest))
for left in 32767, -32768, 16384, -9000:
    hold(f'{left} 0 0 0 0')
    off = off_by(poses(12), lambda a, b, dt: max(turned(b.yaw - a.yaw - RATE * share(left) * dt), abs(b.pitch - a.pitch)))
    check(f'a left stick at {left} turns: {off} deg off', off < 2e-4)
hold('0 -20000 0 0 5')
got = poses(12)
check('and up, by -y', off_by(got, lambda a, b, dt: abs(b.pitch - a.pitch - RATE * share(20000) * dt)) < 2e-4 and got[-1].pitch > got[0].pitch)
check('buttons 0 and 2', all(p.buttons == 5 for p in got))
hold('0 0 0 -32768 0')
got = poses(25)
check('the right stick zooms, twofold a second', off_by(got, lambda a, b, dt: abs(b.zoom / a.zoom / 2 ** dt - 1)) < 1e-5)
hold('32767 0 0 0 0')
zoomed = poses(12)
check('and turns are finer by it', zoomed[0].zoom > 1.2 and
      off_by(zoomed, lambda a, b, dt: turned(b.yaw - a.yaw - RATE / a.zoom * dt)) < 2e-4)
hold('0 0 0 0 10')
check('back to the front by `back`', all((p.yaw, p.pitch, p.zoom, p.buttons) == (0, 0, 1, 16) for p in poses(5)))
hold('0 -32768 0 0 0')
while poses(1)[0].pitch < 90:
    pass
check('no further up than up', all(p.pitch == 90 for p in poses(5)))
hold('gone')
said(NOTED, 'it is gone')
udp.settimeout(0.5)
try:
    while True:
        udp.recv(100)
except socket.timeout:
    pass
ours.close()
check('it ends with its node', window.wait(60) == 0)
print(f'{failures} failures')
sys.exit(failures > 0)
