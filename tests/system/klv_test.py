#!/usr/bin/env python3
"""What test_klv*.sh check of metadata: klv_test.py (CHECK ARGUMENT...)... Values come from klv_decode's readers.

samples DATA        the readers themselves, on packets that others made (folder data/klv)
pose OUT            the chain of angles against truth.jsonl's camera, and ST 0903 against its targets
atr OUT             a recogniser's answers, in three forms, as records and as ST 0903; sent by: klv_test.py send PORT OUT COMMAND...
same OUT OTHER      the answers of OTHER, which are those of OUT sent by: klv_test.py again PORT OUT COMMAND...
ground OUT TIF CRS  frame centre and corners against rays marched through the elevation file itself, from the pose that
                    is in the metadata; positions by gdaltransform (PROJ), heights by gdal_translate. The range plane too

Prints what failed; exit 0: nothing.
"""
import json, math, os, socket, subprocess, sys, tempfile, time

import klv_decode
from klv_answers import BOXES, FORMS, RANGE_M, as_json, as_klv, as_ring, ecef, image_of, sight_of, times_us

failures = []


def check(what, ok):
    if not ok:
        failures.append(what)
        print("FAILED: " + what)


def near(what, got, want, tolerance):
    check("%s: %r, want %r +- %g" % (what, got, want, tolerance),
          got is not None and want is not None and abs(got - want) <= tolerance)


def packets(path, found, lax=False):
    with open(path, "rb") as file:
        return list(klv_decode.decode(file.read(), found, lax))


# ---- the readers ----------------------------------------------------------------------------------

# The standard's worked example: tag, value as printed there.
EXAMPLE = {"5": 159.97436, "6": -0.43153, "7": 3.40586, "13": 60.176822967, "14": 128.426759042, "15": 14190.7195,
           "16": 144.571298, "17": 152.643626, "18": 160.7192114, "19": -168.7923248, "21": 68590.98, "22": 722.8199,
           "23": -10.5423886, "24": 29.1578901, "25": 3216.0372}


def samples(data, found):
    with open(data + "/st0601-dynamic-constant.klv", "rb") as file:
        octets = file.read()
    # its checksum is that of the example before some of its values were changed
    octets = octets[:-2] + klv_decode.checksum(octets[:-2]).to_bytes(2, "big")
    one = list(klv_decode.decode(octets, found))
    check("the worked example is one packet", len(one) == 1)
    for tag, value in EXAMPLE.items():
        for name in ("klvdata", "stanag4609"):
            near("worked example, %s, tag %s" % (name, tag), one[0][name][tag], value, 1e-6 * abs(value) + 1e-5)
    series = packets(data + "/st0903-jmisb.bin", found, True)
    check("ST 0903 samples: five packets", len(series) == 5)
    first = series[0]["tstrans"]["vmti"]
    check("ST 0903 sample: its frame", [first["frame_width"], first["frame_height"]] == [1000, 600])
    check("ST 0903 sample: its targets", [t["centroid_pixel"] for t in first["targets"]] == [387602, 352205])
    near("worked example, tstrans", one[0]["tstrans"]["sensor_rel_az_deg"], EXAMPLE["18"], 1e-4)


# ---- pose and targets -------------------------------------------------------------------------------

def matrix(yaw, pitch, roll):
    """Axes forward, right, down (columns) in the frame that they are turned in."""
    (cy, sy), (cp, sp), (cr, sr) = ((math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (yaw, pitch, roll))
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr]]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def camera(k):
    """Place, and axes of the sensor (forward, right, down: columns) in ECEF: tags 5, 90, 91, 13, 14, 75, 18 .. 20."""
    lat, lon = math.radians(k["13"]), math.radians(k["14"])
    ned = [[-math.sin(lat) * math.cos(lon), -math.sin(lon), -math.cos(lat) * math.cos(lon)],
           [-math.sin(lat) * math.sin(lon), math.cos(lon), -math.cos(lat) * math.sin(lon)],
           [math.cos(lat), 0, -math.sin(lat)]]
    platform = times(ned, matrix(k["5"], k["90"], k["91"]))
    return ecef(k["13"], k["14"], k["75"]), times(platform, matrix(k["18"], k["19"], k["20"]))


def truth_lines(out):
    with open(out + "/truth.jsonl") as file:
        return [json.loads(line) for line in file]


def some_klv(out):
    return sorted(out + "/" + name for name in os.listdir(out) if name.endswith(".klv"))


