#!/usr/bin/env bash
# Names of files in a file are relative to that file, wherever one stands: settings, scenarios, sweeps, cases, catalogs,
# sidecars; on the command line to the current folder. And what --quiet leaves out and --verbose adds.
. "$(dirname "$0")/common.sh"
pitviper=$(realpath "$pitviper")
bare=("${quick[@]}")
source=$PWD
mkdir -p "$tmp/a/data/m" "$tmp/elsewhere" "$tmp/case"
exercise demo "$tmp/demo.pcap"
cat >"$tmp/a/data/m/box.obj" <<'OBJ'
v 0 0 0
v 3 0 0
v 0 3 0
v 0 0 3
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
OBJ
printf 'file: m/box.obj\nname: wedge\n' >"$tmp/a/data/wedge.yaml"
printf 'type,model,origin\n1.1.*.7,wedge.yaml,base\n' >"$tmp/a/data/c.csv"
printf 'sensor:\n  width_px: 64\n  height_px: 48\nmodels:\n  catalog: data/c.csv\n' >"$tmp/a/node.yaml"
seen() { grep -q '"wedge"' "$1/truth.jsonl"; }
hash_of() { run_json "$1" | grep -oE '"config_sha256":"[0-9a-f]+"'; }
show() { run replay "$tmp/demo.pcap" --only 0 --no-png --bands lwir --threads 1 "$@"; }

# ---- settings, catalog, sidecar
cd "$tmp/elsewhere" || exit 1
show --config ../a/node.yaml --out "$tmp/o1"
check "settings, from elsewhere" seen "$tmp/o1"
check "neither quiet nor verbose: choices" grep -q 'exercise.utc' "$tmp/stdout" && check "no tables" not grep -q 'table:' "$tmp/stderr"
cd "$tmp/a" || exit 1
run model list -c node.yaml
check "settings, from where they lie" grep -q 'wedge.yaml' "$tmp/stdout"
run check node.yaml
check "check agrees" [ $code = 0 ]
cd "$tmp" || exit 1
show --set models.catalog=a/data/c.csv --out "$tmp/o3" --size 64x48 --verbose
cp "$tmp/stdout" "$tmp/verbose.out"; cp "$tmp/stderr" "$tmp/verbose.err"
check "--set: from the current folder" seen "$tmp/o3"
check "and it is the same configuration" [ "$(hash_of "$tmp/o1")" = "$(hash_of "$tmp/o3")" ]
show --set models.catalog=data/c.csv --out "$tmp/o4" --size 64x48
check "--set: not from another" [ $code = 1 ] && check "said, with the rule" complained 'models.catalog: cannot read data/c.csv: .*on the command line to the current folder'
check "a pipe has no folder: as the command line" eval '"$pitviper" check <(printf "models:\n  catalog: a/data/c.csv\n") >/dev/null 2>&1'

# ---- a sweep
printf 'axes:\n  models.catalog: [data/c.csv]\n  seed: [1]\n' >"$tmp/a/sweep.yaml"
cd "$tmp/elsewhere" || exit 1
run replay "$tmp/demo.pcap" --sweep ../a/sweep.yaml --out "$tmp/s" --size 64x48 --bands lwir --to 1362.1 --threads 1
check "sweep: made" [ $code = 0 -a "$(cat "$tmp"/s/*/truth.jsonl | grep -c '"wedge"')" -ge 1 ]
run replay "$tmp/demo.pcap" --sweep ../a/sweep.yaml --out "$tmp/s" --size 64x48 --bands lwir --to 1362.1 --threads 1
check "sweep: again: kept" said '0 made, 1 kept'

# ---- a case; a scenario
printf 'purpose: paths\nlog: ../demo.pcap\nconfig: |\n  sensor:\n    width_px: 64\n    height_px: 48\n    bands: lwir\n  models:\n    sag_m: 0.05\n    catalog: ../a/data/c.csv\n  terrain: {woods: off, spacing_m: 16, detail: off}\n  heat: {facets: 3, step_s: 3600, shadow_m: 0, vehicle_step_s: 600}\nframes: [0]\ncausal: false\n' >"$tmp/case/case.yaml"
cd / || exit 1
run regress --update "$tmp/case" --why "first" --work "$tmp/work"
check "case: it runs" [ $code = 0 ]
check "case: and sees its model" seen "$tmp/case/record"
sed 's/catalog: .*/catlog: x/' -i "$tmp/case/case.yaml"
run regress "$tmp/case"
check "case: what is wrong in its lines is still said" said 'no such key: models.catlog'
printf 'duration_s: 1\nground:\n  elevation: dem/none.tif\n' >"$tmp/a/s.yaml"
run exercise "$tmp/a/s.yaml" -o "$tmp/x.pcap"
check "scenario: relative to it" complained "$tmp/a/dem/none.tif"

