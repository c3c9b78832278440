#!/usr/bin/env bash
# `pitviper inspect --pdus tsv --full` against tshark: types, markings, dead reckoning, articulation.
. "$(dirname "$0")/common.sh"
needs_data dis/vrf-dis5-tow-vs-armor.pcap
judges tshark
data=$data/dis

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
        2>/dev/null | awk "$as_ours" >"$tmp/tshark.tsv"
    "$pitviper" inspect "$data/$name.pcap" --pdus tsv --full | tail -n +2 | cut -f 1,28-39 >"$tmp/ours.tsv"
    check "$name: tshark gives something" [ -s "$tmp/tshark.tsv" ]
    check "$name: --full is tshark's" diff "$tmp/tshark.tsv" "$tmp/ours.tsv"
done
# its twin
check "another type is noticed" not quiet diff "$tmp/tshark.tsv" <(sed '1s/\t1/\t2/' "$tmp/ours.tsv")
finish