def minimum(path):
    """ST 0902, the minimum set, but for what is the operator's: security (48) and the core identifier (94)."""
    from stanag4609.st0601 import decode_uas_local_set
    from stanag4609.st0902 import validate_mismms_current_state as validate
    with open(path, "rb") as file:
        for _, whole, items in klv_decode.packets(file.read()):
            if 21 in [tag for tag, _ in items]:  # the centre is on the ground
                issues = validate(decode_uas_local_set(whole), require_security=False, require_miis=False)
                check("minimum metadata: %s" % [i.message for i in issues], not issues)


def pose(out, found):
    truth = truth_lines(out)
    boxes = 0
    for path in some_klv(out):
        made = packets(path, found)
        minimum(path)
        check("%s: a packet for each frame" % path, len(made) == len(truth) > 0)
        times_us = [p["klvdata"]["2"] for p in made]
        for i in range(1, len(made)):
            near("time stamps follow exercise time", times_us[i] - times_us[0],
                 1e6 * (truth[i]["time_s"] - truth[0]["time_s"]), 2)
        for p, line in zip(made, truth):
            k, sensor = p["klvdata"], line["sensors"][0]
            place, axes = camera(k)
            near("sensor position", math.dist(place, line["host"]["ecef_m"]), 0, 0.2)
            near("sensor height above the ellipsoid", k["75"], line["host"]["height_m"], 0.16)
            m = sensor["ecef_from_cam"]  # columns right, down, forward
            for name, want, got in (("right", 0, 1), ("down", 1, 2), ("forward", 2, 0)):
                turned = sum(m[3 * i + want] * axes[i][got] for i in range(3))
                near("axis %s: angle in degrees" % name, math.degrees(math.acos(min(1, turned))), 0, 0.006)
            near("horizontal field of view", k["16"], sensor["hfov_deg"], 0.0014)
            near("vertical field of view", k["17"], sensor["vfov_deg"], 0.0014)
            check("platform, call sign, mode", k["59"] == line["host"]["marking"] and k["77"] == "\x03")
            boxes += vmti(p["stanag4609"]["vmti"], p["klvdata"], line)
            both(p["tstrans"]["vmti"], p["stanag4609"]["vmti"])
    check("targets were compared", boxes > 0)


def vmti(got, k, line):
    """Of one packet against one line of truth; how many boxes."""
    fields, sensor = got["fields"], line["sensors"][0]
    width, height = sensor["width_px"], sensor["height_px"]
    seen = [t for t in line["targets"] if "box_px" in t and t["pixels"] > 0]
    check("VMTI: marked as truth", "truth" in fields["3"].lower() and fields["4"] == 6)
    check("VMTI: time of the packet", fields["2"] == k["2"])
    check("VMTI: frame number", fields["7"] == line["frame"])
    check("VMTI: counts", fields["5"] == len(seen) and fields["6"] == len(got["targets"]) == min(len(seen), 64))
    check("VMTI: frame size", [fields["8"], fields["9"]] == [width, height])
    near("VMTI: horizontal field of view", fields["11"], sensor["hfov_deg"], 0.006)
    near("VMTI: vertical field of view", fields["12"], sensor["vfov_deg"], 0.006)
    check("VMTI: sensor", fields["10"] == k["11"])
    ids = {(int(s) << 32) + (int(a) << 16) + int(e): t for t in seen for s, a, e in [t["entity"].split(":")]}
    sizes = []
    for t in got["targets"]:
        want = ids[t["id"]]
        left, top, right, bottom = want["box_px"]
        first, last = divmod(t["2"] - 1, width), divmod(t["3"] - 1, width)
        check("VMTI: box of %s" % want["entity"], [first[1], first[0], last[1] + 1, last[0] + 1] == want["box_px"])
        row, column = divmod(t["1"] - 1, width)
        check("VMTI: centroid", column == (left + right) // 2 and row == (top + bottom) // 2)
        percent = 100 * want["pixels"] / ((right - left) * (bottom - top))
        near("VMTI: percentage", t["7"], min(100, max(1, percent)), 0.51)
        check("VMTI: no confidence in truth", "5" not in t)
        label = [o["label"] for o in got["ontologies"] if o["ontology_id"] == t["107"][0]["ontology_id"]]
        check("VMTI: class", label == [want["class"]])
        iri = [o["entity_iri"] for o in got["ontologies"] if o["label"] == want["class"]]
        check("VMTI: ontology says truth", iri == ["urn:pitviper:truth:" + want["class"]])
        check("VMTI: algorithm says truth", [a["name"] for a in got["algorithms"]] == ["truth"] and t["22"] == 1)
        place = t["17"]
        distance = math.dist(ecef(place["latitude"], place["longitude"], place["hae"]), line["host"]["ecef_m"])
        near("VMTI: distance of its location", distance, want["range_m"], 4)
        sizes.append(want["pixels"])
    check("VMTI: largest first", sizes == sorted(sizes, reverse=True))
    return len(sizes)


def both(a, b):
    """Two readers of ST 0903 agree."""
    names = "target_id", "bbox_top_left_pixel", "bbox_bottom_right_pixel"
    check("VMTI: readers agree",
          [[t[n] for n in names] for t in a["targets"]] == [[t["id"], t.get("2"), t.get("3")] for t in b["targets"]])


# ---- a recogniser's answers -------------------------------------------------------------------------------

def send(port, out, command):
    """Runs a command; answers each frame once its line of truth is there, in one form or another. Its code."""
    child = subprocess.Popen(command)
    to, done = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), 0
    while child.poll() is None:
        time.sleep(0.005)
        try:
            with open(out + "/truth.jsonl") as file:
                lines = file.read().split("\n")[:-1]
            times = times_us(out)
        except OSError:
            continue
        lines = [json.loads(line) for line in lines[:len(times)]]
        for line, time_us in zip(lines[done:], times[done:]):
            made = [as_ring(line), as_json(line), as_klv(line, time_us)][line["frame"] % 3]
            for octets in (made[:-1], made, made):  # one that is cut, one that is repeated
                to.sendto(octets, ("127.0.0.1", int(port)))
        done = len(lines)
    return child.returncode


