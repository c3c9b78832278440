#!/usr/bin/env bash
# publish.video_labels: a lossless video with and without: where pixels differ, and that each visible target of truth.jsonl has a
# white line just outside its box. labels: video
. "$(dirname "$0")/common.sh"
needs "video: built without FFmpeg's libraries" has_video
judges ffmpeg python3.numpy
exercise demo "$tmp/demo.pcap"
for labels in off bands targets; do
    replay "$tmp/demo.pcap" "$tmp/$labels" "${quick[@]}" --bands mwir,lwir --size 160x120 --rate 5 --only 20,30 --no-png --set sensor.hfov_deg=12 \
        --video "$tmp/$labels.mkv" --set publish.video_codec=ffv1 --set publish.video_labels=$labels
    check "$labels: replays" [ $code = 0 ]
    ffmpeg -v error -y -i "$tmp/$labels.mkv" -fps_mode passthrough -f rawvideo -pix_fmt gray16le "$tmp/$labels.gray"
    check "$labels: ffmpeg reads it" [ $? = 0 ]
done
check "the planes are the same" eval 'same_hashes "$tmp/off" "$tmp/targets" && same_hashes "$tmp/off" "$tmp/bands"'
check "labels where they are said" python3 - "$tmp" <<'END'
import json, numpy as np, sys
tmp = sys.argv[1]
off, bands, targets = (np.fromfile(f"{tmp}/{n}.gray", "<u2").reshape(-1, 120, 320) for n in ("off", "bands", "targets"))
assert len(off) == 2
corner = np.zeros((120, 320), bool)
for left in 0, 160: corner[:12, left:left + 2 + 6 * 4 + 1] = True       # four letters of 6 x 8
assert (bands == off)[:, ~corner].all()
for f in bands:
    for left in 0, 160: assert 20 < (f[:12, left:left + 27] > 32768).sum() < 160
seen = 0
for line, a, b in zip(open(f"{tmp}/targets/truth.jsonl"), off, targets):
    may = corner.copy()
    for t in json.loads(line)["targets"]:
        x0, y0, x1, y1 = t["box_px"]
        if x1 <= x0: continue
        text = 6 * len(t["marking"]) + 1
        for left in 0, 160:
            stop = left + 160
            may[max(0, y0 - 2):y1 + 2, max(left, left + x0 - 2):min(stop, left + x1 + 2)] = True
            may[max(0, y0 - 12):y1 + 12, max(left, left + x0 - 1):min(stop, left + x0 + text)] = True
            if y0 >= 12 and y1 < 100 and x0 > 2 and x1 < 158:
                seen += 1
                assert (b[y1, left + x0:left + x1] == 65535).all()      # the line below, which no text of its own covers
                assert not (a[y1, left + x0:left + x1] == 65535).all()
    assert (a == b)[~may].all()
assert seen >= 4, seen
END
finish
