"""Tracks of `pitviper score`, from its files: a folder of truth and answers, and the scores that they must have.

    score_tracks_judge.py make FOLDER SEED     targets apart from each other, that hide, come and go; tracks that follow them, are
                                               lost, swap, coast on and come back as others; answers on nothing, without a track
    score_tracks_judge.py judge FOLDER SCORE   by TrackEval, and by counting where each answer has one target at most

The judge reads truth.jsonl and answers.jsonl alone, by what the reference says of them."""
import contextlib, io, json, math, random, sys
import numpy
from score_folder import BANDS, target, truth_line

IOU = 0.3 # of score's rules; a pair that just reaches it has similarity 0.5

def make(folder, seed):
    r = random.Random(seed)
    answers = []
    number = {(b, k): 10 * k + 1 for b in BANDS for k in range(5)}
    fresh = 50
    with open(f"{folder}/truth.jsonl", "w") as out:
        state = ["seen"] * 5
        for frame in range(300):
            targets = []
            for band in BANDS:
                for k in range(5):
                    if r.random() >= 0.015: continue # another track from now on; at times that of another target
                    fresh += 1
                    number[band, k] = fresh
                    other = r.randrange(5)
                    if r.random() < 0.4: number[band, k], number[band, other] = number[band, other], number[band, k]
            for k in range(5):
                if r.random() < 0.1: state[k] = r.choice(["seen", "seen", "hidden", "gone"])
                if state[k] == "gone": continue
                x, y = 20 + 120 * k + frame % 40, 60 + 70 * k
                box = [x, y, x + 40, y + 30]
                targets.append(target(k + 1, "tank", box, 0 if state[k] == "hidden" else 900))
                for band in BANDS:
                    if r.random() < (0.3 if state[k] == "hidden" else 0.06): continue
                    d = r.choice([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 14, 17, 19, 20, 21, 22, 25]) # 25 of 40 columns: IoU 0.23
                    answers.append({"frame": frame, "band": band, "class": "tank", "score": r.random(), "track": number[band, k],
                                    "box_px": [x + d, y, x + d + 40, y + 30]})
            for band in BANDS:
                if r.random() < 0.3: answers.append({"frame": frame, "band": band, "class": "tank", "score": 0.5, "track": 9000 + frame // 7,
                                                     "box_px": [300, 440, 330, 460]})
                if r.random() < 0.1: answers.append({"frame": frame, "band": band, "class": "tank", "score": 0.5, "box_px": [400, 440, 430, 460]})
            r.shuffle(targets)
            out.write(json.dumps(truth_line(frame, targets)) + "\n")
    r.shuffle(answers)
    with open(f"{folder}/answers.jsonl", "w") as out:
        for a in answers: out.write(json.dumps(a) + "\n")

def overlap(a, b):
    w, h = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return max(w, 0) * max(h, 0)

def iou(a, b):
    both = overlap(a, b)
    return both / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - both)

def alike(a, b): # of a target that shows, by boxes
    return 0.5 + 0.5 * (iou(a, b) - IOU) / (1 - IOU) if iou(a, b) >= IOU else 0.0

def alike_hidden(a, b): # less than small_px of it show: by centres, in the box grown by 0.25
    d = [abs(a[i] + a[i + 2] - b[i] - b[i + 2]) / 2 for i in (0, 1)]
    w, h = b[2] - b[0], b[3] - b[1]
    return 0.5 + 0.5 / (1 + 4 * (d[0] ** 2 + d[1] ** 2) / (w * w + h * h)) if d[0] <= 0.625 * w and d[1] <= 0.625 * h else 0.0

def frames_of(folder, band):
    """Of each frame: time, visible and hidden truths as {id: box}, scored answers and those beside as {track: box}."""
    by_frame = {}
    for line in open(f"{folder}/answers.jsonl"):
        a = json.loads(line)
        if a["band"] == band and a.get("track"): by_frame.setdefault(a["frame"], {})[a["track"]] = a["box_px"]
    for line in open(f"{folder}/truth.jsonl"):
        t = json.loads(line)
        seen = {x["entity"]: x["amodal_box_px"] for x in t["targets"] if x["pixels"] > 0}
        hidden = {x["entity"]: x["amodal_box_px"] for x in t["targets"] if x["pixels"] == 0}
        scored, beside = {}, {}
        for track, box in by_frame.get(t["frame"], {}).items():
            on_seen = any(iou(box, b) >= IOU for b in seen.values())
            on_hidden = any(alike_hidden(box, b) >= 0.5 or overlap(box, b) >= IOU * (box[2] - box[0]) * (box[3] - box[1]) for b in hidden.values())
            (beside if on_hidden and not on_seen else scored)[track] = box
        yield t["time_s"], seen, hidden, scored, beside

