#!/usr/bin/env bash
# Every command explains itself, and says what it did not understand.
. "$(dirname "$0")/common.sh"

run --help
check "--help ends well" [ $code = 0 ]
check "--help goes to standard output" grep -q replay "$tmp/stdout"
commands=$(grep -oE '^ +(pitviper )?[a-z]+' "$tmp/stdout" | awk '{ print $NF }' | sort -u)
check "--help lists replay" grep -qx replay <<<"$commands"
check "--help lists inspect" grep -qx inspect <<<"$commands"
check "--help lists record" grep -qx record <<<"$commands"

mkdir "$tmp/help"
for command in $commands; do
    run $command --help
    cp "$tmp/stdout" "$tmp/help/$command"
    check "$command --help ends well" [ $code = 0 ]
    check "$command --help shows its usage" grep -qi "usage: pitviper $command" "$tmp/stdout"
done
# the terms of etc/reference/glossary.md, and no others for the same things
cat "$tmp"/help/{replay,run,regress,check,exercise,record} >"$tmp/words"
{ "$pitviper" --help; "$pitviper" check --default; "$pitviper" regress --keys; "$pitviper" help --markdown; } >>"$tmp/words"
grep -nwiE 'nobody|somebody|anybody|everybody|whoever|whom|invented|knobs?|graves?|veils?|even air|held against|a pixel|pictures?' \
    "$tmp/words" | grep -v 'of a pixel\|off, invented or files\|buildings: invented\|invented: villages\|ground.invented' >"$tmp/old_words"
check "help in the glossary's terms" [ ! -s "$tmp/old_words" ] || head -n 5 "$tmp/old_words"
for option in --bands --size --rate --from --to --host --threads --seed --speed --isa --no-png --config --out --causal \
              --no-skip --samples --only; do
    check "replay --help names $option" grep -q -- "$option" "$tmp/help/replay"
done
for option in --address --interface --port --out --bands --size --rate --host --config --set --threads --seed --for --frames \
              --record --isa --no-png --no-files --no-skip; do
    check "run --help names $option" grep -q -- "$option" "$tmp/help/run"
done
while read -r named arguments; do
    # shellcheck disable=SC2086
    run run --out "$tmp/out" --for 1 $arguments
    check "run $arguments: exit code" [ $code != 0 ]
    check "run $arguments: names $named" complained "$named"
done <<'BAD'
port --port 0
port --port 70000
nowhere --address nowhere
nonet9 --interface nonet9
for --for never
host --host 1:2
host --host 1:2:3 --host 1:2:4
dis --set publish.dis=all
listen_s --set exercise.listen_s=0
log.pcap log.pcap
record --record /nowhere/at/all.pcapng
BAD

run
check "no command: exit code" [ $code != 0 ]
check "no command: usage" complained 'usage|--help'
run frobnicate
check "unknown command: exit code" [ $code != 0 ]
check "unknown command is named" complained frobnicate
run --version
check "--version" grep -qE '[0-9]+\.[0-9]+\.[0-9]+' "$tmp/stdout"

# what is wrong is named, on standard error, before anything is made
exercise no-missile "$tmp/log.pcap"
while read -r named arguments; do
    # shellcheck disable=SC2086
    run replay "$tmp/log.pcap" --out "$tmp/out" $arguments
    check "replay $arguments: exit code" [ $code != 0 ]
    check "replay $arguments: names $named" complained "$named"
    check "replay $arguments: makes nothing" [ ! -e "$tmp/out/run.json" ]
done <<'BAD'
frob --frob
bands --bands optical,xray
size --size 0x0
size --size 96
size --size 1e9x1e9
rate --rate -1
rate --rate nan
threads --threads 0
seed --seed x
isa --isa pentium
9:9:9 --host 9:9:9
host --host 1:2
samples --samples 0
nowhere.yaml --config nowhere.yaml
out --out
BAD
run replay
check "replay without a log: exit code" [ $code != 0 ]
check "replay without a log: usage" complained 'usage|--help'
finish
