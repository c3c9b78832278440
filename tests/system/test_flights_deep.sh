#!/usr/bin/env bash
# etc/fly_matrix: with the example tracker three of four flights hit a truck that stands, one that crosses and one that turns, none hits
# without it, and late answers make the miss larger; as tests/flights.csv has it. labels: deep two
. "$(dirname "$0")/common.sh"
judges python3.numpy

check "track: 20 seeds of each case, its twin, and 0.2 s late" python3 etc/fly_matrix --only track --late 0,200 --out "$tmp/out" "$build"
check "hottest: fewer hits" python3 etc/fly_matrix --only hottest --late 0 --out "$tmp/out" "$build"
hits() { grep -cE "^$1,[a-z]+,truck,0,[0-9]+,entity," "$tmp/out/flights.csv"; }
check "the tracker hits more often than the hottest pixel: $(hits track), $(hits hottest)" [ "$(hits track)" -gt "$(hits hottest)" ]
finish
