#!/usr/bin/env bash
# `replay --causal --speed X` of a node's recording sends the Data PDUs that the node sent, octet for octet, time stamps
# included, and the same announcements of its streams; at full speed it sends nothing, and says so.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3
pdus=(python3 tests/system/data_pdus.py)

few=(--size 32x24 --bands optical,lwir --rate 10 --no-files --threads 1 --set exercise.listen_s=0.3 --set publish.dis=truth
    --set publish.vmti=truth)
free_port; to=$port
with_stream udp://127.0.0.1:$to
free_port
few+=("${stream[@]}" --address 127.0.0.1 --port $port)
node live "${few[@]}" --frames 5 --record "$tmp/live.pcapng"
check "it listens" heard_by live 'listening on'
sender demo --set duration_s=900 --send 127.0.0.1:$port
ended live
end_sender
check "the node ends well" [ $code = 0 ] || tail -n 5 "$tmp/live.out"

coproc receiver { "${pdus[@]}" receive 127.0.0.1 $port "$tmp/replayed"; }
receiver_pid=$receiver_PID # bash forgets it once the receiver has ended
read -r -t $patience listening <&"${receiver[0]}"
check "a receiver listens" [ "${listening:-}" = listening ]
again() {
    run replay "$tmp/live.pcapng" --out "$tmp/again" --overwrite --causal --to "$(time_of "$tmp/live" '$')" --only "$(frames_of live)" "${few[@]}" "$@"
}
again
check "at full speed: exit code" [ $code = 0 ]
check "at full speed: nothing is sent, and how it would be" complained 'Data PDUs are not sent at full speed; add --speed 1'
again --speed 20
check "at a speed: exit code" [ $code = 0 ]
check "at a speed: says to where, and how many" said "Data PDUs go to 127.0.0.1 port $port from 4711:1"
sent=$(grep -oE 'Data PDUs sent [0-9]+, not sent 0' "$tmp/stderr" | grep -oE '[0-9]+' | head -n 1)
echo "end" >&"${receiver[1]}"
wait "$receiver_pid" 2>/dev/null
check "all of them arrive, none of the replay at full speed: ${sent:-none}" [ "$(wc -l <"$tmp/replayed")" = "${sent:-none}" ]
check "the same images" part_of "$tmp/live" "$tmp/again" 3
# no network: said, with a next step, and a failure
if unshare -rn true 2>/dev/null; then
    unshare -rn "$pitviper" replay "${bare[@]}" "$tmp/live.pcapng" --out "$tmp/alone" --causal --to "$(time_of "$tmp/live" 1)" "${few[@]}" \
        --address 239.1.2.3 --speed 100 >"$tmp/stdout" 2>"$tmp/stderr"
    check "no network: exit code" [ $? = 1 ]
    check "no network: said" complained 'none of [0-9]+ Data PDUs could be sent to 239.1.2.3 port [0-9]+: Network is unreachable; see --address'
fi
# those that the node received from itself are in its recording, and are not played
heard=$(run_json "$tmp/live" | grep -oE '"own":[0-9]+')
check "its own PDUs are recorded, and not played: $heard" [ "$heard" != '"own":0' -a "$heard" = "$(run_json "$tmp/again" | grep -oE '"own":[0-9]+')" ]
check "the same octets" "${pdus[@]}" same "$tmp/live.pcapng" "$tmp/replayed" 6 >"$tmp/same" || cat "$tmp/same"
# band, kind, raster, codec, klv, its targets, address: per band, two ports apart
if [ ${#stream[@]} != 0 ]; then
    check "the stream of the first band" grep -qx "stream 0 3 $((32 << 16 | 24)) 1 1 2 udp://127.0.0.1:$to" "$tmp/same"
    check "the stream of the second" grep -qx "stream 2 3 $((32 << 16 | 24)) 1 1 2 udp://127.0.0.1:$((to + 2))" "$tmp/same"
fi
cat "$tmp/same"
[ "$failures" = 0 ] || { tail -n 12 "$tmp/live.out"; cat "$tmp/stderr"; }
finish
