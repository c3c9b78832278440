#!/usr/bin/env bash
# Readers of the shared memory that stop or die: every frame that is due is made. An encoder that fails, a full disk:
# test_publish_failures_encoder.sh, test_publish_failures_disk.sh. For longer, with recovery: ..._deep. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"

exercise demo "$tmp/demo.pcap"
reader stopped; stopped=$reader
reader killed; killed=$reader
reader reads --in-order; reads=$reader
disown $killed
(
    for ((i = 0; i < 200; i++)); do [ -s "$tmp/stopped" ] && [ -s "$tmp/killed" ] && break; sleep 0.05; done
    kill -STOP $stopped
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
check "the one that was stopped did stop" [ "$(grep -c '^frame ' "$tmp/stopped")" -lt 11 ]
wait $stopped 2>/dev/null
finish
