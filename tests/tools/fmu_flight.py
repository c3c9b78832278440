"""tests/tools/fmu_flight.py FMU: the FMU by fmpy.

    describe               the description is valid, and the library has every function of FMI 3.0
    fly PITVIPER LOG OUT OPTIONS...     simulates a flight, and judges poses by pyproj and scipy, the lines of sight by
                           truth.jsonl, and the places in the ring
    live PITVIPER OUT OPTIONS...        the same through a live exercise
    say FOLDER             writes what the FMU says in that flight by CIGI to FOLDER/said
    again CIGI PITVIPER LOG OUT OPTIONS...   the same datagrams from a host without FMU
    manners FOLDER         tools that behave otherwise, with fmu_ig.py in place of pitviper"""
import ctypes
import json
import os
import re
import signal
import struct
import subprocess
import sys
import time

import fmpy
import numpy
import pyproj
from fmpy import fmi3, simulate_fmu, validation
from fmpy.fmi1 import FMICallException
from scipy.spatial.transform import Rotation

from cigi_flight import free_port
from cigi_host import Host

STEP_S, FRAMES, START_S = 0.05, 6, 1350.5
HERE = os.path.dirname(os.path.abspath(__file__))
failures = 0


def expect(what, condition, *shown):
    global failures
    if not condition:
        print('FAILED:', what, *shown)
        failures += 1


# ---- the description --------------------------------------------------------------------------------


def describe(fmu):
    problems = validation.validate_fmu(fmu)
    expect('the description is valid', not problems, problems)
    header = open(os.path.join(os.path.dirname(fmpy.__file__), 'c-code', 'fmi3Functions.h'), encoding='utf-8').read()
    wanted = set(re.findall(r'FMI3_Export\s+(fmi3\w+)TYPE', header))
    folder = fmpy.extract(fmu)
    library = ctypes.CDLL(f'{folder}/binaries/x86_64-linux/pitviper_seeker.so')
    missing = [name for name in wanted if not hasattr(library, name)]
    expect('every function is there', len(wanted) > 70 and not missing, len(wanted), missing)
    description = fmpy.read_model_description(fmu)
    flags = [f for f in dir(description.coSimulation) if f.startswith(('canGet', 'canSer', 'provides', 'has'))]
    expect('what is not there is not promised', not any(getattr(description.coSimulation, f) for f in flags), flags)
    seeker = instance(fmu, folder)
    for v in description.modelVariables:
        kind = {'Float64': 'Float64', 'Boolean': 'Boolean', 'Int64': 'Int64', 'String': 'String'}[v.type]
        got = getattr(seeker, 'get' + kind)([v.valueReference])[0]
        got = got.decode() if isinstance(got, bytes) else got
        wanted = v.start if v.start is not None else got
        wanted = {'false': False, 'true': True}.get(wanted, wanted)
        expect(f'{v.name} is as described', str(got) == str(wanted) or float(got) == float(wanted), got, v.start)
        settable = v.causality in ('parameter', 'input')
        expect(f'{v.name}: settable', status(getattr(seeker, 'set' + kind), [v.valueReference], [got]) == (0 if settable else 3))
        other = 'Int64' if kind != 'Int64' else 'Float64'
        expect(f'{v.name} has one type', status(getattr(seeker, 'get' + other), [v.valueReference]) == 3)
    expect('no such variable', status(seeker.getFloat64, [4000000000]) == 3)
    expect('no state', status(seeker.getFMUState) == 3)
    expect('no event mode', status(seeker.enterEventMode) == 3)
    expect('no step before initialization', status(seeker.doStep, 0, STEP_S) == 3)
    seeker.freeInstance()
    description.guid = '{other}'
    other = fmi3.FMU3Slave(guid='{other}', unzipDirectory=folder, modelIdentifier='pitviper_seeker', instanceName='x')
    try:
        other.instantiate()
        expect('another description is refused', False)
    except Exception:  # what fmpy raises is its own business
        pass


def instance(fmu, folder=None):
    description = fmpy.read_model_description(fmu)
    seeker = fmi3.FMU3Slave(guid=description.guid, unzipDirectory=folder or fmpy.extract(fmu),
                            modelIdentifier='pitviper_seeker', instanceName='seeker')
    seeker.instantiate(loggingOn=False)
    seeker.vr = {v.name: v.valueReference for v in description.modelVariables}
    return seeker


