"""Products against their reference, both ways: every field that a product has is a row of `pitviper help --markdown`, with
its type, and every row is in some product; a row that is never absent is there each time. And the lines of Python that
the reference shows run, on the products here.

    reference.py products.md [--run OUT | --truth OUT] ... [--sweep OUT] [--record CASE] ... [--score FOLDER] [--pdus TSV] [--capture PCAPNG [--live OUT]]
                 [--streams COUNT]
"""
import contextlib, glob, io, json, math, os, re, socket, struct, subprocess, sys, time

wrong = []
def check(good, *said):
    if not good: wrong.append(" ".join(map(str, said)))

# ---- the reference -------------------------------------------------------------------------------

class Row:
    def __init__(self, cells):
        self.path, self.type, self.unit, self.frame, self.absent, self.about = cells
        self.path = self.path.strip("`")
        self.found = 0

class Topic:
    def __init__(self, name): self.name, self.rows, self.words, self.python = name, {}, {}, None

def read_reference(path):
    topics, topic, code = {}, None, None
    for line in open(path).read().splitlines():
        if code is not None:
            if line == "```": topic.python, code = "\n".join(code) + "\n", None
            else: code.append(line)
        elif line.startswith("## "): topics[line[3:]] = topic = Topic(line[3:])
        elif line == "```python": code = []
        elif line.startswith("| `"):
            row = Row([c.strip().replace("\\|", "|") for c in re.split(r"(?<!\\)\|", line)[1:-1]])
            check(row.path not in topic.rows, topic.name, row.path, "has two rows")
            check(row.type and row.about, topic.name, row.path, "has no type, or says nothing")
            topic.rows[row.path] = row
        elif topic and (word := re.match(r"`([A-Z]+)`: (.*)$", line)):
            one_of = re.sub(r" \([^)]*\)", "", word[2])
            topic.words[word[1]] = set(re.findall(r"`([^`]+)`", one_of)) if one_of.startswith("one of") else None
    return topics

# ---- JSON ----------------------------------------------------------------------------------------

def is_type(value, type):
    plain = {"integer": int, "number": float, "string": str, "boolean": bool, "object": dict}
    if many := re.fullmatch(r"list of (?:(\d+) )?(\w+?)s", type):
        return (isinstance(value, list) and (not many[1] or len(value) == int(many[1])) and
                all(is_type(v, many[2]) for v in value))
    return type in plain and isinstance(value, plain[type]) and (type == "boolean") == isinstance(value, bool)

def tree_of(topic):
    root = {"row": None, "keys": {}, "item": None}
    for path, row in topic.rows.items():
        at = root
        for token in re.findall(r"[^.\[\]]+|\[\]", path):
            if token == "[]":
                at["item"] = at["item"] or {"row": None, "keys": {}, "item": None}
                at = at["item"]
            else: at = at["keys"].setdefault(token, {"row": None, "keys": {}, "item": None})
        at["row"] = row
    return root

def walk(topic, node, value, path, whole):
    if node["row"]:
        node["row"].found += 1
        check(is_type(value, node["row"].type), topic.name, path, "is no", node["row"].type, repr(value)[:60])
    if isinstance(value, dict):
        words = [k for k in node["keys"] if k in topic.words]
        for key, inside in value.items():
            take = key if key in node["keys"] and key not in topic.words else next(
                (w for w in words if topic.words[w] is None or key in topic.words[w]), None)
            if take is None: check(False, topic.name, f"{path}.{key}", "is not in the reference")
            else: walk(topic, node["keys"][take], inside, f"{path}.{key}", whole)
        for key, child in node["keys"].items():
            if key not in words and child["row"] and not child["row"].absent and whole:
                check(key in value, topic.name, f"{path}.{key}", "is absent, and the reference says that it never is")
    elif isinstance(value, list) and node["item"]:
        for k, inside in enumerate(value): walk(topic, node["item"], inside, f"{path}[{k}]", whole)
    elif isinstance(value, list): check(not any(isinstance(v, dict) for v in value), topic.name, path, "holds objects")

def take_json(topic, path, whole=True):
    tree = tree_of(topic)
    lines = open(path).read().splitlines() if path.endswith("l") else [open(path).read()]
    check(lines, path, "is empty")
    for line in lines: walk(topic, tree, json.loads(line), "", whole)

# ---- pictures and tables --------------------------------------------------------------------------

standard = {"channels", "compression", "dataWindow", "displayWindow", "lineOrder", "pixelAspectRatio",
            "screenWindowCenter", "screenWindowWidth"}  # of OpenEXR itself

