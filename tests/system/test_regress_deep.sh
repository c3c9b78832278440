#!/usr/bin/env bash
# A case fails in the channel that was spoilt and in no earlier one: more settings and tables than test_regress.sh has.
# labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"

new_case good
run regress --update "$tmp/good" --why 'seen'
check "a record" [ $code = 0 ]
changed another_rate 's/rate_hz: 5/rate_hz: 4/';        fails another_rate 'time: time_s is '
changed another_exercise 's/^config/scenario_set: seed=5\nconfig/'; fails another_exercise '(counters|pose): '
changed other_lobe 's/^  seed: 1/  seed: 1\n  radar: {lobe_deg: 4}/'; fails other_lobe '(radar|radar profile): '
changed noisy 's/^  seed: 1/  seed: 1\n  detector: {noise: 50}/'; fails noisy 'target signals: '
changed bent "s/^    width_px/    hfov_deg: 6.2\n    width_px/"; fails bent '(pose|entity|part): '
changed other_bins 's/^  seed: 1/  seed: 1\n  radar: {bins: 100}/'
fails other_bins 'size: expected [0-9]+ range bins, actual 100'
while read -r column factor named; do fails_by_table "$column" "$factor" "$named"; done <<'COLUMNS'
solar_absorptance 0.9 temperature
rho_g 0.9 optical
radar_gamma 1.1 radar
COLUMNS
finish
