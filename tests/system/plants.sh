# What the comparisons with Mitsuba share; source it after common.sh.
judges python3.mitsuba

# judged SCENE SUN_DEG PATHS WORST_BLOCK_PERCENT
judged() {
    local scene=$1 sun=$2 paths=$3 worst=$4 line band percent
    mkdir -p "$tmp/$scene"
    "$build/tests/plants_scene" "$tmp/$scene" "$scene" "$sun" || fail "$scene: Pitviper's own pictures"
    python3 tests/system/plants_judge.py "$tmp/$scene" "$paths" >"$tmp/$scene.txt" 2>&1
    check "$scene: the judge ends well" [ $? = 0 ] || tail -n 5 "$tmp/$scene.txt"
    read -r _ blocks percent <<<"$(grep '^direct ' "$tmp/$scene.txt")"
    check "$scene: blocks to compare" is "${blocks:-0}" '>' 80
    check "$scene: first order, worst block of 8 x 8 pixels: $percent %" is "$percent" '<' "$worst"
    check "$scene: three bands" [ "$(grep -c '^all leaves ' "$tmp/$scene.txt")" = 3 ]
    while read -r _ _ band _ _ percent _; do
        check "$scene: all orders, leaves, $band: $percent %" is "${percent#-}" '<' 5
    done < <(grep '^all leaves ' "$tmp/$scene.txt" | tr -d '+')
    sed "s/^/$scene, sun at $sun degrees: /" "$tmp/$scene.txt"
}
