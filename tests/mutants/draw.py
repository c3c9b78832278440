"""Draws mutants: places in C sources where one number or one operator is changed, chosen by a seed.

A place is found in tokens, so that comments, strings, character constants and preprocessor lines are never touched. An
operator has two sides by the layout that etc/format gives every source: blanks on both sides of `a * b`, none after the `*` of
a pointer. Used by mutate.py.
"""
import hashlib
import os
import random
import re
from dataclasses import dataclass

# where a room's sources are
rooms = {
    'dis': 'dis',
    'earth': 'terrain/earth',
    'motion': 'entities/motion',
    'air': 'render/air',
    'heat': 'render/heat',
    'light': 'render/light',
    'scattering': 'render/scattering',
    'smoke': 'render/smoke',
    'detector': 'sensor/detector',
    'radar': 'sensor/radar',
    'truth': 'sensor/truth',
    'publish': 'sensor/publish',
}
# integers there are lengths, offsets and enumerations of a format
formats = ('dis/pdu/', 'sensor/publish/klv/', 'sensor/publish/dis/')

flipped = {'+': '-', '-': '+', '*': '/', '/': '*', '<': '<=', '<=': '<', '>': '>=', '>=': '>', '==': '!=', '!=': '==',
           '&&': '||', '||': '&&', '+=': '-=', '-=': '+=', '*=': '/=', '/=': '*='}

token_pattern = re.compile(r'''
    (?P<skip>   /\*.*?\*/ | //[^\n]* | \s+ )
  | (?P<line>   \#(?:\\\n|/\*.*?\*/|[^\n])* )
  | (?P<text>   "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*' )
  | (?P<number> (?:0[xX][0-9a-fA-F']+(?:\.[0-9a-fA-F]*)?(?:[pP][+-]?\d+)? | (?:\d[\d']*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\w* )
  | (?P<name>   [A-Za-z_]\w* )
  | (?P<sign>   \.\.\. | <<= | >>= | -> | \+\+ | -- | << | >> | <= | >= | == | != | && | \|\| | [-+*/%&|^]= | :: | . )
''', re.X | re.S)

# what is said, or promised between functions, is not what is computed
said = re.compile(r'(log_\w+|f?printf|v?sn?printf|f?puts|perror|assert|static_assert|_Static_assert|strerror|status_name)$')
# a limit of an iteration, or what keeps a division from 0, is no property of the world
tolerance = re.compile(r'\w*(tolerance|epsilon|tiny|slack)', re.I)
keywords_before_value = {'return', 'case', 'else', 'do', 'sizeof'}
guard = re.compile(r'1e-0?(?:[3-9]|[1-9]\d)')
uncertainty = re.compile(r'(?:\+-|\buncertainty)\s*(?:of\s+)?(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(%|per cent)?')


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    at: int
    line: int


@dataclass(frozen=True)
class Mutant:
    id: str        # counts equal changes of equal lines
    room: str
    file: str
    line: int
    function: str  # '' outside functions
    kind: str      # number, octet, operator
    at: int        # offset in the text
    old: str
    new: str
    nth: int       # of those in the line with the same `old` and `new`; from 1
    text: str      # of the line, without the blanks around it
    first: int     # lines of the statement
    last: int


def tokens_of(text):
    """Tokens that are compiled: neither blanks and comments nor preprocessor lines."""
    found, line, fresh = [], 1, True
    at = 0
    while at < len(text):
        match = token_pattern.match(text, at)
        kind, word = match.lastgroup, match.group()
        if kind == 'line' and not fresh:  # a # within a line
            kind, word = 'sign', '#'
        if kind not in ('skip', 'line'):
            found.append(Token(kind, word, at, line))
        fresh = '\n' in word or (fresh and kind == 'skip')
        line += word.count('\n')
        at += len(word)
    return found


