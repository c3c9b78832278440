#!/usr/bin/env bash
# replay --coco: masks are the pixels of the truth picture, boxes are the masks' own, what is small, mostly hidden, faint or
# without a pixel of its own is an ignore region, and what is hidden is left out; read by pycocotools, and by a decoder of run
# lengths written here.
. "$(dirname "$0")/common.sh"
judges oiiotool python3.numpy python3.PIL python3.pycocotools

# a column of trucks seen from its last: the next one fills the picture's foot, the second is 8 % visible, the third's share
# is no whole pixel, three tanks are hidden, a far helicopter is a quarter of a pixel
cat >"$tmp/column.yaml" <<'Y'
vehicles:
  - {name: Truck, id: 11, type: 1.1.222.7.1.0.0, count: 4, spacing_m: 14, behind_m: -60, route_m: [[0, 0], [400, 40]], speed_mps: 6}
  - {name: Tank, id: 21, type: 1.1.222.1.1.1.0, count: 3, spacing_m: 9, behind_m: -190, route_m: [[0, 12], [400, 40]], speed_mps: 6}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [1400, 60], height_m: 60, heading_deg: 200}
Y
exercise "$tmp/column.yaml" "$tmp/column.pcap"
exercise demo "$tmp/demo.pcap"
column=(--host 1:3001:14 --from 1353 --to 1353 --set sensor.hfov_deg=40 --coco --set publish.coco_min_visible=0.2)
replay "$tmp/column.pcap" "$tmp/c" "${column[@]}" --set publish.coco_min_pixels=9
check "a replay" [ "$code" = 0 ]
check "coco.json" [ -s "$tmp/c/coco.json" ]
check "no parts are left" [ -z "$(find "$tmp/c" -name '*.part')" ]
# a moonless night: the optical image is black, the long-wave one is not
replay "$tmp/column.pcap" "$tmp/night" "${column[@]}" --bands optical,lwir --set exercise.utc=2026-06-21T08:00:00Z
# very near: boxes that fill the picture's height, and are cut by its edges
replay "$tmp/demo.pcap" "$tmp/near" --bands lwir --rate 5 --from 1369.4 --to 1370 --set sensor.hfov_deg=1 --coco
# two hosts, each with a file of its own; pairs and another number of threads change nothing in it
missile=(--bands lwir --from 1366 --to 1366 --no-png --coco)
replay "$tmp/demo.pcap" "$tmp/exr" --host 1:3001:41 "${missile[@]}"
check "no displays: the radiance is named" grep -q '"file_name":"frames/lwir/[0-9]*.exr"' "$tmp/exr/coco.json"
replay "$tmp/demo.pcap" "$tmp/two" --host 1:3001:41 --host observer "${missile[@]}" --pairs target --threads 1
check "pairs, two hosts, one thread: the same images and annotations" \
    cmp -s <(grep -v '^"info"' "$tmp/exr/coco.json") <(grep -v '^"info"' "$tmp/two/1-3001-41/coco.json")

cat >"$tmp/check.py" <<'PY'
import contextlib, csv, io, json, os, subprocess, sys
import numpy as np
from PIL import Image
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval
planes = {}
table = {r["name"]: r for name in ("materials", "plant_optics")
         for r in csv.DictReader(l for l in open(f"etc/{name}.csv") if not l.startswith("#"))}
