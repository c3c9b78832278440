#!/usr/bin/env bash
# Readers of the shared memory that stop or die: every frame that is due is made. An encoder that fails, a full disk:
# test_publish_failures_encoder.sh, test_publish_failures_disk.sh. For longer, with recovery: ..._deep. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"

exercise demo "$tmp/demo.pcap"
reader stopped --slow 300; stopped=$reader # slow, so that it misses frames however late it is stopped
reader killed; killed=$reader
reader reads --in-order; reads=$reader
disown $killed
(
    until_true test -s "$tmp/stopped"
    kill -STOP $stopped
    until_true test -s "$tmp/killed"
    kill -KILL $killed
) &
watched readers --memory $memory
check "readers that stop and die: the replay ends well" [ "$code" = 0 ] || cat "$tmp/readers.out"
check "readers that stop and die: every frame is made" [ "$(frames_of readers)" = 11 ]
check "and written" [ "$(consumer readers memory count)" = 11 -a "$(consumer readers memory left_out)" = 0 ]
check "without truth, as told: neither lines nor hashes, and the run says so" \
    [ ! -e "$tmp/readers/truth.jsonl" -a -z "$(hashes "$tmp/readers")" -a "$(grep -c 'no truth.jsonl' "$tmp/readers/run.json")" = 1 ]
run replay "$tmp/demo.pcap" --out "$tmp/plain" --set publish.truth=false
check "but not at full speed" [ $code = 1 ] && complained 'publish.truth: false is for'
check "the memory's name is gone" [ ! -e /dev/shm/$memory ]
kill -CONT $stopped
wait $reads
check "a reader beside them gets every frame" [ "$(grep -c '^frame ' "$tmp/reads")" = 11 ] || tail -n 3 "$tmp/reads"
check "the one that was stopped misses some" [ "$(grep -c '^frame ' "$tmp/stopped")" -lt 11 ]
wait $stopped 2>/dev/null
finish