def status(call, *arguments):
    try:
        call(*arguments)
    except FMICallException as e:
        return e.status
    return 0


# ---- a flight ---------------------------------------------------------------------------------------


def pose(k):
    """Place and rotation r_ecef_from_eye of frame k."""
    lat, lon, h = 35.9937 + 2e-6 * k, -123.000684, 371. - 0.5 * k
    p, l = numpy.radians([lat, lon])
    ned = numpy.array([[-numpy.sin(p) * numpy.cos(l), -numpy.sin(l), -numpy.cos(p) * numpy.cos(l)],
                       [-numpy.sin(p) * numpy.sin(l), numpy.cos(l), -numpy.cos(p) * numpy.sin(l)],
                       [numpy.cos(p), 0, -numpy.sin(p)]])
    place = numpy.array(pyproj.Transformer.from_crs(4979, 4978).transform(lat, lon, h))
    return place, ned @ Rotation.from_euler('ZYX', [2 + 0.1 * k, -21.5, 1.7 * k], degrees=True).as_matrix()


def inputs(k, rates):
    place, turned = pose(k)
    x, y, z, w = Rotation.from_matrix(turned).as_quat()
    return (*place, *(2.5 * numpy.array([w, x, y, z])), *rates)  # of any length


NAMES = [f'position_{a}' for a in 'xyz'] + [f'attitude_{a}' for a in 'wxyz'] + [f'velocity_{a}' for a in 'xyz'] + \
    [f'turning_{a}' for a in 'xyz']
RATES = (10., -250., 3., 0.01, -0.02, 0.4)
SHOWN = ['valid', 'sight_x', 'sight_y', 'sight_z', 'sight_rate_right', 'sight_rate_up', 'range', 'closing', 'off_axis_right',
         'off_axis_up', 'visible', 'pixels', 'frame_time', 'frame', 'sequence', 'offset', 'octets']


def parameters(program, log, out, options):
    return {'program': program, 'recording': log, 'out': out, 'options': ' '.join(options), 'start_s': START_S, 'rates': True}


def rings():
    return [f for f in os.listdir('/dev/shm') if f.startswith(f'pitviper-fmu-{os.getpid()}-')]


def judge_frame(k, line, now):
    place, turned = pose(k)
    sensor = line['sensors'][0]
    expect(f'frame {k}: its place', numpy.abs(numpy.array(line['host']['ecef_m']) - place).max() < 1e-6)
    cam = numpy.array(sensor['ecef_from_cam']).reshape(3, 3)
    expect(f'frame {k}: its attitude', numpy.abs(cam - turned[:, [1, 2, 0]]).max() < 1e-11, numpy.abs(cam - turned[:, [1, 2, 0]]).max())
    expect(f'frame {k}: its speed', abs(line['host']['speed_mps'] - numpy.linalg.norm(RATES[:3])) < 1e-3, line['host']['speed_mps'])
    expect(f'frame {k}: its time', abs(line['time_s'] - START_S - k * STEP_S) < 1e-9 and now['frame_time'] == line['time_s'])
    targets = sorted(line['targets'], key=lambda t: numpy.hypot(*t['boresight_error_deg'])) if line['targets'] else []
    expect(f'frame {k}: there are targets', targets)
    if not targets:
        return
    t = targets[0]
    expect(f'frame {k}: range', abs(now['range'] - t['range_m']) < 1e-6 * t['range_m'], now['range'], t['range_m'])
    sight = numpy.array([now[f'sight_{a}'] for a in 'xyz'])
    expect(f'frame {k}: a unit vector', abs(numpy.linalg.norm(sight) - 1) < 1e-12)
    right, down, along = cam.T @ sight
    expect(f'frame {k}: angles', numpy.abs(numpy.array([numpy.arctan2(right, along), -numpy.arctan2(down, numpy.hypot(right, along))])
                                          - [now['off_axis_right'], now['off_axis_up']]).max() < 1e-12)
    error = numpy.radians(t['boresight_error_deg'])
    expect(f'frame {k}: off the axis', numpy.abs(error - [now['off_axis_right'], now['off_axis_up']]).max() < 2e-6,
           error, now['off_axis_right'], now['off_axis_up'])
    expect(f'frame {k}: rate', numpy.abs(numpy.radians(t['los_rate_dps']) - [now['sight_rate_right'], now['sight_rate_up']]).max() < 1e-8)
    expect(f'frame {k}: valid', bool(now['valid']) == (now['pixels'] > 0))


