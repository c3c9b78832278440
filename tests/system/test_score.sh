#!/usr/bin/env bash
# pitviper score as a user runs it: counts that answers were made for, exactly; average precision as pycocotools has it, on
# random boxes and on a rendered run; a sweep; recognisers side by side; the end of a replay whose frames were answered.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.pycocotools
bare=("${bare[@]}" "${coarse[@]}")
judge() { check "$1" python3 tests/system/score_judge.py "${@:2}"; }

# ---- counts, of one run and of a sweep
python3 tests/system/score_folder.py "$tmp/one" --frames 40 --seed 3
run score "$tmp/one"
check "score" [ $code = 0 ] || cat "$tmp/stderr"
check "its summary" grep -qE '^  all +[0-9]+  0\.[0-9]+ \(' "$tmp/stdout"
judge "counts" counts "$tmp/one/score.json" "$tmp/one/expected.json"
cp "$tmp/one/score.json" "$tmp/first.json"
run score "$tmp/one"
check "not replaced without --overwrite" [ $code = 1 ] && complained 'score\.json.*--overwrite'
shuf --random-source=<(yes) "$tmp/one/answers.jsonl" >"$tmp/shuffled.jsonl" && cp "$tmp/shuffled.jsonl" "$tmp/one/answers.jsonl"
run score "$tmp/one" --overwrite
check "answers in another order: the same to the octet" cmp "$tmp/one/score.json" "$tmp/first.json"

python3 tests/system/score_judge.py coco-of "$tmp/one"
judge "average precision without coco.json" coco "$tmp/one/score.json" "$tmp/one/made.json" "$tmp/one/results.json"

python3 tests/system/score_folder.py "$tmp/sweep" --frames 12 --sequences 4 --seed 5
run score "$tmp/sweep"
check "sweep" [ $code = 0 ] && check "sweep: variants" grep -q '48 frames of 4 variants' "$tmp/stdout"
judge "counts of a sweep" counts "$tmp/sweep/score.json" "$tmp/sweep/expected.json"
grep -v '"file"' "$tmp/sweep/score.json" >"$tmp/folders.json"
run score "$tmp/sweep" "$tmp/sweep/answers.jsonl" --overwrite
check "sweep: one file, with the sequence in each line" cmp <(grep -v '"file"' "$tmp/sweep/score.json") "$tmp/folders.json"
run score "$tmp/sweep" "$tmp/one/answers.jsonl" --out "$tmp/elsewhere"
check "sweep: a line without sequence" [ $code = 1 ] && complained 'answers\.jsonl:1: .*`sequence`'
rm "$tmp/sweep/v2/answers.jsonl"
run score "$tmp/sweep" --overwrite
check "sweep: a variant without answers" [ $code = 0 ] && complained 'v2 has no answers\.jsonl, as 1 of 4'

# ---- average precision, on random boxes with ties, crowds, a crowded image and a category that truth has not
for seed in 1 2; do
    mkdir "$tmp/coco$seed"
    python3 tests/system/score_judge.py coco-make "$tmp/coco$seed" $seed
    run score "$tmp/coco$seed" "$tmp/coco$seed/results.json"
    check "COCO results" [ $code = 0 ] || cat "$tmp/stderr"
    judge "average precision $seed" coco "$tmp/coco$seed/score.json" "$tmp/coco$seed/coco.json" "$tmp/coco$seed/results.json"
    # the judge can fail
    sed 's/"ap": 0\.1/"ap": 0.2/; s/"ap75": 0\./"ap75": 0.9/' "$tmp/coco$seed/score.json" >"$tmp/spoilt.json"
    check "average precision, spoilt" eval '! python3 tests/system/score_judge.py coco "$tmp/spoilt.json" "$tmp/coco$seed/coco.json" "$tmp/coco$seed/results.json" >"$tmp/said"'
done

mkdir "$tmp/both"
python3 tests/system/score_judge.py coco-sweep "$tmp/both" 11
run score "$tmp/both" "$tmp/both/results.json"
check "COCO results of a sweep" [ $code = 0 ] && check "COCO results of a sweep: frames" grep -q '80 frames of 2 variants' "$tmp/stdout"
judge "average precision of a sweep" coco "$tmp/both/score.json" "$tmp/both/coco.json" "$tmp/both/results.json"
run score "$tmp/both/va" "$tmp/both/results.json"
check "COCO results of images that are elsewhere" [ $code = 1 ] && complained 'image_id'

