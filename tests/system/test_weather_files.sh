#!/usr/bin/env bash
# Weather files of a year, hour by hour, against pvlib's readers. labels: small
. "$(dirname "$0")/common.sh"
judges python3.pvlib
check "EPW and TMY3 are read as pvlib reads them" python3 tests/system/weather_files.py "$pitviper" "$tmp"
finish
