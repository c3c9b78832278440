"""Reads MODTRAN's tape7 (.tp7) with its header cards and spectra in wavenumbers: those of MODTRAN 3.7 to 5, and LOWTRAN7's.

Columns are found by their names in the header line; where a number ends must be where its column's name ends. What does
not fit is refused with file and line (Tape7Error); nothing is guessed.
"""
import re

import numpy as np

# of a Fortran format: fields without a blank between them too
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]\d\d|[+-]\d{3})?")
TWO_WORDS = ("TOT TRANS", "PTH THRML", "THRML SCT", "SURF EMIS", "SOL SCAT", "SING SCAT", "SNGL SCAT", "GRND RFLT",
             "DRCT RFLT", "TOTAL RAD", "REF SOL", "SOL TR", "N2 CON", "H2O CON", "MOL SCAT")
NOTHING = 700.0  # depth where nothing comes through


class Tape7Error(Exception):
    pass


class Run:
    """Of one run: kind "level", "slant", "space" or "sun"; visibility_km 0: no haze; lengths in km, the angle from the
    zenith in degrees as its card 3 has them (None: there is none to read). wavenumber, 1/cm; depth, of what its printed
    digits tell best; thermal, W/(cm2 sr cm-1); sun_top, W/(cm2 cm-1); None where the run has no such column."""
    def __init__(self, path, number, line):
        self.path, self.number, self.line = path, number, line
        self.model = self.kind = self.visibility_km = None
        self.h1_km = self.h2_km = self.angle_deg = self.range_km = self.radius_km = None
        self.wavenumber = self.depth = self.thermal = self.sun_top = None

    def __str__(self):
        return f"{self.path}, run {self.number} (line {self.line})"


def names_of(header):
    """Names in a header line and where they end."""
    for pair in TWO_WORDS:
        header = header.replace(pair, pair.replace(" ", "_"))
    return [(m.group(), m.end()) for m in re.finditer(r"\S+", header)]


def plain(text):
    """A Fortran number as Python writes it: 1.00-100 and 1D-5 are 1.00E-100 and 1E-5."""
    return re.sub(r"(\d|\.)([+-]\d{3})$", r"\1E\2", text.upper().replace("D", "E"))


def value_of(text):
    return float(plain(text))


def half_digit(text):
    """Half a unit of a printed number's last digit."""
    mantissa, _, exponent = plain(text).partition("E")
    return 0.5 * 10.0 ** (-len(mantissa.partition(".")[2]) + (int(exponent) if exponent else 0))


def best_depth(tau_text, depth_text):
    """Of a transmittance and its depth, printed with different digits, the one that is known better."""
    tau = value_of(tau_text)
    tau_error = half_digit(tau_text) / tau if tau > 0 else np.inf
    if depth_text is not None:
        depth = value_of(depth_text)
        if half_digit(depth_text) <= tau_error and depth < 99.9:
            return depth
    return -np.log(tau) if tau > 0 else NOTHING


def fields(line, names, where):
    """{name: text} by where the numbers end; a column may be blank."""
    out = {}
    at = 0
    for m in NUMBER.finditer(line):
        near = [k for k in range(at, len(names)) if abs(names[k][1] - m.end()) <= 2]
        if not near:
            raise Tape7Error(f"{where}: the number {m.group()} that ends in column {m.end()} is under no name of the header")
        k = min(near, key=lambda i: abs(names[i][1] - m.end()))
        out[names[k][0]] = m.group()
        at = k + 1
    return out


def layout_of(names):
    """How a row is read: a function of its line and place to texts of tau, depth, thermal, sun_top; or why not."""
    words = [n for n, _ in names]
    if "TOT_TRANS" in words and ("PTH_THRML" in words or "THRML_EM" in words):
        thermal = "PTH_THRML" if "PTH_THRML" in words else "THRML_EM"
        def radiance(line, where):
            f = fields(line, names, where)
            if "FREQ" not in f or "TOT_TRANS" not in f:
                raise Tape7Error(f"{where}: no number under FREQ or TOT_TRANS")
            return f["FREQ"], f["TOT_TRANS"], f.get("DEPTH"), f.get(thermal), f.get("TOA_SUN")
        return radiance
    # these rows have no blank columns, but names that do not stand above them; the depth is last, and has no name
    if words[:4] == ["FREQ", "TRANS", "SOL_TR", "SOLAR"]:
        return lambda line, where: in_order(line, where, (4, 5), 4, None, 3)
    if words[:4] == ["FREQ", "TRANS", "ATMOS", "PATH"]:
        return lambda line, where: in_order(line, where, (4, 11), -1, 2, None)
    if words[:2] == ["FREQ", "TOTAL"] and "-LOG" not in words:
        return lambda line, where: in_order(line, where, (13,), 12, None, None)
    if words[0] == "FREQ" and len(words) > 1 and words[1] in ("TOTAL", "COMBIN") and "-LOG" in words:
        return lambda line, where: in_order(line, where, range(len(words), len(words) + 2), words.index("-LOG"), None, None)
    return None