def fly(fmu, program, log, out, options):
    """By fmpy's own loop; between its steps the ring is looked into."""
    signals = numpy.array([(k * STEP_S, *inputs(k, RATES)) for k in range(FRAMES + 1)],
                          dtype=[('time', 'f8')] + [(n, 'f8') for n in NAMES])
    def look(_, recorder):
        row = dict(zip([column[0] for column in recorder.cols], recorder.rows[-1]))
        name = rings()
        expect('there is one ring', len(name) == 1, name)
        if not name or not row['sequence']:
            return True
        with open(f'/dev/shm/{name[0]}', 'rb') as ring:
            ring.seek(int(row['offset']))
            lock, sequence, number, _, at_s = struct.unpack('<QQiId', ring.read(32))
        expect('its place in the ring', (lock, sequence, number, at_s) ==
               (2 * row['sequence'], row['sequence'], row['frame'], row['frame_time']), lock, sequence, number, at_s, row)
        return True

    result = simulate_fmu(fmu, start_time=0, stop_time=FRAMES * STEP_S, output_interval=STEP_S, input=signals, output=SHOWN,
                          start_values=parameters(program, log, out, options), step_finished=look)
    lines = [json.loads(line) for line in open(f'{out}/truth.jsonl', encoding='utf-8')]
    expect('as many frames as steps', len(lines) == FRAMES == len(result) - 1, len(lines), len(result))
    for k, line in enumerate(lines):
        judge_frame(k, line, dict(zip(result.dtype.names, result[k + 1])))
    expect('nothing is left in /dev/shm', not rings())


def live(fmu, program, out, options):
    """Through a live exercise, whose time is its own."""
    signals = numpy.array([(k * STEP_S, *inputs(k, RATES)) for k in range(FRAMES + 1)],
                          dtype=[('time', 'f8')] + [(n, 'f8') for n in NAMES])
    result = simulate_fmu(fmu, start_time=0, stop_time=FRAMES * STEP_S, output_interval=STEP_S, input=signals, output=SHOWN,
                          start_values=parameters(program, '', out, options))
    lines = [json.loads(line) for line in open(f'{out}/truth.jsonl', encoding='utf-8')]
    expect('as many frames as steps', len(lines) == FRAMES == len(result) - 1, len(lines), len(result))
    for k, line in enumerate(lines):
        expect(f'live frame {k}: its time', abs(line['time_s'] - lines[0]['time_s'] - k * STEP_S) < 1e-9
               and abs(result['frame_time'][k + 1] - line['time_s']) < 1e-9, line['time_s'] - lines[0]['time_s'], result['frame_time'][k + 1], line['time_s'])
        expect(f'live frame {k}: its place', numpy.abs(numpy.array(line['host']['ecef_m']) - pose(k)[0]).max() < 1e-6)


# ---- the same by CIGI alone -----------------------------------------------------------------------


def say(fmu, folder):
    """What the FMU says in that flight: its datagrams, as fmu_ig.py hears them."""
    os.environ.update(PITVIPER_FMU_LOG=f'{folder}/said', PITVIPER_FMU_IG='good')
    signals = numpy.array([(k * STEP_S, *inputs(k, RATES)) for k in range(FRAMES + 1)],
                          dtype=[('time', 'f8')] + [(n, 'f8') for n in NAMES])
    simulate_fmu(fmu, start_time=0, stop_time=FRAMES * STEP_S, output_interval=STEP_S, input=signals,
                 start_values=parameters(ig(folder), 'log', f'{folder}/none', []))


