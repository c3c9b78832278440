#!/usr/bin/env bash
# A node's own missile by its other sights: an operator's aim, who presses the key; truth, from a shooter and from a place, in replays
# of a recording that holds no flight. And what is refused. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy

cat >"$tmp/road.yaml" <<'END'
duration_s: 900
dis: {heartbeat_s: 2}
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 3, route_m: [[0, 0], [60, 120], [80, 3000]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [700, 100], height_m: 60, heading_deg: 265}
END
few=("${bare[@]}" --set terrain.woods=off --no-png --no-files --planes none --set exercise.listen_s=0.5 --set sensor.hfov_deg=3)
fly=(--fly ir_ag --set flight.from=1:3001:31 --set exercise.aim=1:3001:21)
value() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == 2 { print $c }' "$tmp/$1/flight.csv"; }

# ---- an operator: nothing flies before the key
free_port
sender "$tmp/road.yaml" --send 127.0.0.1:$port
operated=("${few[@]}" "${fly[@]}" --bands lwir --sight operator --set flight.key=true --set flight.hit_m=5)
node operated "${operated[@]}" --address 127.0.0.1 --port $port --rate 10 --size 48x32 --record "$tmp/operated.pcapng" \
    --memory "pitviper_operator_$$" --set publish.memory_record=truth --set flight.operator_port=$((port + 1))
heard_by operated 'ground: invented'
check "operator: nothing flies before the key" not grep -q 'launched at' "$tmp/operated.out"
PITVIPER_MEMORY=pitviper_operator_$$ PITVIPER_PORT=$((port + 1)) python3 "$(dirname "$0")/../tools/loop_operator.py" 1:3001:21 >"$tmp/operator.out" 2>&1 &
operator=$!
ended operated
kill "$operator" 2>/dev/null; wait "$operator" 2>/dev/null
end_sender
check "operator: it ends by itself: $(tail -n 1 "$tmp/operated.out")" [ "$code" = 0 ]
check "operator: one missile" [ "$(lines_in "$tmp/operated/flight.csv")" = 2 ]
check "operator: was guided: $(value operated guided_share), $(value operated miss_m) m" is "$(value operated guided_share)" '>' 0.05
check "operator: garbage and what is old is counted" grep -qE 'operator: [1-9][0-9]* datagrams taken, [1-9][0-9]* refused, [1-9][0-9]* old' "$tmp/operated.out"
replay "$tmp/operated.pcapng" "$tmp/operated-again" --causal --port 0 "${operated[@]}" --rate 2 --size 32x24 --to +60
check "operator: replays" [ "$code" = 0 ]
check "operator: the same octets" cmp -s "$tmp/operated/flight.pcapng" "$tmp/operated-again/flight.pcapng"
check "operator: the same flight" cmp -s "$tmp/operated/flight.csv" "$tmp/operated-again/flight.csv"

# ---- truth, in replays of an exercise without a flight
sed 's/duration_s: 900/duration_s: 8/' "$tmp/road.yaml" >"$tmp/short.yaml"
run exercise "$tmp/short.yaml" -o "$tmp/road.pcap"
flown() { # NAME options
    local name=$1; shift
    replay "$tmp/road.pcap" "$tmp/$name" --causal --size 32x24 "${few[@]}" "${fly[@]}" "$@"
    check "$name: flies" [ "$code" = 0 ]
    [ -e "$tmp/$name/flight.csv" ] && tail -n 1 "$tmp/$name/flight.csv"
}
flown true --rate 10 --bands lwir --set flight.rounds=2 --set flight.every_s=3
check "truth: hits within 0.3 m: $(value true miss_m)" is "$(value true miss_m)" '<' 0.3
check "truth: and the second, 3 s after the first" awk -F, 'NR > 1 { if (!($8 < 0.3)) bad = 1; t[NR] = $4 } END { exit bad || (t[3] - t[2] - 3) ^ 2 > 1e-9 }' "$tmp/true/flight.csv"
flown place --rate 10 --bands lwir --set flight.from=36.0009,-122.9922,250 --set flight.missile=at_loft
check "from a place: hits within 0.3 m: $(value place miss_m)" is "$(value place miss_m)" '<' 0.3
flown coasts --rate 4 --bands lwir --set flight.late_s=2
check "coasts, without a sight in time: $(value coasts miss_m)" is "$(value coasts miss_m)" '>' 6

# ---- refused, and said
refused() { # refused WHAT CODE PATTERN options
    local what=$1 wanted=$2 pattern=$3; shift 3
    replay "$tmp/road.pcap" "$tmp/refused" "$@"
    check "$what: ended with $code" [ "$code" = "$wanted" ]
    check "$what: said" complained "$pattern"
}
refused "a recogniser in a replay" 1 'has no notes of a flight' --causal "${few[@]}" "${fly[@]}" --sight recogniser
refused "not causal" 1 'with --causal' "${few[@]}" "${fly[@]}"
refused "no radar" 1 'radar.preset is the seeker.s radar' --causal "${few[@]}" "${fly[@]}" --sight radar
refused "no shooter" 1 'flight.from: .. is neither' --causal "${few[@]}" --fly ir_ag --set exercise.aim=1:3001:21
refused "no aim" 1 'exercise.aim says what it flies at' --causal "${few[@]}" --fly ir_ag --set flight.from=1:3001:31
refused "no such row" 1 'nosuch' --causal "${few[@]}" "${fly[@]}" --fly nosuch
refused "no seeker" 1 'has no seeker' --causal "${few[@]}" "${fly[@]}" --fly wire_at
refused "a gimbal of its own" 1 'sensor.gimbal_rate_dps: .*leave it out' --causal "${few[@]}" "${fly[@]}" --set sensor.gimbal_rate_dps=5
refused "an operator who does nothing" 1 'flight.operator_port: an operator is for' --causal "${few[@]}" "${fly[@]}" --set flight.operator_port=5000
finish