def again(port, out, command):
    """Runs a command; meanwhile sends it the answers of another run, as the manual has it. Its code."""
    with open("etc/reference/answers.md") as file:
        one, lines = (text.split("```")[0] for text in file.read().split("```python\n")[1:])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sink:
        sink.bind(("127.0.0.1", 0))
        sink.settimeout(60)
        exec(one.replace("3456", str(sink.getsockname()[1])), {})
        said = json.loads(sink.recv(65536))
        check("the manual's answer", said["frame"] == 12 and said["detections"][0]["box_px"] == [288, 214, 436, 272])
    lines = lines.replace("out/answers.jsonl", out + "/answers.jsonl").replace("3456", port)
    child = subprocess.Popen(command)
    while child.poll() is None:
        exec(lines, {})
        time.sleep(0.03)
    return child.returncode or len(failures)


def same_answers(out, other):
    """The answers of `other` are those of `out`, sent back: as many as it had time for."""
    kept = [[{k: v for k, v in json.loads(line).items() if k not in ("latency_ms", "age_ms", "late", "form")}
             for line in open(path + "/answers.jsonl")] for path in (out, other)]
    check("answers sent back: %d lines, %d again" % (len(kept[0]), len(kept[1])), len(kept[1]) >= len(kept[0]) / 2 > 3)
    check("answers sent back are as they were: %s" % [l for l in kept[1] if l not in kept[0]][:1],
          all(line in kept[0] for line in kept[1]))


def record_of(line):
    """What does not depend on the frame, how it came, and when."""
    return {k: v for k, v in line.items() if k not in ("frame", "time_s", "latency_ms", "age_ms", "los_deg", "range_m", "form")}