# ---- side by side
run score "$tmp/one" "$tmp/one/answers.jsonl" "$tmp/shuffled.jsonl" "$tmp/one/answers.jsonl" --out "$tmp/side" --score 0.5
check "side by side" [ $code = 0 ] && check "side by side: names" grep -qE '^ +answers +shuffled +answers-2' "$tmp/stdout"
run score "$tmp/one" a b c d e
check "five" [ $code = 2 ] && complained "at most 4.*'e'"
run score
check "no OUT" [ $code = 2 ] && complained 'OUT is needed'
run score "$tmp/nowhere"
check "OUT is not there" [ $code = 1 ] && complained 'there is no folder'
mkdir "$tmp/hosts" "$tmp/hosts/videos" && cp -r "$tmp/one" "$tmp/hosts/1-1-1" && cp -r "$tmp/one" "$tmp/hosts/observer"
run score "$tmp/hosts"
check "hosts" [ $code = 0 ] && check "hosts: folders that have truth" grep -q '80 frames of 2 sequences' "$tmp/stdout"
run score "$tmp/hosts/videos"
check "no truth" [ $code = 1 ] && complained 'has no truth\.jsonl'
run score "$tmp/one" --iou 1.5
check "--iou" [ $code = 2 ] && complained "'1.5' is not a number"
run score "$tmp/one" "$tmp/coco1/results.json" --out "$tmp/elsewhere" --overwrite
check "COCO results without coco.json" [ $code = 1 ] && complained 'coco\.json.*--coco'

# ---- a replay that is answered while it runs, and its coco.json
exercise demo "$tmp/demo.pcap"
free_port
python3 -u - $port <<'PY' &
import socket, struct, sys, time
to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
while True:
    for frame in range(40):
        for band in (0, 2):
            one = struct.pack("=5fI32s2I", 40, 30, 60.5, 40, 0.75, 9, b"tank", 0, 0)
            to.sendto(struct.pack("=8sIHHiIII", b"PVDETECT", 0x01020304, 2, 64, frame, band, 1, 0) + one, ("127.0.0.1", int(sys.argv[1])))
    time.sleep(0.003)
PY
answers=$!
run replay "$tmp/demo.pcap" --out "$tmp/run" --size 96x64 --rate 1 --from 1364 --to 1367 --bands optical,lwir --threads 1 --coco --no-png \
    --set publish.detections_port=$port
check "replay" [ $code = 0 ] || cat "$tmp/stderr"
kill $answers
grep -A 99 ' frames of 1 sequence' "$tmp/stdout" >"$tmp/end"
check "the end of a replay: what was answered" grep -qE '^answers: [1-9][0-9]* answers in optical, lwir' "$tmp/end"
run score "$tmp/run"
grep -E '^answers: |^  all |^  optical |^  lwir |^  mean of' "$tmp/stdout" >"$tmp/later"
check "the end of a replay: as score says" diff <(grep -E '^answers: |^  all |^  optical |^  lwir |^  mean of' "$tmp/end") "$tmp/later"
python3 - "$tmp/run" <<'PY'
import json, random, sys
random.seed(4)
coco = json.load(open(sys.argv[1] + "/coco.json"))
out = []
for a in coco["annotations"]:
    for s in (0, 0.1): out.append({"image_id": a["image_id"], "category_id": a["category_id"], "score": random.random(),
                                   "bbox": [a["bbox"][0] + s * a["bbox"][2], a["bbox"][1]] + a["bbox"][2:]})
json.dump(out, open(sys.argv[1] + "/results.json", "w"))
PY
run score "$tmp/run" "$tmp/run/results.json" --overwrite
check "COCO results of a rendered run" [ $code = 0 ] || cat "$tmp/stderr"
judge "average precision of a rendered run" coco "$tmp/run/score.json" "$tmp/run/coco.json" "$tmp/run/results.json"
run replay "$tmp/demo.pcap" --out "$tmp/run" --size 32x24 --rate 1 --from 1364 --to 1364 --bands lwir --threads 1 --no-png --overwrite
check "a new run has no score of the earlier one" [ $code = 0 -a ! -e "$tmp/run/score.json" ]
finish
