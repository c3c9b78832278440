#!/usr/bin/env bash
# pitviper score holds answers, not frames: of 100,000 frames of 5 kB with three answers each, 90,000 frames need at most 200 octets an
# answer (80 and 24 each, lists that double, a sort), and all less than 128 MB; the counts are those that were made. labels: deep
. "$(dirname "$0")/common.sh"
needs "/proc/self/status" test -r /proc/self/status
[[ "${sanitized:-}${ASAN_OPTIONS:-}${TSAN_OPTIONS:-}" = "" ]] || skip "memory of a sanitized build is not the program's"
cat >"$tmp/make.py" <<'PY'
import json, os, sys
sys.path.insert(0, "tests/system")
from score_folder import truth_line, target
folder, frames, each = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
os.makedirs(folder)
targets = [target(k + 1, "tank", [50 + 100 * k, 60, 58 + 100 * k, 66], 40, patch_temp_k=[290.25] * 90) for k in range(6)]
rest = json.dumps(truth_line(0, targets), separators=(",", ":"))
assert rest.startswith('{"frame":0,')
rest = rest[len('{"frame":0'):] + "\n"
with open(f"{folder}/truth.jsonl", "w") as truth:
    for frame in range(frames): truth.write(f'{{"frame":{frame}{rest}')
with open(f"{folder}/answers.jsonl", "w") as answers:
    for frame in range(frames):
        for k in range(each):  # one a target, round the targets; every tenth is beside
            n = (frame + k) % 6
            at = 300 if (frame * each + k) % 10 == 0 else 60
            answers.write(f'{{"frame":{frame},"band":"lwir","class":"tank","score":0.{(frame * 7 + k * 3) % 1000:03d},"box_px":[{50 + 100 * n},{at},{58 + 100 * n},{at + 6}],"latency_ms":{frame % 90}}}\n')
PY
# measured FOLDER: its maximum resident set, kB, in $resident; seconds of processor time are printed
measured() {
    read -r resident seconds < <(python3 - "$pitviper" "$1" <<'PY'
import resource, subprocess, sys
subprocess.run([sys.argv[1], "score", sys.argv[2], "-q"], stdout=open(sys.argv[2] + "/said", "w"), check=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_maxrss, round(used.ru_utime + used.ru_stime, 1))
PY
    )
    echo "$1: $resident kB, $seconds s of processor time, $(stat -c %s "$1/truth.jsonl") octets of truth"
}
python3 "$tmp/make.py" "$tmp/few" 10000 3
python3 "$tmp/make.py" "$tmp/many" 100000 3
measured "$tmp/few"
few=$resident
measured "$tmp/many"
check "flat" [ $((resident - few)) -le $((270000 * 200 / 1024)) ]
check "below 128 MB" [ "$resident" -lt 131072 ]
python3 - "$tmp/many/score.json" <<'PY'
import json, sys
r = json.load(open(sys.argv[1]))["recognisers"][0]
t = r["total"]
assert (t["chances"], t["frames"], r["answers"]) == (600000, 100000, 300000), t
assert (t["found"], t["false_alarms"]) == (270000, 30000), t
PY
check "counts of 100,000 frames" [ $? = 0 ]
finish
