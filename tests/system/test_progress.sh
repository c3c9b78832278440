#!/usr/bin/env bash
# A terminal sees the progress of a replay; without one: test_motion.sh.
. "$(dirname "$0")/common.sh"
needs "terminal to be had" script -qec true /dev/null </dev/null

exercise demo "$tmp/demo.pcap"
script -qec "$pitviper replay ${bare[*]} $tmp/demo.pcap --out $tmp/term --size 96x64 --rate 0.5 --no-png --bands lwir" /dev/null \
    </dev/null >"$tmp/terminal" 2>&1
check "a terminal sees progress" grep -q 'frame 1 of [0-9]* ' "$tmp/terminal"
finish