def atr(out, found):
    truth = {line["frame"]: line for line in truth_lines(out)}
    width = truth[0]["sensors"][0]["width_px"]
    made = [p["stanag4609"] for p in packets(out + "/lwir.klv", found)]
    with_targets = [p["vmti"] for p in made if "vmti" in p]
    check("detections are in most packets: %d of %d" % (len(with_targets), len(made)), 2 * len(with_targets) > len(made))
    for v in with_targets:
        fields, t = v["fields"], v["targets"]
        column, row = image_of(truth[fields["7"]]["sensors"][0])
        check("detections: no truth", fields["3"] == "Pitviper ATR" and not any("truth" in str(o) for o in v["ontologies"]))
        check("detections: counts", fields["5"] == fields["6"] == len(t) == 3)
        check("detections: of the frame they were found in", fields["2"] == made[fields["7"]]["2"])
        check("detections: id, box and confidence",
              [t[0]["id"], t[0]["2"], t[0]["3"], t[0]["5"]] == [9, 4 * width + 3 + 1, 9 * width + 20 + 1, 75])
        check("detections: a line of sight is its pixel, through the lens: %s" % t[2],
              [t[2]["1"], t[2]["5"]] == [int(row) * width + int(column) + 1, 25] and "2" not in t[2])
        check("detections: classes", [o["label"] for o in v["ontologies"]] == ["tank", "truck", "jeep"])
    own = list(klv_decode.decode(as_klv(truth[0], 1), found))
    check("answers: what is sent as ST 0903 is so for its readers", [p["set"] for p in own] == ["0903"] and
          [t["id"] for t in own[0]["stanag4609"]["vmti"]["targets"]][0] == 9)
    # the same detections in all forms are the same record
    with open(out + "/answers.jsonl") as file:
        lines = [json.loads(line) for line in file]
    want = [{"band": "lwir", "answer": k + 1, "of": 3, "class": name, "box_px": box, "score": score, "track": track, "late": False}
            for k, (name, box, score, track) in enumerate(BOXES)]
    want.append({"band": "lwir", "answer": 3, "of": 3, "class": "jeep", "score": 0.25, "late": False})
    del want[1]["track"]
    check("answers: each form came: %s" % [l["form"] for l in lines], {l["form"] for l in lines} == set(FORMS))
    for line in lines:
        check("answers: frame %d by %s" % (line["frame"], line["form"]), line["form"] == FORMS[line["frame"] % 3])
        check("answers: %s is the record" % line, record_of(line) == want[line["answer"] - 1])
        check("answers: %s has its times" % line, line["age_ms"] > line["latency_ms"] > 0)
        if line["answer"] < 3:
            continue
        sensor, (az, el, _) = truth[line["frame"]]["sensors"][0], sight_of(truth[line["frame"]])
        step = 1.1 * sensor["hfov_deg"] / width if line["form"] == "klv" else 3e-5  # to a pixel's middle; a float
        near("answers: azimuth by " + line["form"], line["los_deg"][0], az, step)
        near("answers: elevation by " + line["form"], line["los_deg"][1], el, step)
        near("answers: range by " + line["form"], line["range_m"], RANGE_M, 1.1 if line["form"] == "klv" else 0)
    with open(out + "/run.json") as file:
        counted = json.load(file)["counters"]["answers"]
    for form in FORMS:
        c, came = counted["forms"][form], sum(l["form"] == form and l["answer"] == 1 for l in lines)
        cut, repeated = (c["refused"].get(why, 0) for why in ({"ring": "size", "json": "json", "klv": "local_set"}[form], "repeated"))
        # the last frame's three may meet the end of the run
        check("answers: counters of %s: %s" % (form, c), c["taken"] == came and 0 <= cut - came <= 1 and 0 <= came - repeated <= 1)


# ---- on the ground --------------------------------------------------------------------------------

def transform(points, source, target):
    text = "\n".join("%.9f %.9f %.6f" % tuple(p) for p in points)
    said = subprocess.run(["gdaltransform", "-s_srs", source, "-t_srs", target], input=text, capture_output=True,
                          text=True, check=True).stdout
    return [[float(x) for x in line.split()] for line in said.splitlines()]


class Raster:
    def __init__(self, path):
        import numpy
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["gdal_translate", "-q", "-of", "ENVI", "-ot", "Float32", path, folder + "/x"], check=True)
            said = subprocess.run(["gdalinfo", "-json", folder + "/x"], capture_output=True, check=True).stdout
            info = json.loads(said)
            self.width, self.height = info["size"]
            self.values = numpy.fromfile(folder + "/x", "<f4").reshape(self.height, self.width)
        self.x0, self.dx, _, self.y0, _, self.dy = info["geoTransform"]

    def at(self, x, y):
        """Bilinear between the centres of pixels; None: outside."""
        c, r = (x - self.x0) / self.dx - 0.5, (y - self.y0) / self.dy - 0.5
        i, j = math.floor(c), math.floor(r)
        if not (0 <= i < self.width - 1 and 0 <= j < self.height - 1):
            return None
        u, v, z = c - i, r - j, self.values
        north, south = (z[k, i] * (1 - u) + z[k, i + 1] * u for k in (j, j + 1))
        return float(north * (1 - v) + south * v)


