#!/usr/bin/env bash
# Thousands of spoilt GeoTIFF, VRT, NetCDF and DTED headers (tests/terrain/test_raster_mutations.c). labels: deep
. "$(dirname "$0")/common.sh"
program=$build/tests/terrain_tests
needs "$program" test -x "$program"
check "spoilt files do no harm" env PITVIPER_MUTATIONS=1000 "$program" test_raster_mutations
finish
