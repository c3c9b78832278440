#!/usr/bin/env bash
# Cases and records that hold anything at all: said in a line that helps, and nothing breaks. More turned
# octets: test_regress_hostile_deep.sh. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"

# of a log, which a case has ready: a truck drives past an observer
cat >"$tmp/truck.yaml" <<'Y'
duration_s: 4
dis: {heartbeat_s: 0.5}
vehicles:
  - {name: Truck, id: 22, type: truck, route_m: [[-40, 0], [0, 5], [60, 0]], speed_mps: 8}
Y
exercise "$tmp/truck.yaml" "$tmp/truck.pcap"
new_case good 24x16 5 '13, 14'
sed -i "s|^scenario: .*|log: $tmp/truck.pcap|; s/listen_s: 14/listen_s: 1/" "$tmp/good/case.yaml"
echo mine >"$tmp/good/notes.txt"
run regress --update "$tmp/good" --why 'small and quick'
check "recorded" [ $code = 0 ] || cat "$tmp/stdout" "$tmp/stderr"

# ---- a record that is damaged -------------------------------------------------------------------
changed cut_exr 's/x/x/'
head -c 1000 "$tmp/good/record/000013.exr" >"$tmp/cut_exr/record/000013.exr"
fails cut_exr 'image: cannot read .*000013.exr'
changed no_frame 's/frames: .*/frames: [13, 14, 18]/'
fails no_frame 'the baseline has no frame 18: .*--update'
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
changed hashes 's/x/x/'
sed -i '/"frame_sha256"/,/\]/s/"[0-9a-f]\{64\}"/"0"/' "$tmp/hashes/record/run.json"
mkdir "$tmp/suite"
mv "$tmp/older" "$tmp/hashes" "$tmp/suite/"
TMPDIR=$tmp/suite run regress "$tmp/suite"
check "a folder of cases" grep -q '2 cases: 2 ok, 0 failed' "$tmp/stdout"
check "nothing is left in TMPDIR" [ "$(ls "$tmp/suite" | wc -l)" = 2 ]
check "another compiler: its hashes are not looked at" grep -qE '^older +ok  \(' "$tmp/stdout"
check "other bits: only remarked" grep -qE '^hashes +ok: bits differ in 2 of 2 frames, within tolerance' "$tmp/stdout"

# turned octets in every file of a record: the case ends, well or not, and says so
turned() { # turned FILE AT
    changed turned 's/x/x/'
    printf '\xff\x7f' | dd of="$tmp/turned/record/$1" bs=1 seek="$2" conv=notrunc status=none
    run regress "$tmp/turned"
    check "$1 turned at $2" [ $code -le 1 ] && grep -qE '^turned +(ok|FAILED)' "$tmp/stdout"
}
files=(000013.exr 000013.profile.exr truth.jsonl run.json)
if [ "${PITVIPER_TURNED_ALL:-no}" = yes ]; then
    for file in "${files[@]}"; do for at in 8 40 200 700 1500; do turned "$file" $at; done; done
    finish
fi
for i in 0 1 2 3; do turned "${files[i]}" $((i % 2 ? 40 : 700)); done

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
check "no record of what did not run: the old one stays" cmp -s "$tmp/good/record/000013.exr" "$tmp/bad_config/record/000013.exr"
check "no record of what did not run: nor a card" test -z "$(grep 'cannot run' "$tmp/bad_config/card.md")"
run regress --keys
check "--keys" grep -q 'lwir_k' "$tmp/stdout"
finish
