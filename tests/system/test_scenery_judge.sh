#!/usr/bin/env bash
# A house of walls, roof and windows on level ground, in the sun and in its own shadow, against Mitsuba 3: the sun alone, sun and sky
# with light sampled over the hemisphere, and as frames have it by default: each within 2 %.
. "$(dirname "$0")/common.sh"
judges python3.mitsuba

regions() { # the table of regions
    python3 tests/system/scenery_judge.py "$tmp/house" >"$tmp/regions" || fail "scenery_judge.py"
}
worst() { # worst COLUMN [ONLY]: the largest deviation, of regions `lit` or `shade`
    awk -v column="$1" -v only="${2:-}" 'only == "" || $2 == only { v = $column < 0 ? -$column : $column; if (!(v <= w)) w = v } END { print w }' "$tmp/regions"
}
mkdir -p "$tmp/house"
"$build/tests/scenery_scene" "$tmp/house" || fail "scenery_scene"
regions
cat "$tmp/regions"
check "ground, walls, roofs and windows, lit and in shade" [ "$(cut -d' ' -f1 "$tmp/regions" | sort -u | tr '\n' ' ')" = "ground roof wall window " ]
check "the sun alone: $(worst 5) %" is "$(worst 5)" '<' 2
check "sun and sky, sampled: $(worst 7) %" is "$(worst 7)" '<' 2
check "by default, in the sun: $(worst 9 lit) %" is "$(worst 9 lit)" '<' 2
check "by default, in shade: $(worst 9 shade) %" is "$(worst 9 shade)" '<' 2
check "by default, the last metre before the walls: $(worst 9 close) %" is "$(worst 9 close)" '<' 2

# its twin: walls a tenth brighter
awk '$1 == "part" && $2 == "wall" { $3 *= 1.1 } { print }' "$tmp/house/scene.txt" >"$tmp/scene.txt"
mv "$tmp/scene.txt" "$tmp/house/scene.txt"
regions
check "its twin is noticed: $(worst 7) %" is "$(worst 7)" '>' 5
finish
