#!/usr/bin/env bash
# As test_determinism_scenes.sh, with more numbers of threads and more scenes: a pole, a helicopter in a turn. labels: deep
PITVIPER_SCENES_DEEP=yes exec bash "$(dirname "$0")/test_determinism_scenes.sh" "$@"
