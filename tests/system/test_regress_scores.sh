#!/usr/bin/env bash
# Scores of a recogniser as a channel of `pitviper regress`: recorded answers and a command, made of the truth of the frames so
# that the rates are known; what goes wrong with a command; a bisection that ends in the scores.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"
judges python3

new_case case 96x64 1 '3, 6'
sed -i 's/sag_m: 0.02/sag_m: 0.1/; s/step_s: 1800, shadow_m: 64/step_s: 3600, shadow_m: 0/; s/^    width_px/    bands: lwir\n    width_px/' \
    "$tmp/case/case.yaml"
# answers TRUTH MISSED FALSE: all targets of truth but so many, and so many boxes in the sky; to standard output
cat >"$tmp/answers.py" <<'PYTHON'
import json, sys
missed, false = int(sys.argv[2]), int(sys.argv[3])
for line in open(sys.argv[1]):
    frame = json.loads(line)
    for target in frame["targets"]:
        if missed > 0: missed -= 1
        else: print(json.dumps({"frame": frame["frame"], "band": "lwir", "class": target["class"], "box_px": target["box_px"], "score": 0.9}))
    for k in range(false):
        print(json.dumps({"frame": frame["frame"], "band": "lwir", "class": "tank", "box_px": [8 * k, 0, 8 * k + 6, 4], "score": 0.1}))
    false = 0
PYTHON
with() { # with NAME LINES: the case with its record, and these lines
    rm -rf "${tmp:?}/$1"
    cp -r "$tmp/case" "$tmp/$1"
    printf '%s\n' "$2" >>"$tmp/$1/case.yaml"
}

# ---- recorded answers: all targets found, nothing else ---------------------------------------------------
run regress --update "$tmp/case" --why first --work "$tmp/work"
check "without scores: no scores.json" [ ! -e "$tmp/case/record/scores.json" ]
python3 "$tmp/answers.py" "$tmp/case/record/truth.jsonl" 0 0 >"$tmp/case/answers.jsonl"
with recorded 'scores: {answers: answers.jsonl}'
fails recorded 'scores: the baseline has none: `pitviper regress --update`'
run regress --update "$tmp/recorded" --why 'with answers'
check "recorded: --update" [ $code = 0 ]
python3 - "$tmp/recorded/record" <<'PYTHON' || fail "recorded: scores.json"
import json, math, sys
truth = [json.loads(line) for line in open(sys.argv[1] + "/truth.jsonl")]
chances = sum(1 for frame in truth for t in frame["targets"] if t["pixels"] >= 5)
scores = json.load(open(sys.argv[1] + "/scores.json"))
all = scores["all"]
assert chances == 3 and all["chances"] == all["found"] == all["recognised"] == scores["answers"] == chances, (chances, all)
assert all["frames"] == len(truth) == 2 and all["false_alarms"] == 0 and all["false_alarms_per_frame"] == 0, all
z = 1.959963984540054  # Wilson's bounds of one sample: both frames are of one flight
low = (1 + z * z / 2 - z * z / 2) / (1 + z * z)
assert all["detection"] == 1 and abs(all["detection_low"] - low) < 1e-9 and all["detection_high"] == 1, all
assert scores["ap"] == scores["ap50"] == 1 and list(scores["bands"]) == ["lwir"], scores
PYTHON
run regress "$tmp/recorded"
check "recorded: passes" grep -qE '^recorded +ok: detection rate 1 \(0\.20[67] \.\. 1; 3 of 3 targets\), false alarms per frame 0 .*AP 1' "$tmp/stdout" || cat "$tmp/stdout"
# one target less, two boxes in the sky: as Python counts them
python3 "$tmp/answers.py" "$tmp/case/record/truth.jsonl" 1 2 >"$tmp/recorded/answers.jsonl"
run regress "$tmp/recorded" --report "$tmp/report.html"
check "one missed: exit code" [ $code = 1 ]
check "one missed: the channel, the rates" grep -qE '^recorded +FAILED: scores: detection rate 0\.6667 \(.*; 2 of 3 targets\), was 1 \(.*; 3 of 3 targets\), and [1-9][0-9]* more' "$tmp/stdout" || cat "$tmp/stdout"
check "one missed: no channel before it" not grep -q 'channels after it' "$tmp/stdout"
check "one missed: in the page" grep -q 'detection rate 0.6667' "$tmp/report.html"
printf 'tolerance: {detection: 0.4, false_alarms: 0.9, ap: 1}\n' >>"$tmp/recorded/case.yaml"
fails recorded 'scores: false alarms per frame 1 \(.*; 2 of 2 frames\), was 0 '
sed -i 's/false_alarms: 0.9/false_alarms: 1/' "$tmp/recorded/case.yaml"
run regress "$tmp/recorded"
check "within the case's tolerances" grep -qE '^recorded +ok: detection rate 0.6667' "$tmp/stdout" || cat "$tmp/stdout"

