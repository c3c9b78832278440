#!/usr/bin/env bash
# replay --sweep: random draws are kept as more are asked for, and a file with slips runs nothing.
. "$(dirname "$0")/common.sh"

. "$(dirname "$0")/sweep.sh"

draws() { printf 'mode: random\ncount: %s\ndraw: %s\naxes: {sensor.hfov_deg: {from: 2, to: 6}, seed: {from: 1, to: 9}}\n' "$1" "$2"; }
draws 1 5 >"$tmp/r1.yaml"; draws 2 5 >"$tmp/r2.yaml"; draws 1 6 >"$tmp/other.yaml"
sweep "$tmp/r1.yaml" "$tmp/r" --no-files
sweep "$tmp/r2.yaml" "$tmp/r" --no-files
check "random: --no-files, and none is there" [ -z "$(find "$tmp/r" -path '*/frames*')" ]
check "random: more draws keep the first" [ "$(statuses "$tmp/r")" = ' 1 "status":"kept" 1 "status":"made" ' ]
check "random: within" bash -c "grep -oE 'hfov_deg\":\"[0-9.]+' '$tmp/r/manifest.jsonl' | cut -d'\"' -f3 | awk '\$1 < 2 || \$1 > 6 { bad = 1 } END { exit bad || NR != 2 }'"
check "random: whole seeds" [ "$(grep -cE '"seed":"[1-9]"' "$tmp/r/manifest.jsonl")" = 2 ]
sweep "$tmp/other.yaml" "$tmp/r" --no-files
check "random: another seed, other draws" [ "$(statuses "$tmp/r")" = ' 1 "status":"made" ' ]
printf 'axes: {weather.visibility_m: [9000, 9000]}\n' >"$tmp/same.yaml"
sweep "$tmp/same.yaml" "$tmp/same" --no-files
check "a value said twice is run once" said '1 variant left out: equal to others'

printf 'axes: {sensor.bands: [[mwir, lwir], lwir, [lwir]]}\n' >"$tmp/lists.yaml"
sweep "$tmp/lists.yaml" "$tmp/lists" --no-files
check "a list in a list is one value, and the same said otherwise is run once" said '1 variant left out: equal to others'
check "a list in a list: both bands, and one" [ "$(grep -ohE '"bands":"[a-z,]*"' "$tmp/lists/manifest.jsonl" | tr '\n' ' ')$(grep -ohE '"sensor.bands":"[a-z,]*"' "$tmp/lists/manifest.jsonl" | tr '\n' ' ')" = '"sensor.bands":"mwir,lwir" "sensor.bands":"lwir" ' ]

# the example of etc/reference/products.md, of one time, weather and seed: cameras, and the exact image beside them
sed -nE '/^    axes:$/,/^$/p' etc/reference/products.md | sed -E 's/(utc|visibility_m|seed): \[([^],]*),.*/\1: \2/' >"$tmp/manual.yaml"
sweep "$tmp/manual.yaml" "$tmp/manual"
check "the manual's sweep: three sensors" [ "$(statuses "$tmp/manual")" = ' 3 "status":"made" ' ]
check "two of cameras, whose counts there are, and none" eval \
    '[ "$(grep -c "\"sensor.preset\":\"[a-z_0-9]*,tv\"" "$tmp/manual/manifest.jsonl") $(find "$tmp/manual" -path "*/raw/optical/*.png" | wc -l)" = "2 2" ]'

