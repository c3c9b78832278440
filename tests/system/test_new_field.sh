#!/usr/bin/env bash
# A new field of truth.jsonl is one row: that of etc/ADDING.md is put into sensor/frame/target_fields.c, and nothing else is
# touched. It is then in the file, in the reference, and compared by regress.
# labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"
judges python3
needs "ninja, and the build folder's own objects" ninja -C "$build" -t commands pitviper
source=sensor/frame/target_fields.c
object=CMakeFiles/sensor.dir/$source.o
row=$(awk '/^ *```c truth field$/ { on = 1; next } /^ *```/ { on = 0 } on' etc/ADDING.md)
check "ADDING has a row, one" [ "$(grep -c '{"' <<<"$row")" = 1 ]
name=$(sed -n 's/^ *{"\([a-z_]*\)".*/\1/p' <<<"$row")
check "no field is called so" not grep -rqF "\"$name\"" sensor/frame

# with_row ROW: a program of that source with the row at the end of the targets' rows, all else as it was built
with_row() {
    awk -v row="$1" '{ if (in_it && /^};/) { print row; in_it = 0 } print } /^static const Field target_rows/ { in_it = 1 }' $source >"$tmp/target_fields.c"
    ninja -C "$build" -t commands "$object" | tail -n 1 | sed "s|[^ ]*$source\$|$tmp/target_fields.c|; s|-o [^ ]*|-o $tmp/row.o|; s|-M[FT] [^ ]*||g; s|-MD||" >"$tmp/build.sh"
    ninja -C "$build" -t commands pitviper | tail -n 1 | sed "s|CMakeFiles/pitviper.dir/main.c.o|& $tmp/row.o|; s|-o pitviper |-o $tmp/bin/pitviper |" >>"$tmp/build.sh"
    (cd "$build" && bash -e "$tmp/build.sh") >"$tmp/build.out" 2>&1 || { fail "it builds"; tail -n 5 "$tmp/build.out"; }
}
mkdir "$tmp/bin"
for module in "$build"/*.so "$build"/pitviper-rasters; do [ ! -e "$module" ] || ln -s "$(realpath "$module")" "$tmp/bin/"; done
exercise demo "$tmp/demo.pcap"
replayed() { run replay "$tmp/demo.pcap" --out "$tmp/$1" --overwrite --size 32x24 --rate 1 --from 1366 --to 1366 --bands lwir --no-png --threads 1 "${bare[@]}" "${coarse[@]}"; }
replayed before
check "before: a replay" [ $code = 0 ]
without=$pitviper
with_row "$row"
pitviper=$tmp/bin/pitviper
export PITVIPER_ETC=$PWD/etc
replayed after
check "after: a replay" [ $code = 0 ] || tail -n 3 "$tmp/stderr"
python3 - "$tmp" "$name" <<'PY'
import json, sys
folder, name = sys.argv[1:]
before, after = (json.loads(open(f'{folder}/{run}/truth.jsonl').readline()) for run in ('before', 'after'))
assert before['targets'] and all(name not in t for t in before['targets']), 'before: it is there'
for target in after['targets']:
    assert list(target)[-1] == name, (name, list(target))
    # of the frame's table, whose values in the plane begin with 1
    assert target.pop(name) == target['plane_value'] - 1, target
assert json.dumps(before) == json.dumps(after), 'other fields differ'
PY
check "truth.jsonl: every target has it, all else is as it was" [ $? = 0 ]
run help truth
check "help: it is listed" grep -qE "^  targets\[\]\.$name +integer" "$tmp/stdout"
run help --markdown
check "products.md: it is listed" grep -qE "^\| \`targets\[\]\.$name\` \| integer \|" "$tmp/stdout"

# ---- compared
new_case good 32x24 5 5
run regress --update "$tmp/good" --why 'a new field'
check "regress: a baseline" [ $code = 0 ] || tail -n 3 "$tmp/stderr"
check "regress: which has it" grep -q "\"$name\":" "$tmp/good/record/truth.jsonl"
run regress "$tmp/good"
check "regress: it is equal" [ $code = 0 ]
cp -r "$tmp/good" "$tmp/spoilt"
sed -i "s/\"$name\":\([0-9]\)/\"$name\":9\1/" "$tmp/spoilt/record/truth.jsonl"
fails spoilt "motion: targets\[.*\]\.$name is [0-9]+, was 9[0-9]+ in frame 5"
# held: a run that lacks it fails; a baseline from before does not
pitviper=$without
fails good "motion: targets\[.*\]\.$name is absent, was"
finish
