# What the tests of a live node share; after common.sh. Everything here ends by itself.

# Ports that no other test of this machine uses at the moment, most likely: by this process, below the system's own.
port=$((20000 + ($$ * 7) % 12000))
free_port() { # the next
    while :; do
        port=$((port + 1))
        (exec 3<>"/dev/udp/127.0.0.1/$port") 2>/dev/null && ! grep -qi ":$(printf '%04X' $port) " /proc/net/udp && break
    done
}

# node NAME options: a live node in the background; its folder, output, and process in $tmp/NAME, $tmp/NAME.out, ${node[NAME]}
declare -A node
node() {
    local name=$1; shift
    "$pitviper" run "${bare[@]}" --out "$tmp/$name" --size 96x64 --threads 2 "$@" >"$tmp/$name.out" 2>&1 &
    node[$name]=$!
}
# heard_by NAME TEXT SECONDS: until it has said that
heard_by() {
    local i
    for ((i = 0; i < 10 * $3; i++)); do
        grep -q "$2" "$tmp/$1.out" && return 0
        sleep 0.1
    done
    return 1
}
# ended NAME SECONDS: exit code in $code; killed, and 124, after so long
ended() {
    local i
    for ((i = 0; i < 10 * $2; i++)); do
        kill -0 "${node[$1]}" 2>/dev/null || break
        sleep 0.1
    done
    kill -KILL "${node[$1]}" 2>/dev/null && { wait "${node[$1]}" 2>/dev/null; code=124; return 1; }
    wait "${node[$1]}"
    code=$?
}
# sender options: pitviper exercise in the background, in ${sender}
sender() {
    "$pitviper" exercise "$@" >"$tmp/sender.out" 2>&1 &
    sender=$!
}
end_sender() { kill "$sender" 2>/dev/null; wait "$sender" 2>/dev/null; }

# with_stream URL: sets the array stream to the options for it; empty, and says so, without FFmpeg's libraries
with_stream() {
    stream=()
    printf 'publish: {stream: "%s"}\n' "$1" >"$tmp/stream.yaml"
    if "$pitviper" check "$tmp/stream.yaml" >/dev/null 2>&1; then
        stream=(--set publish.stream="$1")
    else
        echo "skipped in part: no streams, built without FFmpeg's libraries"
    fi
}

# numbered OUT: `number hash`, a frame a line
numbered() {
    paste -d' ' <(run_json "$1" | grep -oE '"frame_number":\[[^]]*\]' | grep -oE '[0-9]+') \
                <(hashes "$1" | grep -oE '[0-9a-f]{64}')
}
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