def functions_of(tokens):
    """For each token the name of the function in which it is, '' outside; and whether it is in a list of values or an enum."""
    where, opened = [], []  # opened: a brace each: (name, kind)
    for i, token in enumerate(tokens):
        if token.text == '}' and opened:
            opened.pop()
        name = next((n for n, kind in opened if kind == 'function'), '')
        where.append((name, opened[-1][1] if opened else 'file'))
        if token.text != '{':
            continue
        before = tokens[i - 1].text if i else ''
        if name:
            opened.append(('', 'list' if before in ('=', ')', ',', '{', '[', '(') and before != ')' else 'block'))
        elif before == ')' or (before in ('const', 'noexcept')):
            depth, k = 0, i - 1
            while k > 0:
                depth += (tokens[k].text == ')') - (tokens[k].text == '(')
                if depth == 0 and tokens[k].text == '(':
                    break
                k -= 1
            opened.append((tokens[k - 1].text, 'function'))
        elif before == 'namespace' or (i > 1 and tokens[i - 2].text == 'namespace') or (i and tokens[i - 1].kind == 'text'):
            opened.append(('', 'file'))
        else:
            head = statement_head(tokens, i)
            kind = 'enum' if 'enum' in head else 'list' if before in ('=', ',', '{', ']') else 'type'
            opened.append(('', kind if not opened or opened[-1][1] != 'list' else 'list'))
    return where


def statement_head(tokens, i):
    """Words from the statement's beginning to token i."""
    k = i
    while k > 0 and tokens[k - 1].text not in (';', '}', '{'):
        k -= 1
    return [t.text for t in tokens[k:i]]


def statement_lines(tokens, i):
    """First and last line of the statement that holds token i."""
    first = last = i
    while first > 0 and tokens[first - 1].text not in (';', '{', '}'):
        first -= 1
    while last + 1 < len(tokens) and tokens[last].text not in (';', '{', '}'):
        last += 1
    return tokens[first].line, tokens[last].line


def inside(tokens, i, opening, closing):
    """Indices of the opening tokens around token i within its statement, the innermost first."""
    depth, k, found = 0, i - 1, []
    while k >= 0 and tokens[k].text not in (';', '}'):
        if tokens[k].text == closing:
            depth += 1
        elif tokens[k].text == opening:
            if depth == 0:
                found.append(k)
            else:
                depth -= 1
        k -= 1
    return found


def declares(head):
    """Whether the statement begins as a declaration does: two words, or a word and a pointer."""
    words = [w for w in head if w not in ('static', 'const', 'inline', 'extern', '_Thread_local', 'unsigned', 'struct', 'enum')]
    if words and words[0] in keywords_before_value | {'goto'}:
        return False
    return len(words) > 1 and bool(re.match(r'[A-Za-z_]', words[0]) and re.match(r'[A-Za-z_*]', words[1]))


def changed_number(word, line_text, alone):
    """A number of floating type, 10 % larger or twice its stated uncertainty, whichever is more; None for 0. Of a power of ten
    from 1e-3 down that stands alone (no factor, no value of a list) the order of magnitude is what is meant: a guard, an offset
    that must be small. It becomes a thousand times as large."""
    digits = word.rstrip('fFlL') if not word.lower().startswith('0x') else None
    if digits is None or not re.fullmatch(r'[\d.]+(?:[eE][+-]?\d+)?', digits) or float(digits) == 0:
        return None
    value = float(digits)
    step = 999 * value if alone and guard.fullmatch(digits) else 0.1 * value
    comments = ' '.join(re.findall(r'/\*.*?(?:\*/|$)|//.*', line_text))
    for amount, percent in uncertainty.findall(comments):
        step = max(step, 2 * float(amount) * (value / 100 if percent else 1))
    new = repr(float(f'{value + step:.12g}'))
    return new + word[len(digits):]


