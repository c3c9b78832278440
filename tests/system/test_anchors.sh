#!/usr/bin/env bash
# labels: physics
# The tables of etc/ against published values (tests/data/anchors.csv), and against orderings that physics demands where a table
# has few. quality.csv, made by `pitviper bench quality`, has no source outside; woods.csv, ground_detail.csv and effects.csv are
# mostly estimates; leaves of plant_optics.csv are held against PROSPECT by test_leaf_optics.sh.
. "$(dirname "$0")/common.sh"
check "tables hold what their sources say" python3 tests/system/anchors.py etc tests/data/anchors.csv
# its twins: copies with one thing wrong
spoilt() { # spoilt WHAT TABLE SED SAID: the table after sed -E; what is said of it
    rm -rf "$tmp/etc"
    mkdir "$tmp/etc"
    cp -r etc/*.csv etc/radar etc/atmosphere "$tmp/etc"
    sed -i -E "$3" "$tmp/etc/$2"
    check "$1: the copy is another" eval "! cmp -s 'etc/$2' '$tmp/etc/$2'"
    python3 tests/system/anchors.py "$tmp/etc" tests/data/anchors.csv >"$tmp/said"
    check "$1: refused" grep -qE "^FAILED: $4" "$tmp/said"
}
spoilt "rock as soil" surfaces.csv 's/^rock, .*/rock, soil_loam_brown/' 'surfaces.csv rock: material is soil_loam_brown'
spoilt "MWIR and LWIR of engine smoke exchanged" effects.csv '/^engine_smoke,/s/,600,250,/,250,600,/' \
    'effects.csv engine_smoke: ext_mwir'
spoilt "grass clutter + 3 dB" radar/clutter.csv '/^grass,Ku/s/-14.0/-11.0/' 'radar/clutter.csv grass/Ku: gamma_db'
spoilt "a row that is missing" materials.csv '/^snow_coarse,/d' 'materials.csv snow_coarse: no such row'
spoilt "two rows exchanged" materials.csv 's/^stone_granite,/x,/; s/^stone_basalt,/stone_granite,/; s/^x,/stone_basalt,/' \
    'materials.csv stone_basalt'
spoilt "a column that is missing" radars.csv '/^name,/s/centre_ghz/middle_ghz/' 'radars.csv seeker_94: no column centre_ghz'
spoilt "a tenth of a quality's time" quality.csv '/^bare,8,16/s/1.409e\+04/1.409e+03/' 'quality.csv'
cp -r etc/*.csv "$tmp/etc"
sed '/^woods.csv/d' tests/data/anchors.csv >"$tmp/anchors.csv"
python3 tests/system/anchors.py etc "$tmp/anchors.csv" >"$tmp/said"
check "a table without an anchor" grep -q '^FAILED: woods.csv has no anchor; add ' "$tmp/said"
finish
