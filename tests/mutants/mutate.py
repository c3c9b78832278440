"""Changes one thing at a time in the product's sources and asks whether a test notices. etc/mutate --help says how it is used.

The sources in the tree stay as they are: a mutant is a copy, compiled as build/release compiles its source, and linked before the
room's library. Tests that execute the mutated statement run one by one, until one fails.
"""
import argparse
import csv
import os
import queue
import re
import sys
import time
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

import draw
from programs import Failure, Programs, Stand, tests_of
from ran import Ran, flat, sha_of

# They compare with what an earlier program made: "changed", not "wrong". Asked last.
baselines = {'system/test_regress_suite', 'system/test_regress_suite_heat', 'system/test_regress_suite_radar', 'system/test_mutants', 'sensor/test_plane_hash'}

# The second line: scripts that know the right answer, and take seconds; then baselines
second_line = ['system/test_inspect_judge', 'system/test_network_judge', 'system/test_occlusion', 'system/test_exercise_judge',
               'system/test_record', 'system/test_five_records', 'system/test_leaf_optics', 'system/test_probe',
               'system/test_klv_ground', 'system/test_burst_aim', 'system/test_level', 'system/test_hands', 'system/test_events',
               'system/test_klv', 'system/test_video_labels', 'system/test_radar', 'system/test_rcs', 'system/test_stamps',
               'system/test_propagation_judge', 'system/test_motion', 'system/test_regress_suite']

columns = ['id', 'room', 'file', 'line', 'function', 'from', 'to', 'result', 'caught_by', 'seconds', 'text']
NO_MUTANT, EQUIVALENT, ANSWER, BASELINE, LIVED = 'does not compile', 'equivalent', 'answer', 'baseline', 'lived'


class Equivalents:
    """tests/mutants/equivalent.csv: mutants that compute the same, each with its reason. `nth` says which of several equal changes
    of a line is meant, from 1; an entry without it is of a line with one alone."""

    def __init__(self, path, mutants):
        self.path, self.rows = path, {}
        drawn = [m for found in mutants.values() for m in found]
        self.there = {(m.file, m.text, m.old, m.new, n) for m in drawn for n in (0, m.nth)}
        self.several = {(m.file, m.text, m.old, m.new) for m in drawn if m.nth > 1}
        if not os.path.exists(path):
            return
        with open(path, encoding='utf-8', newline='') as stream:
            for n, row in enumerate(csv.DictReader((line for line in stream if not line.startswith('#')), restval='')):
                if None in row or not row['reason'].strip() or not re.fullmatch(r'([1-9]\d*)?', row.get('nth', '')):
                    raise Failure(f'{path}: entry {n + 1} is not file,line,from,to,reason[,nth]; next: give it these')
                key = row['file'], row['line'].strip(), row['from'], row['to'], int(row.get('nth') or 0)
                self.rows[key] = row['reason']

    def reason(self, mutant):
        key = mutant.file, mutant.text, mutant.old, mutant.new
        return self.rows.get((*key, mutant.nth)) or (None if key in self.several else self.rows.get((*key, 0)))

    def stale(self):
        """Entries of no mutant, and those that do not say which of several is meant."""
        return [key for key in self.rows if key not in self.there or key[-1] == 0 and key[:-1] in self.several]


