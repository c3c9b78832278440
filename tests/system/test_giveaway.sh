#!/usr/bin/env bash
# etc/giveaway: what its figures are, against what is known of drawn and random images.
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.OpenEXR

check "its figures are those of drawn images" python3 tests/system/giveaway_judge.py etc/giveaway
python3 etc/giveaway "$tmp" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "a folder without a run: a failure, with the next step" eval '[ $code = 1 ] && complained "neither run.json .*pitviper replay"'
echo '{}' >"$tmp/run.json"; : >"$tmp/truth.jsonl"
python3 etc/giveaway "$tmp" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?
check "a run without frames: a failure" eval '[ $code = 1 ] && complained "no frames"'
finish
