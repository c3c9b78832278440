#!/usr/bin/env bash
# What hands do to a command line: slips are named with what was meant, in one line; what cannot be printed is a
# failure; an installation works from where it lies. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
free_port

# refused WHAT PATTERN: the last run was a wrong command, told in one line, or two where the second says where help is
refused() {
    check "$1: exit code 2" [ "$code" = 2 ]
    check "$1: says '$2'" grep -qF -e "$2" "$tmp/stderr"
    check "$1: not lost in a page" [ "$(wc -l <"$tmp/stderr")" -le 2 ]
}
run insepct
refused "no such command" 'no such command: insepct; `pitviper --help` lists them'
run probe nonsense
refused "no such probe" 'no such probe: nonsense'
run bench nonsense
refused "no such bench" 'no such bench: nonsense'
run model nonsense
refused "no such action" 'no such action: nonsense'
run record -z
refused "an option that is none" "pitviper record: invalid option -- 'z'"
run replay "$tmp/none.pcap" --set sensor.widht_px=3
refused "a slip" 'no such key: sensor.widht_px; did you mean sensor.width_px?'
run replay "$tmp/none.pcap" --set width_px=3
refused "no section" 'no such key: width_px; did you mean sensor.width_px?'
run exercise demo -o "$tmp/a.pcap" --set colour=3
refused "nothing like it" 'no such key: colour; all keys: `pitviper exercise --keys`'

run help
cp "$tmp/stdout" "$tmp/help"
run --help
check "help is --help" cmp -s "$tmp/stdout" "$tmp/help"
run help exercise
check "help COMMAND is COMMAND --help" grep -q '^usage: pitviper exercise' "$tmp/stdout"

# ---- nowhere to print to
for what in --help "help run" "exercise --keys" "check --default" "model info tank"; do
    # shellcheck disable=SC2086
    "$pitviper" $what >/dev/full 2>"$tmp/stderr"
    check "$what on a full disk: exit code 1" [ $? = 1 ]
    check "$what on a full disk: says so" grep -q 'cannot write' "$tmp/stderr"
    # shellcheck disable=SC2086
    "$pitviper" $what >&- 2>"$tmp/stderr"
    check "$what on a closed output: exit code 1" [ $? = 1 ]
done
# a file opened while standard output is closed must not become it
"$pitviper" exercise demo -o "$tmp/closed.pcapng" >&- 2>/dev/null <&-
exercise demo "$tmp/open.pcapng"
check "a recording takes no messages" cmp -s "$tmp/closed.pcapng" "$tmp/open.pcapng"

# ---- where it lies
PITVIPER_ETC=$tmp/none run model info tank
check "no such PITVIPER_ETC: exit code 1" [ "$code" = 1 ]
check "no such PITVIPER_ETC: is named" grep -q 'PITVIPER_ETC: there is no folder' "$tmp/stderr"
mkdir -p "$tmp/moved/bin" "$tmp/moved/share/pitviper/scenarios"
cp "$pitviper" "$tmp/moved/bin/"
sed 's/^duration_s: 30/duration_s: 7/' etc/scenarios/demo.yaml >"$tmp/moved/share/pitviper/scenarios/demo.yaml"
(cd / && "$tmp/moved/bin/pitviper" exercise demo -o "$tmp/moved.pcap") >"$tmp/stdout"
check "share beside the program comes first" grep -q '^7.0 s' "$tmp/stdout"
check "the demo's help builds nothing" [ "$(here=$PWD; cd / && "$here/etc/demo" --help | wc -l)" = 3 ]

# ---- a live node says at once what it could not do at the end
: >"$tmp/file"
run run --port "$port" --for 1 --out "$tmp/file"
check "run into a file: exit code 1" [ "$code" = 1 ]
check "run into a file: before it listens" eval '! grep -q listening "$tmp/stderr"'
# a disk that fills up after 4 KiB
"$pitviper" exercise demo --send "127.0.0.1:$port" --set dis.heartbeat_s=0.1 >/dev/null 2>&1 &
sender=$!
(
    trap '' XFSZ
    ulimit -f 4
    exec "$pitviper" run "${bare[@]}" --port "$port" --for 3 --set exercise.listen_s=10 --out "$tmp/o" --record "$tmp/cut.pcapng"
) >"$tmp/stdout" 2>"$tmp/stderr"
check "a recording cut short: exit code 1" [ $? = 1 ]
kill "$sender" 2>/dev/null
wait "$sender" 2>/dev/null
check "a recording cut short: is named" grep -q 'the recording .*/cut.pcapng ends early' "$tmp/stderr"
run inspect "$tmp/cut.pcapng"
check "what there is of it can be read" [ "$code" = 0 ]

finish
