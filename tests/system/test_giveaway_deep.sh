#!/usr/bin/env bash
# Among what stands in the rear area (terrain.clutter_table) the hottest pixel of a frame is a target's in some 60 % of frames with one,
# and what else it lies on is of four kinds or more, none of them a mark by itself. 12 scenes of three frames; bounds are 0.6 and a fifth
# and the sampling error of 18 views (a scene is seen at two times of day), 1.64 sqrt(p (1 - p) / 18).
# labels: deep two
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.OpenEXR

sed 's/^  seed: .*/  seed: [1, 2]/' tests/scores/giveaway.yaml >"$tmp/sweep.yaml"
"$pitviper" exercise tests/scores/world.yaml -o "$tmp/world.pcap" -q || fail "the exercise"
"$pitviper" replay "$tmp/world.pcap" --sweep "$tmp/sweep.yaml" --out "$tmp/out" -q --set observer.range_m=800 --set terrain.clutter=1 \
    --set terrain.clutter_table=rear_area || fail "the sweep"
python3 etc/giveaway "$tmp/out" --bands mwir,lwir --csv "$tmp/figures.csv" >/dev/null || fail "etc/giveaway"
figure() { awk -F, -v band="$1" -v what="$2" '$1 == band && $2 == what { print $3 }' "$tmp/figures.csv"; }
# What a recogniser would take for targets: clutter, by class.
others() { grep "^$1,hottest_" "$tmp/figures.csv" | grep -v 'hottest_\(target\|ground\|plant\|building\|sky\)'; }
for band in mwir lwir; do
    check "$band: frames are seen" is "$(figure $band frames)" '==' 36
    check "$band: the hottest pixel is the target's in 0.6 of frames, or fewer" is "$(figure $band hottest_target)" '<=' 0.79
    check "$band: and not in none" is "$(figure $band hottest_target)" '>=' 0.2
    check "$band: else it lies on four kinds or more" [ "$(others $band | wc -l)" -ge 4 ]
    check "$band: on none in more than a fifth" is "$(others $band | cut -d, -f3 | sort -g | tail -1)" '<=' 0.355
done
finish