def exr_fields(path):
    data, at, out = open(path, "rb").read(), 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<i", data, at)
        value, at = data[at + 4:at + 4 + size], at + 4 + size
        if name == b"channels":
            while value[0]:
                channel, value = value.split(b"\0", 1)
                out["channel", channel.decode()] = ("uint", "half", "float")[value[0]]
                value = value[16:]
        elif name.decode() not in standard: out["header", name.decode()] = kind.decode()
    return out

def take_exr(topic, path, prefix, header_prefix):
    rows = {}
    for row in topic.rows.values():
        what, name = row.path.split(" ", 1)
        head = prefix if what == "channel" else header_prefix
        if name.startswith(head): rows[what, name[len(head):]] = row
    found = exr_fields(path)
    for field, kind in found.items():
        check(field in rows, topic.name, path, *field, "is not in the reference")
        if field in rows:
            rows[field].found += 1
            check(rows[field].type == kind, topic.name, path, *field, "is", kind)
    for field, row in rows.items():
        check(row.absent or field in found, topic.name, path, *field, "is absent, and the reference says that it never is")

def take_png(topic, path, folder):
    bits, colour = struct.unpack(">BB", open(path, "rb").read()[24:26])
    kind = f"{'RGB' if colour == 2 else 'grey'} {bits} bit"
    check(folder in topic.rows, topic.name, path, "is not in the reference")
    if folder in topic.rows:
        row = topic.rows[folder]
        if row.type == kind: row.found += 1
        else: check(kind in row.absent, topic.name, path, "is", kind)

def take_table(topic, lines, between, whole):
    rows = [line.split(between) for line in lines if not line.startswith("#")]
    names = [row.path for row in topic.rows.values() if whole or not row.absent]
    check(rows[0] == names, topic.name, "has the columns", rows[0])
    pattern = {"integer": r"-?\d+", "number": r"-?\d*\.?\d+(e[+-]?\d+)?", "hexadecimal": r"(0x)?[0-9a-f]+", "text": r".*"}
    for row in rows[1:]:
        for name, value in zip(rows[0], row):
            if name in topic.rows:
                topic.rows[name].found += 1
                check(re.fullmatch(pattern[topic.rows[name].type], value), topic.name, name, "is no", topic.rows[name].type, value)
    check(len(rows) > 1, topic.name, "is empty")

# ---- Data PDUs ------------------------------------------------------------------------------------

def datagrams(path):
    """UDP payloads of a pcapng of ours, over IPv4."""
    data, at, link = open(path, "rb").read(), 0, 0
    while at + 12 <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind == 1: link, = struct.unpack_from("<H", data, at + 8)
        if kind == 6:
            kept, = struct.unpack_from("<I", data, at + 20)
            packet = data[at + 28:at + 28 + kept][{1: 14, 101: 0, 228: 0, 113: 16}[link]:]
            if packet[0] >> 4 == 4 and packet[9] == 17: yield packet[(packet[0] & 15) * 4 + 8:]
        at += size

def kind_of(pdu):
    fixed, = struct.unpack(">I", pdu[32:36])
    kind = dict(struct.unpack(">II", pdu[40 + 8 * i:48 + 8 * i]) for i in range(fixed))[600003]
    return {1: "data-pdu", 2: "data-pdu", 3: "stream-pdu", 4: "radar-pdu"}[kind]