def places(room, file, text):
    """Every mutant of one source, in order."""
    tokens = tokens_of(text)
    where = functions_of(tokens)
    lines = text.split('\n')
    seen, in_line = {}, {}

    def mutant(i, kind, at, old, new):
        token = tokens[i]
        key = (file, lines[token.line - 1].strip(), old, new)
        count = seen[key] = seen.get(key, 0) + 1
        nth = in_line[token.line, old, new] = in_line.get((token.line, old, new), 0) + 1
        ident = hashlib.sha256('\0'.join((*key, str(count))).encode()).hexdigest()[:8]
        return Mutant(ident, room, file, token.line, where[i][0], kind, at, old, new, nth, key[1],
                      *statement_lines(tokens, i))

    for i, token in enumerate(tokens):
        function, place = where[i]
        if token.kind not in ('number', 'sign') or place in ('type', 'file') and token.kind != 'number' or place == 'type':
            continue
        if token.kind == 'sign' and token.text not in flipped and token.text != '!':
            continue
        if any(said.match(tokens[k - 1].text) for k in inside(tokens, i, '(', ')') if k):
            continue
        head = statement_head(tokens, i)
        in_brackets = bool(inside(tokens, i, '[', ']'))
        if in_brackets and (declares(head) or place == 'file'):  # the size of an array
            continue
        if 'static_assert' in head or '_Static_assert' in head:
            continue
        if token.kind == 'number':
            floating = re.search(r'[.eE]', token.text) and not token.text.lower().startswith('0x')
            fixed = 'const' in head and ('static' in head or not function)
            constant = fixed and ('double' in head or 'float' in head) and not in_brackets
            if floating or constant and '=' in head and not inside(tokens, i, '(', ')'):
                if any(tolerance.match(word) for word in head) or \
                        re.match(r'[\d.]+e\+?[3-9]\d', token.text.lower()) or \
                        re.match(r'1e-(0?[6-9]|\d\d)', token.text) and tokens[i - 1].text in ('<', '<=', '>', '>=', ','):
                    continue
                new = changed_number(token.text, lines[token.line - 1], place != 'list' and
                                     not {tokens[i - 1].text, tokens[i + 1].text} & {'*', '/'})
                if new:
                    yield mutant(i, 'number', token.at, token.text, new)
            elif file.startswith(formats) and (function or place in ('enum', 'list')) and \
                    re.fullmatch(r'(\d+|0[xX][0-9a-fA-F]+)[uUlL]*', token.text):
                value = int(re.sub(r'[uUlL]+$', '', token.text), 0) if not re.match(r'0\d', token.text) else 0
                if value >= 2 and 'for' not in head and tokens[i - 1].text not in ('<', '<=', '>', '>='):
                    suffix = re.search(r'[uUlL]*$', token.text).group()
                    new = (hex(value + 1) if token.text.lower().startswith('0x') else str(value + 1)) + suffix
                    yield mutant(i, 'octet', token.at, token.text, new)
            continue
        before, end = tokens[i - 1], token.at + len(token.text)
        spaced = text[token.at - 1].isspace() and text[end:end + 1].isspace()
        if spaced and token.text in flipped:
            if before.kind in ('name', 'number') and before.text not in keywords_before_value or before.text in (')', ']'):
                yield mutant(i, 'operator', token.at, token.text, flipped[token.text])
        elif not text[end:end + 1].isspace() and token.text in ('-', '!'):
            if before.kind == 'sign' and before.text not in (')', ']') or before.text in keywords_before_value or \
                    before.text == ')' and not text[token.at - 1].isspace():
                yield mutant(i, 'operator', token.at, token.text, '')


def mutated(text, mutant):
    """The source with that one thing changed."""
    assert text[mutant.at:mutant.at + len(mutant.old)] == mutant.old
    return text[:mutant.at] + mutant.new + text[mutant.at + len(mutant.old):]


def sources(root, folder):
    found = []
    for at, _, names in os.walk(os.path.join(root, folder)):
        found += [os.path.relpath(os.path.join(at, n), root) for n in names
                  if n.endswith(('.c', '.cpp')) and not n.endswith('_module.cpp')]
    return sorted(found)


def all_mutants(root, folders=rooms):
    """Every mutant by room."""
    found = {}
    for room, folder in folders.items():
        found[room] = []
        for file in sources(root, folder):
            with open(os.path.join(root, file), encoding='utf-8') as stream:
                found[room] += places(room, file, stream.read())
    return found


def draw(mutants, seed):
    """All mutants in an order that follows from the seed: a room after the other, in each a number, an operator, and so on, so
    that any count from the beginning has as many of every room, half of them numbers as far as there are any."""
    queues = {}
    for room, found in mutants.items():
        chance = random.Random(f'{seed} {room}')
        numbers = [m for m in found if m.kind != 'operator']
        operators = [m for m in found if m.kind == 'operator']
        chance.shuffle(numbers)
        chance.shuffle(operators)
        queues[room] = [numbers, operators]
    turn = 0
    while any(a or b for a, b in queues.values()):
        for lists in queues.values():
            chosen = lists[turn % 2] or lists[1 - turn % 2]
            if chosen:
                yield chosen.pop()
        turn += 1
