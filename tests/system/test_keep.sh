#!/usr/bin/env bash
# What is there is kept: nothing of an earlier run or recording is replaced unasked, a signal leaves whole records that say
# so; and what part of a recording is shown, and which planes of truth are kept.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/small_demo.sh"

status_of() { run_json "$1" | grep -oE '"status":"[a-z]+"' | cut -d'"' -f4; }
times() { json_numbers "$1/truth.jsonl" time_s | tr '\n' ' '; }
"$pitviper" inspect "$tmp/demo.pcap" >"$tmp/inspected"
first=$(sed -nE 's/ *exercise time ([0-9.]+) .*/\1/p' "$tmp/inspected")
last=$(sed -nE 's/ *exercise time [0-9.]+ \.\. ([0-9.]+) .*/\1/p' "$tmp/inspected")
absolute() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.6f", a + b }'; }

# ---- an earlier run
shown "$tmp/a"
check "a whole run" [ "$code $(status_of "$tmp/a")" = "0 complete" ]
count=$(json_numbers "$tmp/a/run.json" frames)
touch "$tmp/a/mine.txt" "$tmp/a/frames/lwir/mine.png"
before=$(cd "$tmp/a" && find . -type f | sort | xargs sha256sum)
shown "$tmp/a" --only 1
check "again: refused" [ $code = 1 ]
check "with the name of the option" complained 'truth.jsonl exists from an earlier run.*--overwrite'
run run --out "$tmp/a" --for 1
check "of a live node too" [ $code = 1 ]
check "nothing is touched" [ "$before" = "$(cd "$tmp/a" && find . -type f | sort | xargs sha256sum)" ]
# ---- with --overwrite and a part of the recording, given from its ends
shown "$tmp/a" --from +16 --to -12 --overwrite
check "--from +16 --to -12" [ $code = 0 ]
part=$(wc -l <"$tmp/a/truth.jsonl")
check "--from +16 --to -12: more than one frame, and fewer than all" [ "$part" -ge 2 -a "$part" -lt "$count" ]
check "--overwrite: its frames alone" [ "$(find "$tmp/a/frames/lwir" -name '0*.exr' | wc -l)" = "$part" ]
check "--overwrite: what is not of a run stays" [ -e "$tmp/a/mine.txt" -a -e "$tmp/a/frames/lwir/mine.png" ]
mkdir -p "$tmp/b" && : >"$tmp/b/truth.jsonl"
shown "$tmp/b" --from "$(absolute "$first" 16)" --to "$(absolute "$last" -12)"
check "a run that never came to a frame is no loss" [ $code = 0 ]
check "the same span in exercise time: the same frames" same_hashes "$tmp/a" "$tmp/b"
check "where asked" is "$(times "$tmp/a" | cut -d' ' -f1)" '>=' "$(absolute "$first" 16)"
rm "$tmp/a/truth.jsonl" "$tmp/a/run.json"
shown "$tmp/a"
check "pictures without their records: refused" complained 'frames/(lwir|truth)/[0-9]{6}.(png|exr) exists'

# ---- an earlier recording
cp "$tmp/demo.pcap" "$tmp/log.pcap"
run exercise demo -o "$tmp/log.pcap"
check "exercise -o: refused" [ $code = 1 ]
check "exercise -o: said" complained 'log.pcap exists already.*--overwrite'
run record -o "$tmp/log.pcap" --for 1
check "record -o: refused" [ $code = 1 ]
run run --out "$tmp/c" --record "$tmp/log.pcap" --for 1
check "run --record: refused" [ $code = 1 -a ! -e "$tmp/c" ]
check "and all stays" cmp -s "$tmp/demo.pcap" "$tmp/log.pcap"

# ---- signals: the frame in hand is finished; a replay in real time has seconds of nothing else
stop_after_frames() { # stop_after_frames SIGNAL OUT options
    local signal=$1 out=$2; shift 2
    "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$out" "${small[@]}" --speed 2 "$@" >"$tmp/stdout" 2>"$tmp/stderr" &
    until_true test -s "$out/truth.jsonl"
    kill -s "$signal" $!
    wait $!
    code=$?
}
for signal in INT:130 HUP:129; do
    name=${signal%:*} out=$tmp/stop-${signal%:*}
    stop_after_frames "$name" "$out"
    check "SIG$name: exit code $code" [ $code = "${signal#*:}" ]
    check "SIG$name: stopped" [ "$(status_of "$out")" = stopped ]
    check "SIG$name: fewer than all" is "$(json_numbers "$out/run.json" frames)" '<' "$count"
    check "SIG$name: a line a frame, whole" [ "$(grep -c '^{.*}$' "$out/truth.jsonl")" = "$(json_numbers "$out/run.json" frames)" ]
    check "SIG$name: and a picture" [ "$(frames "$out" lwir)" = "$(json_numbers "$out/run.json" frames)" ]
