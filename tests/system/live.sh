# What the tests of a live node share; after common.sh.

# Ports that no other test of this machine uses at the moment, most likely: by this process, below the system's own.
port=$((20000 + ($$ * 7) % 12000))
free_port() { # the next
    while :; do
        port=$((port + 1))
        (exec 3<>"/dev/udp/127.0.0.1/$port") 2>/dev/null && ! grep -qi ":$(printf '%04X' $port) " /proc/net/udp && break
    done
}

# node NAME options: a live node in the background; its folder, output, and process in $tmp/NAME, $tmp/NAME.out, ${node[NAME]}.
# It runs until the test has seen what it waits for, and stops it: how many frames there are by then, and when, is the
# machine's business. One that is forgotten ends by itself.
declare -A node
node() {
    local name=$1; shift
    "$pitviper" run "${bare[@]}" --out "$tmp/$name" --size 96x64 --threads 2 --for 900 "$@" >"$tmp/$name.out" 2>&1 &
    node[$name]=$!
}
runs() { kill -0 "${node[$1]}" 2>/dev/null; }
# until_of NAME CONDITION...: until it is true; false when the node ends before
until_of() {
    local name=$1; shift
    or_over() { "$@" || ! runs "$name"; }
    until_true or_over "$@" && "$@"
}
heard_by() { until_of "$1" grep -q -e "$2" "$tmp/$1.out"; }    # NAME TEXT: until it has said that
makes() { until_of "$1" has_lines "$tmp/$1/truth.jsonl" "$2"; } # NAME COUNT: until it has made so many frames
# ended NAME: once it has, its exit code in $code; one that hangs is killed, and has 124
ended() {
    if until_true not runs "$1"; then
        wait "${node[$1]}"
        code=$?
    else
        kill -KILL "${node[$1]}"
        wait "${node[$1]}" 2>/dev/null
        code=124
    fi
}
stop() { kill -INT "${node[$1]}" 2>/dev/null; ended "$1"; } # stop NAME: tells it to end; $code
# sender options: pitviper exercise in the background, in ${sender}
sender() {
    "$pitviper" exercise "$@" >"$tmp/sender.out" 2>&1 &
    sender=$!
}
end_sender() { kill "$sender" 2>/dev/null; wait "$sender" 2>/dev/null; }
# flight FILE: a scenario of minutes: vehicles on a road, and a slow missile that takes two minutes to one of them
flight() {
    cat >"$1" <<'YAML'
duration_s: 900
dis: {heartbeat_s: 2}
vehicles:
  - {name: Tank, id: 11, type: 1.1.222.1.1.1.0, force: 2, count: 2, behind_m: -40, route_m: [[0, 0], [0, 300]], speed_mps: 8, turret: swing}
  - {name: Truck, id: 22, type: 1.1.222.7.1.0.0, force: 2, route_m: [[20, 20], [20, 300]], speed_mps: 4}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [3000, 100], height_m: 90, heading_deg: 265}
shots:
  - {name: Missile, id: 41, type: 2.2.225.1.1.3.0, from: Heli 31, at: Truck 22, time_s: 3, launch_mps: 25, boost_mps: 0, drag_mps2: 0}
YAML
}

# with_stream URL: sets the array stream to the options for it
with_stream() {
    needs "video: built without FFmpeg's libraries" has_video
    stream=(--set publish.stream="$1")
}

# numbered OUT: `number hash`, a frame a line
numbered() {
    paste -d' ' <(run_json "$1" | grep -oE '"frame_number":\[[^]]*\]' | grep -oE '[0-9]+') \
                <(hashes "$1" | grep -oE '[0-9a-f]{64}')
}
# frames_of NAME: numbers of its frames, separated by commas. On a busy machine they are few of a long time
frames_of() { numbered "$tmp/$1" | cut -d' ' -f1 | paste -sd,; }
# part_of LIVE REPLAY LEAST: every frame of the first is in the second, and they are at least so many
part_of() {
    local n
    n=$(numbered "$1" | wc -l)
    [ "$n" -ge "$3" ] || { echo "only $n frames in $1"; return 1; }
    [ -z "$(comm -23 <(numbered "$1" | sort) <(numbered "$2" | sort))" ]
}
# agree LIVE REPLAY LEAST: the frames that both have are the same, and they are at least so many
agree() {
    local numbers same
    numbers=$(comm -12 <(numbered "$1" | cut -d' ' -f1 | sort) <(numbered "$2" | cut -d' ' -f1 | sort) | wc -l)
    same=$(comm -12 <(numbered "$1" | sort) <(numbered "$2" | sort) | wc -l)
    [ "$numbers" -ge "$3" ] && [ "$numbers" = "$same" ] || { echo "of $numbers frames in both, $same are the same"; return 1; }
}
# time_of OUT LINE: of a line of the truth; $: the last
time_of() { json_numbers <(sed -n "$2p" "$1/truth.jsonl") time_s | head -n 1; }
# live_counter OUT NAME
live_counter() { run_json "$1" | grep -oE '"live":\{[^}]*\}' | grep -oE "\"$2\":[0-9]+" | cut -d: -f2; }
