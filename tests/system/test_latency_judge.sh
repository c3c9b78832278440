#!/usr/bin/env bash
# The latency ledger of a live node against a receiver outside it, which stamps the last octet of each frame's video: no frame arrives
# before it is rendered or after the ledger says that it was sent. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"
needs "video: built without FFmpeg's libraries" has_video

free_port
"$pitviper" run "${quick[@]}" --out "$tmp/live" --address 127.0.0.1 --port $port --size 96x64 --rate 10 --frames 20 --for 900 \
    --bands lwir --threads 1 --host observer --no-files --memory $memory --stream udp://127.0.0.1:$((port + 1000)) \
    --set exercise.listen_s=0.5 --set quality.budget=off >"$tmp/live.out" 2>&1 &
node[live]=$!
python3 tests/system/latency_judge.py $memory $((port + 1000)) "$tmp/live" ${node[live]} >"$tmp/judged" 2>&1 &
judge=$!
until_true test -s "$tmp/judged"
heard_by live 'listening on'
sender demo --set duration_s=900 --send 127.0.0.1:$port
ended live
end_sender
check "the node ends well" [ $code = 0 ] || cat "$tmp/live.out"
wait $judge
check "the judge agrees with the ledger" [ $? = 0 ]
cat "$tmp/judged"
# on a busy machine its reader of the ring may miss some frames, and truth.jsonl may lack some
sent=$(consumer live video count)
of() { sed -n "s/^$1: \([0-9]*\) frames.*/\1/p" "$tmp/judged"; }
check "half of the stream's frames at least were judged ($(of judge) of $sent)" [ $(($(of judge) * 2)) -ge "$sent" -a "$sent" -ge 1 ]
check "and compared ($(of ledger))" [ $(($(of ledger) * 2)) -ge "$sent" ]
finish
