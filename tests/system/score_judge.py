"""Judges of `pitviper score`.

    score_judge.py counts SCORE EXPECTED      the counts that answers were made for (score_folder.py), exactly
    score_judge.py coco-make FOLDER SEED      truth.jsonl, coco.json and results.json of random boxes
    score_judge.py coco-sweep FOLDER SEED     the same of two variants: manifest.jsonl, one coco.json of both, one results.json
    score_judge.py coco SCORE COCO RESULTS    average precision as pycocotools has it, to 1e-9
    score_judge.py coco-of FOLDER             made.json and results.json of truth.jsonl and answers.jsonl, where there is no coco.json"""
import contextlib, io, json, math, os, random, sys

wrong = []
def same(what, got, want, within=0.0):
    if not (got is not None and abs(got - want) <= within): wrong.append(f"{what}: {got!r}, want {want!r}")

def counts(score, expected):
    r, e = json.load(open(score))["recognisers"][0], json.load(open(expected))
    t = r["total"]
    for key in ("chances", "found", "recognised", "false_alarms"): same(key, t[key], e[key])
    for band in ("optical", "lwir"):
        for key in ("chances", "found"): same(f"{key} {band}", r["by_band"][band][key], e[f"{key} {band}"])
    same("answers", r["answers"], e["answers"])
    same("ignored", r["ignored"], e["ignored"])
    same("on clutter", r["on_clutter"]["car"], e["on car"])
    for row in ("tank", "truck", "false"):
        for column in ("tank", "truck", "unknown") + (("missed",) if row != "false" else ()):
            same(f"{row} as {column}", r["confusion"].get(row, {}).get(column, 0), e.get(f"{row} as {column}", 0))
    # made one pixel to the right and half of one up, 25 m too far, 10 or 30 ms old
    same("mean right", r["errors"]["mean_px"][0], 1, 1e-12), same("mean down", r["errors"]["mean_px"][1], -0.5, 1e-12)
    same("rms", r["errors"]["rms_px"], math.sqrt(1.25), 1e-12)
    same("rms deg", r["errors"]["rms_deg"], math.degrees(math.sqrt(1.25) / (320 / math.tan(math.radians(2)))), 1e-12)
    same("range", r["errors"]["range_mean_m"], 25, 1e-9), same("range rms", r["errors"]["range_rms_m"], 25, 1e-9)
    same("errors", r["errors"]["count"], e["found"])
    for age in ("median_ms", "p95_ms", "max_ms"):
        if r["ages"][age] not in (10, 30): wrong.append(f"{age}: {r['ages'][age]}")
    same("detection", t["detection"]["value"], e["found"] / e["chances"], 1e-12)
    same("a frame", t["per_frame"]["value"], e["false_alarms"] / t["frames"], 1e-12)
    same("a square degree", t["per_deg2"]["value"], e["false_alarms"] / (12 * t["frames"]), 1e-12)
    same("a km2", t["per_km2"]["value"], e["false_alarms"] / (0.5 * t["frames"]), 1e-12)
    # the rule has no ties and no ignored ones among small and large: each quantity's bins make the whole again
    for what, bins in r["against"].items(): same(what, sum(b["chances"] for b in bins), e["chances"])
    same("hour", r["against"]["hour"][0]["from"], 6)  # the sun in the east, 30 degrees high, on the equator: 8 o'clock