def by_trackeval(frames):
    with contextlib.redirect_stdout(io.StringIO()): import trackeval.metrics
    truths, tracks = sorted({i for f in frames for i in f[1]}), sorted({i for f in frames for i in f[3]})
    data = {"gt_ids": [numpy.array([truths.index(i) for i in f[1]], int) for f in frames],
            "tracker_ids": [numpy.array([tracks.index(i) for i in f[3]], int) for f in frames],
            "similarity_scores": [numpy.array([[alike(a, b) for a in f[3].values()] for b in f[1].values()]).reshape(len(f[1]), len(f[3]))
                                  for f in frames],
            "num_timesteps": len(frames), "num_gt_ids": len(truths), "num_tracker_ids": len(tracks),
            "num_gt_dets": sum(len(f[1]) for f in frames), "num_tracker_dets": sum(len(f[3]) for f in frames)}
    with contextlib.redirect_stdout(io.StringIO()):
        identity, clear = trackeval.metrics.Identity().eval_sequence(data), trackeval.metrics.CLEAR().eval_sequence(data)
    return {"idtp": identity["IDTP"], "idfp": identity["IDFP"], "idfn": identity["IDFN"], "switches": clear["IDSW"],
            "matched": clear["CLR_TP"], "mostly_tracked": clear["MT"], "mostly_lost": clear["ML"], "tracks": len(tracks),
            "targets": len(truths), "present": data["num_gt_dets"], "answers": data["num_tracker_dets"]}

def by_counting(frames):
    """What TrackEval does not say. Each answer has one target at most, and the other way, so there is nothing to choose."""
    matches, first, found, coast, before = {}, {}, {}, {}, None
    n = dict.fromkeys(["fragmentations", "hidings", "coasts", "coast_frames", "coast_most", "returns", "resumed"], 0)
    gap, left, overlaps = set(), {}, []
    for t, seen, hidden, scored, beside in frames:
        on = {i: k for i, b in seen.items() for k, a in scored.items() if iou(b, a) >= IOU}
        for i in seen:
            first.setdefault(i, t)
            if i not in on:
                if i in found: gap.add(i)
                continue
            found.setdefault(i, t)
            n["fragmentations"] += i in gap
            gap.discard(i)
            matches.setdefault(on[i], []).append(i)
            if i in left:
                n["returns"] += 1
                n["resumed"] += left.pop(i) == on[i]
        for i, box in hidden.items():
            if before and i in before[0]:
                n["hidings"] += 1
                coast[i] = [before[0][i], 0]
                left[i] = before[0][i]
            elif not (before and i in before[1]): coast.pop(i, None)
            if i not in coast: continue
            track = coast[i][0]
            answer = (scored | beside).get(track)
            if answer is None or track in on.values(): coast.pop(i); continue
            coast[i][1] += 1
            n["coasts"] += coast[i][1] == 1
            n["coast_frames"] += 1
            n["coast_most"] = max(n["coast_most"], coast[i][1])
            overlaps.append(alike_hidden(answer, box))
        for i in seen: coast.pop(i, None)
        before = (on, hidden)
    answered = {}
    for f in frames:
        for k in f[3]: answered[k] = answered.get(k, 0) + 1
    purity = [max(map(m.count, m)) / answered[k] for k, m in matches.items()]
    return n | {"tracks_false": len(answered) - len(matches), "coast_held": sum(a >= 0.5 for a in overlaps), "beside": sum(len(f[4]) for f in frames),
                "targets_found": len(found), "length_most": max(answered[k] for k in matches),
                "_purity": purity, "_length": [answered[k] for k in matches], "_coast": overlaps, "_delay": [found[i] - first[i] for i in found]}

def judge(folder, path):
    score = json.load(open(path))["recognisers"][0]["tracks"]
    parts = [by_trackeval(f) | by_counting(f) for f in (list(frames_of(folder, b)) for b in BANDS)]
    want = {}
    for key in parts[0]:
        values = [p[key] for p in parts]
        if key[0] == "_": want[key] = sum(values, [])
        else: want[key] = max(values) if key.endswith("_most") else sum(values)
    mean = lambda of: sum(want[of]) / len(want[of])
    want |= {"purity": mean("_purity"), "length": mean("_length"), "coast_similarity": mean("_coast"), "delay_s": mean("_delay"),
             "delay_most_s": max(want["_delay"]), "idf1": 2 * want["idtp"] / (want["present"] + want["answers"]),
             "idp": want["idtp"] / want["answers"], "idr": want["idtp"] / want["present"],
             "mota": (2 * want["matched"] - want["answers"] - want["switches"]) / want["present"]}
    wrong = [f"{k}: {score.get(k)}, not {v}" for k, v in want.items()
             if k[0] != "_" and not abs(score.get(k, math.nan) - v) <= 1e-12 * max(1, abs(v))]
    dull = [k for k in ("switches", "fragmentations", "coasts", "resumed", "beside", "mostly_tracked", "tracks_false") if not want[k]]
    if wrong or dull: sys.exit("\n".join(wrong + [f"{k}: nothing to differ in" for k in dull]))
    print(f"{len(want) - 4} figures are equal: {want['switches']} switches, {want['coast_frames']} frames of coasting, IDF1 {want['idf1']:.3f}")

{"make": lambda: make(sys.argv[2], int(sys.argv[3])), "judge": lambda: judge(sys.argv[2], sys.argv[3])}[sys.argv[1]]()
