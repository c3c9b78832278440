#!/usr/bin/env bash
# Spoilt model files - FBX, glTF, GLB, OBJ - end with a model or one error line, within their memory, and reach no network.
# Thousands, and every call to the kernel: test_model_mutants_deep.sh.
. "$(dirname "$0")/common.sh"
check "spoilt models" python3 tests/system/model_mutants.py "$pitviper" "$tmp" "${PITVIPER_MUTANT_MODELS:-16}" ${PITVIPER_MUTANT_STRACE:-}
finish
