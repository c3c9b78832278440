#!/usr/bin/env bash
# The optics of fog and rain against miepython: extinction, scattered share and mean cosine over three spectra of drops.
. "$(dirname "$0")/common.sh"

judges python3.miepython python3.numpy
python3 tests/system/droplets_judge.py >"$tmp/judge.txt" 2>&1
check "the judge ends well" [ $? = 0 ]
cat "$tmp/judge.txt"
for what in radiation advection rain; do
    read -r rows worst < <(grep -oP "^$what \K.*" "$tmp/judge.txt")
    check "$what: a row a wavelength" [ "${rows:-0}" = 38 ]
    check "$what: ${worst:-none}" is "${worst:-9}" '<' 0.05
done

finish
