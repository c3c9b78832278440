#!/usr/bin/env bash
# etc/giveaway: what its figures are, against what is known of drawn and random images; and that content, as it is by default, takes
# the hottest pixel from targets: few views of one vehicle, with a few hundred metres of the world about it. Shares: test_giveaway_deep.sh.
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.OpenEXR

check "its figures are those of drawn images" python3 tests/system/giveaway_judge.py etc/giveaway
python3 etc/giveaway "$tmp" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "a folder without a run: a failure, with the next step" eval '[ $code = 1 ] && complained "neither run.json .*pitviper replay"'
echo '{}' >"$tmp/run.json"; : >"$tmp/truth.jsonl"
python3 etc/giveaway "$tmp" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "a run without frames: a failure" eval '[ $code = 1 ] && complained "no frames"'

# ---- by default content has hot things ----------------------------------------------------------------
exercise tests/scores/twelve.yaml "$tmp/twelve.pcap"
cat >"$tmp/axes.yaml" <<'Y'
axes:
  terrain.clutter: [0, 1]
Y
"$pitviper" replay "$tmp/twelve.pcap" --sweep "$tmp/axes.yaml" --out "$tmp/views" -q --size 128x96 --threads 2 --bands mwir --no-png --rate 0.2 \
    --host observer --from +2 --to +39 --planes entity,part,material,instance --set exercise.aim=1:3001:13 --set observer.rate_dps=9 \
    --set observer.range_m=1200 --set sensor.preset=staring_mwir --set exercise.local_solar=2026-06-21T02:00:00 \
    --set terrain.woods_half_m=300 --set terrain.woods_far_m=0 --set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=64 \
    --set heat.vehicle_step_s=600 --set terrain.detail=off --set terrain.buildings=off || fail "the views"
views() { # views CLUTTER: what the hottest pixel of eight views about a tank whose engine idles lies on
    local folder
    folder=$(grep -F "\"terrain.clutter\":\"$1\"" "$tmp/views/manifest.jsonl" | grep -oE '"folder":"[^"]*"' | cut -d'"' -f4)
    python3 etc/giveaway "$tmp/views/$folder" --bands mwir --csv "$tmp/views.csv" >/dev/null || fail "etc/giveaway"
}
figure() { awk -F, -v what="$1" '$2 == what { print $3 }' "$tmp/views.csv"; }
views 0
check "without clutter every hottest pixel is the target's" is "$(figure hottest_target)" '==' 1
check "and a fixed threshold finds little else" is "$(figure fixed_false_a_frame)" '<=' 0.5
views 1
check "with clutter it is the target's in 0.6 of views, or fewer" is "$(figure hottest_target)" '<=' 0.6
check "and else of two kinds or more" [ "$(grep -c '^mwir,hottest_' "$tmp/views.csv")" -ge 3 ]
check "and a fixed threshold has a false alarm a view" is "$(figure fixed_false_a_frame)" '>=' 1
finish
