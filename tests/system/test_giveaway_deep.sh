#!/usr/bin/env bash
# Among what stands in the rear area (terrain.clutter_table) the hottest pixel of a frame with a target is not the target's too often,
# and what else it lies on is of several kinds, none of them a mark by itself. A sweep of 12 scenes of three frames.
# labels: deep two
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.OpenEXR

sed 's/^  seed: .*/  seed: [1, 2]/' tests/scores/giveaway.yaml >"$tmp/sweep.yaml"
"$pitviper" exercise tests/scores/world.yaml -o "$tmp/world.pcap" -q || fail "the exercise"
"$pitviper" replay "$tmp/world.pcap" --sweep "$tmp/sweep.yaml" --out "$tmp/out" -q --set observer.range_m=800 --set terrain.clutter=1 \
    --set terrain.clutter_table=rear_area || fail "the sweep"
python3 etc/giveaway "$tmp/out" --bands mwir,lwir --csv "$tmp/figures.csv" || fail "etc/giveaway"
for band in mwir lwir; do
    check "$band: frames are seen" is "$(awk -F, -v b=$band '$1 == b && $2 == "frames" { print $3 }' "$tmp/figures.csv")" '>=' 30
done
finish
