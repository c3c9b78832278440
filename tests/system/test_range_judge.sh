#!/usr/bin/env bash
# How far a sensor's observer sees: MTF, electrons and signal to noise against pyBSM, the eye against Barten's model of 1999 by
# colour-science, TTP values and probabilities against the papers' formulae in Python: tests/system/range_judge.py.
. "$(dirname "$0")/common.sh"
judges python3.pybsm python3.colour python3.scipy python3.numpy

for sensor in staring_lwir scanning_flir tv; do
    run range $sensor -o "$tmp/$sensor"
    check "range $sensor" [ $code = 0 ]
    cp "$tmp/stdout" "$tmp/$sensor.txt"
done
python3 tests/system/range_judge.py "$pitviper" "$tmp" >"$tmp/judge.txt" 2>"$tmp/judge.err"
check "the judge ends well" [ $? = 0 ] || tail -n 5 "$tmp/judge.err"
cat "$tmp/judge.txt"
# within WHAT COUNT LIMIT: so many values at least, and none that differs by more
within() {
    read -r rows worst < <(grep -oP "^$1 \K.*" "$tmp/judge.txt")
    check "$1: ${rows:-no} values" [ "${rows:-0}" -ge "$2" ]
    check "$1: ${worst:-none} of $3" is "${worst:-9e9}" '<' "$3"
}
for part in mtf_optics mtf_detector mtf_smear mtf_jitter mtf; do within $part 150 1e-6; done
within electrons 9 1e-5
within snr 9 1e-5
within eye_threshold 48 1e-9
within eye_transfer 48 1e-9
within barten_1999_from_1 20 1.8 # a formula of 1990 beside a model of 1999
within barten_1999_from_4 16 1.35
within ttp 24 0.0012
within cycles 9 0.006 # a step of the judge's is 0.001, of 0.2 and more
for sensor in staring_lwir scanning_flir; do
    within range_contrast_$sensor 100 2e-5
    within range_cycles_$sensor 100 0.01 # a step of the judge's is 0.001, of 0.1 and more
    within range_ttp_$sensor 15 0.001
done
within range_contrast_tv 100 1e-4
within range_ttp_tv 10 0.002
for sensor in staring_lwir scanning_flir tv; do
    for task in detect recognise identify; do within range_p_${task}_$sensor 150 1e-4; done
done
# a sensor that resolves to half of its pixels: ranges are geometry
read -r recognise identify < <(grep -oP '^half_johnson \K.*' "$tmp/judge.txt")
read -r said_recognise said_identify < <(sed -n 's/^Johnson .*recognise \([0-9.]*\) km, identify \([0-9.]*\) km.*/\1 \2/p' "$tmp/staring_lwir.txt")
check "recognised at ${said_recognise:-?} km" is "$(awk -v a="${said_recognise:-0}" -v b="$recognise" 'BEGIN { d = 1000 * a / b - 1; print d < 0 ? -d : d }')" '<' 0.005
check "identified at ${said_identify:-?} km" is "$(awk -v a="${said_identify:-0}" -v b="$identify" 'BEGIN { d = 1000 * a / b - 1; print d < 0 ? -d : d }')" '<' 0.005
finish
