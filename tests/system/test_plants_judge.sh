#!/usr/bin/env bash
# Light among plants against Mitsuba 3: the same trees, leaf spectra, sun and rays. First order, block by block: the lit crown
# and the shaded ground. All orders, which Pitviper has in closed form (render/light/canopy.h): the mean of the leaves.
# labels: small
. "$(dirname "$0")/common.sh"

# judged SCENE SUN_DEG PATHS WORST_BLOCK_PERCENT
judged() {
    local scene=$1 sun=$2 paths=$3 worst=$4 line band percent
    mkdir -p "$tmp/$scene"
    "$build/tests/plants_scene" "$tmp/$scene" "$scene" "$sun" || fail "$scene: Pitviper's own pictures"
    python3 tests/system/plants_judge.py "$tmp/$scene" "$paths" >"$tmp/$scene.txt" 2>&1
    code=$?
    if [ $code = 77 ]; then
        cat "$tmp/$scene.txt"
        exit 77
    fi
    check "$scene: the judge ends well" [ $code = 0 ] || tail -n 5 "$tmp/$scene.txt"
    read -r _ blocks percent <<<"$(grep '^direct ' "$tmp/$scene.txt")"
    check "$scene: blocks to compare" is "${blocks:-0}" '>' 80
    check "$scene: first order, worst block of 8 x 8 pixels: $percent %" is "$percent" '<' "$worst"
    check "$scene: three bands" [ "$(grep -c '^all leaves ' "$tmp/$scene.txt")" = 3 ]
    while read -r _ _ band _ _ percent _; do
        check "$scene: all orders, leaves, $band: $percent %" is "${percent#-}" '<' 5
    done < <(grep '^all leaves ' "$tmp/$scene.txt" | tr -d '+')
    sed "s/^/$scene, sun at $sun degrees: /" "$tmp/$scene.txt"
}

command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
judged oak 44.6 4 2
judged pine 20 4 2
judged stand 44.6 1 4 # of the blocks' dim ones: Mitsuba starts its shadow rays up to 5 mm off, past the nearest leaves
finish
