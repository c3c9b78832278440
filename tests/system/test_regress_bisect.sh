#!/usr/bin/env bash
# `pitviper regress bisect`: planted differences of settings, tables and programs are named, alone or together, and
# nothing else is; what it says, writes and leaves alone.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"
judges python3

new_case case 16x12 5 5
sed -i 's/sag_m: 0.02/sag_m: 0.1/; s/step_s: 1800, shadow_m: 64/step_s: 3600, shadow_m: 0/; s/^    width_px/    bands: mwir\n    width_px/
    s/listen_s: 14/listen_s: 5/' "$tmp/case/case.yaml"
mkdir "$tmp/temporary"
# bisect ARGUMENTS: of the case; its lines without the case's name in $tmp/said
bisect() {
    TMPDIR=$tmp/temporary run regress bisect "$@"
    sed -E 's/^case +//' "$tmp/stdout" >"$tmp/said"
}
names() { check "$1" grep -qE -- "$2" "$tmp/said"; grep -qE -- "$2" "$tmp/said" || head -n 30 "$tmp/stdout" "$tmp/stderr"; }
# causes COUNT OF: no more, none left over
causes() { names "$1 of $2 differences" "^$1 causes? in $2 differences?: "; }

# ---- settings: two keys, one of which moves it --------------------------------------------------------
echo 'seed: 1' >"$tmp/old.yaml"
printf 'seed: 1\nweather: {visibility_m: 5000}\ndetector: {gain: 2}\npublish: {png: false}\n' >"$tmp/new.yaml"
before=$(find "$tmp/case" | sort | cksum)
bisect "$tmp/old.yaml" "$tmp/new.yaml" "$tmp/case" --out "$tmp/page"
check "settings: exit code" [ $code = 1 ]
names "settings: what moves" '^moved: (temperature|mwir): .* at frame 5 \([0-9]+, [0-9]+\)'
names "settings: the key, and by how much" "^cause: setting weather.visibility_m is '5000', was '23000': (temperature|mwir): .*at frame 5"
names "settings: the other alone" "^alone: setting detector.gain is '2', was '1': nothing moves"
names "settings: the rest" '^rest: without it the other 1 do not move'
causes 1 2
check "nothing is left in the temporary folder" [ -z "$(ls -A "$tmp/temporary")" ]
check "nothing is written beside the case" [ "$before" = "$(find "$tmp/case" | sort | cksum)" ]
bisect "$tmp/old.yaml" "$tmp/new.yaml" "$tmp/case" --out "$tmp/page"
check "--out of an earlier one: exit code" [ $code != 0 ]
check "--out of an earlier one: what to do" complained 'page/work is there.*remove it, or name another'
python3 - "$tmp/page" <<'PYTHON' || fail "bisect.json and report.html"
import base64, json, re, sys
told = json.load(open(sys.argv[1] + "/bisect.json"))
assert told["case"] == "case" and told["kind"] == "settings" and told["differences"] == 2 and told["runs"] == 2, told
assert told["channel"] in ("temperature", "mwir") and told["frame"] == 5, told
(cause,) = told["causes"]
assert cause["smallest"] is True and cause["together"] is False and cause["channel"] == told["channel"], cause
assert [d["setting"] for d in cause["differences"]] == ["weather.visibility_m"], cause
assert [(a["setting"], a["line"], "channel" in a) for a in told["alone"]] == [("detector.gain", "", False)], told["alone"]
page = open(sys.argv[1] + "/report.html").read()
assert "weather.visibility_m" in page and "Cause 1" in page and "New against old" in page and "Tried alone" in page
pictures = re.findall(r'data:image/png;base64,([^"]+)"', page)
assert len(pictures) >= 4 and all(base64.b64decode(p)[:8] == b"\x89PNG\r\n\x1a\n" for p in pictures), len(pictures)
PYTHON
check "the settings of the cause" grep -qE 'visibility_m: 5000' "$tmp/page/work/cause1/settings.yaml"
check "and not the other's" not grep -qE '^ *gain:' "$tmp/page/work/cause1/settings.yaml"

