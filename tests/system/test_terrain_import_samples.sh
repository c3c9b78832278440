#!/usr/bin/env bash
# `pitviper terrain import` on samples of real terrain: GeoTIFF, SRTM tiles, a landscape file. labels: small
. "$(dirname "$0")/common.sh"
needs_data terrain/autzen/autzen_dtm_1m.tif
data=$data/terrain

run terrain import "$data/autzen/autzen_dtm_1m.tif" --cover "$data/autzen/autzen_cover_1m.tif" --photo \
    "$data/autzen/autzen_rgb_1m.tif" -o "$tmp/autzen.store" --size 0.2x0.2 --horizon 1
check "autzen" [ $code = 0 ]
check "autzen: classes and photograph" said 'photograph: pixels 1 m'
run terrain import "$data/srtm3/N49W123.hgt" "$data/srtm3/N49W124.hgt" -o "$tmp/srtm.store" --origin 49.5,-123 --size 8x8 --horizon 5
check "two SRTM tiles" said 'from 2 files of posts'
run terrain import "$data/bitterroot/example_lcp.tif" --cover "$data/bitterroot/example_lcp.tif" --canopy-height \
    "$data/bitterroot/example_lcp.tif:6" --canopy-cover "$data/bitterroot/example_lcp.tif:5" -o "$tmp/lcp.store" --size 3x3 --horizon 3
check "bitterroot: the table is recognised" said 'table fbfm40'
check "bitterroot: canopies in tenths of a metre" said 'canopy height: numbers of 0\.1 m'
run terrain import "$data/bigtujunga/bigtujunga.tif" -o "$tmp/big.store" --size 3x3 --horizon 3
check "bigtujunga" [ $code = 0 ]
finish
