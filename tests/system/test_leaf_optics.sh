#!/usr/bin/env bash
# Reflectance and transmittance of leaves against PROSPECT. labels: small
. "$(dirname "$0")/common.sh"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
python3 tests/system/leaf_optics.py >"$tmp/said" 2>&1
code=$?
cat "$tmp/said"
[ $code != 77 ] || exit 77
check "leaves are PROSPECT's" [ $code = 0 ]
finish
