# What the comparisons of a box's faces with Mitsuba share; source it after common.sh.
judges python3.mitsuba

# faces INFRARED MODEL VISIBILITY_KM SUN_DEG LIFT_M GROUND PAINT: unlit faces, in $tmp/faces.txt, with contact shadows and by
# sampling
faces() {
    local what="$*" line face channel theirs error contact sampled
    mkdir -p "$tmp/faces"
    "$build/tests/faces_scene" "$tmp/faces" "$@" || fail "$what: Pitviper's own pictures"
    python3 tests/system/faces_judge.py "$tmp/faces" 0.3 >"$tmp/faces.txt" 2>&1
    check "$what: the judge ends well" [ $? = 0 ] || tail -n 5 "$tmp/faces.txt"
    check "$what: two faces, four channels" [ "$(grep -c '^unlit ' "$tmp/faces.txt")" = 8 ]
    while read -r face channel _ _ theirs _ error _ contact _ sampled; do
        check "$what: $channel: Mitsuba's standard error $error %" is "$error" '<=' 0.3
        check "$what: $face $channel, contact shadows: $contact %" is "${contact#[-+]}" '<' 5
        check "$what: $face $channel, sampled: $sampled %" is "${sampled#[-+]}" '<' 5
    done < <(grep '^unlit ' "$tmp/faces.txt")
    sed "s/^/$what: /" "$tmp/faces.txt"
}