slip() { # slip WHAT PATTERN TEXT
    printf "$3" >"$tmp/slip.yaml"
    sweep "$tmp/slip.yaml" "$tmp/slip"
    check "$1: exit code $code" [ "$code" = 2 ]
    check "$1: named" complained "$2"
    check "$1: nothing is run" [ ! -e "$tmp/slip" ]
}
slip "unknown key" 'slip.yaml:3: no such key: weather.visibilty_m; did you mean weather.visibility_m' 'axes:\n  seed: [1]\n  weather: {visibilty_m: [5000]}\n'
slip "out of range" "slip.yaml:4: weather.visibility_m: '50' is not a number in 100 .. 300000 m" 'axes:\n  weather.visibility_m:\n    - 5000\n    - 50\n'
slip "not a word of the key's" "slip.yaml:1: sensor.optical: 'red' is not one of rgb.pan.nir" 'axes: {sensor.optical: [rgb, red]}\n'
slip "given twice" 'slip.yaml:3: sensor.hfov_deg:.*twice' 'axes:\n  sensor.hfov_deg: [3]\n  sensor: {hfov_deg: [4]}\n'
slip "a list of what takes none" 'slip.yaml:1: seed: needs single values, or lists of words where the key takes' 'axes: {seed: [[1, 2], [3]]}\n'
slip "a list in a list in a list" 'slip.yaml:1: sensor.bands: needs single values' 'axes: {sensor.bands: [[[lwir]], [mwir]]}\n'
slip "a wrong word in a list" "sensor.bands: 'optical,lwr' is not a list.*there is no 'lwr'" 'axes: {sensor.bands: [[optical, lwr]]}\n'
slip "together wrong" 'in variant 2, exercise.from_s=1400' 'axes: {exercise.from_s: [1366, 1400]}\n'
slip "a time that is none" "exercise.utc: 'noon'" 'axes: {exercise.utc: [noon]}\n'
slip "an unknown sensor" "no sensor named 'hubble'" 'axes: {sensor.preset: [none, hubble]}\n'
slip "mode" "slip.yaml:1: mode: 'dance' is not one of grid.zip.random" 'mode: dance\naxes: {seed: [1]}\n'
slip "a stray key" "slip.yaml:1: no such key: 'seed'" 'seed: [1, 2]\n'
slip "unequal lists" 'slip.yaml:4: sensor.hfov_deg: has 3 values, but seed has 2' 'mode: zip\naxes:\n  seed: [1, 2]\n  sensor.hfov_deg: [3, 4, 5]\n'
slip "random without count" 'count: is missing' 'mode: random\naxes: {seed: [1, 2]}\n'
slip "more draws than there are" 'slip.yaml:2: count: 7 different draws are requested, but the axes have 6 combinations' \
    'mode: random\ncount: 7\naxes: {seed: [1, 2, 3], weather.visibility_m: [5000, 23000]}\n'
slip "count out of range" "count: '0' is not a whole number in 1 .. 10000" 'mode: random\ncount: 0\naxes: {seed: [1]}\n'
slip "count without random" 'count: .*applies to `mode: random`' 'count: 3\naxes: {seed: [1]}\n'
slip "a range in a grid" 'slip.yaml:1: seed: only `mode: random` draws' 'axes: {seed: {from: 1, to: 9}}\n'
slip "a range of words" 'is not a number' 'mode: random\ncount: 2\naxes: {sensor.optical: {from: rgb, to: pan}}\n'
slip "a range upside down" 'from is above to' 'mode: random\ncount: 2\naxes: {seed: {from: 9, to: 1}}\n'
slip "too many" 'more than 10000 variants' "axes: {seed: [$(seq -s, 1 101)], weather.pressure_mbar: [$(seq -s, 900 1000)]}\n"
slip "overflow" 'more than 10000 variants' "axes: {$(for k in sensor.width_px sensor.height_px seed radar.bins weather.visibility_m detector.level; do echo "$k: [$(seq -s, 100 2000)],"; done | sed '$d')}\n"
slip "no axes" 'axes: are missing' 'mode: grid\n'
slip "empty axes" 'axes' 'axes:\n'
slip "an empty list" 'empty list' 'axes: {seed: []}\n'
slip "a list of lists" 'needs single values' 'axes: {seed: [[1]]}\n'
slip "not YAML" 'slip.yaml:[12]:' 'axes: {seed: [1\n'
slip "empty" 'expected `axes:`' ''
slip "aliases to itself" 'slip.yaml' 'axes: &a\n  sensor: *a\n'
sweep "$tmp/none.yaml" "$tmp/slip"
check "no such file" [ "$code" != 0 ]
sweep "$tmp/grid.yaml" "$tmp/slip" --host 1:3001:41 --host 1:3001:42
check "several hosts: an axis" complained 'make exercise.host an axis'
sweep "$tmp/same.yaml" "$tmp/odd" --set record.path=$'a\nb'
check "a setting that no file holds: said, not lost" complained 'variant 1, .*its settings cannot be written or read back'
sweep "$tmp/grid.yaml" "$tmp/slip" --memory frames
check "one place for many variants" complained 'publish.memory names one place'
sweep "$tmp/grid.yaml" "$tmp/slip" --coco --no-files
check "what does not go together, in no variant" complained 'publish.coco: needs image files'
# bytes of no sense end in a line, not in a crash (run counts exit codes above 123 as failures)
for seed in 1 2 3 4 5 6; do
    awk -v s=$seed 'BEGIN { srand(s) } { line = $0; for (i = 0; i < 2; i++) { at = int(rand() * (length(line) + 1)); line = substr(line, 1, at) substr("[]{}:,&*-\x27\"%!", int(rand() * 13) + 1, 1) substr(line, at + 2) } print line }' "$tmp/grid.yaml" >"$tmp/noise.yaml"
    "$pitviper" replay "${bare[@]}" "$tmp/none.pcap" --out "$tmp/noise" --sweep "$tmp/noise.yaml" >/dev/null 2>"$tmp/stderr"
    check "noise $seed: refused" [ $? -gt 0 -a $? -lt 124 ]
done
finish
