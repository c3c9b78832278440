"""The boxes of a frame's targets in five formats: used by test_five_records.sh.

    five_records.py watch RING FILE     targets of every frame in shared memory, a line of JSON each, until the node ends
    five_records.py compare FOLDER      FOLDER/out, pdus, memory.jsonl, lwir.klv

Each reader gives {frame: {entity: numbers as read}}; the table FORMATS has what turns them into half-open pixels from 0.
A format is one function and one row."""
import json, os, sys

sys.path[:0] = [os.path.dirname(__file__), "etc/examples"]

def frames_of(folder): return [json.loads(line) for line in open(f"{folder}/out/truth.jsonl")]

# ---- readers -----------------------------------------------------

def truth(folder):
    return {f["frame"]: {t["entity"]: t["box_px"] for t in f["targets"] if "box_px" in t} for f in frames_of(folder)}

regions = set()  # (frame, entity) of COCO's ignore regions

def coco(folder):
    """pycocotools; also that the box is that of the mask, to the pixel."""
    import contextlib, io
    from pycocotools.coco import COCO
    with contextlib.redirect_stdout(io.StringIO()): c = COCO(f"{folder}/out/coco.json")
    found = {image["frame"]: {} for image in c.dataset["images"]}
    for a in c.loadAnns(c.getAnnIds()):
        rows, columns = c.annToMask(a).nonzero()
        mask = [columns.min(), rows.min(), columns.max() + 1 - columns.min(), rows.max() + 1 - rows.min()]
        assert a["bbox"] == mask and a["area"] == len(rows), (a["bbox"], mask)
        found[c.imgs[a["image_id"]]["frame"]][a["entity"]] = a["bbox"]
        if a["iscrowd"]: regions.add((c.imgs[a["image_id"]]["frame"], a["entity"]))
    return found

def data_pdu(folder):
    """opendis reads the PDU and its datums; the octets of a datum are this program's own, as consume_dis.h has them."""
    from opendis.PduFactory import createPdu
    found = {}
    for line in open(f"{folder}/pdus"):
        pdu = createPdu(bytes.fromhex(line))
        assert pdu.pduType == 20
        fixed = {d.fixedDatumID: d.fixedDatumValue for d in pdu.fixedDatumRecords}
        targets = found.setdefault(fixed[600001], {})
        for d in pdu.variableDatumRecords:
            if d.variableDatumID != 600202: continue
            assert d.variableDatumLength == 448
            u16 = [d.variableData[k] << 8 | d.variableData[k + 1] for k in range(0, 16, 2)]
            if any(u16[4:]): targets["%d:%d:%d" % tuple(u16[:3])] = u16[4:] # 0 0 0 0: hidden
    return found

def st0903(folder):
    """stanag4609 and tstrans, through klv_decode.py: numbers of the first, last and central pixel."""
    import klv_decode
    keys = {"stanag4609": ("id", "2", "3", "1"),
            "tstrans": ("target_id", "bbox_top_left_pixel", "bbox_bottom_right_pixel", "centroid_pixel")}
    readers, found = klv_decode.readers(keys), {}
    for packet in klv_decode.decode(open(f"{folder}/lwir.klv", "rb").read(), readers):
        frame = found.setdefault(packet["stanag4609"]["vmti"]["fields"]["7"], {}) # its number, which tstrans does not say
        for reader in readers:
            for t in packet[reader]["vmti"]["targets"]:
                number, *pixels = (t[k] for k in keys[reader])
                name = f"{number >> 32}:{number >> 16 & 65535}:{number & 65535}"
                assert frame.setdefault(name, pixels) == pixels, (reader, name, pixels, frame[name])
    return found

def memory(folder):
    frames = map(json.loads, open(f"{folder}/memory.jsonl"))
    return {f["frame"]: {e: b for e, b in f["box"].items() if any(b)} for f in frames}

def watch(ring, path):
    import read_memory
    with open(path, "w") as to:
        for frame in read_memory.Ring(ring, wait_s=200).frames(in_order=True):
            box = {f"{t.site}:{t.application}:{t.entity}": list(t.box) for t in frame.targets}
            to.write(json.dumps({"frame": frame.record.frame, "box": box}) + "\n")

