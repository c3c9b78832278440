"""Which tests run which functions and lines, measured once: objects of the drawn rooms are compiled with gcc's --coverage, the
tests are linked with them and run one by one. What was measured stays in build/mutate/ran, a file a test."""
import hashlib
import json
import os
import shutil
import subprocess

import draw
from programs import Failure, Stand


def flat(source):
    return source.replace('/', '_')


def sha_of(path):
    with open(path, 'rb') as stream:
        return hashlib.sha256(stream.read()).hexdigest()[:16]


class Ran:
    def __init__(self, programs, files, work, say):
        self.programs, self.files, self.say = programs, files, say
        self.folder, self.objects = os.path.join(work, 'ran'), os.path.join(work, 'coverage')
        self.work, self.tests, self.shas = work, {}, {f: sha_of(os.path.join(programs.root, f)) for f in files}
        self.libraries, self.spans = {}, {}
        for folder in (self.folder, self.objects):
            os.makedirs(folder, exist_ok=True)

    def source_of(self, test):
        """What a test is made of, so that a changed one is measured again."""
        words = [w for w in test.command if w.endswith('.sh')]
        path = words[0] if words else os.path.join('tests', test.name + '.c')
        path = os.path.join(self.programs.root, path)
        return sha_of(path) if os.path.exists(path) else ''

    def read(self, tests):
        """What is known of these tests; the tests of which nothing is known, or which have changed."""
        missing = []
        for test in tests:
            try:
                with open(os.path.join(self.folder, flat(test.name) + '.json'), encoding='utf-8') as stream:
                    known = json.load(stream)
            except (OSError, ValueError):
                known = None
            if known and known['sha'] == self.source_of(test):
                self.tests[test.name] = known
            else:
                missing.append(test)
        return missing

    def prepare(self):
        """Objects that count, and libraries with them in place of the usual ones."""
        for n, file in enumerate(self.files):
            out = os.path.join(self.objects, flat(file) + '.o')
            stamp = out + '.' + self.shas[file]
            if not os.path.exists(stamp):
                with open(os.path.join(self.programs.root, file), encoding='utf-8') as stream:
                    text = stream.read()
                if not self.programs.compile(file, text, out, self.objects, ['-O2', '--coverage']):
                    raise Failure(f'{file} does not compile; next: cmake --build {self.programs.build}')
                open(stamp, 'w', encoding='utf-8').close()
            if n % 20 == 19:
                self.say(f'compiled to count lines: {n + 1} of {len(self.files)}')
        replaced = {self.programs.compiles[f][1]: os.path.join(self.objects, flat(f) + '.o') for f in self.files}
        for library in {self.programs.compiles[f][0] for f in self.files}:
            path = os.path.join(self.objects, f'lib{library}.a')
            if os.path.exists(path):
                os.remove(path)
            members = [replaced.get(m, os.path.join(self.programs.build, m)) for m in self.programs.members[library]]
            subprocess.run(['ar', 'qcsT', path, *members], check=True)
            self.libraries[library] = path

    def measure(self, tests, longest_s):
        """Runs tests and keeps what each executed."""
        if not self.libraries:
            self.prepare()
        stand = Stand(self.programs, os.path.join(self.work, 'count'))
        counts = os.path.join(stand.folder, 'counts')
        os.makedirs(counts)
        for file in self.files:
            name = flat(file) + '.gcno'
            os.symlink(os.path.join(self.objects, name), os.path.join(counts, name))
        for n, test in enumerate(tests):
            shutil.rmtree(os.path.join(stand.folder, 'cache'), ignore_errors=True)  # what is kept is not executed
            stand.link(test.program, libraries=self.libraries, extra='--coverage')
            code, seconds = stand.run(test, longest_s, {'GCOV_PREFIX': counts, 'GCOV_PREFIX_STRIP': '99'})
            files = {} if code == test.skip else self.counted(counts)
            self.tests[test.name] = {'sha': self.source_of(test), 'code': code, 'seconds': round(seconds, 3), 'files': files}
            with open(os.path.join(self.folder, flat(test.name) + '.json'), 'w', encoding='utf-8') as stream:
                json.dump(self.tests[test.name], stream)
            self.say(f'measured {n + 1} of {len(tests)}: {test.name} {seconds:.1f} s, {len(files)} sources' +
                     ('' if code == 0 else f', ended with {code}'))

    def counted(self, counts):
        """Functions and lines that the last test ran, by source; the counts are taken away."""
        data = [n for n in os.listdir(counts) if n.endswith('.gcda')]
        found = {}
        if data:
            said = subprocess.run(['gcov', '--json-format', '--stdout', *data], cwd=counts, capture_output=True, text=True,
                                  check=False)
            for line in said.stdout.split('\n'):
                for of in json.loads(line)['files'] if line else ():
                    file = os.path.relpath(os.path.join(self.programs.root, of['file']), self.programs.root)
                    if file in self.shas:
                        lines = {}
                        for entry in of['lines']:
                            lines[entry['line_number']] = lines.get(entry['line_number'], 0) + entry['count']
                        functions = sorted({f['name'] for f in of['functions'] if f['execution_count']})
                        if functions:
                            found[file] = {'sha': self.shas[file], 'functions': functions,
                                           'lines': sorted(n for n, count in lines.items() if count),
                                           'still': sorted(n for n, count in lines.items() if not count)}
        for name in data:
            os.remove(os.path.join(counts, name))
        return found

    def runs_function(self, mutant, ran):
        """Whether what a test ran of a file has the mutant's function, also where it was inlined: then gcov has its lines alone."""
        if mutant.function in ran['functions']:
            return True
        if ran['sha'] != self.shas[mutant.file]:
            return False
        if mutant.file not in self.spans:
            with open(os.path.join(self.programs.root, mutant.file), encoding='utf-8') as stream:
                tokens = draw.tokens_of(stream.read())
            spans = self.spans[mutant.file] = {}
            for token, (name, _) in zip(tokens, draw.functions_of(tokens)):
                first, last = spans.get(name, (token.line, token.line))
                spans[name] = min(first, token.line), max(last, token.line)
        first, last = self.spans[mutant.file].get(mutant.function, (1, 0))
        return not set(range(first, last + 1)).isdisjoint(ran['lines'])

    def of(self, mutant, tests):
        """Tests that run the mutated statement, the cheapest first; where it is no code (a table), those that run its
        function, or its file. A file that has changed since is asked by function. A statement of constants in a function that
        was inlined everywhere has neither lines nor a function of its own: the nearest line of code stands for it."""
        span = range(mutant.first, mutant.last + 1)
        known = [self.tests[t.name]['files'].get(mutant.file) for t in tests if t.name in self.tests]
        known = [k for k in known if k]
        code = any(not set(span).isdisjoint(k['lines']) or not set(span).isdisjoint(k['still']) for k in known)
        if mutant.function and not code and not any(mutant.function in k['functions'] for k in known):
            lines = {n for k in known for n in (*k['lines'], *k['still'])}
            nearest = min(lines, key=lambda n: (max(mutant.first - n, n - mutant.last), n), default=mutant.first)
            span, code = [nearest], True
        chosen = []
        for test in tests:
            ran = self.tests.get(test.name, {'files': {}})['files'].get(mutant.file)
            if not ran:
                continue
            if mutant.function and code and ran['sha'] == self.shas[mutant.file]:
                if not set(span).isdisjoint(ran['lines']):
                    chosen.append(test)
            elif not mutant.function or self.runs_function(mutant, ran) or mutant.file.endswith('.cpp'):
                chosen.append(test)
        return sorted(chosen, key=lambda t: (self.tests[t.name]['seconds'], t.name))
