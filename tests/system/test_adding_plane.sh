#!/usr/bin/env bash
# etc/ADDING.md, a plane: its row in the one list, and no other file, is a plane in files, by name, in help and in
# regression; a row of what the renderer has is in hashes and saved frames too. A field of a frame file: its line. labels: two deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"
judges python3.numpy python3.OpenEXR
needs "ninja, and a build by it" ninja -C "$build" -n
root=$PWD
build=$(realpath "$build")
blocks() { awk -v head="$1" '$0 ~ "^ *```" head "$" { on = 1; next } /^ *```/ { on = 0 } on' etc/ADDING.md; }
blocks 'c plane-function' >"$tmp/function.c"
blocks 'c plane' >"$tmp/row.c"
check "there are a function and a row" [ -s "$tmp/function.c" -a -s "$tmp/row.c" ]
check "there is a field of a frame file" [ "$(blocks 'c frame-field' | wc -l)" = 1 ]
link=$(ninja -C "$build" -t commands pitviper | tail -n 1)
check "how the build links" [ -n "$link" ]

# program NAME SOURCE AWK VARIABLES: $tmp/NAME/pitviper with SOURCE as awk makes it: one object of its own, before the libraries
program() {
    local folder=$tmp/$1 source=$2 script=$3 compile; shift 3
    mkdir "$folder"
    awk "$@" 'function put(file, line) { while ((getline line <file) > 0) print line } '"$script" "$source" >"$folder/toy.c"
    check "${folder##*/}: another source" not cmp -s "$source" "$folder/toy.c"
    compile=$(ninja -C "$build" -t commands pitviper | grep -E -- "-c [^ ]*$source\$")
    (cd "$build" && eval "$(sed -E "s| -MF [^ ]+||; s| -MD||; s| -MT [^ ]+||; s| -o [^ ]+| -o $folder/toy.o|; s| -c [^ ]+$| -c $folder/toy.c|" <<<"$compile")" &&
        eval "$(sed -E "s| -o pitviper | $folder/toy.o -o $folder/pitviper |" <<<"$link")") >"$folder/said" 2>&1
    check "${folder##*/}: is built" [ -x "$folder/pitviper" ] || cat "$folder/said"
    check "${folder##*/}: no warning" not grep -q warning "$folder/said"
    for file in pitviper-exr.so pitviper-images.so pitviper-rasters; do ln -s "$build/$file" "$folder/"; done
}
# plane NAME ROW [FUNCTION]: with the row behind that of ranges
plane() {
    program "$1" render/frame/planes.c '/^const PlaneRow plane_rows\[\]/ { put(made) } { print } /\.choice = "range"/ { put(row) }' \
        -v row="$2" -v made="${3:-/dev/null}"
}
small=(--size 32x24 --only 12 --no-png --threads 2 "${coarse[@]}" --overwrite)
plain=$pitviper
exercise demo "$tmp/demo.pcap"
run replay "$tmp/demo.pcap" --out "$tmp/plain" "${small[@]}"

# the two texts that name the planes in words are complete
printf 'publish: {planes: none_such}\n' >"$tmp/none.yaml"
run check "$tmp/none.yaml"
names=$(grep -oE 'a list of .*, each once' "$tmp/stderr" | sed 's/a list of //; s/, each once//; s/ //g')
for help in "replay --help" "check --default"; do
    run $help
    check "$help: names all planes" grep -qF "any of $names" <<<"$(tr -s ' \n' ' ' <"$tmp/stdout" | sed 's/material, temp/material,temp/')"
done

