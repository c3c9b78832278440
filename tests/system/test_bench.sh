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
    [ "$1" = stability ] || check "$1: every row has a figure above 0" \
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

table stability # errors alone
for what in "time stamp to seconds" "exercise clock unwrapped" "denormals, infinities" "latitude, longitude, height to ECEF" "ENU axes: jump" \
            "1000 km away" "origins anywhere" "sun over leap seconds" "geoid: a pole" "ground: cliffs" "ground of files: voids" \
            "dead reckoning, nine algorithms" "turn to turn" "psi, theta, phi" "turrets at any angle" "Entity State: each float" \
            "Detonation: each float" "scenario: each key" "effects.csv" "probes: each column" "built-in models" "1e6 to 1" \
            "model files: needles"; do has stability "$what"; done

run bench speed --quick --size 17
check "a size that is none is refused" [ $code = 1 ]
check "and said" complained "size: '17' is not"
run bench speed --quick --ground 1x1 --model "$tmp/none.obj"
check "a model that is not there is refused" [ $code = 1 ]
check "and said, too" complained "none.obj"

finish