class Runner:
    def __init__(self, options, programs, ran, units, systems, equivalents):
        self.options, self.programs, self.ran = options, programs, ran
        self.units, self.systems, self.equivalents = units, systems, equivalents
        self.stands = queue.Queue()
        for n in range(options.jobs):
            self.stands.put(Stand(programs, os.path.join(options.work, f'job{n}')))
        self.whole = {}  # tests that pass on the program as it is

    def original(self, file, text, folder):
        """The object of the source as it is, compiled the same way."""
        out = os.path.join(self.options.work, 'original', f'{flat(file)}.{sha_of(os.path.join(self.programs.root, file))}.o')
        if not os.path.exists(out):
            os.makedirs(os.path.dirname(out), exist_ok=True)
            if not self.programs.compile(file, text, out + f'.{os.path.basename(folder)}', folder):
                raise Failure(f'{file} does not compile; next: cmake --build {self.programs.build}')
            os.rename(out + f'.{os.path.basename(folder)}', out)
        with open(out, 'rb') as stream:
            return stream.read()

    def passes(self, test, stand, limit_s):
        """Whether a test that a mutant failed passes on the program as it is."""
        if test.name not in self.whole:
            stand.clean()
            self.whole[test.name] = stand.run(test, limit_s)[0] in (0, test.skip)
        return self.whole[test.name]

    def ask(self, mutant, stand, tests, text, out):
        library = self.programs.compiles[mutant.file][0]
        tests = [t for t in tests if self.whole.get(t.name, True) and self.programs.has(t.program, library)]
        for test in tests:
            limit_s = 5 * self.ran.tests[test.name]['seconds'] + 5
            stand.link(test.program, objects=[out])
            code, _ = stand.run(test, limit_s)
            if code not in (0, test.skip) and self.passes(test, stand, limit_s):
                return test.name + (' (hangs)' if code == 'hang' else '')
        return None

    def judge(self, mutant):
        """(result, by what) of one mutant."""
        with open(os.path.join(self.programs.root, mutant.file), encoding='utf-8') as stream:
            text = stream.read()
        reason = self.equivalents.reason(mutant)
        if reason:
            return EQUIVALENT, reason
        stand = self.stands.get()
        try:
            out = os.path.join(stand.folder, 'mutant.o')
            if not self.programs.compile(mutant.file, draw.mutated(text, mutant), out, stand.folder):
                return NO_MUTANT, ''
            with open(out, 'rb') as stream:
                if stream.read() == self.original(mutant.file, text, stand.folder):
                    return EQUIVALENT, 'the same object'
            tests = [t for t in self.ran.of(mutant, self.units) if self.ran.tests[t.name]['seconds'] <= self.options.longest]
            second = [t for t in self.ran.of(mutant, self.systems)]
            exact = [t for t in tests if t.name not in baselines] + [t for t in second if t.name not in baselines]
            by = self.ask(mutant, stand, exact, text, out)
            if by:
                return ANSWER, by
            by = self.ask(mutant, stand, [t for t in tests + second if t.name in baselines], text, out)
            return (BASELINE, by) if by else (LIVED, f'{len(tests)} unit and {len(second)} system tests pass' if tests or second
                                              else 'no test executes it')
        finally:
            stand.clean()
            self.stands.put(stand)

    def timed(self, mutant):
        begun = time.monotonic()
        result, by = self.judge(mutant)
        return mutant, result, by, time.monotonic() - begun


def row_of(mutant, result, by, seconds):
    return dict(zip(columns, (mutant.id, mutant.room, mutant.file, mutant.line, mutant.function, mutant.old, mutant.new,
                              result, by, f'{seconds:.1f}', mutant.text)))


def run(runner, mutants, count, out, known, say):
    """Judges mutants until count of them compile. The drawn order decides which: one that does not compile is left out, and the
    next is taken."""
    rows, taken, order = {}, 0, iter(mutants)
    jobs = runner.options.jobs
    with open(out, 'a' if known else 'w', encoding='utf-8', newline='') as stream, ThreadPoolExecutor(jobs) as pool:
        writer = csv.DictWriter(stream, columns)
        if not known:
            writer.writeheader()
        going, more = set(), True
        while going or more:
            while more and taken + len(going) < count and len(going) < jobs:
                mutant = next(order, None)
                more = mutant is not None
                if more and mutant.id in known:
                    rows[mutant.id] = known[mutant.id]
                    taken += 1
                elif more:
                    going.add(pool.submit(runner.timed, mutant))
            if not going:
                break
            done, going = wait(going, return_when=FIRST_COMPLETED)
            for future in done:
                mutant, result, by, seconds = future.result()
                if result == NO_MUTANT:
                    continue
                taken += 1
                rows[mutant.id] = row_of(mutant, result, by, seconds)
                writer.writerow(rows[mutant.id])
                stream.flush()
                say(f'{taken} of {count}: {result:10} {seconds:5.1f} s  {mutant.file}:{mutant.line} {mutant.old} -> '
                    f'{mutant.new or "(dropped)"}  {by}')
    return list(rows.values())


def table(rows, stream=sys.stdout):
    """What came of the mutants, by room; the share of those that are not equivalent that a test noticed."""
    kinds = (EQUIVALENT, ANSWER, BASELINE, LIVED)
    print('room,drawn,' + ','.join(kinds) + ',caught_percent', file=stream)
    share = 0
    for room in list(dict.fromkeys(r['room'] for r in rows)) + ['all']:
        of = [r for r in rows if room in (r['room'], 'all')]
        counts = {k: sum(r['result'] == k for r in of) for k in kinds}
        asked = len(of) - counts[EQUIVALENT]
        share = 100 * (counts[ANSWER] + counts[BASELINE]) / asked if asked else 100
        print(','.join(map(str, (room, len(of), *counts.values(), f'{share:.1f}'))), file=stream)
    return share