def again(said, program, log, out, options):
    datagrams = [bytes.fromhex(line) for line in open(said, encoding='ascii').read().split('\n')[1:] if line]
    expect('it said as many datagrams as frames', len(datagrams) == FRAMES, len(datagrams))
    ours, theirs = free_port(), free_port()
    host = Host(theirs, own=ours)
    command = [program, 'replay', log, '--out', out, '--cigi', f'127.0.0.1:{ours}', '--set', f'exercise.cigi_port={theirs}',
               '--memory', f'pitviper-test-{os.getpid()}', '--set', 'publish.memory_record=truth', *options]
    with subprocess.Popen(command) as node:
        host.heartbeat(1)
        for data in datagrams:
            host.send(data)
            host.next()
        node.send_signal(signal.SIGINT)
        node.wait(60)


# ---- manners ----------------------------------------------------------------------------------------


def ig(folder):
    path = f'{folder}/ig'
    with open(path, 'w', encoding='ascii') as f:
        f.write(f'#!/bin/sh\nexec {sys.executable} {HERE}/fmu_ig.py "$@"\n')
    os.chmod(path, 0o755)
    return path


def gone(pid):
    """Whether a process is; it may take a moment."""
    for _ in range(2000):
        try:
            with open(f'/proc/{pid}/stat', encoding='ascii') as f:
                if f.read().rsplit(')', 1)[1].split()[0] == 'Z':
                    return True
        except FileNotFoundError:
            return True
        time.sleep(0.01)
    return False


class Tool:
    """A tool with the FMU, which has started fmu_ig.py in that way."""

    def __init__(self, fmu, folder, way, **values):
        os.environ.update(PITVIPER_FMU_LOG=f'{folder}/said', PITVIPER_FMU_IG=way)
        self.said = f'{folder}/said'
        self.seeker = instance(fmu)
        self.set(program=ig(folder), recording='log', start_s=START_S, **values)
        self.pose(0)
        self.seeker.enterInitializationMode(startTime=0.)

    def set(self, **values):
        for name, value in values.items():
            call = self.seeker.setString if isinstance(value, str) else self.seeker.setBoolean if isinstance(value, bool) else self.seeker.setFloat64
            call([self.seeker.vr[name]], [value])

    def pose(self, k):
        self.set(**dict(zip(NAMES, map(float, inputs(k, RATES)))))

    def begin(self):
        return status(self.seeker.exitInitializationMode)

    def step(self, at_s, step_s=STEP_S):
        return status(self.seeker.doStep, at_s, step_s)

    def pid(self):
        return int(open(self.said, encoding='ascii').readline())

    def free(self):
        self.seeker.freeInstance()


def stamps(said):
    """IG Control's number and time of what the host said, without repetitions."""
    lines = open(said, encoding='ascii').read().split('\n')[1:]
    return list(dict.fromkeys(struct.unpack('>II', bytes.fromhex(line)[8:16]) for line in lines if line))


