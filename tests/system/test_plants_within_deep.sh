#!/usr/bin/env bash
# Light within a closed broadleaf forest against Mitsuba 3, of all orders and under an overcast sky: the ground, bark and leaves
# by their height. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/plants.sh"

mkdir -p "$tmp/within"
"$build/tests/plants_scene" "$tmp/within" within -1 || fail "within: Pitviper's own pictures"
python3 tests/system/plants_judge.py "$tmp/within" 2 >"$tmp/within.txt" 2>&1
check "within: the judge ends well" [ $? = 0 ] || tail -n 5 "$tmp/within.txt"
check "within: seven places in three bands" [ "$(grep -c '^within ' "$tmp/within.txt")" = 21 ]
while read -r _ what band _ _ percent _ spread _; do
    case $what in ground | bark | leaves) ;; *) continue ;; esac
    # 20 %, and what the noise of two paths a ray may add
    check "within: $what, $band: $percent +- $spread %" is "${percent#[+-]}" '<' "$(awk "BEGIN { print 20 + 2 * $spread }")"
done < <(grep '^within ' "$tmp/within.txt")
sed 's/^/overcast: /' "$tmp/within.txt"
finish
