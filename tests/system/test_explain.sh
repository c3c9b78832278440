#!/usr/bin/env bash
# `pitviper explain`: the terms of pixels of all kinds (ground, sky, plants, targets large and small, their edges, smoke) add up
# to the value in the EXR to the bit, by the program and by a judge that adds them up itself; greys and counts are those of the
# images; what emits has Planck's radiance of the told temperature. Wrong pixels, frames and folders are told what to do.
. "$(dirname "$0")/common.sh"
# A few pixels here; test_explain_deep.sh has all kinds, sensors, and a forced table.
judges python3.OpenEXR python3.numpy python3.PIL
whole=${whole:-false}

judge() { python3 tests/system/explain_judge.py "$@"; }
# with plants
bare=(--set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=64 --set heat.vehicle_step_s=600 --set detector.agc_s=0
    --set terrain.woods=on --set terrain.woods_half_m=300 --set terrain.woods_trees=1000 "${coarse[@]}")
exercise demo "$tmp/demo.pcap"

# explained OUT FRAME KIND X Y: judged; what it was made of is added to $tmp/facts
explained() {
    local out=$1 frame=$2 kind=$3 x=$4 y=$5
    "$pitviper" explain "$out" "$frame" "$x" "$y" --json --threads 2 >"$tmp/e.json" 2>"$tmp/stderr"
    check "$kind $x $y of frame $frame: explained" [ $? = 0 ]
    judge "$out" "$frame" judge "$kind" "$x" "$y" <"$tmp/e.json" >"$tmp/said"
    check "$kind $x $y of frame $frame: the judge agrees" [ $? = 0 ]
    grep -v '^FACTS' "$tmp/said"
    grep '^FACTS' "$tmp/said" >>"$tmp/facts"
}

run replay "$tmp/demo.pcap" --out "$tmp/out" --size 120x81 --only 12,38 --save-frame 12,38 --bands optical,mwir,lwir,radar \
    --threads 2
check "replay" [ "$code" = 0 ]
for frame in 12 38; do
    $whole || [ $frame = 38 ] || continue
    judge "$tmp/out" $frame pixels>"$tmp/pixels"
    $whole || { grep -m1 '^inside' "$tmp/pixels" >"$tmp/one"; mv "$tmp/one" "$tmp/pixels"; }
    check "frame $frame has pixels to explain" [ -s "$tmp/pixels" ]
    while read -r kind x y; do explained "$tmp/out" $frame "$kind" "$x" "$y"; done <"$tmp/pixels"
done
sed 's/^FACTS //' "$tmp/facts"
if $whole; then
for kind in ground sky plant inside edge beside; do check "some $kind" grep -q "^FACTS $kind " "$tmp/facts"; done
for what in matte smoke mean1 mean4 smoothed beside target; do
    check "some pixel has $what" grep -qE "^FACTS .* $what( .*)? \|" "$tmp/facts"
done
for what in sky ground alder truck; do check "some ray met $what" grep -qE "\|.* ?$what" "$tmp/facts"; done
fi

