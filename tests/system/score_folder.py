"""Folders of products made by hand, for `pitviper score`: truth.jsonl with the fields that scoring reads, coco.json, and answers
whose scores are known from how they were made, not from where they lie.

    score_folder.py FOLDER [--sequences N] [--frames N] [--seed N]

Writes truth.jsonl and coco.json into FOLDER (of several sequences: into FOLDER/vN, with manifest.jsonl), answers.jsonl, and
FOLDER/expected.json: the counts that the answers were made for."""
import argparse, json, os, random

BANDS = ["optical", "lwir"]
SIZE = (640, 480)
AGE_MS, RANGE_OFF_M = (10.0, 30.0), 25.0

def camera():
    """At 0 N 0 E looking north: camera x east (ecef y), y down (-ecef x), z north (ecef z); rows, columns are axes."""
    return [0, -1, 0, 1, 0, 0, 0, 0, 1]

def truth_line(frame, targets, km2=0.5):
    return {"frame": frame, "time_s": frame * 0.1, "host": {"entity": "observer", "lat_deg": 0.0, "lon_deg": 0.0, "height_m": 100.0},
            "sun": {"azimuth_deg": 90.0, "elevation_deg": 30.0},
            "sensors": [{"name": "seeker", "bands": BANDS, "width_px": SIZE[0], "height_px": SIZE[1], "hfov_deg": 4.0, "vfov_deg": 3.0,
                         "ecef_from_cam": camera(), "ground_km2": km2}],
            "targets": targets, "clutter": [{"class": "car", "id": "1", "instance": 1, "pixels": 400.0, "box_px": [95, 295, 115, 315],
                                             "range_m": 1500.0, "temp_k": 300.0}]}

def target(number, kind, box, pixels, **more):
    t = {"entity": f"1:1:{number}", "class": kind, "range_m": 1500.0, "aspect_deg": 90.0, "pixels": pixels, "visible_fraction": 1.0,
         "foliage_fraction": 0.0, "amodal_box_px": box, "bands": {b: {"snr": 4.0} for b in BANDS}}
    if pixels > 0: t["box_px"] = [round(v) for v in box]
    return t | more

class Maker:
    """A grid of places far from each other: what stands at one is named there or nowhere."""
    def __init__(self, seed):
        self.random, self.expected = random.Random(seed), {}
    def count(self, key, n=1): self.expected[key] = self.expected.get(key, 0) + n
    def sequence(self, folder, frames, name):
        r, answers = self.random, []
        os.makedirs(folder, exist_ok=True)
        with open(f"{folder}/truth.jsonl", "w") as out:
            for frame in range(frames):
                targets = []
                for k in range(6):
                    x, y, small = 50 + 100 * k, 60 + 20 * (k % 2), k % 2 == 0
                    w, h = (8, 6) if small else (40, 30)
                    kind = "tank" if k < 3 else "truck"
                    hidden = k == 5 and frame % 3 == 0
                    tiny = k == 4 and frame % 4 == 0
                    pixels = 0 if hidden else 3 if tiny else 0.7 * w * h
                    targets.append(target(k + 1, kind, [x, y, x + w, y + h], pixels))
                    for band in BANDS:
                        line = {"frame": frame, "band": band, "score": r.randrange(1, 1000) / 1000, "latency_ms": r.choice(AGE_MS)}
                        if name: line["sequence"] = name
                        found = r.random() < 0.7
                        if found:
                            said = r.choice([kind, kind, "truck" if kind == "tank" else "tank", "unknown", "lorry"])
                            dx, dy = 1.0, -0.5
                            answers.append(line | {"class": said, "range_m": 1500 + RANGE_OFF_M, "track": k + 1,
                                                   "box_px": [x + dx, y + dy, x + w + dx, y + h + dy]})
                        if hidden or tiny:
                            self.count("ignored", found)
                            continue
                        self.count("chances"), self.count(f"chances {band}")
                        self.count("found", found), self.count(f"found {band}", found)
                        said = "missed" if not found else said if said in ("tank", "truck") else "unknown"
                        self.count("recognised", said == kind)
                        self.count(f"{kind} as {said}")
                for band in BANDS:
                    line = {"frame": frame, "band": band, "score": r.randrange(1, 1000) / 1000, "latency_ms": r.choice(AGE_MS)}
                    if name: line["sequence"] = name
                    for n in range(r.choice([0, 0, 1, 2])):
                        said = r.choice(["tank", "unknown"])
                        answers.append(line | {"class": said, "box_px": [100 + 200 * n, 300, 110 + 200 * n, 310]})
                        self.count("false_alarms"), self.count(f"false as {said}"), self.count("on car", n == 0)
                    if r.random() < 0.5: answers.append({k: v for k, v in line.items() if k not in ("score",)} | {"answer": 0, "of": 0})
                out.write(json.dumps(truth_line(frame, targets), separators=(",", ":")) + "\n")
        return answers

def main():
    p = argparse.ArgumentParser()
    p.add_argument("folder"), p.add_argument("--sequences", type=int, default=1), p.add_argument("--frames", type=int, default=20)
    p.add_argument("--seed", type=int, default=1)
    o = p.parse_args()
    maker, answers = Maker(o.seed), []
    os.makedirs(o.folder, exist_ok=True)
    if o.sequences > 1:
        with open(f"{o.folder}/manifest.jsonl", "w") as manifest:
            for n in range(o.sequences):
                one = maker.sequence(f"{o.folder}/v{n}", o.frames, f"v{n}")
                with open(f"{o.folder}/v{n}/answers.jsonl", "w") as out:
                    for a in one: out.write(json.dumps({k: v for k, v in a.items() if k != "sequence"}) + "\n")
                answers += one
                manifest.write(json.dumps({"variant": f"v{n}", "folder": f"v{n}", "status": "made"}) + "\n")
            manifest.write(json.dumps({"variant": "broken", "folder": "broken", "status": "failed"}) + "\n")
    else: answers = maker.sequence(o.folder, o.frames, None)
    with open(f"{o.folder}/answers.jsonl", "w") as out:
        for a in answers: out.write(json.dumps(a) + "\n")
    maker.expected["answers"] = sum("class" in a for a in answers)
    json.dump(maker.expected, open(f"{o.folder}/expected.json", "w"))

if __name__ == "__main__": main()