def coco_make(folder, seed):
    from score_folder import BANDS, truth_line, target
    r = random.Random(seed)
    classes = ["tank", "apc", "truck", "helicopter"]
    ids = {"tank": 1, "apc": 2, "truck": 9, "helicopter": 28}
    images, annotations, results = [], [], []
    def box():
        if r.random() < 0.5: return [r.randrange(0, 500), r.randrange(0, 400), r.randrange(2, 90), r.randrange(2, 70)]
        return [round(r.uniform(0, 500), 3), round(r.uniform(0, 400), 3), round(r.uniform(2, 90), 3), round(r.uniform(2, 70), 3)]
    with open(f"{folder}/truth.jsonl", "w") as truth:
        for frame in range(40):
            targets, places = [], []
            for k in range(r.randrange(0, 7)):
                b, kind = box(), r.choice(classes)
                x, y, w, h = b
                targets.append(target(k + 1, kind, [x, y, x + w, y + h], 0.7 * w * h))
                places.append((k + 1, kind, b))
            truth.write(json.dumps(truth_line(frame, targets)) + "\n")
            for b, band in enumerate(("optical", "mwir", "lwir", "radar")):
                if band not in BANDS: continue
                image = 4 * frame + b + 1
                images.append({"id": image, "width": 640, "height": 480, "file_name": "x", "band": band, "frame": frame, "time_s": 0.1 * frame})
                for number, kind, (x, y, w, h) in places:
                    if r.random() < 0.1: continue # nothing of it is visible
                    crowd = int(r.random() < 0.2)
                    annotations.append({"id": len(annotations) + 1, "image_id": image, "category_id": ids[kind], "bbox": [x, y, w, h],
                                        "area": w * h, "iscrowd": crowd, "ignore": crowd, "entity": f"1:1:{number}"})
                    for copy in range(r.choice([0, 1, 1, 2])): # near it, at many overlaps
                        s = r.choice([0, 0.02, 0.1, 0.25])
                        results.append({"image_id": image, "category_id": ids[r.choice([kind, kind, kind, r.choice(classes)])],
                                        "bbox": [x + s * w, y - s * h, w, h], "score": r.randrange(0, 40) / 40})
                    if w % 3 == 0: # an IoU of one half, exactly
                        results.append({"image_id": image, "category_id": ids[kind], "bbox": [x + w // 3, y, w, h], "score": r.randrange(0, 40) / 40})
                for k in range(r.choice([0, 1, 3])):
                    results.append({"image_id": image, "category_id": r.choice(list(ids.values()) + [5]), "bbox": box(), "score": r.randrange(0, 40) / 40})
                if frame % 9 == 7: # more than a hundred of a class, of which the last are right
                    results += [{"image_id": image, "category_id": 1, "bbox": box(), "score": 1.0} for k in range(97)]
                    results += [{"image_id": image, "category_id": 1, "bbox": b, "score": 0.99 - 0.01 * k} for k, (_, _, b) in enumerate(places)]
    # where scores are equal pycocotools goes by the order in the file; `score` by what the answers say
    results.sort(key=lambda a: (a["image_id"], -a["score"], a["bbox"], a["category_id"]))
    names = json.load(open(sys.argv[4])) if len(sys.argv) > 4 else {}
    json.dump({"images": images, "annotations": annotations, "categories": [{"id": i, "name": names.get(str(i), str(i))} for i in sorted(set(ids.values()) | {5})],
               "info": {}}, open(f"{folder}/coco.json", "w"))
    json.dump(results, open(f"{folder}/results.json", "w"))

def coco_sweep(folder, seed):
    images, annotations, results = [], [], []
    with open(f"{folder}/manifest.jsonl", "w") as manifest:
        for v in ("va", "vb"):
            os.makedirs(f"{folder}/{v}")
            coco_make(f"{folder}/{v}", seed + len(images))
            one, new = json.load(open(f"{folder}/{v}/coco.json")), {}
            for i in one["images"]:
                new[i["id"]] = len(images) + 1
                images.append(i | {"id": len(images) + 1, "variant": v})
            for a in one["annotations"]: annotations.append(a | {"id": len(annotations) + 1, "image_id": new[a["image_id"]]})
            for a in json.load(open(f"{folder}/{v}/results.json")): results.append(a | {"image_id": new[a["image_id"]]})
            manifest.write(json.dumps({"folder": v, "status": "kept"}) + "\n")
    json.dump({"images": images, "annotations": annotations, "categories": one["categories"], "info": {}}, open(f"{folder}/coco.json", "w"))
    json.dump(results, open(f"{folder}/results.json", "w"))

def coco_of(folder):
    ids, bands = {"tank": 1, "truck": 9}, ("optical", "mwir", "lwir", "radar")
    images, annotations, results = [], [], []
    for line in open(f"{folder}/truth.jsonl"):
        frame = json.loads(line)
        for band in frame["sensors"][0]["bands"]:
            image = 4 * frame["frame"] + bands.index(band) + 1
            images.append({"id": image, "band": band})
            for t in frame["targets"]:
                if "box_px" not in t: continue
                x0, y0, x1, y1 = t["box_px"]
                annotations.append({"id": len(annotations) + 1, "image_id": image, "category_id": ids[t["class"]], "bbox": [x0, y0, x1 - x0, y1 - y0],
                                    "area": t["pixels"], "iscrowd": int(t["pixels"] < 5)})
    for a in map(json.loads, open(f"{folder}/answers.jsonl")):
        if a.get("class") not in ids: continue
        x0, y0, x1, y1 = a["box_px"]
        results.append({"image_id": 4 * a["frame"] + bands.index(a["band"]) + 1, "category_id": ids[a["class"]], "score": a["score"],
                        "bbox": [x0, y0, x1 - x0, y1 - y0]})
    results.sort(key=lambda a: (a["image_id"], -a["score"], a["bbox"], a["category_id"]))
    json.dump({"images": images, "annotations": annotations, "categories": [{"id": i, "name": n} for n, i in ids.items()], "info": {}},
              open(f"{folder}/made.json", "w"))
    json.dump(results, open(f"{folder}/results.json", "w"))

def coco(score, truth, results):
    from pycocotools.coco import COCO
    from pycocotools.cocoeval import COCOeval
    import numpy
    r = json.load(open(score))["recognisers"][0]
    with contextlib.redirect_stdout(io.StringIO()):
        gt = COCO(truth)
        dt = gt.loadRes(results)
    names = {1: "tank", 2: "apc", 9: "truck", 28: "helicopter"} | {c["id"]: c["name"] for c in gt.dataset["categories"] if not c["name"].isdigit()}
    compared = 0
    for band in [None] + r["bands"]:
        with contextlib.redirect_stdout(io.StringIO()):
            e = COCOeval(gt, dt, "bbox")
            if band: e.params.imgIds = [i["id"] for i in gt.dataset["images"] if i["band"] == band]
            e.evaluate(), e.accumulate(), e.summarize()
        for k, category in enumerate(e.params.catIds):
            p = e.eval["precision"][:, :, k, 0, -1]
            ours = r["classes"].get(names.get(category, ""), {})
            ours = (ours.get("bands", {}).get(band) if band else ours.get("all")) or {}
            if (p < 0).all():
                if "ap" in ours: wrong.append(f"{band} {category}: {ours['ap']}, pycocotools has no target")
                continue
            for key, want in (("ap", p.mean()), ("ap50", p[0].mean()), ("ap75", p[5].mean())):
                same(f"{band} {names[category]} {key}", ours.get(key), want, 1e-9)
                compared += 1
        if not band:
            same("mAP", r.get("map"), e.stats[0], 1e-9), same("mAP50", r.get("map50"), e.stats[1], 1e-9)
    print(compared, "average precisions compared")
    if compared < 6: wrong.append("too few were compared")

{"counts": counts, "coco-make": lambda folder, seed, *_: coco_make(folder, int(seed)), "coco": coco, "coco-of": coco_of,
 "coco-sweep": lambda folder, seed: coco_sweep(folder, int(seed))}[sys.argv[1]](*sys.argv[2:])
for line in wrong[:20]: print("FAILED:", line)
sys.exit(bool(wrong))