# ---- no more runs --------------------------------------------------------------------------------------------
bisect "$tmp/old.yaml" "$tmp/new.yaml" "$tmp/case" --runs 1
check "no more runs: exit code" [ $code = 3 ]
names "no more runs: what moves it" '^cause, not told further apart: setting weather.visibility_m'
check "no more runs: what to do" complained 'ended after 1 runs; more are allowed by --runs'

# ---- nothing that moves, nothing that differs ------------------------------------------------------------
printf 'detector: {gain: 2}\n' >"$tmp/new.yaml"
echo 'seed: 1' >"$tmp/old.yaml"
bisect "$tmp/old.yaml" "$tmp/new.yaml" "$tmp/case"
check "nothing moves: exit code" [ $code = 0 ]
names "nothing moves: said" '^no channel moves beyond its tolerance'
bisect "$tmp/old.yaml" "$tmp/old.yaml" "$tmp/case"
check "nothing differs: exit code" [ $code = 0 ]
names "nothing differs: said" ': 0 differences'

# ---- tables: two rows of one, of which one is seen; two other tables; a remark ---------------------------------
etc=$(realpath etc)
# fresh: the second folder, as the first, which is etc itself
fresh() {
    rm -rf "$tmp/etc2"
    cp -r etc "$tmp/etc2"
    rm -rf "$tmp/etc2/reference"
}
fresh
# row TABLE NAME COLUMN VALUE: in the second folder
row() {
    awk -F, -v OFS=, -v name="$2" -v column="$3" -v value="$4" '
        /^#/ || NF < 2 { print; next }
        !head { for (i = 1; i <= NF; i++) if ($i == column) at = i; head = 1; print; next }
        $1 == name { $at = value } { print }' "$tmp/etc2/$1" >"$tmp/table"
    cmp -s "$tmp/table" "$tmp/etc2/$1" && fail "no row $2 of $1"
    mv "$tmp/table" "$tmp/etc2/$1"
}
row materials.csv leaf_deciduous rho_mwir 0.2
row materials.csv snow_fine rho_mwir 0.2
row effects.csv muzzle_smoke life_s 7
row radars.csv "$(grep -v '^#' etc/radars.csv | sed -n 2p | cut -d, -f1)" source 'of mine' # which no run reads
echo '# a remark' >>"$tmp/etc2/heat.csv"
bisect "$etc" "$tmp/etc2" "$tmp/case"
check "tables: exit code" [ $code = 1 ]
names "tables: the row and its cell" '^cause: table materials.csv, line [0-9]+, leaf_deciduous: rho_mwir is 0.2, was 0.1004: mwir: .* at frame 5'
names "tables: each file alone" '^alone: table effects.csv, 1 row: nothing moves'
names "tables: each row alone" '^alone: table materials.csv, line [0-9]+, snow_fine: .*: nothing moves'
names "tables: the rest" '^rest: without it the other 3 do not move mwir'
check "tables: what no run reads is not tried" not grep -q radars.csv "$tmp/said"
causes 1 4

# ---- a row that needs another: together -------------------------------------------------------------------
fresh
sed -n 's/^leaf_deciduous,/leaf_of_mine,/p' etc/materials.csv >>"$tmp/etc2/materials.csv"
row materials.csv leaf_of_mine rho_mwir 0.3
sed -i 's/^scrub, *leaf_deciduous/scrub, leaf_of_mine/' "$tmp/etc2/surfaces.csv"
bisect "$etc" "$tmp/etc2" "$tmp/case"
check "together: exit code" [ $code = 1 ]
names "together: the row" '^cause, only together: table materials.csv, line [0-9]+, leaf_of_mine: is new$'
names "together: the one that needs it" '^cause, only together: table surfaces.csv, line [0-9]+, scrub: material is leaf_of_mine, was leaf_deciduous$'
names "together: what they move" '^they move: material: .*different material'
names "together: one alone does nothing" '^alone: table materials.csv, 1 row: nothing moves'
names "together: the other cannot be run" '^alone: table surfaces.csv, 1 row: cannot be run: .*leaf_of_mine'
causes 1 2

