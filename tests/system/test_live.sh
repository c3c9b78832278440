#!/usr/bin/env bash
# A live node and a replay of its recording make the same frames, to the bit; whoever carries the sensor, whatever else
# is on the network.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

# a node that hears nothing, and one that is told to stop; meanwhile the others
free_port
node silent --address 127.0.0.1 --port $port
silent_port=$port
free_port
node told --address 127.0.0.1 --port $port

# ---- three nodes on one exercise: by multicast on the loopback interface, else one by unicast ------------------
flight "$tmp/flight.yaml"
group=239.71.7.$((1 + $$ % 250))
few=(--no-png --set exercise.listen_s=0.5)
missile=("${few[@]}" --host munition --rate 10 --bands lwir --no-files --size 48x32)
chosen=("${few[@]}" --host 1:3001:41 --rate 5 --bands optical,lwir --size 32x24 --set node.application=3)
watch=("${few[@]}" --rate 5 --bands lwir,radar --no-files --size 32x24 --set node.application=2 --set publish.dis=truth)
free_port
nodes=(missile watch chosen)
node missile --address $group --interface lo --port $port --record "$tmp/missile.pcapng" --frames 8 "${missile[@]}"
if heard_by missile 'listening on'; then
    node watch --address $group --interface lo --port $port --record "$tmp/watch.pcapng" --frames 10 "${watch[@]}" --threads 1
    node chosen --address $group --interface lo --port $port --record "$tmp/chosen.pcapng" "${chosen[@]}" --threads 1
    heard_by watch 'listening on'; heard_by chosen 'listening on'
    sender "$tmp/flight.yaml" --send $group:$port --interface lo
else
    echo "skipped: no multicast on the loopback interface here; one node by unicast"
    cat "$tmp/missile.out"
    nodes=(missile)
    node missile --address 127.0.0.1 --port $port --record "$tmp/missile.pcapng" --frames 8 "${missile[@]}"
    heard_by missile 'listening on'
    sender "$tmp/flight.yaml" --send 127.0.0.1:$port
fi
heard_by told 'listening on'
stop told
check "told to stop before anything was heard: no failure ($code)" [ $code = 0 ]
check "told to stop: its last line says that it had not begun" eval 'tail -n 1 "$tmp/told.out" | grep -q "before the first frame.*nothing heard"'
check "told to stop: run.json, stopped, without a frame" grep -q '"status": *"stopped"' "$tmp/told/run.json"