def check(out, min_pixels, min_visible, min_snr, *wanted, coco=None):
    coco = coco or json.load(open(f"{out}/coco.json"))
    truth = {t["frame"]: t for t in map(json.loads, open(f"{out}/truth.jsonl"))}
    images = {i["id"]: i for i in coco["images"]}
    assert len(images) == len(coco["images"]) == sum(len(t["sensors"][0]["bands"]) for t in truth.values()), "images"
    assert len({a["id"] for a in coco["annotations"]}) == len(coco["annotations"]) > 0, "annotations"
    assert min(images) >= 1 and min(a["id"] for a in coco["annotations"]) == 1, "ids begin with 1"
    names = {c["id"]: c["name"] for c in coco["categories"]}
    assert len(names) == len(coco["categories"]) and min(names) == 1 and names[1] == "tank" and names[2] == "apc"
    for i in images.values(): assert os.path.exists(f"{out}/{i['file_name']}"), i["file_name"]
    def plane(frame):
        if (out, frame) not in planes:
            path = f"{out}/frames/truth/{frame:06d}.exr"
            subprocess.run(["oiiotool", path, "--ch", "entity", "-d", "uint32", "-o", f"{out}/x.tif"], check=True)
            info = subprocess.run(["oiiotool", "--info", "-v", path], check=True, capture_output=True, text=True).stdout
            ids, materials = ([l for l in info.splitlines() if key in l][0].split('"')[1].split(",") for key in ("entity_ids", "material_names"))
            planes[out, frame] = np.array(Image.open(f"{out}/x.tif")), ids
            # value k of every truth plane is the k-th name, and 0 is none
            subprocess.run(["oiiotool", path, "--ch", "material", "-d", "uint32", "-o", f"{out}/x.tif"], check=True)
            material, entity = np.array(Image.open(f"{out}/x.tif")), planes[out, frame][0]
            # the emissivity of each pixel is that of its material in the tables; the sky has none
            bands = [b for b in ("mwir", "lwir") if os.path.exists(f"{out}/frames/{b}")]
            assert [c for c in ("mwir", "lwir") if f"emissivity_{c}" in info] == bands, info
            for b in bands:
                subprocess.run(["oiiotool", path, "--ch", f"emissivity_{b}", "-d", "float", "-o", f"{out}/x.tif"], check=True)
                row = [table[name] for name in materials]
                want = np.array([np.nan] + [1 - float(r[f"rho_{b}"]) - float(r.get(f"tau_{b}") or 0) for r in row])
                assert np.allclose(np.array(Image.open(f"{out}/x.tif")), want[material], rtol=0, atol=2e-7, equal_nan=True), b
            vehicle = [k + 1 for k, name in enumerate(ids) if not name.endswith(":31")]
            of_vehicles = {materials[v - 1] for v in np.unique(material[np.isin(entity, vehicle)])}
            assert "none" not in materials and of_vehicles <= {"paint_olive", "paint_olive_flat", "canvas", "rubber_black", "glass_window",
                "steel_worn", "metal_dark", "metal_steel_oxidized"} and "paint_olive" in of_vehicles, of_vehicles
        return planes[out, frame]
    def runs(text):  # the format's description, read again: five bits a letter, the second run before added from the fourth on
        counts, value, shift = [], 0, 0
        for letter in text:
            group = ord(letter) - 48
            value |= (group & 31) << shift
            shift += 5
            if group & 32: continue
            if group & 16: value -= 1 << shift
            counts.append(value + (counts[-2] if len(counts) > 2 else 0))
            value = shift = 0
        return counts
    seen, asked_of = {}, {}
    met = {k: 0 for k in ("cut", "tall", "ignored", "hidden", "no_mask", "small", "little", "faint", "black", "part_hidden")}
    for a in coco["annotations"]:
        image = images[a["image_id"]]
        frame = image["frame"]
        target = [t for t in truth[frame]["targets"] if t["entity"] == a["entity"]][0]
        rows, columns = a["segmentation"]["size"]
        assert (columns, rows) == (image["width"], image["height"])
        counts = runs(a["segmentation"]["counts"])
        assert sum(counts) == rows * columns and all(c > 0 for c in counts[1:]), "runs"
        bits = np.repeat(np.arange(len(counts)) % 2, counts).reshape(columns, rows).T
        entity, ids = plane(frame)
        # the id of the list's place is the value in the plane, and what both records say it is
        assert a["plane_value"] == target["plane_value"] == ids.index(a["entity"]) + 1
        own = entity == a["plane_value"]
        signal = target["bands"].get(image["band"], {})
        why = "no_mask" if not own.any() else "small" if own.sum() < float(min_pixels) else \
            "hidden" if a["visible_fraction"] < float(min_visible) else "faint" if abs(signal.get("snr", 9e9)) < float(min_snr) else None
        if why: # the whole box
            left, top, right, bottom = target["box_px"]
            own = np.zeros_like(own)
            own[top:bottom, left:right] = True
        assert (bits == own).all(), (frame, a["entity"], "mask", why)
        y, x = np.nonzero(bits)
        assert len(x) == a["area"] > 0, "an empty mask, or another area"
        assert a["bbox"] == [x.min(), y.min(), x.max() + 1 - x.min(), y.max() + 1 - y.min()], (frame, a["bbox"])
        assert a["pixels"] == target["pixels"] and names[a["category_id"]] == target["class"] and a["model"] == target["model"]
        assert a["range_m"] == target["range_m"] and a["visible_fraction"] == target["visible_fraction"]
        for key in ("aspect_deg", "foliage_fraction", "occluded_by"): assert a.get(key) == target.get(key), key
        assert a.get("snr") == signal.get("snr") and a.get("contrast_k") == signal.get("contrast_k"), signal
        assert a.get("contrast") == signal.get("contrast", signal.get("contrast_k")), signal
        left, top, right, bottom = target["amodal_box_px"]
        assert np.allclose(a["bbox_amodal"], [left, top, right - left, bottom - top], rtol=1e-9), a["bbox_amodal"]
        assert a["iscrowd"] == a["ignore"] == (why is not None) and a.get("ignored_as") == why, (frame, a["entity"], why)
        seen.setdefault((frame, image["band"]), set()).add(a["entity"])
        asked_of.setdefault(a["image_id"], []).append(a["iscrowd"])
        met["cut"] += x.max() + 1 == columns or x.min() == 0 or y.max() + 1 == rows or y.min() == 0
        met["tall"] += y.min() == 0 and y.max() + 1 == rows
        met["ignored"] += why is not None
        met["little" if why == "hidden" else why or "ignored"] += why is not None
        met["part_hidden"] += a["visible_fraction"] < 1
    for i in images.values():  # in the dark no target is asked for
        if i["file_name"].endswith(".png") and np.asarray(Image.open(f"{out}/{i['file_name']}")).max() < 8:
            assert all(asked_of.get(i["id"], [])), i["file_name"]
            met["black"] += len(asked_of.get(i["id"], []))
    for t in truth.values():  # what is visible in any part, and nothing else
        here = {k["entity"] for k in t["targets"] if k["pixels"] > 0}
        assert here == {k["entity"] for k in t["targets"] if "box_px" in k}
        for band in t["sensors"][0]["bands"]: assert seen.get((t["frame"], band), set()) == here, (t["frame"], band)
        met["hidden"] += sum(k["pixels"] == 0 for k in t["targets"])
    print(len(coco["annotations"]), "annotations", met)
    for what in wanted: assert met[what] > 0, f"none is {what}: the scene tests nothing"
    with contextlib.redirect_stdout(io.StringIO()):
        c = COCO(f"{out}/coco.json")
        everything = c.loadAnns(c.getAnnIds())
        for a in everything:
            if not a["iscrowd"]: assert (c.annToMask(a) == (plane(images[a["image_id"]]["frame"])[0] == a["plane_value"])).all()
            else: assert c.annToMask(a).sum() == a["area"] == a["bbox"][2] * a["bbox"][3]
        # a recogniser that finds all it is asked for and nothing else; and one that finds what is to be ignored, too
        asked = [a for a in everything if not a["iscrowd"]]
        for found in (asked, everything):
            for kind, key in (("segm", "segmentation"), ("bbox", "bbox")):
                results = [{"image_id": a["image_id"], "category_id": a["category_id"], "score": 0.9, key: a[key]} for a in found]
                json.dump(results, open(f"{out}/results.json", "w"))
                e = COCOeval(c, c.loadRes(f"{out}/results.json"), kind)
                e.evaluate(), e.accumulate(), e.summarize()
                assert e.stats[0] > 1 - 1e-9, (kind, e.stats)
        # what is found in an ignore region, with more confidence, is no error; what is found in nothing is one
        boxes = lambda all, score, move=0: [{"image_id": a["image_id"], "category_id": a["category_id"], "score": score,
                                             "bbox": [(a["bbox"][0] + move) % (images[a["image_id"]]["width"] - a["bbox"][2] + 1), *a["bbox"][1:]]} for a in all]
        kinds = {a["category_id"] for a in asked}
        ignored = [a for a in everything if a["iscrowd"] and a["category_id"] in kinds]
        for move, wrong in (0, False), (200, True):
            if not ignored or not asked: continue
            e = COCOeval(c, c.loadRes(boxes(asked, 0.5) + boxes(ignored, 0.9, move)), "bbox")
            e.evaluate(), e.accumulate(), e.summarize()
            assert (e.stats[0] < 1 - 1e-9) == wrong, (move, e.stats)
        # and one that misses half does not
        results = [{"image_id": a["image_id"], "category_id": a["category_id"], "score": 0.9, "bbox": a["bbox"]} for a in asked[::2]]
        e = COCOeval(c, c.loadRes(results), "bbox")
        e.evaluate(), e.accumulate(), e.summarize()
        assert len(asked) < 2 or e.stats[0] < 1