def in_order(line, where, counts, depth, thermal, sun_top):
    texts = NUMBER.findall(line)
    if len(texts) not in counts:
        raise Tape7Error(f"{where}: {len(texts)} numbers, where {' or '.join(str(c) for c in counts)} belong")
    def at(i):
        return texts[i] if i is not None and i < len(texts) else None
    return texts[0], texts[1], at(depth), at(thermal), at(sun_top)


def read_cards(run, cards):
    """Cards 1 to 3 as tape7 repeats them. Geometry that is not there stays None."""
    lines = [(number, text) for number, text in cards if text.strip()]
    if len(lines) < 6:
        return
    try:
        run.model = int(lines[0][1][3:5])
        kind, emission = int(lines[0][1][5:10]), int(lines[0][1][10:15])
        haze, visibility_km = int(lines[1][1][0:5]), float(lines[1][1][30:40])
        third = [float(lines[-5][1][k:k + 10]) for k in range(0, 40, 10)]
        radius = lines[-5][1][50:62].split()
    except ValueError:
        run.kind = None
        return
    run.kind = "sun" if emission == 3 else {1: "level", 2: "slant", 3: "space"}.get(kind)
    run.visibility_km = visibility_km if haze > 0 else 0.0
    run.h1_km, run.h2_km, run.angle_deg, run.range_km = third
    run.radius_km = float(radius[0]) if radius and NUMBER.fullmatch(radius[0]) and float(radius[0]) > 0 else 6371.23


def read(path):
    """All runs of a file."""
    with open(path, encoding="latin-1") as file:
        lines = file.read().split("\n")
    runs, cards, at = [], [], 0
    while at < len(lines):
        text = lines[at].rstrip()
        if re.search(r"WAVLEN|WAVELENGTH", text):
            raise Tape7Error(f"{path}:{at + 1}: a spectrum in wavelengths; the file tape7 (.tp7) of the same run has it in 1/cm")
        if not re.match(r"\s*FREQ\b", text):
            cards.append((at + 1, text))
            at += 1
            continue
        run = Run(path, len(runs) + 1, at + 1)
        names = names_of(text)
        row = layout_of(names)
        if row is None:
            raise Tape7Error(f"{path}:{at + 1}: a header of unknown columns: {' '.join(n for n, _ in names)[:100]}")
        read_cards(run, cards)
        at = read_spectrum(run, lines, at + 1, row)
        runs.append(run)
        cards = []
    if not runs:
        raise Tape7Error(f"{path}: no header line that begins with FREQ: not a tape7 (.tp7) file")
    if any(NUMBER.search(text) for _, text in cards):
        raise Tape7Error(f"{path}:{cards[0][0]}: cards without a spectrum: the last run is not whole")
    return runs


def read_spectrum(run, lines, at, row):
    """Rows to the end mark; where the next run begins."""
    rows = []
    while True:
        where = f"{run.path}:{at + 1}"
        if at == len(lines):
            raise Tape7Error(f"{run}: the file ends before -9999.: the run is not whole")
        text = lines[at].rstrip()
        at += 1
        if re.match(r"\s*-9999\.", text):
            break
        if not text or re.match(r"\s*CM-1\b", text):
            continue
        if re.search(r"[*]|nan|inf", text, re.I) or re.search(r"[A-CF-Za-cf-z]", text):
            raise Tape7Error(f"{where}: not a row of numbers: {text.strip()[:60]}")
        freq, tau, depth, thermal, sun_top = row(text, where)
        try:
            numbers = [value_of(freq), value_of(tau)] + [value_of(t) for t in (depth, thermal, sun_top) if t is not None]
        except ValueError:
            raise Tape7Error(f"{where}: not a row of numbers: {text.strip()[:60]}") from None
        if not 0 <= numbers[1] <= 1.0001 or min(numbers) < 0:
            raise Tape7Error(f"{where}: a transmittance of {tau} or a negative number")
        if rows and numbers[0] <= rows[-1][0]:
            raise Tape7Error(f"{where}: {freq} 1/cm does not lie above that of the row before")
        rows.append((numbers[0], best_depth(tau, depth), *(np.nan if t is None else value_of(t) for t in (thermal, sun_top))))
    if len(rows) < 2:
        raise Tape7Error(f"{run}: {len(rows)} rows")
    run.wavenumber, run.depth, run.thermal, run.sun_top = np.array(rows).T
    if np.isnan(run.thermal).any():
        run.thermal = None
    if np.isnan(run.sun_top).any():
        run.sun_top = None
    return at
