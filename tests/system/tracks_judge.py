"""Scores of tracks by TrackEval and py-motmetrics, of the sequences that track_scores prints (standard input).

    tracks_judge.py trackeval|motmetrics    prints what differs, the greatest difference, and how much was compared
"""
import contextlib, io, json, sys
import numpy

with contextlib.redirect_stdout(io.StringIO()):
    if sys.argv[1] == "trackeval": import trackeval.metrics
    else: import motmetrics

def scored(frame):
    """Truths that are visible and tracks that are scored, with their similarities."""
    truth, track = numpy.array(frame["truth"], int), numpy.array(frame["track"], int)
    hidden = numpy.array(frame["hidden"], bool)
    s = numpy.array(frame["similarity"], float).reshape(len(truth), len(track))
    meets = s >= 0.5
    keep = meets[~hidden].any(axis=0) | ~meets[hidden].any(axis=0)
    return truth[~hidden], track[keep], s[~hidden][:, keep], int((~keep).sum())

def by_trackeval(frames):
    ids = sorted({int(i) for f in frames for i in f[0]})
    tracks = sorted({int(i) for f in frames for i in f[1]})
    data = {"gt_ids": [numpy.array([ids.index(i) for i in f[0]], int) for f in frames],
            "tracker_ids": [numpy.array([tracks.index(i) for i in f[1]], int) for f in frames],
            "similarity_scores": [f[2] for f in frames], "num_timesteps": len(frames),
            "num_gt_ids": len(ids), "num_tracker_ids": len(tracks),
            "num_gt_dets": sum(len(f[0]) for f in frames), "num_tracker_dets": sum(len(f[1]) for f in frames)}
    with contextlib.redirect_stdout(io.StringIO()):
        identity = trackeval.metrics.Identity().eval_sequence(data)
        clear = trackeval.metrics.CLEAR().eval_sequence(data)
    out = {"idtp": identity["IDTP"], "idfp": identity["IDFP"], "idfn": identity["IDFN"],
           "matched": clear["CLR_TP"], "switches": clear["IDSW"], "mostly_tracked": clear["MT"], "mostly_lost": clear["ML"],
           "present": data["num_gt_dets"], "answers": data["num_tracker_dets"], "truths": len(ids), "tracks": len(tracks),
           "similarity": clear["MOTP_sum"] if "MOTP_sum" in clear else 0, "beside": sum(f[3] for f in frames)}
    # its ratios of nothing are 0, as are those of a sequence without truths or answers
    if data["num_gt_dets"] and data["num_tracker_dets"]:
        out |= {"idf1": identity["IDF1"], "idp": identity["IDP"], "idr": identity["IDR"], "mota": clear["MOTA"]}
    return out

def by_motmetrics(frames):
    accumulator = motmetrics.MOTAccumulator(auto_id=True)
    for truth, track, s, _ in frames:
        accumulator.update(truth, track, numpy.where(s >= 0.5, 1 - s, numpy.nan))
    names = ["idtp", "idfp", "idfn", "num_switches", "num_fragmentations", "num_detections", "mostly_tracked", "mostly_lost",
             "idf1", "idp", "idr", "mota"]
    got = motmetrics.metrics.create().compute(accumulator, metrics=names, return_dataframe=False)
    rename = {"num_switches": "switches", "num_fragmentations": "fragmentations", "num_detections": "matched"}
    out = {rename.get(n, n): float(v) for n, v in got.items() if numpy.isfinite(float(v))}
    del out["mostly_tracked"] # its share is 0.8 and more, not above 0.8
    return out

judge = {"trackeval": by_trackeval, "motmetrics": by_motmetrics}[sys.argv[1]]
worst, compared, sequences, sums = 0.0, 0, 0, {}
for line in sys.stdin:
    one = json.loads(line)
    frames = [scored(f) for f in one["frames"]]
    want = judge(frames)
    sequences += 1
    for name, value in want.items():
        if name not in one["score"]: continue
        difference = abs(one["score"][name] - value)
        worst = max(worst, difference if difference == difference else 9)
        compared += 1
        sums[name] = sums.get(name, 0) + value
        if not difference <= 1e-9: print(f"sequence {one['sequence']}: {name} {one['score'][name]}, not {value}")
print("sequences", sequences)
print("compared", compared)
print("worst", worst)
for name, value in sums.items(): print("sum", name, value)