# ---- programs: each with its own tables beside it; the new one makes another exercise, its tables are another's --------
program=$(realpath "$pitviper")
for side in old new; do
    mkdir -p "$tmp/$side/bin" "$tmp/$side/share"
    cat >"$tmp/$side/bin/pitviper" <<SCRIPT
#!/bin/sh
export PITVIPER_ETC="\${PITVIPER_ETC:-$tmp/$side/share/pitviper}"
[ \$1 = exercise ] && set -- "\$@" $([ $side = new ] && echo --set place.turn_deg=30)
exec "$program" "\$@"
SCRIPT
    chmod +x "$tmp/$side/bin/pitviper"
done
ln -s "$etc" "$tmp/old/share/pitviper"
ln -s "$tmp/etc2" "$tmp/new/share/pitviper"
bisect "$tmp/old" "$tmp/new/bin/pitviper" "$tmp/case" --threads 2
check "programs: exit code" [ $code = 1 ]
names "programs: what moves" '^moved: (pose|sun): '
names "programs: the one that makes the exercise" '^cause: the program that makes the exercise \(exercise\): (pose|sun): '
names "programs: its tables alone" '^alone: its tables: material: '
names "programs: the one that renders alone" '^alone: the program that renders \(replay\): nothing moves'
names "programs: the rest" '^rest: without it the other 3 do not move (pose|sun)'
causes 1 4

# ---- what is wrong is said ------------------------------------------------------------------------------
wrong() { # wrong WHAT EXIT MESSAGE ARGUMENTS
    TMPDIR=$tmp/temporary run regress bisect "${@:4}"
    check "$1: exit code" [ $code = "$2" ]
    check "$1: said" complained "$3" || cat "$tmp/stderr"
}
wrong "two of other kinds" 2 'are not of one kind: tables, settings; name two of one' "$etc" "$tmp/new.yaml" "$tmp/case"
wrong "what is not there" 2 'nowhere: No such file.*; name a program' "$tmp/nowhere" "$etc" "$tmp/case"
wrong "a folder of something else" 2 'holds neither a program .* nor tables' "$tmp/temporary" "$etc" "$tmp/case"
wrong "a case that is none" 2 'case.yaml; a case is a folder that holds one' "$etc" "$tmp/etc2" "$tmp"
wrong "two arguments" 2 '2 arguments where OLD NEW CASE are three' "$etc" "$tmp/etc2"
wrong "tables of tables" 2 '--old-tables and --new-tables are of programs' "$etc" "$tmp/etc2" "$tmp/case" --old-tables "$etc"
wrong "no runs" 2 "--runs: '0' is not a whole number" "$etc" "$tmp/etc2" "$tmp/case" --runs 0
echo 'sensor: {width_px: 7}' >"$tmp/bad.yaml"
wrong "bad settings" 2 'bad.yaml:1: sensor.width_px' "$tmp/old.yaml" "$tmp/bad.yaml" "$tmp/case"
rm "$tmp/etc2/materials.csv"
wrong "NEW that cannot run" 3 'NEW \(.*etc2\) cannot run case: .*materials.csv' "$etc" "$tmp/etc2" "$tmp/case"
TMPDIR=$tmp/temporary "$pitviper" regress bisect "$tmp/old.yaml" "$tmp/new.yaml" "$tmp/case" >"$tmp/stdout" 2>"$tmp/stderr" &
stopped=$!
running() { [ -n "$(find "$tmp/temporary" -name exercise.stdout)" ]; }
until_true running || fail "no run of OLD"
kill -INT $stopped
wait $stopped
check "stopped: exit code" [ $? = 130 ]
check "nothing is left over" [ -z "$(ls -A "$tmp/temporary")" ]
finish