cases = [each.split() for each in " ".join(sys.argv[1:]).split(",")]
for case in cases: check(*case)
# their twins: one field of one annotation is wrong
twins = {"area": lambda a: a["area"] + 1, "bbox": lambda a: [a["bbox"][0] + 1, *a["bbox"][1:]], "iscrowd": lambda a: 1 - a["iscrowd"],
         "category_id": lambda a: 1 + a["category_id"] % 2, "plane_value": lambda a: a["plane_value"] + 1, "id": lambda a: 2,
         "segmentation": lambda a: {**a["segmentation"], "counts": chr(ord(a["segmentation"]["counts"][0]) ^ 1) + a["segmentation"]["counts"][1:]}}
for field, wrong in twins.items():
    coco = json.load(open(f"{cases[0][0]}/coco.json"))
    coco["annotations"][0][field] = wrong(coco["annotations"][0])
    try: check(*cases[0], coco=coco)
    except AssertionError: continue
    sys.exit(f"a wrong {field} is not noticed")
PY
# the column; very near; two hosts
check "masks are the truth's" python3 "$tmp/check.py" "$tmp/c" 9 0.2 0.1 cut ignored hidden no_mask little part_hidden, \
    "$tmp/night" 5 0.2 0.1 faint black, "$tmp/near" 5 0 0.1 cut tall, "$tmp/two/1-3001-41" 5 0 0.1, "$tmp/two/observer" 5 0 0.1

