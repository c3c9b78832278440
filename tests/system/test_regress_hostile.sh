#!/usr/bin/env bash
# Cases and records that hold anything at all: said in a line that helps, and nothing breaks. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"

new_case good 24x16 5 '3, 4'
echo mine >"$tmp/good/notes.txt"
run regress --update "$tmp/good" --why 'small and quick'
check "recorded" [ $code = 0 ] || cat "$tmp/stdout" "$tmp/stderr"

# ---- a record that is damaged -------------------------------------------------------------------
changed cut_exr 's/x/x/'
head -c 3000 "$tmp/good/record/000003.exr" >"$tmp/cut_exr/record/000003.exr"
fails cut_exr 'image: cannot read .*000003.exr'
changed no_frame 's/frames: .*/frames: [3, 4, 20]/'
fails no_frame 'the baseline has no frame 20: .*--update'
changed bad_truth 's/x/x/'
sed -i '2s/:/;/' "$tmp/bad_truth/record/truth.jsonl"
fails bad_truth '.*truth.jsonl:2: not JSON'
changed bad_run 's/x/x/'
echo '[1]' >"$tmp/bad_run/record/run.json"
fails bad_run '.*run.json: not JSON'
changed other_size 's/width_px: 24/width_px: 32/'
fails other_size 'size: expected 24 x 16 pixels, actual 32 x 16'
changed moved 's/x/x/'
sed -i 's/"datagrams": *[0-9]*/"datagrams": 7/' "$tmp/moved/record/run.json"
fails moved 'counters: counters.datagrams is [0-9]+, was 7'
changed older 's/x/x/'
sed -i 's/"compiler": "[^"]*"/"compiler": "another"/; s/\("frame_sha256": \[\)/\1 "0",/' "$tmp/older/record/run.json"
run regress "$tmp/older"
check "another compiler: its hashes are not looked at" [ $code = 0 ]
changed hashes 's/x/x/'
sed -i '/"frame_sha256"/,/\]/s/"[0-9a-f]\{64\}"/"0"/' "$tmp/hashes/record/run.json"
run regress "$tmp/hashes"
check "other bits: only remarked" [ $code = 0 ] && grep -q 'ok: bits differ in 2 of 2 frames, within tolerance' "$tmp/stdout"

# turned octets in every file of a record: the case ends, well or not, and says so
for file in 000003.exr 000003.profile.exr truth.jsonl run.json; do
    for at in 40 700; do
        changed turned 's/x/x/'
        printf '\xff\x7f' | dd of="$tmp/turned/record/$file" bs=1 seek=$at conv=notrunc status=none
        run regress "$tmp/turned"
        check "$file turned at $at" [ $code -le 1 ] && grep -qE '^turned +(ok|FAILED)' "$tmp/stdout"
    done
done

# ---- what a user can do wrong ---------------------------------------------------------------------
new_case wrong
while IFS='|' read -r line said; do
    printf '%b\n' "$line" >"$tmp/wrong/case.yaml"
    run regress "$tmp/wrong"
    check "$line: exit code" [ $code = 2 ]
    check "$line: $said" complained "$said"
    check "$line: one line" [ "$(wc -l <"$tmp/stderr")" = 1 ]
done <<'WRONG'
scenario: demo\nframes: [1]|purpose: is missing
purpose: p\nframes: [1]|log: or scenario: is missing
purpose: p\nscenario: demo\nlog: a\nframes: [1]|both given
purpose: p\nscenario: demo|frames: is missing
purpose: p\nscenario: demo\nframes: [1]\nlog_may_be_absent: true|log_may_be_absent: applies to a log
purpose: p\nscenario: demo\nframes: [2, 1]|ascend
purpose: p\nscenario: demo\nframes: [1.5]|whole
purpose: p\nscenario: demo\nframes: [1]\ntolerance: {lwir_k: -1}|tolerance.lwir_k: '-1'
purpose: p\nscenario: demo\nframes: [1]\ntolerance: {lvir_k: 1}|lwir_k
purpose: [|case.yaml:
WRONG
run regress "$tmp/nowhere"
check "no such case" complained 'there is no .*nowhere/case.yaml'
run regress "$tmp/good" "$tmp/good/"
check "twice" complained 'given twice'
run regress
check "nothing: usage" [ $code = 2 ] && complained usage
run regress "$tmp/good" --jobs 0
check "--jobs 0" [ $code = 2 ] && complained 'jobs'
run regress "$tmp/good" --why x
check "--why alone" [ $code = 2 ] && complained 'update'
run regress "$tmp/good" --work "$tmp/work" --report /nowhere/at/all.html
check "a report that cannot be written" [ $code = 1 ] && complained 'cannot write /nowhere'
changed bad_config 's/width_px: 24/width_px: 7/'
run regress --update "$tmp/bad_config" --why 'it cannot run'
check "no record of what did not run: exit code" [ $code = 1 ]
check "no record of what did not run: the old one stays" cmp -s "$tmp/good/record/000003.exr" "$tmp/bad_config/record/000003.exr"
check "no record of what did not run: nor a card" test -z "$(grep 'cannot run' "$tmp/bad_config/card.md")"
run regress --keys
check "--keys" grep -q 'lwir_k' "$tmp/stdout"
mkdir "$tmp/suite"
cp -r "$tmp/good" "$tmp/suite/one"
cp -r "$tmp/good" "$tmp/suite/two"
TMPDIR=$tmp/suite run regress "$tmp/suite"
check "a folder of cases" grep -q '2 cases: 2 ok, 0 failed' "$tmp/stdout"
check "nothing is left in TMPDIR" [ "$(ls "$tmp/suite" | wc -l)" = 2 ]
finish
