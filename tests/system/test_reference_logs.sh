#!/usr/bin/env bash
# Recordings made by other people's simulators, from $PITVIPER_DATA (default ../shared/data): Entity States
# field by field against tshark's decode, and the missile's target growing until impact.
. "$(dirname "$0")/common.sh"

needs_data dis/vrf-dis5-tow-vs-armor.pcap
data=$data/dis

# compare TSHARK OURS: rows of tshark's file that ours does not hold, joined by packet and entity. Numbers to 1e-5
# relative (tshark prints six digits), places to 2 um.
compare() {
    awk -F'\t' '
    function number(s) { return s ~ /^-?[0-9.]+([eE][-+]?[0-9]+)?$/ }
    function size(x) { return x < 0 ? -x : x }
    NR == FNR { if (FNR == 1) head = $0; else ours[$1, $6, $7, $8] = $0; next }
    FNR == 1 { if ($0 != head) { print "header differs"; bad = 1 } next }
    {
        rows++
        if (!(($1, $6, $7, $8) in ours)) { print "missing: packet " $1 " entity " $8; bad++; next }
        n = split(ours[$1, $6, $7, $8], got, "\t")
        for (i = 1; i <= NF; i++) {
            if ($i == got[i]) continue
            if (number($i) && number(got[i])) {
                d = size($i - got[i]); m = size($i)
                if (d <= (m < 1e6 ? 1e-5 * (m > 1 ? m : 1) : 2e-6)) continue
            }
            print "packet " $1 " column " i ": " got[i] ", tshark " $i; bad++
        }
    }
    END { print rows + 0 " Entity States"; exit bad || !rows }' "$2" "$1"
}
differs() { ! compare "$@" >/dev/null; }

for log in vrf-dis5-tow-vs-armor vrf-dis7-gaz69-blocks vrf-dis7-gaz69-straight; do
    run inspect "$data/$log.pcap" --pdus tsv
    check "$log: inspect" [ $code = 0 ]
    checks=$((checks + 1))
    compare "$data/$log.espdu.tsv" "$tmp/stdout" >"$tmp/compare" || { fail "$log: differs from tshark"; head -n 5 "$tmp/compare"; }
done
# the twin: a comparison that cannot fail proves nothing
awk -F'\t' -v OFS='\t' 'NR == 20 { $14 = sprintf("%.6f", $14 + 0.001) } { print }' "$tmp/stdout" >"$tmp/wrong.tsv"
check "a millimetre would be seen" differs "$data/vrf-dis7-gaz69-straight.espdu.tsv" "$tmp/wrong.tsv"

replay "$data/vrf-dis5-tow-vs-armor.pcap" "$tmp/tow" --rate 2 --no-png --threads 1
check "tow-vs-armor: replays" [ $code = 0 ]
check "tow-vs-armor: from a TOW that hits" grep -qxE '1:3001:(82|88|90)' <(host_of "$tmp/tow")
for band in optical lwir radar truth; do
    check "tow-vs-armor: $band frames" [ "$(frames "$tmp/tow" $band)" -ge 10 ]
done
# the target with the most pixels at last: at least four times those of the first frame, and nearer
verdict=$(awk '
{
    rest = $0
    while (match(rest, /"entity": *"[0-9:]+", *"marking"/)) {
        rest = substr(rest, RSTART); id = rest; sub(/^"entity": *"/, "", id); sub(/".*/, "", id)
        one = rest; sub(/"bands".*/, "", one)
        p = one; r = one
        if (sub(/.*"pixels": */, "", p) && sub(/.*"range_m": */, "", r)) {
            p += 0; r += 0
            if (!(id in first)) { first[id] = p; first_range[id] = r }
            if (p > most[id]) most[id] = p
            last_range[id] = r
        }
        rest = substr(rest, 12)
    }
}
END {
    for (id in most) if (best == "" || most[id] > most[best]) best = id
    if (best == "") exit
    base = first[best] > 1 ? first[best] : 1
    print (most[best] >= 4 * base && last_range[best] < first_range[best] ? "grows" : "does not grow"), best, first[best], most[best]
}' "$tmp/tow/truth.jsonl")
echo "tow-vs-armor: target $verdict"
check "tow-vs-armor: the target grows until impact" [ "${verdict%% *}" = grows ]

# three frames of every band by four threads, and by four without skips: the same bits as by one with all skips
number() { grep -oE '^\{"frame":[0-9]+' "$tmp/tow/truth.jsonl" | grep -oE '[0-9]+' | sed -n "$1p"; }
count=$(wc -l <"$tmp/tow/truth.jsonl")
some=$(number 2),$(number $((count / 2))),$(number "$count")
of_frames() { # of_frames OUT: number and hash of those, a line each
    grep -oE '^\{"frame":[0-9]+|"frame_sha256":"[0-9a-f]+' "$1/truth.jsonl" | grep -oE '[0-9a-f]+$' | paste -d' ' - - |
        grep -E "^(${some//,/|}) "
}
for same in "" --no-skip; do
    # shellcheck disable=SC2086
    replay "$data/vrf-dis5-tow-vs-armor.pcap" "$tmp/same" --rate 2 --only "$some" --no-png --threads 4 $same
    check "tow-vs-armor: three frames again" [ "$(of_frames "$tmp/same" | wc -l)" = 3 ]
    check "tow-vs-armor: --threads 4 $same, same bits" [ "$(of_frames "$tmp/tow")" = "$(of_frames "$tmp/same")" ]
done

replay "$data/vrf-dis7-gaz69-straight.pcap" "$tmp/gaz" --rate 0.2 --no-files --threads 1
check "gaz69-straight: no missile, and still shown" [ $code = 0 ]
check "gaz69-straight: the GAZ-69 is in the truth" grep -qE '"model": *"jeep"' "$tmp/gaz/truth.jsonl"
run replay "$data/singles.pcap" --out "$tmp/singles" --size 96x64 --rate 0.5 --no-files --threads 1
check "singles: ends by itself" [ $code -lt 124 ]
finish