width_of = {"u16": 2, "u32": 4, "f32": 4, "f64": 8, "text": None}
def take_data_pdus(topic, pdus):
    octets = {}
    for row in topic.rows.values():
        kind, many = re.fullmatch(r"(\w+)(?:\[(\d)\])?", row.type).groups()
        where, name = row.path.split(" ")
        number, offset = (name + "+0").split("+")[:2]
        octets.setdefault((where, int(number)), {})[int(offset)] = (width_of[kind] and width_of[kind] * int(many or 1), row)
    for pdu in pdus:
        fixed, variable = struct.unpack(">II", pdu[32:40])
        seen, at = [("fixed", *struct.unpack(">I", pdu[40 + 8 * i:44 + 8 * i]), 4) for i in range(fixed)], 40 + 8 * fixed
        for _ in range(variable):
            number, bits = struct.unpack(">II", pdu[at:at + 8])
            seen.append(("variable", number, bits // 8))
            at += 8 + (bits + 63) // 64 * 8
        check(at == len(pdu), topic.name, "ends at", at, "of", len(pdu))
        for where, number, size in seen:
            fields, end = octets.get((where, number)), 0
            check(fields, topic.name, where, number, "is not in the reference")
            for offset in sorted(fields or {}):
                check(offset == end, topic.name, number, "has a gap at", end)
                end = offset + (fields[offset][0] or size - offset)
                fields[offset][1].found += 1
            check(not fields or end == size, topic.name, number, "is of", size, "octets, the reference of", end)
        for (where, number), fields in octets.items():
            if number not in (600201, 600202, 600402):
                check((where, number) in [s[:2] for s in seen], topic.name, number, "is absent")

# ---- the lines of Python --------------------------------------------------------------------------

def runs(topic, folder, given="", least=1):
    """Its lines run in this folder and print."""
    here, stdin, said = os.getcwd(), sys.stdin, io.StringIO()
    try:
        os.chdir(folder)
        sys.stdin = io.StringIO(given)
        with contextlib.redirect_stdout(said): exec(compile(topic.python, topic.name, "exec"), {})
    except Exception as error: check(False, topic.name, "Python:", repr(error))
    finally:
        os.chdir(here)
        sys.stdin = stdin
    check(len(said.getvalue().splitlines()) >= least, topic.name, "Python prints", repr(said.getvalue()[:200]))
    return said.getvalue()

def runs_data_pdu(topic, pdus, prints):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    child = subprocess.Popen([sys.executable, "-c", topic.python.replace("('', 3000)", f"('127.0.0.1', {port})")],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    os.set_blocking(child.stdout.fileno(), False)
    said = ""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as to:
        for _ in range(300):  # until it listens, and has printed
            for pdu in pdus: to.sendto(pdu, ("127.0.0.1", port))
            time.sleep(0.05)
            said += (child.stdout.read() or b"").decode()
            if said or child.poll() is not None: break
    child.kill()
    check(re.match(prints, said), topic.name, "Python prints", repr(said), child.communicate()[1])

# ---- frames, units and index bases, where two products say one thing -----------------------------------

def near(a, b, within): return a == b or abs(a - b) <= within

def meaning_of_truth(out):
    """WGS 84 by its closed form; the rows of ecef_from_cam, the line of sight in ENU and the boresight error agree."""
    for frame in map(json.loads, open(f"{out}/truth.jsonl")):
        host, sensor = frame["host"], frame["sensors"][0]
        lat, lon, height = math.radians(host["lat_deg"]), math.radians(host["lon_deg"]), host["height_m"]
        e2 = (2 - 1 / 298.257223563) / 298.257223563
        n = 6378137 / math.sqrt(1 - e2 * math.sin(lat) ** 2)
        place = ((n + height) * math.cos(lat) * math.cos(lon), (n + height) * math.cos(lat) * math.sin(lon),
                 (n * (1 - e2) + height) * math.sin(lat))
        check(all(near(a, b, 1e-3) for a, b in zip(place, host["ecef_m"])), out, "host: lat, lon, height are not ecef_m")
        r = sensor["ecef_from_cam"]
        tangents = [math.tan(math.radians(sensor[f"{k}fov_deg"]) / 2) for k in "hv"]
        check("distortion" in sensor or near(tangents[0] / tangents[1], sensor["width_px"] / sensor["height_px"], 1e-6), out, "fov")
        for target in frame["targets"]:
            az, el = math.radians(target["los_az_deg"]), math.radians(target["los_el_deg"])
            east, north, up = math.cos(el) * math.sin(az), math.cos(el) * math.cos(az), math.sin(el)
            ecef = (-math.sin(lon) * east - math.sin(lat) * math.cos(lon) * north + math.cos(lat) * math.cos(lon) * up,
                    math.cos(lon) * east - math.sin(lat) * math.sin(lon) * north + math.cos(lat) * math.sin(lon) * up,
                    math.cos(lat) * north + math.sin(lat) * up)
            x, y, z = (sum(r[3 * k + axis] * ecef[k] for k in range(3)) for axis in range(3))
            said = math.degrees(math.atan2(x, z)), math.degrees(math.atan2(-y, z))
            check(all(near(a, b, 1e-6) for a, b in zip(said, target["boresight_error_deg"])), out, "line of sight", said, target)
            check(near(target["depression_deg"], -target["los_el_deg"], 1e-9), out, "depression")

def meaning_of_data_pdus(out, topic, pdus):
    """Each target of a truth PDU is the target of truth.jsonl, in the units of both."""
    same = {8: "box_px", 16: "pixels", 20: "visible_fraction", 24: "range_m", 28: "closing_mps", 32: "aspect_deg",
            36: "los_az_deg", 40: "los_el_deg", 44: "boresight_error_deg", 48: "boresight_error_deg"}
    truth, held = {t["frame"]: t for t in map(json.loads, open(f"{out}/truth.jsonl"))}, 0
    for pdu in pdus:
        fixed, variable = struct.unpack(">II", pdu[32:40])
        datum, at = dict(struct.unpack(">II", pdu[40 + 8 * i:48 + 8 * i]) for i in range(fixed)), 40 + 8 * fixed
        frame = truth.get(datum[600001])
        for _ in range(variable if frame else 0):
            number, bits = struct.unpack(">II", pdu[at:at + 8])
            value, at = pdu[at + 8:at + 8 + bits // 8], at + 8 + (bits + 63) // 64 * 8
            if number == 600101: check(struct.unpack(">d", value) == (frame["time_s"],), topic.name, "time_s")
            if number == 600102: check(near(math.dist(struct.unpack(">3d", value), frame["host"]["ecef_m"]), 0, 1e-6), topic.name, "eye")
            if number != 600202: continue
            name = "%d:%d:%d" % struct.unpack(">3H", value[:6])
            target = [t for t in frame["targets"] if t["entity"] == name]
            check(target, topic.name, name, "is no target of truth.jsonl")
            for offset, key in same.items() if target else ():
                row = topic.rows[f"variable 600202+{offset}"]
                if offset == 8: got, want = list(struct.unpack(">4H", value[8:16])), target[0].get(key, [0, 0, 0, 0])
                else:
                    got, want = struct.unpack(">f", value[offset:offset + 4])[0], target[0].get(key, math.nan)
                    if isinstance(want, list): want = want[offset == 48]
                    if row.unit == "rad": got = math.degrees(got)
                good = got == want if offset == 8 else near(got, want, 1e-5 * max(1, abs(want))) or math.isnan(got) and math.isnan(want)
                check(good, topic.name, name, key, got, "is not", want)
                held += 1
    check(held, topic.name, "no target of a PDU is one of", out)

# ---- all of it ------------------------------------------------------------------------------------

def take_run(topics, out, lines_of):
    take_json(topics["truth"], f"{out}/truth.jsonl")
    take_json(topics["run.json"], f"{out}/run.json")
    for path in glob.glob(f"{out}/**/frames/*/*.exr", recursive=True):
        take_exr(topics["exr"], path, path.split("/")[-2] + "/", "")
    for name, parent in (("png", "frames"), ("raw", "raw")):
        for path in glob.glob(f"{out}/**/{parent}/*/*.png", recursive=True): take_png(topics[name], path, path.split("/")[-2])
    for path in glob.glob(f"{out}/latest/*.png"): take_png(topics["png"], path, path.split("/")[-1][:-4])
    for path in glob.glob(f"{out}/profiles/radar/*.csv"):
        take_table(topics["profile"], open(path).read().splitlines(), ",", True)
    for path in glob.glob(f"{out}/radar/*.csv"):
        take_table(topics["radar-azimuths" if "_dbs" in path else "radar"], open(path).read().splitlines(), ",", True)
    for path in glob.glob(f"{out}/radar/??????.exr"): take_exr(topics["radar-map"], path, "", "")
    for path in glob.glob(f"{out}/radar/??????_*.exr"): take_exr(topics["radar-scan"], path, path[:-4].split("/")[-1][7:] + "/", "")
    for name, file in (("pairs", "pairs.jsonl"), ("coco", "coco.json"), ("answers", "answers.jsonl")):
        if os.path.exists(f"{out}/{file}"): take_json(topics[name], f"{out}/{file}")
    known = r"(pairs/\w+/)?(frames|raw|profiles)/\w+/\d{6}\.(exr|png|csv)|radar/\d{6}(_scan|_dbs|_view|_view_scan|_view_dbs)?\.(exr|png|csv)|latest/\w+\.png|(truth|pairs|answers)\.jsonl|(run|coco|variant)\.json|settings\.yaml|log\.txt|thumbnail\.png"
    for path in glob.glob(f"{out}/**", recursive=True):
        if os.path.isfile(path): check(re.fullmatch(known, os.path.relpath(path, out)), path, "is no product of the reference")
    meaning_of_truth(out)
    for name in lines_of: runs(topics[name], out)

def take_sweep(topics, out):
    take_json(topics["manifest"], f"{out}/manifest.jsonl")
    if os.path.exists(f"{out}/coco.json"): take_json(topics["coco"], f"{out}/coco.json")
    for path in glob.glob(f"{out}/*/variant.json"): take_json(topics["manifest"], path)
    page, sheet = open(f"{out}/manifest.html").read(), topics["sheet"]
    variants = sum(1 for _ in open(f"{out}/manifest.jsonl"))
    for row in sheet.rows.values():
        row.found = len(re.findall(f"<{row.path.split('/')[-1]}[ >]", page))
        check(row.found == variants or row.absent, sheet.name, row.path, row.found, "times")
    runs(topics["manifest"], out, least=variants)
    runs(sheet, out)

def take_record(topics, case, all_lines):
    topic = topics["regress-record"]
    for path in glob.glob(f"{case}/record/??????.exr"): take_exr(topic, path, "frame/", "frame/")
    for path in glob.glob(f"{case}/record/*.profile.exr"): take_exr(topic, path, "profile/", "profile/")
    take_json(topics["truth"], f"{case}/record/truth.jsonl")
    take_json(topics["run.json"], f"{case}/record/run.json", whole=False)
    if all_lines and (said := runs(topic, case)):
        import numpy, OpenEXR  # what it decodes is the run's picture, to the steps of the record
        name, mean = re.match(r"record/(\d+)\.exr ([0-9.e+-]+) ", said).groups()
        want = OpenEXR.File(f"{case}/out/frames/lwir/{name}.exr", separate_channels=True).channels()["Y"].pixels.mean()
        check(abs(float(mean) / want - 1) < 2 ** -12, topic.name, "decodes to", mean, "of", want)

def main():
    topics, pdus, has_streams = read_reference(sys.argv[1]), [], True
    first = {}
    for what, path in zip(sys.argv[2::2], sys.argv[3::2]):
        begin = first.setdefault(what, True)
        first[what] = False
        every = ("truth", "run.json", "exr", "png", "raw", "profile", "radar", "radar-map", "radar-scan", "radar-azimuths", "pairs", "coco", "answers")
        if what == "--run": take_run(topics, path, every if begin else ())
        elif what == "--truth": take_run(topics, path, ["truth"])
        elif what == "--sweep": take_sweep(topics, path)
        elif what == "--record": take_record(topics, path, begin)
        elif what == "--score":
            take_json(topics["score.json"], f"{path}/score.json")
            runs(topics["score.json"], path)
        elif what == "--pdus":
            take_table(topics["pdus"], open(path).read().splitlines(), "\t", begin)
            runs(topics["pdus"], ".", given=open(path).read())
        elif what == "--capture": pdus += [p for p in datagrams(path) if len(p) > 40 and p[2] == 20]
        elif what == "--live": meaning_of_data_pdus(path, topics["data-pdu"], [p for p in pdus if kind_of(p) == "data-pdu"])
        elif what == "--streams": has_streams = path != "0"  # 0: built without FFmpeg's libraries
    if pdus:
        for name, prints in (("data-pdu", r"\d+ \d+ \(\d+, \d+, \d+\) \d+\.\d+"), ("stream-pdu", r"\d+ udp://127\.0\.0\.1:\d+\n"),
                             ("radar-pdu", r"\d+ \d+\.\d+ -?\d")):
            these = [p for p in pdus if kind_of(p) == name]
            if name == "stream-pdu" and not has_streams:
                for row in topics[name].rows.values(): row.found += 1
                continue
            check(these, name, "none is sent")
            take_data_pdus(topics[name], these)
            runs_data_pdu(topics[name], pdus, prints)
    rows = [(t, r) for t in topics.values() for r in t.rows.values()]
    # counters of a flood are written when they count: their rows say so
    source = open("sensor/node/run/run_counters.c").read() + open("sensor/score/track_fields.c").read()
    for topic, row in rows:
        if row.absent == "when 0": check(re.search(r'\{"%s",[^{}]*\.unless_0' % row.path.split(".")[-1], source), topic.name, row.path, "is never written")
        elif row.path == "given_up": continue  # whether a live frame gives anything up is the machine's business: tests/sensor/test_frame_verdict.c writes it
        elif row.path == "recognisers[].tracks.idf1_most": continue  # of more tracks than are kept: tests/sensor/test_tracks.c
        # by chance, of a live node that lasts: tests/system/test_live_radar.sh has both
        # of a display whose refresh rate is known: Xvfb and SDL's dummy have none
        elif row.path.startswith("counters.projector.off_refresh_ms"): continue
        elif row.path in ("counters.frames_of_coarse_radar", "counters.live.ready_s"): continue
        else: check(row.found, topic.name, row.path, "is in the reference and in no product")
    for line in sorted(set(wrong))[:2000]: print("FAILED:", line)
    print(len(topics), "topics,", len(rows), "rows")
    sys.exit(1 if wrong or len(rows) < 200 else 0)

main()