# ---- to half-open pixels from 0 --------------------------------------------------------------------------

def as_it_is(numbers, width): return list(numbers)

def of_xywh(numbers, width):
    x, y, w, h = map(int, numbers)
    return [x, y, x + w, y + h]

def of_pixel_numbers(numbers, width):
    (x0, y0), (x1, y1), centre = (((n - 1) % width, (n - 1) // width) for n in numbers)
    if centre != ((x0 + x1 + 1) // 2, (y0 + y1 + 1) // 2): return None
    return [x0, y0, x1 + 1, y1 + 1]

FORMATS = {"truth.jsonl": (truth, as_it_is), "coco.json": (coco, of_xywh), "Data PDU": (data_pdu, as_it_is),
           "ST 0903": (st0903, of_pixel_numbers), "shared memory": (memory, as_it_is)}

# ---- the same box ------------------------------------------------------------------------------------------

def within(a, b): return a[0] >= b[0] and a[1] >= b[1] and a[2] <= b[2] and a[3] <= b[3]

def differences(read, frames):
    """Of every format that was read, as text; and how many boxes are the same, and of COCO's smaller, or whole
    since they are ignore regions."""
    wrong, met = [], {"same": 0, "smaller": 0, "region": 0}
    want = read["truth.jsonl"]
    for name, found in read.items():
        if sorted(found) != sorted(want): wrong.append(f"{name}: frames {sorted(found)}, not {sorted(want)}")
        for f in frames:
            boxes, width = found.get(f["frame"], {}), f["sensors"][0]["width_px"]
            of_target = {t["entity"]: t for t in f["targets"]}
            for entity in sorted(boxes.keys() | want[f["frame"]].keys()):
                box, got = want[f["frame"]].get(entity), boxes.get(entity)
                got = got and FORMATS[name][1](got, width)
                where = f"{name}, frame {f['frame']}, {entity}"
                region = name == "coco.json" and (f["frame"], entity) in regions
                if got == box:
                    met["region" if region else "same"] += 1
                elif name != "coco.json" or not box or not got or region:
                    wrong.append(f"{where}: {got}, not {box}")
                else: # of pixels that it fills in part: within, and the target is small or hidden in part
                    met["smaller"] += 1
                    small = max(box[2] - box[0], box[3] - box[1]) <= 16
                    part = of_target[entity]["visible_fraction"] < 1 or small
                    if not within(got, box) or not part: wrong.append(f"{where}: {got} of {box}")
    return wrong, met

def spoilt(read, frames):
    """With one number of one box off by one, in each format: what goes unnoticed."""
    unnoticed = []
    for name in read:
        frame = frames[0]["frame"]
        # of COCO one whose box is that of the others: the largest
        area = {t["entity"]: t["pixels"] for t in frames[0]["targets"]}
        entity = max(read[name][frame], key=area.get)
        for k in range(len(read[name][frame][entity])):
            for step in (-1, 1):
                numbers = list(read[name][frame][entity])
                numbers[k] += step
                other = {**read, name: {**read[name], frame: {**read[name][frame], entity: numbers}}}
                if not differences(other, frames)[0]: unnoticed.append(f"{name}, number {k}, off by {step}")
    return unnoticed

def compare(folder):
    frames, read = frames_of(folder), {name: reader(folder) for name, (reader, _) in FORMATS.items()}
    wrong, met = differences(read, frames)
    # what is wrong hides what is spoilt
    if not wrong: wrong = [f"unnoticed: {u}" for u in spoilt(read, frames)]
    for what, count in met.items():
        if count == 0: wrong.append(f"no box is {what}: the scene shows nothing")
    print(", ".join(read), "-", met)
    for line in wrong[:40]: print("FAILED:", line)
    sys.exit(bool(wrong))

if __name__ == "__main__":
    {"watch": watch, "compare": compare}[sys.argv[1]](*sys.argv[2:])
