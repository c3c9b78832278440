#!/usr/bin/env bash
# What hands do to a command line: slips are named with what was meant, in one line; what cannot be printed is a
# failure; an installation works from where it lies. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
free_port

# refused WHAT PATTERN: the last run was a wrong command, told in one line, before any work
refused() {
    check "$1: exit code 2" [ "$code" = 2 ]
    check "$1: says '$2'" grep -qF -e "$2" "$tmp/stderr"
    check "$1: in one line, which names the program" [ "$(wc -l <"$tmp/stderr")" = 1 -a "$(grep -c '^pitviper: error: ' "$tmp/stderr")" = 1 ]
}
run insepct
refused "no such command" 'no such command: insepct; did you mean inspect? `pitviper --help` lists them'
run probe nonsense
refused "no such probe" 'no such probe: nonsense'
run bench nonsense
refused "no such bench" 'no such bench: nonsense'
run model nonsense
refused "no such action" 'no such action: nonsense'
run record -z
refused "an option that is none" "record: no such option: -z; see \`pitviper record --help\`"
run replay "$tmp/none.pcap" --set sensor.widht_px=3
refused "a slip" 'no such key: sensor.widht_px; did you mean sensor.width_px?'
run replay "$tmp/none.pcap" --set width_px=3
refused "no section" 'no such key: width_px; did you mean sensor.width_px?'
run exercise demo -o "$tmp/a.pcap" --set colour=3
refused "nothing like it" 'no such key: colour; all keys: `pitviper exercise --keys`'

# slips WHAT MEANT ARGUMENTS...: each is answered with what was meant
slips() {
    local what=$1 meant=$2; shift 2
    run "$@"
    refused "$what: $*" "did you mean $meant?"
}
slips option --size replay "$tmp/none.pcap" --siez 3x3
slips option --size replay "$tmp/none.pcap" -size 3x3
slips option --frequency rcs tank --frequensy 3
slips option --heading heat tank --headng 3
slips option --port inspect --prot 3 x.pcap
slips option --length model info tank --lenght 3
slips option --interface record --interfase lo
slips option --default check --defualt
slips option --size bench speed --quick --sise 32x32
slips option --verify terrain info --verfy store
slips command replay replya
slips topic products help product
slips probe geoid probe geiod
slips bench speed bench sped
slips action show model shwo tank
slips action import terrain imprt
slips band lwir replay "$tmp/none.pcap" --bands optical,lwr
slips plane range replay "$tmp/none.pcap" --planes rnge
slips choice manual replay "$tmp/none.pcap" --set detector.level=manaul
run exercise demoo -o "$tmp/a.pcap"
check "a scenario" eval '[ $code = 1 ] && complained "did you mean demo\?"'
run heat tnak
check "a model" eval '[ $code = 1 ] && complained "did you mean tank\?" && [ "$(wc -l <"$tmp/stderr")" = 1 ]'
printf 'sensor: {preset: staring_lwri}\nradar: {preset: seker_94}\n' >"$tmp/presets.yaml"
run check "$tmp/presets.yaml"
check "presets" eval 'complained "did you mean staring_lwir\?" && complained "did you mean seeker_94\?"'
for names in lwir,lwir optical,lwir,optical; do
    run replay "$tmp/none.pcap" --bands $names
    refused "--bands $names" 'is named twice'
done
run replay "$tmp/none.pcap" --planes range,entity,range
refused "a plane twice" 'range is named twice'
for wrong in "--size 0x0" "--size 640" "--rate -1" "--set sensor.hfov_deg" "--threads none" "--only 1,x" "--out" "--no-skip=3"; do
    # shellcheck disable=SC2086
    run replay "$tmp/none.pcap" $wrong
    refused "$wrong" pitviper
done
run
refused "nothing" '`pitviper --help` lists them'
for command in run replay frame regress inspect check exercise record model heat range rcs terrain probe bench "bench speed" "model info" "terrain import"; do
    # shellcheck disable=SC2086
    check "$command -h is --help" [ -n "$("$pitviper" $command -h)" -a "$("$pitviper" $command -h)" = "$("$pitviper" $command --help)" ]
    # shellcheck disable=SC2086
    check "$command -V" [ "$("$pitviper" $command -V)" = "$("$pitviper" --version)" ]
done
check "-V" [ "$("$pitviper" -V)" = "$("$pitviper" --version)" ]
# benches look at their options before they set anything up
for wrong in "speed --size 17" "speed --model none.obj" "speed --bands all" "speed --ground 0x1" "woods --trees many" "woods --level1-px 0" \
             "quality --table $tmp/none/q.csv" "all --size 17"; do
    # shellcheck disable=SC2086
    run bench $wrong --quick
    refused "bench $wrong" pitviper
    check "bench $wrong: before any work" [ ! -s "$tmp/stdout" ]
done
touch "$tmp/plain"
for wrong in "--csv $tmp/none/x.csv" "--report $tmp/none/x.html" "--plots $tmp/plain/y"; do
    # shellcheck disable=SC2086
    run bench speed $wrong --quick
    check "bench $wrong: before any work" [ $code = 1 -a ! -s "$tmp/stdout" ]
done
check "bench speed --help is of speed alone" eval '"$pitviper" bench speed --help >"$tmp/stdout" && grep -q -- "--ground KMxKM" "$tmp/stdout" && not grep -q -- "--trees" "$tmp/stdout"'

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
check "the demo's help builds nothing" [ "$(here=$PWD; cd / && "$here/etc/demo" --help | wc -l)" = 6 ]
# in a tree where nothing is built: what the demo asks of the program
mkdir -p "$tmp/tree/etc" "$tmp/tree/build/release" "$tmp/tree/bin"
cp etc/demo "$tmp/tree/etc/"
printf '#!/bin/sh\necho "$@" >>%q\n' "$tmp/asked" >"$tmp/tree/build/release/pitviper"
printf '#!/bin/sh\n' | tee "$tmp/tree/etc/setup" >"$tmp/tree/bin/cmake"
chmod +x "$tmp/tree/build/release/pitviper" "$tmp/tree/etc/setup" "$tmp/tree/bin/cmake"
asked() { rm -f "$tmp/asked"; PATH=$tmp/tree/bin:$PATH "$tmp/tree/etc/demo" "$tmp/shown" "$@" >/dev/null 2>&1; grep -oE 'sensor.preset=[^ ]*' "$tmp/asked" | xargs; }
check "the demo has cameras" [ "$(asked)" = sensor.preset=staring_mwir,staring_lwir,tv ]
check "at its size and field of view" grep -qE -e '^replay .*--size 720x486 --set sensor.hfov_deg=6 ' "$tmp/asked"
check "those of the bands that are asked for" [ "$(asked --bands lwir,radar)" = sensor.preset=staring_lwir ]
check "or none" [ "$(asked --set sensor.bands=radar)" = sensor.preset=none ]
check "and the exact image when that is asked for, last" [ "$(asked --set sensor.preset=none)" = "sensor.preset=staring_mwir,staring_lwir,tv sensor.preset=none" ]

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
