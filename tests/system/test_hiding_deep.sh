#!/usr/bin/env bash
# Where the vehicles of tests/scores/learn.yaml stand gives them away no more than other places do: as many plants beside them as in
# the image, within a factor of two; hardly any at the very centre; hidden as planned, 0.1 .. 0.9; and what is around a place, the
# target blanked, tells no classifier whether a vehicle is there.
# labels: deep two
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.OpenEXR
judge() { python3 tests/system/hiding_judge.py "$1" "$2" >"$tmp/said" || fail "hiding_judge.py $1"; cat "$tmp/said"; }
figure() { awk -v name="$1" '$1 == name { print $2 }' "$tmp/said"; }

sed 's/^  scenario.seed: .*/  scenario.seed: 1/; s/local_solar: .*/local_solar: 2026-06-21T10:00:00/; s/publish.planes: .*/publish.planes: "entity,instance"/
    s/sensor.preset: .*/sensor.preset: staring_lwir/; s/sensor.bands: .*/sensor.bands: lwir/' tests/scores/learn.yaml >"$tmp/about.yaml"
"$pitviper" replay tests/scores/hiding.yaml --sweep "$tmp/about.yaml" --out "$tmp/about" -q || fail "the sweep"
judge about "$tmp/about"
check "plants beside targets: half of the image's share, or more" is "$(figure near_plants)" '>' "$(awk -v a="$(figure frames_plants)" 'BEGIN { print a / 2 }')"
check "plants beside targets: twice the image's share, or less" is "$(figure near_plants)" '<' "$(awk -v a="$(figure frames_plants)" 'BEGIN { print a * 2 }')"
check "targets are seen" is "$(figure targets)" '>' 40
check "hardly any is at the centre" is "$(figure centred)" '<=' 0.05

cat >"$tmp/planned.yaml" <<'Y'
axes:
  seed: [1, 2]
  scenario.seed: [1, 2, 3, 4, 5, 6, 7, 8]
  exercise.aim: ["1:3001:11", "1:3001:21", "1:3001:31", "1:3001:51"]
  observer.range_m: 600
  observer.rate_dps: 0
  exercise.host: observer
  exercise.from_s: "+2"
  exercise.to_s: "+2"
  exercise.local_solar: 2026-06-21T10:00:00
  sensor.preset: [[staring_lwir]]
  sensor.bands: [[lwir]]
  publish.planes: "entity,instance"
  publish.pairs: all
  heat.facets: 3
  heat.step_s: 1800
  heat.shadow_m: 64
  terrain.woods_far_m: 0
Y
"$pitviper" replay tests/scores/hiding.yaml --sweep "$tmp/planned.yaml" --out "$tmp/planned" -q || fail "the sweep of places"
judge planned "$tmp/planned"
check "most are hidden as planned, to 0.1" is "$(figure within)" '>' 0.7
check "and none the more for it" is "$(figure bias | tr -d +-)" '<' 0.04
check "in all nine bins" is "$(grep -c '^bin_' "$tmp/said")" '>=' 8
judge context "$tmp/planned"
check "surroundings tell nothing" is "$(figure auc)" '<=' 0.55
finish