# ---- a command, in the case's folder, with the folder of the run behind it ----------------------------------
cp "$tmp/answers.py" "$tmp/case"
with command 'scores:
  command: ./recogniser.sh --weights "my weights"'
cat >"$tmp/command/recogniser.sh" <<'SH'
#!/bin/bash
[ "$2" = "my weights" ] && [ -z "${DISPLAY:-}" ] && [ -s "$3/frames/lwir/000003.png" ] || { echo "no display of frame 3 in $3" >&2; exit 5; }
python3 -c 'import socket; socket.socket()' 2>/dev/null && { echo "there is a network" >&2; exit 6; }
python3 "$(dirname "$0")/answers.py" "$3/truth.jsonl" 1 0 >"$3/answers.jsonl"
SH
chmod +x "$tmp/command/recogniser.sh"
cp "$tmp/case/record/"* "$tmp/command/record"
DISPLAY=:9 run regress --update "$tmp/command" --why 'as the recogniser has it'
check "command: --update" [ $code = 0 ] || cat "$tmp/stdout"
check "command: two of three" grep -q '"chances":3,"found":2,' "$tmp/command/record/scores.json"
# what makes targets smaller than the scores count is found by a bisection as any other
printf 'seed: 1\n' >"$tmp/old.yaml"
printf 'seed: 1\ndetector: {gain: 2}\n' >"$tmp/new.yaml"
sed -i 's/ 1 0 >/ $(grep -q "gain: 2" "$3\/..\/settings.yaml" \&\& echo 2 || echo 1) 0 >/' "$tmp/command/recogniser.sh"
run regress bisect "$tmp/old.yaml" "$tmp/new.yaml" "$tmp/command"
check "bisect: exit code" [ $code = 1 ]
check "bisect: the key" grep -qE "cause: setting detector.gain is '2', was '1': scores: detection rate 0.3333 \(.*1 of 3 targets\), was 0.6667" "$tmp/stdout" || cat "$tmp/stdout"

# ---- a command that goes wrong is a failed case, with what it said last ------------------------------------------
wrong() { # wrong NAME COMMAND
    with "$1" "scores:
  timeout_s: 1
  command: '$2'"
    cp "$tmp/command/record/scores.json" "$tmp/$1/record"
    sed -i 's/frames: .*/frames: [3]/' "$tmp/$1/case.yaml"
}
wrong fails_ 'echo loading; echo no weights >&2; exit 3; true'
wrong hangs 'echo slow >&2; sleep 4711.25 & sleep 4711.25; true'
wrong silent 'true'
wrong nonsense 'f() { echo nonsense >$1/answers.jsonl; }; f'
wrong absent '/nowhere/recogniser'
with both 'scores: {command: a, answers: b}'
with missing 'scores: {answers: nowhere.jsonl}'
run regress "$tmp"/{fails_,hangs,silent,nonsense,absent,missing} --jobs 2
check "wrong: exit code" [ $code = 1 ]
while IFS='|' read -r name said; do
    check "$name: said" grep -qE "^$name +FAILED: $said" "$tmp/stdout"
    grep -qE "^$name +FAILED: $said" "$tmp/stdout" || grep "^$name " "$tmp/stdout"
done <<'SAID'
fails_|the recogniser failed with exit code 3: no weights
hangs|the recogniser was ended after 1 s \(scores.timeout_s\): slow
silent|the recogniser wrote no answers.jsonl into the folder that is its last argument, /
nonsense|its answers cannot be scored: .*answers.jsonl
absent|the recogniser failed with exit code 127: .*/nowhere/recogniser: not found
missing|scores.answers: .*nowhere.jsonl: No such file .*; record them, or name a command
SAID
check "hangs: its whole process group has ended" [ -z "$(pgrep -fx 'sleep 4711.25')" ]
run regress "$tmp/both"
check "both: exit code" [ $code = 2 ]
check "both: said" complained 'scores.command: and scores.answers: are both given; leave one out'
finish