# the twin: one term of one ray a thousandth off, and the judge refuses
read -r _ x y < <(grep '^inside' "$tmp/pixels")
if $whole; then "$pitviper" explain "$tmp/out" 38 "$x" "$y" --json --threads 1 >"$tmp/one.json"; else cp "$tmp/e.json" "$tmp/one.json"; fi
check "the judge refuses another figure" judge "$tmp/out" 38 twin inside "$x" "$y" <"$tmp/one.json" >/dev/null
"$pitviper" explain "$tmp/out" 38 "$x" "$y" --json --threads 3 >"$tmp/three.json"
check "the same with other threads" cmp "$tmp/one.json" "$tmp/three.json"
run explain "$tmp/out" 38 "$x" "$y"
check "text: the exit code" [ "$code" = 0 ]
check "text: no more than 50 lines" [ "$(wc -l <"$tmp/stdout")" -le 50 ]
check "text: the verdict" said 'the sums are the planes. values to the bit, and the planes are those of the run'
check "text: value and sum" [ "$(grep -E "^  sum, in the|^  the plane's value " "$tmp/stdout" | awk '{print $(NF-4), $NF}' | sort -u | wc -l)" = 1 ]

px=($x $y)

if $whole; then
# sensors: raw counts; lateral colour: R and B have rays of their own
run replay "$tmp/demo.pcap" --out "$tmp/sensor" --size 96x64 --only 12 --save-frame 12 --bands optical,lwir --threads 2 \
    --set sensor.preset=staring_lwir --set detector.raw=true --set sensor.lateral_r=0.002 --set sensor.lateral_b=-0.002
check "sensors: replay" [ "$code" = 0 ]
judge "$tmp/sensor" 12 pixels | grep -E '^(edge|ground)' >"$tmp/pixels"
while read -r kind x y; do explained "$tmp/sensor" 12 "$kind" "$x" "$y"; done <"$tmp/pixels"
fi

# another table: refused by name; forced, the pixel of another picture is explained, and that is said
cp -r etc "$tmp/etc"
sed -i '/^[a-z]/s/,0\.0\([0-9]\)/,0.1\1/g' "$tmp/etc/materials.csv"
PITVIPER_ETC=$tmp/etc run explain "$tmp/out" 38 "${px[@]}"
check "another table: refused" [ "$code" = 1 ]
check "another table: named" complained 'materials\.csv is not the table'
$whole && PITVIPER_ETC=$tmp/etc run explain "$tmp/out" 38 "${px[@]}" --force
$whole && check "another table, forced: exit code" [ "$code" = 1 ]
$whole && check "another table, forced: says so" complained 'explain: the frame rendered here is not that of the file'
$whole && check "another table, forced: in the verdict" said "values to the bit; but the planes are not those of the run"

# what cannot be explained
refused() { # refused CODE WHAT WORDS ARGUMENTS
    local want=$1 what=$2 words=$3; shift 3
    run explain "$@"
    check "$what: exit code $want" [ "$code" = "$want" ]
    check "$what: says $words" complained "$words"
    check "$what: nothing else" [ ! -s "$tmp/stdout" ]
}
out=$tmp/out
refused 1 "outside" 'outside the picture of 120 x 81: columns are 0 to 119, rows 0 to 80' "$out" 12 120 0
refused 1 "outside" 'outside the picture' "$out" 12 0 81
refused 1 "an unknown frame" 'has no frame 13; its frames are 12 to 38' "$out" 13 1 1
refused 1 "no folder" "no folder '$tmp/none'" "$tmp/none" 12 1 1
mkdir "$tmp/empty"
refused 1 "not ours" 'not a folder of products: it has no run.json' "$tmp/empty" 12 1 1
mkdir "$tmp/hosts" && ln -s "$out" "$tmp/hosts/1-3001-41"
refused 1 "several hosts" 'name one of them: .*/hosts/1-3001-41' "$tmp/hosts" 12 1 1
mv "$out/frame_000012.pvf" "$tmp/kept.pvf"
refused 1 "not saved" 'was not saved.*--only 12 --save-frame 12' "$out" 12 1 1
head -c 2000 "$tmp/kept.pvf" >"$out/frame_000012.pvf"
refused 1 "damaged" 'cannot be read' "$out" 12 1 1
refused 2 "too few words" 'OUT FRAME X Y are needed' "$out" 12 1
refused 2 "too many words" "not also '9'" "$out" 12 1 2 9
refused 2 "no column" "X: '-1' is not a whole number" "$out" 12 -- -1 1
refused 2 "no row" "Y: '1.5' is not a whole number" "$out" 12 1 1.5
refused 2 "another option" 'no such option|--jsen' "$out" 12 1 1 --jsen
finish
