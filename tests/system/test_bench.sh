#!/usr/bin/env bash
# pitviper bench by its quickest suite: the table, the page, two runs side by side, and what is refused. No time is judged.
# The rows of the other suites, and their limits: tests/bench/test_rows.sh.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/bench_rows.sh"
judges python3

unset PITVIPER_DATA
run bench dis --quick --threads 1 --csv "$tmp/dis.csv" --report "$tmp/dis.html"
ends_whole "$tmp/dis.csv" 10
check "some rows have a limit" [ "$(grep -c "^dis,.*,yes," "$tmp/dis.csv")" -ge 2 ]
check "a chapter of the page" grep -q '<h2 id="dis">' "$tmp/dis.html"
for what in "Entity State: decode" "Entity State: encode" "Fire: decode" "Detonation: encode" bundles "capture: read" \
            "report: walk" "report: update alone" "snapshot"; do
    check "a row: $what" grep -q "^dis,.*$what" "$tmp/dis.csv"
done
run bench --help
for suite in dis network stability precision speed crowd woods skip quality; do
    check "there is a suite $suite" grep -qx "  $suite" "$tmp/stdout"
done

# ---- the page, and two runs side by side
check "the page is HTML" python3 tests/system/bench_page.py "$tmp/dis.html" 14
run bench compare "$tmp/dis.csv" "$tmp/dis.csv" --slower 1.01 --report "$tmp/compare.html"
check "a run is like itself" [ $code = 0 ]
rows=$(grep -c within\ noise "$tmp/stdout")
check "in every row" grep -qE "^($((rows - 1))) rows in both: \1 within noise" "$tmp/stdout"
check "and is a page" grep -q '</html>' "$tmp/compare.html"
awk -F, -v OFS=, '$2 == "Fire: decode" { $3 *= 1.5; $4 *= 1.5; $15 *= 1.5; $16 *= 1.5 } { print }' "$tmp/dis.csv" \
    >"$tmp/slow.csv"
run bench compare "$tmp/dis.csv" "$tmp/slow.csv" --slower 1.3
check "a slower row ends it with 1" [ $code = 1 ]
check "and is named, alone" [ "$(grep 'slower 1.50 x' "$tmp/stdout" | grep -c 'dis: Fire: decode')" = 1 ]
sed '/^dis,Fire: encode,/d; s/^# machine: .*/# machine: another/' "$tmp/dis.csv" |
    sed '/^dis,Detonation: decode,/s/,0,0,octets,/,3,0,octets,/' >"$tmp/worse.csv"
run bench compare "$tmp/dis.csv" "$tmp/worse.csv"
check "an error beyond its limit ends it with 1" [ $code = 1 ]
check "and is named" grep -q 'dis: Detonation: decode.*error beyond its limit' "$tmp/stdout"
check "a row that is gone is named" grep -q 'dis: Fire: encode.*only in the first' "$tmp/stdout"
check "another machine is named" grep -q 'Different machines' "$tmp/stdout"
head -c 3000 /dev/urandom >"$tmp/noise.csv"
run bench compare "$tmp/dis.csv" "$tmp/noise.csv"
check "noise is refused" [ $code = 1 ]

# ---- the program that is run: the one beside, else that of PATH, else none
mkdir "$tmp/alone"
cp "$pitviper" "$tmp/alone/"
"$tmp/alone/pitviper" bench compare "$tmp/dis.csv" "$tmp/dis.csv" >"$tmp/stdout" 2>"$tmp/stderr"
check "pitviper alone: exit code 1" [ $? = 1 ]
check "what is missing is said, and what to do" complained 'cannot run pitviper-bench.*beside pitviper nor on PATH.*install it'
PATH=$(realpath "$build"):$PATH "$tmp/alone/pitviper" bench compare "$tmp/dis.csv" "$tmp/dis.csv" >"$tmp/stdout" 2>"$tmp/stderr"
check "that of PATH will do" [ $? = 0 ]
check "and says the same" grep -q 'rows in both' "$tmp/stdout"
run bench --version
check "its version is pitviper's" [ "$(cat "$tmp/stdout")" = "$("$pitviper" --version)" ]
run bench dis/dis --quick --threads 1
check "one room's rows of a suite" eval 'grep -q "Fire: decode" "$tmp/stdout" && not grep -q "table of" "$tmp/stdout"'
check "are all of that run" [ $code = 0 ]

refused() { # refused SAID ARGUMENTS...: a usage error, and said, before any work
    local named=$1; shift
    run bench "$@"
    check "bench $*: refused" [ $code = 2 ]
    check "bench $*: said" complained "$named"
}
refused 'no such option: --size' dis --quick --size 17x9
refused "threads: '0' is not" dis --quick --threads 0
refused 'option --threads needs an argument' dis --quick --threads
refused "no such bench: nix" nix
refused "no such bench: dis/terrain" dis/terrain

finish
