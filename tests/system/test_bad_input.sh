#!/usr/bin/env bash
# The world may be wrong: a clear message with a next step, and whatever can still be shown is shown. The exit
# code is an error only when there is nothing to show. labels: small
. "$(dirname "$0")/common.sh"
judges python3
bare=("${quick[@]}") # how a picture looks is not what is tested

# a small one
replay() {
    local log=$1 out=$2; shift 2
    run replay "$log" --out "$out" --size 32x24 --rate 1 --threads 1 --overwrite "${coarse[@]}" "$@"
}
next_step='next|use|give|check|see|choose|--[a-z]|inspect|wanted|are read'
# nothing_shown NAME WHAT [NEXT]: the last run failed, named WHAT, and said what to do
nothing_shown() {
    local before=$failures
    check "$1: exit code is an error" [ "$code" != 0 ]
    check "$1: names $2" complained "$2"
    check "$1: says what to do next" complained "${3:-$next_step}"
    [ "$failures" = "$before" ] || sed 's/^/    /' "$tmp/stderr" | tail -n 5
}
shown() { # NAME OUT
    check "$1: exit code is 0" [ "$code" = 0 ]
    check "$1: frames" [ "$(frames "$2")" -gt 0 ]
    check "$1: as many radiance frames as truth frames" [ "$(frames "$2" lwir)" = "$(frames "$2")" ]
    check "$1: a truth line a frame" [ "$(wc -l <"$2/truth.jsonl" 2>/dev/null)" = "$(frames "$2")" ]
    check "$1: no file left half written" [ -z "$(find "$2" -name '*.part' 2>/dev/null)" ]
    [ "$code" = 0 ] || sed 's/^/    /' "$tmp/stderr" | tail -n 5
}

# ---- nothing to show
replay "$tmp/absent.pcap" "$tmp/o"
nothing_shown "absent log" absent.pcap "no such file"
replay "$tmp" "$tmp/o"
nothing_shown "a folder for a log" "$tmp" "is a directory"
: >"$tmp/nought.pcap"
replay "$tmp/nought.pcap" "$tmp/o"
nothing_shown "a log of no octets" nought.pcap
head -c 5000 "$pitviper" >"$tmp/foreign.pcap"
replay "$tmp/foreign.pcap" "$tmp/o"
nothing_shown "a foreign file" foreign.pcap
printf 'time,x,y\n1,2,3\n' >"$tmp/table.csv"
replay "$tmp/table.csv" "$tmp/o"
nothing_shown "a text file" table.csv
exercise empty "$tmp/empty.pcap"
replay "$tmp/empty.pcap" "$tmp/o"
nothing_shown "an empty capture" empty.pcap
check "nothing shown, nothing written" [ ! -e "$tmp/o/run.json" ]

exercise demo "$tmp/demo.pcap"
replay "$tmp/demo.pcap" "$tmp/o" --set weather.atmosphere=tropical
nothing_shown "an atmosphere that is not there" 'no model tropical; there are: midlat_summer, us1976' 'README.md'

# ---- part of it to show
exercise no-missile "$tmp/high.pcap" place.height_m=3000
replay "$tmp/high.pcap" "$tmp/high" --only 0 --bands lwir
check "air of low ground on high ground is said" said '15 C at the ground.* -4 C at the 300[01] m'
size=$(wc -c <"$tmp/demo.pcap")
head -c $((size * 7 / 10)) "$tmp/demo.pcap" >"$tmp/cut.pcap"
replay "$tmp/cut.pcap" "$tmp/cut"
shown "a truncated log" "$tmp/cut"
check "a truncated log is called so" said 'truncat|cut short|ends inside|ended inside'

exercise no-vehicles "$tmp/no-vehicles.pcap"
replay "$tmp/no-vehicles.pcap" "$tmp/nv" --rate 0.5
shown "no vehicles" "$tmp/nv"
exercise no-missile "$tmp/no-missile.pcap"
replay "$tmp/no-missile.pcap" "$tmp/nm" --rate 0.2
shown "no missile" "$tmp/nm"
check "no missile: says who looks instead" said 'observer'

exercise bad-pdus "$tmp/bad.pcap"
replay "$tmp/bad.pcap" "$tmp/bad"
shown "malformed PDUs" "$tmp/bad"
check "malformed PDUs: the same missile as without them" [ "$(host_of "$tmp/bad")" = 1:3001:41 ]
dropped() { run_json "$1" | grep -oE '"dropped":\{[^}]*\}'; }
for reason in short_header version length finite position identity count; do
    check "malformed PDUs: drops counted ($reason)" grep -qE "\"[a-z_]*$reason[a-z_]*\":[1-9]" <(dropped "$tmp/bad")
done
replay "$tmp/demo.pcap" "$tmp/good"
shown "the same without them" "$tmp/good"
check "and nothing is dropped there" [ "$(dropped "$tmp/good" | grep -cE ':[1-9]')" = 0 ]
check "JSON holds no NaN and no raw control character" \
    bash -c '! grep -lE "[: \[]-?(nan|inf)" "$@" && ! grep -lP "[\x01-\x09\x0b-\x1f]" "$@"' - \
    "$tmp"/{bad,good,nv,nm}/{run.json,truth.jsonl}
check "JSON is JSON" python3 -c '
import json, sys
for name in sys.argv[1:]:
    text = open(name).read()
    for part in text.splitlines() if name.endswith("l") else [text]:
        json.loads(part, parse_constant=lambda c: sys.exit(c))' "$tmp"/{bad,good,nv,nm}/{run.json,truth.jsonl}

# ---- nowhere to put it
: >"$tmp/file"
replay "$tmp/demo.pcap" "$tmp/file"
nothing_shown "a file where the output should be" "$tmp/file"
replay "$tmp/demo.pcap" "$tmp/file/below"
nothing_shown "a folder below a file" "$tmp/file/below"
replay "$tmp/demo.pcap" /proc/pitviper
nothing_shown "an unwritable folder" /proc/pitviper
check "an unwritable folder: found before the first frame" [ "$(grep -c 'frames/' "$tmp/stderr")" -le 1 ]

# a disk that fills up: files end at 4 kB, smaller than any EXR of ours
(
    trap '' XFSZ
    ulimit -f 4
    replay "$tmp/demo.pcap" "$tmp/full" --size 96x64 --to +14
    echo "$code" >"$tmp/full.code"
) >/dev/null 2>&1
code=$(cat "$tmp/full.code" 2>/dev/null || echo 124)
check "a full disk: ends by itself, with an error" [ "$code" -gt 0 -a "$code" -lt 124 ]
check "a full disk: no half-written pictures" [ -z "$(find "$tmp/full" -name '*.part' 2>/dev/null)" ]
check "a full disk: no EXR shorter than it should be" [ -z "$(find "$tmp/full" -name '*.exr' -size -1k 2>/dev/null)" ]
finish
