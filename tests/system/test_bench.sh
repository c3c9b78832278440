#!/usr/bin/env bash
# pitviper bench, quickly: every row is there and whole, and every error that has a limit keeps it. No time is judged.
. "$(dirname "$0")/common.sh"

unset PITVIPER_DATA
# table SUITE: runs it, table in $tmp/SUITE.csv
table() {
    run bench "$1" --quick --threads 2 --csv "$tmp/$1.csv"
    check "$1 ends well" [ $code = 0 ]
    check "$1 names the machine first" grep -q "pitviper [0-9]" <(head -n 1 "$tmp/stdout")
    check "$1: the file too" grep -q "^# .*pitviper [0-9]" <(head -n 1 "$tmp/$1.csv")
    check "$1: every error keeps its limit" [ "$(grep -c ',no$' "$tmp/$1.csv")" = 0 ]
    check "$1: some have one" [ "$(grep -c ',yes$' "$tmp/$1.csv")" -ge 4 ]
    check "$1: every row has as many columns as the header" \
        awk -F, 'NR == 2 { n = NF } NR > 1 { line = $0; gsub(/"[^"]*"/, "", line); if (split(line, x, ",") != n) exit 1 }' "$tmp/$1.csv"
    check "$1: every row has a figure above 0" \
        awk 'NR > 2 { line = $0; gsub(/"[^"]*"/, "", line); split(line, x, ","); if (!(x[3] > 0)) { print; exit 1 } }' "$tmp/$1.csv"
}
# has SUITE WHAT
has() { check "$1 has a row: $2" grep -q "^$1,.*$2" "$tmp/$1.csv"; }

table dis
for what in "Entity State: decode" "Entity State: encode" "Fire: decode" "Detonation: encode" bundles "capture: read" \
            "report: walk" "report: update alone" "snapshot"; do has dis "$what"; done

table speed
for what in "ground: " "ground: pyramid" "40 m up: frame" "100 m up: frame" "300 m up: frame" "1000 m up: frame" \
            "rays alone" "one ray a pixel" "1 thread: snapshot" "1 thread: air" "1 thread: visibility" "1 thread: sun rays" \
            "1 thread: shading" "small targets" "pass over edges" "truth of targets" "hash of the planes" "256 x 256" \
            "of the pixels: one ray a pixel" "optical alone, one ray" "radar alone" "files of a frame" "memory: posts" "memory: arena" "memory: resident"; do
    has speed "$what"
done

# every approximation has its knob, with one default each, whose error is what is stated
run bench precision --quick --threads 2 --csv "$tmp/precision.csv"
check "precision ends well" [ $code = 0 ]
check "precision: every default keeps what is stated" [ "$(grep -c ',no$' "$tmp/precision.csv")" = 0 ]
for knob in "Earth to local frame" "latitude. longitude. height" "geoid between posts" "the sun's place" "powers of two" \
            "spacing of invented ground" "reach of the finest level" "height of a post" "texture under a pixel" \
            "dead reckoning" "heat of parts between reports" "radiance of a black body" "temperature of a radiance" \
            "light on the ground" "smoke along a ray" "air before a pixel. visible" "air before a pixel. thermal" \
            "radiance of the sky" "light of the sky on a plane" "range to the ground" "range to a part" "rays a pixel" \
            "rays a pixel. 8-12 um" "rays over a small target" "light from all around" "mirrors of a radar path" \
            "rays a pixel. radar" "facets" "facets. silhouette" "optics' blur" "electrons of a radiance" "display" "converter" \
            "display's curve"; do
    check "precision has one default of: $knob" \
        [ "$(grep -cE "^precision,\"?$knob: .* \(default\)\"?,.*,yes$" "$tmp/precision.csv")" = 1 ]
    check "precision has other settings of: $knob" \
        [ "$(grep -E "^precision,\"?$knob: " "$tmp/precision.csv" | grep -vc "(default)")" -ge 1 ]
done
for absent in trees "heat conduction" "shooting and bouncing"; do has precision "$absent.*none in this version"; done

run bench speed --quick --size 17
check "a size that is none is refused" [ $code = 1 ]
check "and said" complained "size: '17' is not"
run bench speed --quick --ground 1x1 --model "$tmp/none.obj"
check "a model that is not there is refused" [ $code = 1 ]
check "and said, too" complained "none.obj"

finish
