# What tests of `pitviper regress` share; source it after common.sh.
export TMPDIR=$tmp # what failed on purpose is not kept
# new_case NAME [SIZE RATE FRAMES]: frames in all bands of the demo's missile, 2 of 64x48 unless said; without the ground's
# detail, whose noise no file format makes small; with few posts, and warmed up in few steps, as $coarse and $bare do
new_case() {
    local name=$1 size=${2:-64x48} rate=${3:-5} frames=${4:-5, 24}
    mkdir -p "$tmp/$name"
    cat >"$tmp/$name/case.yaml" <<YAML
purpose: a missile nears a truck & its <column>
scenario: demo
config: |
  sensor:
    width_px: ${size%x*}
    height_px: ${size#*x}
    rate_hz: $rate
  exercise:
    listen_s: 14
    utc: 2026-06-21T17:00:00Z
  terrain:
    detail: off
    spacing_m: 30
    woods: off
    buildings: off
    clutter: 0
  heat: {facets: 3, step_s: 1800, shadow_m: 64, vehicle_step_s: 600}
  models: {sag_m: 0.02}
  seed: 1
causal: true
frames: [$frames]
timeout_s: 300
YAML
}
# changed NAME SED: the case good with its record, and a line changed
changed() {
    rm -rf "${tmp:?}/$1"
    cp -r "$tmp/good" "$tmp/$1"
    sed -i "$2" "$tmp/$1/case.yaml"
}
# fails NAME WHAT options: the case ends with 1, and this is its line
fails() {
    run regress "$tmp/$1" "${@:3}"
    check "$1: exit code" [ $code = 1 ]
    check "$1: $2" grep -qE "^$1 +FAILED: $2" "$tmp/stdout" || tail -n 3 "$tmp/stdout"
}
# spoil_table COLUMN FACTOR: the tables in $tmp/etc, one column of the materials by a factor
spoil_table() {
    rm -rf "$tmp/etc"
    cp -r etc "$tmp/etc"
    awk -F, -v OFS=, -v name="$1" -v factor="$2" '
        /^#/ || NF < 2 { print; next }
        !head { for (i = 1; i <= NF; i++) if ($i == name) at = i; head = 1; print; next }
        at { $at = $at * factor } { print }' etc/materials.csv >"$tmp/etc/materials.csv"
}
# fails_by_table COLUMN FACTOR CHANNEL: what is said and reported of the case good with such a table
fails_by_table() {
    local column=$1 factor=$2 named=$3
    spoil_table "$column" "$factor"
    PITVIPER_ETC=$tmp/etc run regress "$tmp/good" --report "$tmp/report.html" --work "$tmp/work"
    check "materials, $column: the changed table comes first" \
        [ "$(head -n 1 "$tmp/stdout" | grep -cE '^good +changed: table materials.csv: SHA-256 [0-9a-f]{8}')" = 1 ]
    check "materials, $column: no other table" [ "$(grep -c 'changed: table' "$tmp/stdout")" = 1 ]
    check "materials, $column: it heads the report" test "$(grep -nm1 'table materials.csv' "$tmp/report.html" | cut -d: -f1)" \
        -lt "$(grep -nm1 '<th>channel</th>' "$tmp/report.html" | cut -d: -f1)"
    check "materials, $column: names $named" grep -qE "^good +FAILED: $named: " "$tmp/stdout" || cat "$tmp/stdout"
}