# whole or not at all
few=(--bands lwir --from 1366 --to 1366)
mkdir -p "$tmp/full" && ln -sf "$tmp/elsewhere" "$tmp/full/coco.json.part"
replay "$tmp/demo.pcap" "$tmp/full" "${few[@]}" --coco
check "a link in its place: exit code" [ "$code" = 1 ]
check "a link in its place: said" complained "coco: cannot write .*coco.json: .*symbolic link"
check "a link in its place: not followed" [ ! -e "$tmp/full/coco.json" -a ! -e "$tmp/elsewhere" ]
replay "$tmp/demo.pcap" "$tmp/c" "${few[@]}"
check "an earlier run's coco.json goes" [ ! -e "$tmp/c/coco.json" ]
replay "$tmp/demo.pcap" "$tmp/c" "${few[@]}" --coco --no-files
check "without files: refused" complained "publish.coco: needs image files"
for bad in coco_min_pixels=0 coco_min_visible=1.5 coco_min_snr=-1; do
    replay "$tmp/demo.pcap" "$tmp/c" "${few[@]}" --coco --set publish.$bad
    check "$bad: refused, with its range" complained "publish.${bad%=*}: '${bad#*=}' is not a .*number in [01] .. "
done
replay "$tmp/demo.pcap" "$tmp/c" --bands optical --from 1366 --to 1366 --planes emissivity
check "emissivity without a thermal band: refused" complained "publish.planes: emissivity is of thermal bands.*sensor.bands"
finish