def marches(rays, raster, crs, step):
    """Of rays (origin ECEF, unit direction, near, far): where each meets the raster first, (x, y, height, range)."""
    points, lengths = [], []
    for origin, direction, low, high in rays:
        lengths.append([low + step * n for n in range(int((high - low) / step))])
        points += [[o + t * d for o, d in zip(origin, direction)] for t in lengths[-1]]
    placed, out = iter(transform(points, "EPSG:4978", crs)), []
    for ranges in lengths:
        before, hit = None, None
        for t in ranges:
            x, y, z = next(placed)
            ground = raster.at(x, y)
            above = None if ground is None else z - ground
            if hit is None and above is not None and above <= 0 and before:
                share = before[1] / (before[1] - above)
                hit = [b + share * (a - b) for a, b in zip((x, y, z, t), before[2])]
            before = None if above is None else (t, above, (x, y, z, t))
        out.append(hit)
    return out


def plane_at(path, column, row):
    said = subprocess.run(["oiiotool", path, "--cut", "1x1+%d+%d" % (column, row), "--printstats"], capture_output=True,
                          text=True, check=True).stdout
    return float(said.split("Stats Avg:")[1].split()[0])


def ground(out, tif, crs, found):
    raster, worst, worst_exact, worst_range = Raster(tif), 0, 0, 0
    truth = truth_lines(out)
    made = packets(some_klv(out)[0], found)
    for p, line in zip(made, truth):
        k = p["klvdata"]
        sensor = line["sensors"][0]
        names = ["centre", "upper left", "upper right", "lower right", "lower left"]
        tags = [("23", "24"), ("82", "83"), ("84", "85"), ("86", "87"), ("88", "89")]
        near("slant range of the frame", k["21"], 3000, 300)
        origin, axes = camera(k)
        m = sensor["ecef_from_cam"]
        exact = [[m[3 * i + 2], m[3 * i], m[3 * i + 1]] for i in range(3)]
        across, down = math.tan(math.radians(k["16"] / 2)), math.tan(math.radians(k["17"] / 2))
        tan_exact = [math.tan(math.radians(sensor[f] / 2)) for f in ("hfov_deg", "vfov_deg")]
        rays, rays_exact = [], []
        for right, below in ((0, 0), (-1, -1), (1, -1), (1, 1), (-1, 1)):
            for list_, a, o, t in ((rays, axes, origin, (across, down)),
                                   (rays_exact, exact, line["host"]["ecef_m"], tan_exact)):
                d = [a[i][0] + right * t[0] * a[i][1] + below * t[1] * a[i][2] for i in range(3)]
                n = math.sqrt(sum(x * x for x in d))
                # 400 m before its end the ray is some 200 m above the highest ground of the file
                list_.append((o, [x / n for x in d], k["21"] - 400, k["21"] + 400))
        hits = marches(rays + rays_exact, raster, crs, 2)
        claimed = transform([[k[lon], k[lat], 0] for lat, lon in tags], "EPSG:4979", crs)
        for n in range(5):
            for hit, what in ((hits[n], "from the metadata"), (hits[5 + n], "from the pose")):
                if hit is None:
                    check("%s %s: the ray meets the file's ground" % (names[n], what), False)
                    continue
                error = math.dist(hit[:2], claimed[n][:2])
                if what == "from the pose":
                    worst_exact = max(worst_exact, error)
                else:
                    worst = max(worst, error)
                near("%s, marched %s: metres apart" % (names[n], what), error, 0, 1)
        near("height of the frame centre above sea level", k["25"], hits[0][2], 0.6)
        near("slant range", k["21"], hits[5][3], 1)
        # the centre pixel of an odd size: its middle is the boresight
        path = "%s/pairs/background/frames/truth/%06d.exr" % (out, line["frame"])
        check("range plane %s" % path, os.path.exists(path))
        ranged = plane_at(path, sensor["width_px"] // 2, sensor["height_px"] // 2)
        worst_range = max(worst_range, abs(ranged - k["21"]))
        near("range plane at the centre", ranged, k["21"], 0.01)
    print("%d frames: %.2f m from rays marched with the metadata's pose, %.2f m with the exact one; range plane %.4f m"
          % (len(made), worst, worst_exact, worst_range))


def main(arguments):
    if arguments[0] in ("send", "again"):
        return (send if arguments[0] == "send" else again)(arguments[1], arguments[2], arguments[3:])
    if arguments[0] == "same":
        same_answers(arguments[1], arguments[2])
        return 1 if failures else 0
    found = klv_decode.readers()
    checks = {"samples": samples, "pose": pose, "atr": atr, "ground": ground}
    starts = [i for i, a in enumerate(arguments) if a in checks]
    for start, end in zip(starts, starts[1:] + [len(arguments)]):
        checks[arguments[start]](*arguments[start + 1:end], found)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
