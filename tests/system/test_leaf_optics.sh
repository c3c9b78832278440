#!/usr/bin/env bash
# Reflectance and transmittance of leaves against PROSPECT.
. "$(dirname "$0")/common.sh"
judges python3.prosail
check "leaves are PROSPECT's" python3 tests/system/leaf_optics.py etc/plant_optics.csv
# its twin: one value 0.002 off
awk -F, -v OFS=, '/^leaf_/ && !done { for (i = 1; i <= NF; i++) if ($i ~ /^0\.[0-9]+$/) { $i += 0.002; done = 1; break } } { print }' \
    etc/plant_optics.csv >"$tmp/spoilt.csv"
python3 tests/system/leaf_optics.py "$tmp/spoilt.csv" >"$tmp/said" 2>&1
check "its twin: a leaf that is 0.002 off" grep -q '^FAILED: leaf_' "$tmp/said"
finish
