#!/usr/bin/env bash
# `pitviper range`: what larger targets, more contrast, thicker air and harder tasks do to a sensor's ranges; its table and plot;
# a replay's targets; and what is refused. Its figures: test_range_judge.sh.
. "$(dirname "$0")/common.sh"
judges python3

# km METHOD TASK: of the summary of the last run
km() { sed -n "s/^$1 .*$2 \(beyond \)\?\([0-9.]*\) km.*/\2/p" "$tmp/stdout"; }
# ranges OPTIONS: of the staring LWIR sensor, into $tmp/out
ranges() { run range staring_lwir -o "$tmp/out" --overwrite "$@"; check "range $*: exit code" [ $code = 0 ]; }

ranges
for file in range.csv range.svg; do check "$file" [ -s "$tmp/out/$file" ]; done
check "nothing half written" [ -z "$(find "$tmp/out" -name '*.part')" ]
check "the plot is XML" xml "$tmp/out/range.svg"
check "six curves" [ "$(grep -c '<polyline' "$tmp/out/range.svg")" = 6 ]
check "a row a range" [ "$(wc -l <"$tmp/out/range.csv")" = 202 ]
check "each row has all cells" [ "$(awk -F, '{ print NF }' "$tmp/out/range.csv" | sort -u)" = 11 ]
check "probabilities fall with range, and with the task" awk -F, 'NR > 2 {
    for (i = 5; i <= 11; i++) { if (i != 8 && ($i > was[i] + 1e-9 || $i < 0 || $i > 1)) exit 1; was[i] = $i }
    if ($6 > $5 || $7 > $6 || $10 > $9 || $11 > $10) exit 1 } NR == 2 { for (i = 5; i <= 11; i++) was[i] = $i }' "$tmp/out/range.csv"
johnson=$(km Johnson recognise) ttp=$(km TTP recognise)
check "detected farther than recognised" is "$(km Johnson detect)" '>' "$johnson"
check "recognised farther than identified" is "$johnson" '>' "$(km Johnson identify)"
# its pixels' half is resolved near by: ranges in proportion to size over cycles
ranges --size 4.6
check "twice the size, twice the range by pixels: $(km Johnson recognise)" is "$(awk -v a="$(km Johnson recognise)" -v b="$johnson" 'BEGIN { d = a / b - 2; print d < 0 ? -d : d }')" '<' 0.02
check "and farther by TTP" is "$(km TTP recognise)" '>' "$ttp"
ranges --criteria johnson
check "4 cycles instead of 3: $(km Johnson recognise)" is "$(awk -v a="$(km Johnson recognise)" -v b="$johnson" 'BEGIN { d = a / b - 0.75; print d < 0 ? -d : d }')" '<' 0.01
ranges --n50 1,6,12 --v50 4,15,26
check "harder tasks, TTP" is "$(km TTP recognise)" '<' "$ttp"
check "harder tasks, Johnson" is "$(km Johnson recognise)" '<' "$(awk -v a="$johnson" 'BEGIN { print 0.6 * a }')"
ranges --probability 0.9
check "of nine in ten" is "$(km TTP recognise)" '<' "$ttp"
check "of nine in ten: said" said 'probability of 0.9'
ranges --contrast -0.2
check "less contrast, of either sign" is "$(km TTP recognise)" '<' "$ttp"
ranges --visibility 2
check "thick haze" is "$(km TTP detect)" '<' 10
ranges --air midlat_summer
check "moist air" is "$(km TTP recognise)" '<' "$ttp"
ranges --far 1
check "beyond the last row" said 'detect beyond 1 km'
ranges --size 0.01 --far 10
check "a speck" said 'identify nowhere|identify 0\.00'
run range etc/sensors/example_flir2.sheet -o "$tmp/sheet"
check "a data sheet" [ $code = 0 -a -s "$tmp/sheet/range.csv" ]
run range tv -o "$tmp/day" --sun 45
day=$(km TTP recognise)
run range tv -o "$tmp/dusk" --sun 2
check "a low sun" is "$(km TTP recognise)" '<' "$day"
run range staring_swir -o "$tmp/swir"
check "a channel in another's place" [ $code = 0 ]

# the same of a replay's targets: where a band has a sensor
exercise demo "$tmp/demo.pcap"
replay "$tmp/demo.pcap" "$tmp/frames" --from 1366 --to 1366 --bands lwir,mwir --set sensor.preset=staring_lwir --no-png
check "replay" [ $code = 0 ]
check "cycles, TTP and probabilities of what is seen" python3 - "$tmp/frames/truth.jsonl" <<'PY'
import json, sys
seen = 0
for line in open(sys.argv[1]):
    for t in json.loads(line)["targets"]:
        b = t["bands"]
        assert not set(b.get("mwir", {})) & {"cycles", "ttp_v", "p_detect"}, b  # without a sensor
        if "ttp_v" not in b.get("lwir", {}):
            continue
        lwir, seen = b["lwir"], seen + 1
        assert 0 <= lwir["cycles"] <= 0.5 * t["pixels"] ** 0.5 + 1e-9, t
        for p, half in (("p_detect", 2), ("p_recognise", 7.5), ("p_identify", 13)):
            x = lwir["ttp_v"] / half
            assert abs(lwir[p] - x ** (1.51 + 0.24 * x) / (1 + x ** (1.51 + 0.24 * x))) < 1e-9, (p, lwir)
assert seen > 0
PY

echo kept >"$tmp/out/range.csv"
run range staring_lwir -o "$tmp/out"
check "existing files: exit code" [ $code = 1 ]
check "existing files: said" complained 'range\.csv exists already.*--overwrite'
check "existing files: kept" [ "$(cat "$tmp/out/range.csv")" = kept ]
run range staring_lwri -o "$tmp/none"
check "no such sensor" complained "no sensor named 'staring_lwri'"
run range staring_lwir --air mars -o "$tmp/none"
check "no such air" complained 'mars'
run range "$tmp/none.sheet" -o "$tmp/none"
check "no such sheet" complained 'none.sheet'
check "nothing is made" [ ! -e "$tmp/none" ]
while read -r named arguments; do
    # shellcheck disable=SC2086
    run range -o "$tmp/none" $arguments
    check "range $arguments: exit code" [ $code = 2 ]
    check "range $arguments: said" complained "$named"
    check "range $arguments: nothing is made" [ ! -e "$tmp/none" ]
done <<'WRONG'
--class tv --class ufo
--size tv --size 0
--size tv --size nan
--contrast tv --contrast 0
--visibility tv --visibility 0.1
--height tv --height -1
--sun tv --sun 0
--far tv --far 0
--criteria tv --criteria lloyd
--n50 tv --n50 1,2
--n50 tv --n50 3,2,1
--v50 tv --v50 1,2,3,4
--v50 tv --v50 1,2,inf
--probability tv --probability 1
sensor tv staring_lwir
sensor --size 2
option tv --frob
WRONG
finish