done
printf 'axes: {seed: [1, 2]}\n' >"$tmp/two.yaml"
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/s" "${small[@]}" --speed 2 --sweep "$tmp/two.yaml" >"$tmp/stdout" 2>"$tmp/stderr" &
begun() { [ -n "$(cat "$tmp"/s/v*/truth.jsonl 2>/dev/null)" ]; }
until_true begun
kill $!
wait $!
check "a sweep: exit code" [ $? = 143 ]
check "a sweep: said" complained 'stopped with 0 of 2 variants'
check "a sweep: its run too" [ "$(status_of "$(echo "$tmp"/s/v*)")" = stopped ]
shown "$tmp/s" --only 1 --sweep "$tmp/two.yaml"
check "a sweep goes on" [ "$code $(grep -c '"status":"made"' "$tmp/s/manifest.jsonl")" = "0 2" ]
shown "$tmp/s" --set weather.visibility_m=7000 --only 1 --sweep "$tmp/two.yaml"
check "another sweep: refused" [ $code = 1 ]
check "another sweep: said" complained 'holds a run of another log.*--overwrite'

# ---- no part of it
for span in "--from +99"; do
    # shellcheck disable=SC2086
    shown "$tmp/none" $span
    check "$span: exit code" [ $code = 1 ]
    check "$span: the recording's span, both ways" complained "from $first to $last s.*\\+0 to \\+[0-9.]+ .*-[0-9.]+ to -0"
done
shown "$tmp/none" --from noon
check "--from noon" complained "exercise.from_s: 'noon' is not a number of seconds.*\\+12"

# ---- planes of truth
shown "$tmp/all" --only 1 --coco
for planes in none entity,normal; do
    pairs=(--pairs off)
    [ $planes = none ] && pairs=(--pairs all)
    shown "$tmp/p" --only 1 --coco --overwrite --planes $planes "${pairs[@]}"
    check "--planes $planes: exit code" [ $code = 0 ]
    check "--planes $planes: the same run" same_hashes "$tmp/p" "$tmp/all"
    check "--planes $planes: the same truth" cmp -s "$tmp/p/truth.jsonl" "$tmp/all/truth.jsonl"
    check "--planes $planes: the same boxes" [ "$(grep -o '"annotations".*' "$tmp/p/coco.json")" = "$(grep -o '"annotations".*' "$tmp/all/coco.json")" ]
    check "--planes $planes: in run.json" grep -qF "\"planes\":\"$planes\"" <(run_json "$tmp/p")
    check "--planes $planes: radiance as ever" cmp -s "$tmp/p/frames/lwir/000001.exr" "$tmp/all/frames/lwir/000001.exr"
    # the header of an EXR names its channels
    of=$([ $planes = none ] || head -c 2000 "$tmp/p/frames/truth/000001.exr" | grep -aoE '(range_m|entity|part|material|temp_k|n[xyz])[^a-z_]' | tr -dc 'a-z_\n' | sort -u | tr '\n' ' ')
    case $planes in
        none)
            check "--planes none: no folder" [ ! -e "$tmp/p/frames/truth" ]
            check "--planes none with pairs: they are there" [ -s "$tmp/p/pairs.jsonl" ]
            check "--planes none with pairs: no truth is listed" not grep -q '"truth"' "$tmp/p/pairs.jsonl" ;;
        *) check "--planes $planes: they alone: $of" [ "$of" = "entity nx ny nz " ] ;;
    esac
done
shown "$tmp/p" --planes range,colour
check "--planes range,colour" complained "publish.planes: 'range,colour' is not all, none"

# ---- names that would speak to a terminal
name=$'a\033[31m\033]0;x\a\302\2331m\342\200\256\377\303\251.pcap'
cp "$tmp/demo.pcap" "$tmp/$name" && mkdir "$tmp/o$name"
steers() { LC_ALL=C grep -qaP '[\x00-\x08\x0b-\x1f\x7f\xff]|\xc2\x9b|\xe2\x80\xae' "$tmp/stdout" "$tmp/stderr"; }
for words in "inspect $tmp/$name" "inspect $tmp/no$name" "replay $tmp/$name --host $name" \
             "replay ${bare[*]} ${small[*]} $tmp/$name --only 1 --out $tmp/o$name/o" \
             "replay $tmp/$name --set $name=1" "replay --$name" "check $tmp/$name" "regress $tmp/$name" "model info $name" "probe $name" "help $name" "help truth $name" "$name" \
             "exercise $name -o x" "record -o $tmp/nowhere/$name --for 1" "replay $tmp/$name --out $tmp/o$name/o --planes $name"; do
    # shellcheck disable=SC2086
    "$pitviper" $words >"$tmp/stdout" 2>"$tmp/stderr" </dev/null
    check "$(printf '%q' "${words//$tmp/}"): nothing steers the terminal" not steers
    check "$(printf '%q' "${words//$tmp/}"): something is said" [ -s "$tmp/stdout" -o -s "$tmp/stderr" ]
done
finish
