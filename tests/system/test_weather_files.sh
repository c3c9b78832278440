#!/usr/bin/env bash
# Weather files of a year, hour by hour, against pvlib's readers. labels: small
. "$(dirname "$0")/common.sh"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
python3 tests/system/weather_files.py "$pitviper" "$tmp" >"$tmp/said" 2>&1
code=$?
cat "$tmp/said"
[ $code != 77 ] || exit 77
check "EPW and TMY3 are read as pvlib reads them" [ $code = 0 ]
finish
