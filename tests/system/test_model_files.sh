#!/usr/bin/env bash
# Model files of one thing whose sizes are known, in each unit, axes, number form and packing: FBX, glTF, OBJ, others.
. "$(dirname "$0")/common.sh"
for what in fbx gltf obj other; do
    check "$what" python3 tests/system/model_files.py "$pitviper" "$tmp" "$what"
done
finish
