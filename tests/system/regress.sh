# What tests of `pitviper regress` share; source it after common.sh.
export TMPDIR=$tmp # what failed on purpose is not kept
# new_case NAME [SIZE RATE FRAMES]: frames in all bands of the demo's missile, 2 of 64x48 unless said; without the ground's
# detail, whose noise no file format makes small; warmed up in few steps, as $bare does
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
    woods: off
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