def manners(fmu, folder):
    begun = round(START_S * 100000)
    t = Tool(fmu, folder, 'good')  # a tool that repeats, goes back, and gives no numbers
    expect('it begins', t.begin() == 0)
    expect('a step', t.step(0) == 0)
    expect('the same time again is a frame again', t.step(0) == 0)
    expect('time that is no number', t.step(float('nan')) == 3)
    expect('a step of none', t.step(0.05, 0.) == 3 and t.step(0.05, float('inf')) == 3)
    for name, value in (('position_x', float('nan')), ('attitude_w', float('inf')), ('turning_z', float('nan')), ('position_z', 1e300)):
        t.set(**{name: value})
        expect(f'{name} {value}', t.step(0.05) == 3)
        t.pose(1)
    t.set(attitude_w=0., attitude_x=0., attitude_y=0., attitude_z=0.)
    expect('no attitude', t.step(0.05) == 3)
    t.pose(1)
    expect('it goes on', t.step(0.05) == 0)
    expect('time that goes back', t.step(0) == 3)
    expect('and on', t.step(0.2) == 0)
    expect('a parameter is fixed now', status(t.seeker.setString, [t.seeker.vr['options']], ['x']) == 3)
    expect('without rates no Rate Control', {len(line) for line in open(t.said, encoding='ascii').read().split('\n')[1:] if line} == {2 * (24 + 48 + 32)})
    expect('nothing of that was asked for', stamps(t.said) == [(1, begun), (2, begun), (3, begun + 5000), (4, begun + 20000)], stamps(t.said))
    pid = t.pid()
    t.free()  # without fmi3Terminate
    expect('free: no child is left', gone(pid))

    t = Tool(fmu, folder, 'good')  # one that terminates, resets, and begins again
    expect('it begins', t.begin() == 0 and t.step(0) == 0)
    pid = t.pid()
    t.seeker.terminate()
    expect('terminate: no child is left', gone(pid))
    expect('no step after the end', t.step(0.05) == 3)
    t.seeker.reset()
    t.set(program=ig(folder), recording='log')
    t.pose(0)
    t.seeker.enterInitializationMode(startTime=7.)
    expect('after a reset', t.begin() == 0 and t.step(7.) == 0 and stamps(t.said) == [(1, 0)], stamps(t.said))
    pid = t.pid()
    t.seeker.reset()
    expect('reset: no child is left', gone(pid))
    t.free()

    t = Tool(fmu, folder, 'deaf', start_limit_s=0.3)
    expect('a program that never says anything', t.begin() == 3)
    expect('and is left by', gone(t.pid()))
    t.free()

    t = Tool(fmu, folder, 'slow', step_limit_s=0.2)
    expect('slow: the first', t.begin() == 0 and t.step(0) == 0)
    t.pose(1)
    got = [t.step(0.05)]
    while got[-1] == 2 and len(got) < 100:
        got.append(t.step(0.05))
    expect('a step is discarded until its frame is there', got[0] == 2 and got[-1] == 0, got)
    expect('and is asked for once', t.step(0.1) == 0 and stamps(t.said) == [(1, begun), (2, begun + 5000), (3, begun + 10000)], stamps(t.said))
    t.free()

    t = Tool(fmu, folder, 'lossy')
    expect('a link that loses', t.begin() == 0 and [t.step(k * 0.05) for k in range(4)] == [0] * 4 and len(stamps(t.said)) == 4)
    t.free()

    for code in 0, 3:
        t = Tool(fmu, folder, f'leaves {code}')
        expect('leaves: two frames', t.begin() == 0 and t.step(0) == 0 and t.step(0.05) == 0)
        try:
            over = t.seeker.doStep(0.1, STEP_S)
            expect('a program that ends well ends the simulation', code == 0 and over[1], over)
        except FMICallException as e:
            expect('a program that fails fails the step', code == 3 and e.status == 3)
        expect('and there is no further step', t.step(0.15) == 3)
        t.free()

    t = Tool(fmu, folder, 'good')
    t.set(program=f'{folder}/none')
    expect('a program that is not there', t.begin() == 3)
    t.free()

    t = Tool(fmu, folder, 'stubborn')
    expect('stubborn: it begins', t.begin() == 0 and t.step(0) == 0)
    pid = t.pid()
    t.free()
    expect('one that does not end when told is killed', gone(pid))

    # two at a time, of which the first is freed first; and a tool that is killed
    a = Tool(fmu, folder, 'good')
    expect('a', a.begin() == 0)
    pid_a = a.pid()
    b = Tool(fmu, folder, 'good')
    expect('b', b.begin() == 0)
    a.free()
    expect('a is gone', gone(pid_a))
    expect('b is there', b.step(0) == 0)
    b.free()
    child = os.fork()
    if child == 0:
        t = Tool(fmu, folder, 'good')
        t.begin()
        t.step(0)
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    expect('of a tool that was killed no child is left', gone(int(open(f'{folder}/said', encoding='ascii').readline())))


def main():
    fmu, what, *rest = sys.argv[1:]
    if what == 'describe':
        describe(fmu)
    elif what == 'fly':
        fly(fmu, rest[0], rest[1], rest[2], rest[3:])
    elif what == 'live':
        live(fmu, rest[0], rest[1], rest[2:])
    elif what == 'say':
        say(fmu, rest[0])
    elif what == 'again':
        again(rest[0], rest[1], rest[2], rest[3], rest[4:])
    else:
        manners(fmu, rest[0])
    print(f'{what}: {failures} failures')
    return bool(failures)


if __name__ == '__main__':
    sys.exit(main())