# the one with files until it has some: those that it has no time for are left out
pictures() { [ "$(frames "$tmp/chosen" lwir)" -ge 3 ] && [ "$(frames "$tmp/chosen" optical)" -ge 3 ]; }
[ ${#nodes[@]} = 1 ] || check "chosen: makes pictures" until_of chosen pictures
kill -INT "${node[chosen]}" 2>/dev/null
for name in "${nodes[@]}"; do
    ended $name
    check "$name: ends well" [ $code = 0 ]
    check "$name: says how many of the frames it kept" grep -qE 'kept [0-9.]+ of [0-9.]+ frames a second' "$tmp/$name.out"
    check "$name: so does run.json" python3 -c 'import json, sys
run = json.load(open(sys.argv[1])); live = run["counters"]["live"]
made = [live["frames_" + step] for step in ("full", "targets", "checkerboard", "quarter")]
assert live["rate_hz"] > 0 and abs(live["kept_share"] - run["frames"] / (run["frames"] + live["frames_late"])) < 1e-9, live
assert sum(made) == run["frames"] and run["counters"].get("frames_reduced", 0) == sum(made[1:]) >= 1, live' "$tmp/$name/run.json"
    check "$name: run.json counts what was lost: nothing" [ "$(live_counter "$tmp/$name" lost_kernel)$(live_counter "$tmp/$name" lost_queue)" = 00 ]
done
end_sender

# the same configuration on the recording; --to: the live node went on after the last PDU
again() { # NAME LEAST options; least: how many frames there must be
    local name=$1 least=$2; shift 2
    echo "$name: $(numbered "$tmp/$name" | wc -l) frames"
    last=$(time_of "$tmp/$name" '$')
    replay "$tmp/$name.pcapng" "$tmp/$name-again" --causal --port 0 --to "${last:-0}" "$@"
    check "$name: its recording replays" [ $code = 0 ]
    check "$name: every live frame is the replay's of that number" part_of "$tmp/$name" "$tmp/$name-again" "$least"
    check "$name: the same configuration" [ "$(run_json "$tmp/$name" | grep -o '"config_sha256":"[0-9a-f]*"')" = \
        "$(run_json "$tmp/$name-again" | grep -o '"config_sha256":"[0-9a-f]*"')" ]
    check "$name: the same host" [ "$(run_json "$tmp/$name" | grep -o '"hosts":[^,]*')" = "$(run_json "$tmp/$name-again" | grep -o '"hosts":[^,]*')" ]
    check "$name: the hashes stand in its truth, too" [ "$(grep -oE '"frame_sha256":"[0-9a-f]{64}"' "$tmp/$name/truth.jsonl" | wc -l)" = \
        "$(numbered "$tmp/$name" | wc -l)" ]
}
again missile 8 "${missile[@]}" --threads 1 --only "$(frames_of missile)"
check "munition: the missile" grep -q '"1:3001:41"' "$tmp/missile/run.json"
check "munition: it looks at the target of its Fire" grep -q 'aim: 1:3001:22' "$tmp/missile.out"
# the twin: another seed is another picture
replay "$tmp/missile.pcapng" "$tmp/other" --causal --port 0 "${missile[@]}" --to "$last" --only "$(frames_of missile)" --seed 2
check "another seed: as many frames" [ "$(frames_of other)" = "$(frames_of missile)" ]
check "another seed: other bits" [ -z "$(comm -12 <(numbered "$tmp/missile" | sort) <(numbered "$tmp/other" | sort))" ]

if [ ${#nodes[@]} = 3 ]; then
    again chosen 3 "${chosen[@]}" --only "$(frames_of chosen)"
    whole=$(($(numbered "$tmp/chosen" | wc -l) - $(live_counter "$tmp/chosen" files_left_out)))
    check "chosen: a picture a frame and band" [ "$(frames "$tmp/chosen" lwir)$(frames "$tmp/chosen" optical)" = "$whole$whole" ]
    again watch 10 "${watch[@]}" --only "$(frames_of watch)"
    check "watch: nobody flies at first, so an observer" grep -q '"observer"' "$tmp/watch/run.json"
    # two PDUs a frame, and each came back, but for those of the last frame that were still on their way
    sent=$(live_counter "$tmp/watch" sent)
    own() { run_json "$1" | grep -oE '"own":[0-9]+' | cut -d: -f2; }
    check "watch: two Data PDUs a frame" [ "$sent" = $((2 * $(numbered "$tmp/watch" | wc -l))) ]
    check "watch: hears its own, and ignores them" [ "$(own "$tmp/watch")" -le "$sent" -a "$(own "$tmp/watch")" -ge $((sent - 2)) ]
    check "watch: so does its replay" [ "$(own "$tmp/watch-again")" = "$(own "$tmp/watch")" ]
    check "others: a Data PDU is nobody's entity" [ "$(own "$tmp/missile")" = 0 ]
    if command -v tshark >/dev/null; then
        tshark -r "$tmp/watch.pcapng" -d udp.port==1-65535,dis -Y 'dis.pdu_type == 20' -T fields -e dis.exer_id \
            -e dis.num_fixed_data -e dis.num_variable_data -e udp.length -e _ws.malformed >"$tmp/tshark" 2>/dev/null
        check "tshark: reads every Data PDU" [ "$(wc -l <"$tmp/tshark")" = "$(own "$tmp/watch")" ]
        check "tshark: none malformed, eight fixed datums, at least four variable ones, 1400 octets at most" \
            awk -F'\t' '$2 != 8 || $3 < 4 || $4 > 1408 || $5 != "" { bad = 1 } END { exit bad || NR == 0 }' "$tmp/tshark"
    fi
fi

check "silence: is said" heard_by silent '^pitviper: warning: run: nothing heard'
stop silent
check "silence, and told to stop: no failure ($code)" [ $code = 0 ]
check "silence: said once, with port and next step" [ "$(grep -c "^pitviper: warning: run: nothing heard.*port $silent_port.*--port" "$tmp/silent.out")" = 1 ]
for name in "${nodes[@]}"; do [ "$failures" = 0 ] || { echo "-- $name"; tail -n 8 "$tmp/$name.out"; }; done
finish