def options_of(words):
    parser = argparse.ArgumentParser(prog='etc/mutate', description='''Changes one thing at a time in the sources, as a copy, and
        asks whether a test notices: a constant by 10 % or twice its stated uncertainty, an operator flipped or dropped.''',
        epilog='''The first run compiles objects that count lines and runs every test once (minutes); that is
        kept in build/mutate. Needs a built build/release. Mutants that compute the same go in tests/mutants/equivalent.csv, with
        the reason.''')
    parser.add_argument('--seed', default='1', help='''which mutants are drawn (%(default)s); those of --count 60 are the first of
        --count 300''')
    parser.add_argument('--count', type=int, default=300, help='how many (%(default)s)')
    parser.add_argument('--room', action='append', help='of these alone: ' + ', '.join(draw.rooms))
    parser.add_argument('--jobs', type=int, default=1, help='how many at a time (%(default)s)')
    parser.add_argument('--list', action='store_true', help='only print them')
    parser.add_argument('--only', metavar='ID', help='this one, whatever the seed; an id is in the list and in the CSV')
    parser.add_argument('--out', help='the CSV (build/mutate/mutants_SEED.csv)')
    parser.add_argument('--go-on', action='store_true', help='take over the results that the CSV holds')
    parser.add_argument('--units', action='store_true', help='without system tests')
    parser.add_argument('--longest', type=float, default=20, help='without unit tests that take longer, s (%(default)s)')
    parser.add_argument('--least', type=float, default=0, help='fail when a smaller share is caught, %%')
    parser.add_argument('--measure', action='store_true', help='forget what was measured, and measure again')
    parser.add_argument('--root', default='.', help=argparse.SUPPRESS)
    parser.add_argument('--build', default='build/release', help='the build folder (%(default)s)')
    parser.add_argument('--sources', metavar='ROOM=FOLDER', action='append', help='other rooms than the product\'s')
    o = parser.parse_args(words)
    o.root, o.build = os.path.abspath(o.root), os.path.abspath(o.build)
    o.work = os.path.join(o.root, 'build', 'mutate')
    o.folders = dict(s.split('=', 1) for s in o.sources) if o.sources else draw.rooms
    for room in o.room or ():
        if room not in o.folders:
            raise Failure(f'no room {room}; next: one of {", ".join(o.folders)}')
    if o.count < 1 or o.jobs < 1:
        raise Failure('--count and --jobs are at least 1; next: etc/mutate --help')
    o.out = o.out or os.path.join(o.work, f'mutants_{o.seed}.csv')
    return o


def known_rows(options):
    if not options.go_on or not os.path.exists(options.out):
        return {}
    with open(options.out, encoding='utf-8', newline='') as stream:
        return {row['id']: row for row in csv.DictReader(stream)}


def main(words):
    begun = time.monotonic()

    def say(line):
        print(f'[{time.monotonic() - begun:6.0f} s] {line}', file=sys.stderr, flush=True)

    options = options_of(words)
    mutants = draw.all_mutants(options.root, options.folders)
    order = list(draw.draw({r: m for r, m in mutants.items() if not options.room or r in options.room}, options.seed))
    if options.only:
        order = [m for m in order if m.id == options.only]
        options.count = len(order)
    if not order:
        raise Failure('no such mutant; next: etc/mutate --list, without --only')
    if options.list:
        for m in order[:options.count]:
            print(f'{m.id} {m.room} {m.file}:{m.line} {m.function or "-"}: {m.old} -> {m.new or "(dropped)"}: {m.text}')
        return 0
    equivalents = Equivalents(os.path.join(options.root, 'tests', 'mutants', 'equivalent.csv'), mutants)
    for *key, nth in equivalents.stale():
        file, line, old, new = key
        several = tuple(key) in equivalents.several and nth == 0
        print(f'etc/mutate: tests/mutants/equivalent.csv: {file} has ' + ('several' if several else 'no') +
              f' {old} -> {new or "(dropped)"} in a line `{line}`' + ('; next: say in nth which of them' if several else
              ' any more; next: take the entry away, or give the line as it is now'), file=sys.stderr)

    programs = Programs(options.root, options.build)
    for file in {m.file for m in order if m.file not in programs.compiles}:
        say(f'{file} is not part of {options.build}: left out')
    order = [m for m in order if m.file in programs.compiles]
    there = [t for t in tests_of(options.build) if 'deep' not in t.labels and
             os.path.exists(os.path.join(options.build, t.program))]
    units = [t for t in there if not t.system and 'bench' not in t.labels]
    systems = [] if options.units else [t for t in there if t.name in second_line]
    if not units:
        raise Failure(f'{options.build} has no tests; next: cmake --build {options.build}')
    os.makedirs(options.work, exist_ok=True)
    files = [f for folder in options.folders.values() for f in draw.sources(options.root, folder) if f in programs.compiles]
    ran = Ran(programs, files, options.work, say)
    missing = units + systems if options.measure else ran.read(units + systems)
    if missing:
        say(f'{len(missing)} tests are not measured yet')
        ran.measure(missing, 60)
    runner = Runner(options, programs, ran, units, systems, equivalents)
    rows = run(runner, order, options.count, options.out, known_rows(options), say)
    share = table(rows)
    print(f'each mutant: {os.path.relpath(options.out)}', file=sys.stderr)
    if share < options.least:
        print(f'etc/mutate: FAILED: {share:.1f} % are caught, fewer than {options.least:g} %; next: a test for each line of '
              f'{os.path.relpath(options.out)} that says "{LIVED}", or an entry of equivalent.csv', file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        print(f'etc/mutate: {failure}', file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