# ---- what is wrong, with the line that led there
printf 'sensor:\n  width_px: 64\nterrain:\n  elevation: a.tif, %s\n  cover_table: codes.csv\nweather:\n  atmosphere: ./air\n' "$tmp/demo.pcap" >"$tmp/a/bad.yaml"
run check "$tmp/a/bad.yaml"
check "check: elevation, at its line" complained "bad.yaml:4: terrain.elevation"
check "check: cover's table, at its line" complained "bad.yaml:5: terrain.cover_table" && check "and where it was looked for" complained "$tmp/a/codes.csv"
check "check: atmosphere, at its line" complained "bad.yaml:7: weather.atmosphere" && check "and where" complained "there is no folder $tmp/a/./air"
printf 'type,model,origin\n1.1,m/box.obj,base\n1.1.2,m/none.obj,base\n' >"$tmp/a/data/c2.csv"
printf 'models:\n  catalog: data/c2.csv\n' >"$tmp/a/bad.yaml"
run check "$tmp/a/bad.yaml"
check "check: a model that is not there: catalog and line" complained 'c2.csv line=3' && check "and its setting" complained 'bad.yaml:2: models.catalog'
printf 'joints: 3\n' >"$tmp/a/data/m/box.yaml"
run check "$tmp/a/bad.yaml"
check "check: a sidecar" complained 'm/box.yaml:1: joints:'
rm "$tmp/a/data/m/box.yaml"
head -n 30 "$source/etc/materials.csv" | sed 's/^grass_green,0.0413/grass_green,1.5/' >"$tmp/a/m.csv"
printf 'models:\n  materials: m.csv\n' >"$tmp/a/bad.yaml"
run check "$tmp/a/bad.yaml"
check "check: a material out of range" complained 'a/m.csv.*rho_b' && check "and its setting" complained 'bad.yaml:2: models.materials'
cp -r "$source/etc/atmosphere/us1976" "$tmp/a/air"
printf 'weather:\n  atmosphere: ./air\n' >"$tmp/a/good.yaml"
run check "$tmp/a/good.yaml"
check "an atmosphere of one's own" [ $code = 0 ]

# ---- quiet and verbose
cd "$tmp" || exit 1
show -q --config a/node.yaml --out "$tmp/q"
check "quiet: warnings alone" [ $code = 0 -a ! -s "$tmp/stdout" -a "$(grep -vc '^pitviper: warning: ' "$tmp/stderr")" = 0 ]
check "the pictures are the same" same_hashes "$tmp/q" "$tmp/o1"
run -q replay "$tmp/none.pcap" --out "$tmp/q"
check "quiet: errors stay" [ $code = 1 -a -s "$tmp/stderr" ]
run inspect --quiet "$tmp/demo.pcap"
check "quiet: what was asked for stays" grep -q 'Shapes' "$tmp/stdout"
check "verbose: choices, too" grep -q 'exercise.utc' "$tmp/verbose.out"
check "verbose: tables" grep -qE 'table: .*/materials.csv: [0-9]+ rows' "$tmp/verbose.err"
check "verbose: models" grep -qE 'model: .*box.obj: .*sidecar: .*wedge.yaml' "$tmp/verbose.err"
check "verbose: times" grep -qE 'replay: shade: .* ms a frame' "$tmp/verbose.err"
run replay "$tmp/demo.pcap" -q -v
check "both: refused" [ $code = 2 ] && check "said" complained 'quiet and --verbose exclude each other'
for command in replay run check model regress inspect exercise record probe bench; do
    run "$command" --help
    check "$command --help has both" [ "$(grep -cE '^  -(q, --quiet|v, --verbose) ' "$tmp/stdout")" = 2 ]
done
cd "$source" || exit 1
finish
