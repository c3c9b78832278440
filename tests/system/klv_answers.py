"""A recogniser's answer to a frame, in each form, from its line of truth.jsonl: for klv_test.py."""
import json, math, struct

import klv_decode


def ecef(lat, lon, h):
    a, f = 6378137.0, 1 / 298.257223563
    e2, s, c = f * (2 - f), math.sin(math.radians(lat)), math.cos(math.radians(lat))
    n = a / math.sqrt(1 - e2 * s * s)
    east = math.radians(lon)
    return [(n + h) * c * math.cos(east), (n + h) * c * math.sin(east), (n * (1 - e2) + h) * s]


FORMS = "ring", "json", "klv"  # of frame n: that of n modulo 3
BOXES = [("tank", [3, 4, 21, 10], 0.75, 9), ("truck", [1, 1, 5, 5], 0.5, 0)]
SIGHT = 0.045, -0.03  # tangents right and down of a third detection's line of sight, without a box
RANGE_M = 900
MIIS = "0170F592F02373364AF8AA9162C00F2EB2DA16B74341000841A0BE365B5AB96A3645"  # an id of a platform: no concern of ours


def image_of(sensor):
    """Column and row of SIGHT, through the lens: OpenCV's model, which truth.jsonl has."""
    x, y = SIGHT
    k1, k2, p1, p2, k3 = sensor.get("distortion", [0] * 5)
    r2 = x * x + y * y
    g = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    focal = sensor["width_px"] / 2 / math.tan(math.radians(sensor["hfov_deg"] / 2))
    return (sensor["width_px"] / 2 + focal * (x * g + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)),
            sensor["height_px"] / 2 + focal * (y * g + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y))


def sight_of(line):
    """Azimuth and elevation of SIGHT at the sensor, degrees; its unit vector in ECEF."""
    m, host = line["sensors"][0]["ecef_from_cam"], line["host"]
    n = math.sqrt(SIGHT[0] ** 2 + SIGHT[1] ** 2 + 1)
    u = [(m[3 * i] * SIGHT[0] + m[3 * i + 1] * SIGHT[1] + m[3 * i + 2]) / n for i in range(3)]
    lat, lon = math.radians(host["lat_deg"]), math.radians(host["lon_deg"])
    east = -math.sin(lon) * u[0] + math.cos(lon) * u[1]
    level = math.cos(lon) * u[0] + math.sin(lon) * u[1]
    north, up = math.cos(lat) * u[2] - math.sin(lat) * level, math.sin(lat) * u[2] + math.cos(lat) * level
    return math.degrees(math.atan2(east, north)) % 360, math.degrees(math.asin(up)), u


def geodetic(p):
    """Latitude, longitude in degrees, height: the place whose ecef() is p, by Newton's way on the three."""
    at = [math.degrees(math.asin(p[2] / math.hypot(*p))), math.degrees(math.atan2(p[1], p[0])), 0.0]
    for _ in range(20):
        lat, lon = math.radians(at[0]), math.radians(at[1])
        d = [a - b for a, b in zip(p, ecef(*at))]
        up = (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat))
        north = (-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat))
        at[2] += sum(a * b for a, b in zip(d, up))
        at[0] += math.degrees(sum(a * b for a, b in zip(d, north)) / 6.4e6)
        at[1] += math.degrees((-math.sin(lon) * d[0] + math.cos(lon) * d[1]) / (6.4e6 * math.cos(lat)))
    return at


def as_ring(line):
    az, el, _ = sight_of(line)
    found = [struct.pack("=5fI32s3fI2I", *box, score, track, name.encode(), 0, 0, 0, 0, 0, 0)
             for name, box, score, track in BOXES]
    found.append(struct.pack("=5fI32s3fI2I", 0, 0, 0, 0, 0.25, 0, b"jeep", math.radians(az), math.radians(el), RANGE_M,
                             3, 0, 0))
    head = struct.pack("=8sIHHiIII", b"PVDETECT", 0x01020304, 3, 80, line["frame"], 2, len(found), 0)
    return head + b"".join(found)


def as_json(line):
    az, el, _ = sight_of(line)
    found = [{"class": name, "box_px": box, "score": score, "track": track} for name, box, score, track in BOXES]
    found.append({"class": "jeep", "score": 0.25, "los_deg": [az, el], "range_m": RANGE_M})
    return json.dumps({"frame": line["frame"], "band": "lwir", "detections": found}).encode()


def times_us(out):
    """The time stamps of the packets so far, of which each frame has one: the first item."""
    with open(out + "/lwir.klv", "rb") as file:
        made = file.read().split(klv_decode.UAS)[1:]
    at = [m.find(b"\2\x08") + 2 for m in made]  # behind a length of one to three octets
    return [int.from_bytes(m[a:a + 8], "big") for m, a in zip(made, at) if 3 <= a <= 5 and len(m) >= a + 8]


def as_klv(line, time_us):
    """By the standard's tables: VTargets of boxes, one of a centroid and a place, their classes in an ontology series."""
    sensor, (_, _, u) = line["sensors"][0], sight_of(line)
    width = sensor["width_px"]

    def item(tag, octets):
        return bytes([tag, len(octets)]) + octets if len(octets) < 128 else bytes([tag, 0x82]) + len(octets).to_bytes(2, "big") + octets

    def number(tag, value, octets=0):  # in as few as it needs
        return item(tag, int(value).to_bytes(octets or max(1, (int(value).bit_length() + 7) // 8), "big"))

    def series(elements):
        return b"".join(bytes([len(e)]) + e for e in elements)

    def imapb(low, high, octets, value):
        scale = 2.0 ** (8 * octets - 1 - math.ceil(math.log2(high - low)))
        zero = scale * low - math.floor(scale * low) if low < 0 < high else 0
        return int(scale * (value - low) + zero).to_bytes(octets, "big")

    def of_class(k):
        return item(107, series([number(3, k)]))
    found = []
    for k, (_, (left, top, right, bottom), score, track) in enumerate(BOXES, 1):
        found.append((bytes([track]) if track else bytes.fromhex("9080808000")) + number(2, top * width + left + 1) +
                     number(3, (bottom - 1) * width + right) + number(5, 100 * score) + of_class(k))
    column, row = image_of(sensor)
    lat, lon, h = geodetic([p + RANGE_M * d for p, d in zip(line["host"]["ecef_m"], u)])
    place = imapb(-90, 90, 4, lat) + imapb(-180, 180, 4, lon) + imapb(-900, 19000, 2, h)
    found.append(bytes.fromhex("9080808002") + number(1, int(row) * width + int(column) + 1) + number(5, 25) +
                 item(17, place) + of_class(3))
    classes = [number(1, k) + item(3, b"urn:x") + item(4, b"urn:x:" + c) + item(6, c)
               for k, c in enumerate((b"tank", b"truck", b"jeep"), 1)]
    items = b"".join([number(2, time_us, 8), item(3, b"another ATR"), number(4, 6),
                      number(5, len(found)), number(6, len(found)), number(7, line["frame"]), number(8, width),
                      number(9, sensor["height_px"]), item(10, b"IR LWIR"), item(11, imapb(0, 180, 2, sensor["hfov_deg"])),
                      item(12, imapb(0, 180, 2, sensor["vfov_deg"])), item(13, bytes.fromhex(MIIS)), item(101, series(found)),
                      item(103, series(classes))])
    octets = klv_decode.VMTI + b"\x82" + (len(items) + 4).to_bytes(2, "big") + items + b"\1\2"
    return octets + klv_decode.checksum(octets).to_bytes(2, "big")
