#!/bin/bash
# tests/system/test_inspect.sh BUILD_DIR: `pitviper inspect` as a user types it, and against tshark where there is
# one. labels: small
set -u
pitviper=$1/pitviper
data=${PITVIPER_DATA:-../shared/data}/dis
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# expect CODE PATTERN ARGS...: exit code and something said, on either stream
expect() {
    local want=$1 pattern=$2 got
    shift 2
    "$pitviper" inspect "$@" >"$scratch/said" 2>&1
    got=$?
    [ "$got" = "$want" ] || fail "inspect $*: exit code $got, want $want"
    grep -q -e "$pattern" "$scratch/said" || fail "inspect $*: nothing like '$pattern' in: $(head -3 "$scratch/said")"
}

# ---- usage and failures need no data -----------------------------------------------------------------------
: >"$scratch/empty.pcap"
echo "# not a capture" >"$scratch/text.dislog"
expect 0 'usage: pitviper inspect' --help
expect 2 'usage: pitviper inspect'
expect 2 'unknown option' --nonsense x.pcap
expect 2 '0 .. 65535' --port 65536 x.pcap
expect 2 '0 .. 255' x.pcap --exercise all
expect 2 'one log at a time' a.pcap b.pcap
expect 2 'tsv' x.pcap --pdus json
expect 2 'goes with' x.pcap --full
expect 1 'cannot open' "$scratch/absent.pcap"
expect 1 'empty' "$scratch/empty.pcap"
expect 1 'not a capture' "$scratch/text.dislog"

if [ ! -f "$data/vrf-dis5-tow-vs-armor.pcap" ]; then
    [ $failures = 0 ] || exit 1
    echo "skipped: no reference data at $data (set PITVIPER_DATA)"
    exit 77
fi

# ---- the summary -------------------------------------------------------------------------------------------
tow=$data/vrf-dis5-tow-vs-armor.pcap
expect 0 '462  *1 Entity State' "$tow"
expect 0 '15  *2 Fire' "$tow"
expect 0 '1:3001:70  *O1:3001_3  *1.1.222.1.1.1.0  *2  *70 ' "$tow"
expect 0 '1:3001:90 of 1:3001:66 ends: entity impact (1), target 1:3001:74' "$tow"
expect 0 '861  *72 Attribute' "$data/vrf-dis7-gaz69-blocks.pcap"
expect 0 '759  other_exercise' "$tow" --exercise 9
expect 0 'try --port 0' "$tow" --port 3001
expect 0 '462  *1 Entity State' "$tow" --port 0
head -c 100000 "$tow" >"$scratch/cut.pcap"
expect 0 'ends inside a packet' "$scratch/cut.pcap"
if [ -w /dev/full ]; then
    "$pitviper" inspect "$tow" >/dev/full 2>"$scratch/said"
    [ $? = 1 ] || fail "a full disk is not told"
fi

# ---- one line per Entity State -----------------------------------------------------------------------------
for name in vrf-dis5-tow-vs-armor vrf-dis7-gaz69-blocks vrf-dis7-gaz69-straight; do
    "$pitviper" inspect "$data/$name.pcap" --pdus tsv >"$scratch/ours.tsv" || fail "$name: exit code"
    cmp "$scratch/ours.tsv" "$data/$name.espdu.tsv" || fail "$name: the lines differ from tshark's"
    "$pitviper" inspect "$data/$name.pcap" --pdus tsv --full | cut -f 1-27 | cmp - "$scratch/ours.tsv" ||
        fail "$name: --full changes the first columns"
done

# ---- --full, against tshark itself -------------------------------------------------------------------------
if ! command -v tshark >/dev/null || ! tshark -G fields 2>/dev/null | grep -q 'dis.vp.artic_param_type'; then
    [ $failures = 0 ] || exit 1
    echo "skipped: --full needs a tshark with DIS fields to be held against (apt install tshark); the rest passed"
    exit 77
fi
# tshark gives both entity types in one field, splits the category by domain, names the dead-reckoning algorithm and
# the character set alike, and gives the articulation as lists: put into our columns here.
as_ours='
function part(list, n,  a) { split(list, a, ","); return a[n] }
function join_type(n, s) {
    return part($2, n) s part($3, n) s part($4, n) s part(category, n) s part($11, n) s part($12, n) s part($13, n)
}
BEGIN { FS = OFS = "\t" }
{
    category = $5 $6 $7 $8 $9 $10
    type = join_type(1, OFS)
    other = join_type(2, ".")
    articulation = ""
    records = split($17, t, ",")
    for (i = 1; i <= records; i++)
        articulation = articulation (i > 1 ? ";" : "") part($18, i) ":" part($19, i) ":" part($20, i) ":" part($21, i)
    print $1, type, part($14, 1), $15, $16, other, articulation
}'
for name in vrf-dis5-tow-vs-armor vrf-dis7-gaz69-blocks vrf-dis7-gaz69-straight singles; do
    fields=(frame.number dis.entityKind dis.entityDomain dis.country dis.category dis.category.land dis.category.air
            dis.category.surface dis.category.subsurface dis.category.space dis.subcategory dis.specific dis.extra
            dis.entity_marking_character_set dis.dead_reckoning_other_parameters dis.capabilities
            dis.variable_parameter_type dis.vp.change dis.vp.part_attached_to_id dis.vp.artic_param_type
            dis.vp.parameter_value)
    tshark -r "$data/$name.pcap" -d udp.port==3000,dis -Y 'dis.pdu_type == 1' -T fields "${fields[@]/#/-e}" \
        2>/dev/null | awk "$as_ours" >"$scratch/tshark.tsv"
    "$pitviper" inspect "$data/$name.pcap" --pdus tsv --full | tail -n +2 | cut -f 1,28-39 >"$scratch/ours.tsv"
    [ -s "$scratch/tshark.tsv" ] || fail "$name: tshark gave nothing"
    diff "$scratch/tshark.tsv" "$scratch/ours.tsv" >"$scratch/diff" ||
        fail "$name: --full differs from tshark: $(head -4 "$scratch/diff")"
done

[ $failures = 0 ] && echo "inspect: all as it should be"
[ $failures = 0 ]
