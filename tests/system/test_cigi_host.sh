#!/usr/bin/env bash
# A CIGI host written from the interface control document, over loopback, with what this program reads and sends: packets,
# lockstep, and a host and a network that do not behave; in either octet order. labels: small
. "$(dirname "$0")/common.sh"
needs python3 python3 -c 1
host=$(dirname "$0")/../tools/cigi_host.py

for order in "" --little; do
    for scenario in packets lockstep lost_answers repeats jumps runs_ahead garbage restarts wraps time_back time_ahead silent; do
        # shellcheck disable=SC2086
        check "$scenario $order" python3 "$host" "$build/tests/cigi_ig" $scenario 5 $order
    done
done
check "a long lockstep" python3 "$host" "$build/tests/cigi_ig" lockstep 2000
finish