# ---- made for the file: as in ADDING
plane tilt "$tmp/row.c" "$tmp/function.c"
pitviper=$tmp/tilt/pitviper
run help exr
check "help: it is told" grep -qE '^  channel truth/tilt +float$' "$tmp/stdout"
run help regress-record
check "help: of a baseline too" grep -qE '^  channel frame/tilt +uint, 1/512$' "$tmp/stdout"
printf 'publish: {planes: tilts}\n' >"$tmp/tilts.yaml"
run check "$tmp/tilts.yaml"
check "by name: one that is meant" complained "range, tilt, entity, .*did you mean tilt"
run replay "$tmp/demo.pcap" --out "$tmp/one" "${small[@]}" --planes tilt,normal
check "by name: it is chosen" [ $code = 0 ] || cat "$tmp/stderr"
cat >"$tmp/judge.py" <<'PY'
import sys, numpy, OpenEXR
have = {n: c.pixels for n, c in OpenEXR.File(sys.argv[1], separate_channels=True).channels().items()}
assert sorted(have) == ['nx', 'ny', 'nz', 'tilt'], sorted(have)
up, tilt = numpy.abs(have['nz'].astype(float)), have['tilt'].astype(float)
seen = ~numpy.isnan(tilt)
assert 0.2 < seen.mean() <= 1, seen.mean()
assert numpy.abs(tilt[seen] ** 2 + up[seen] ** 2 - 1).max() < 1e-5
PY
check "its values: the normals' own" python3 "$tmp/judge.py" "$tmp/one/frames/truth/000012.exr"
check "the twin: without it the judge objects" not quiet python3 "$tmp/judge.py" "$tmp/plain/frames/truth/000012.exr"
check "no hash changes" same_hashes "$tmp/plain" "$tmp/one"
new_case slope 32x24 5 12
run regress --update "$tmp/slope" --why "a plane more"
check "regress: its baseline" [ $code = 0 ]
run regress "$tmp/slope"
check "regress: the same" grep -qE '^slope +ok' "$tmp/stdout"
sed 's/hypotf(/0.02f + &/' "$tmp/function.c" >"$tmp/steeper.c"
plane steeper "$tmp/row.c" "$tmp/steeper.c"
pitviper=$tmp/steeper/pitviper run regress "$tmp/slope"
check "regress: another value fails in its channel" grep -qE '^slope +FAILED: normal: tilt: .* beyond 0\.' "$tmp/stdout" || cat "$tmp/stdout"
new_case older 32x24 5 12
pitviper=$plain run regress --update "$tmp/older" --why "without it"
pitviper=$tmp/tilt/pitviper run regress "$tmp/older"
check "regress: an older baseline has no such plane" grep -qE '^older +FAILED: normal: tilt of frame 12 is not in the baseline' "$tmp/stdout" || cat "$tmp/stdout"

# ---- of the picture: what small targets cover, which has been without a row
cat >"$tmp/rendered.c" <<'C'
{"truth", "covered", PLANE_TRUTH, PLANE_F32, "", "0 .. 1", "", "share of small targets", .at = AT(covered), .choice = "covered"},
C
plane covered "$tmp/rendered.c"
pitviper=$tmp/covered/pitviper
run replay "$tmp/demo.pcap" --out "$tmp/two" "${small[@]}" --save-frame 12
check "of the picture: it is made" [ $code = 0 ] || cat "$tmp/stderr"
check "of the picture: the hash has it" not same_hashes "$tmp/plain" "$tmp/two"
check "of the picture: the rest is the same" python3 - "$tmp/plain/frames/truth/000012.exr" "$tmp/two/frames/truth/000012.exr" <<'PY'
import sys, numpy, OpenEXR
was, now = ({n: c.pixels for n, c in OpenEXR.File(p, separate_channels=True).channels().items()} for p in sys.argv[1:])
more = now.pop('covered')
assert sorted(was) == sorted(now) and all(numpy.array_equal(was[n], now[n], equal_nan=was[n].dtype.kind == 'f') for n in was)
assert more.min() >= 0 and 0 < more.max() <= 1, (more.min(), more.max())
PY
run frame "$tmp/two/frame_000012.pvf"
check "of the picture: a saved frame has it, to the bit" [ $code = 0 ] || cat "$tmp/stderr"
pitviper=$plain run frame "$tmp/two/frame_000012.pvf"
check "of the picture: a program without it says so" complained 'truth/covered is not among the planes'

# ---- a field of a frame file: a line, which writes and reads
blocks 'c frame-field' >"$tmp/field.c"
program field sensor/verify/saved_frame/saved_fields.c '/^void saved_fields_request/ { on = 1 } on && /^}/ { put(line); on = 0 } { print }' -v line="$tmp/field.c"
pitviper=$tmp/field/pitviper
run replay "$tmp/demo.pcap" --out "$tmp/three" "${small[@]}" --save-frame 12 --no-skip
check "a field: the frame is saved, once it has been read back" [ $code = 0 ] || cat "$tmp/stderr"
run frame "$tmp/three/frame_000012.pvf"
check "a field: it is read" [ $code = 0 ] || cat "$tmp/stderr"
pitviper=$plain run frame "$tmp/three/frame_000012.pvf"
check "a field: a program without it has octets too many" complained 'a chunk is too long'
pitviper=$plain run replay "$tmp/demo.pcap" --out "$tmp/four" "${small[@]}" --save-frame 12
run frame "$tmp/four/frame_000012.pvf"
check "a field: a file without it has too few" complained 'a chunk ends too early'
cd "$root" || exit 1
finish
