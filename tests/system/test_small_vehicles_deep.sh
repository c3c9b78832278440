#!/usr/bin/env bash
# As test_small_vehicles.sh, with twice the sightings and all as it is by default. labels: deep
PITVIPER_SIGHTINGS=all exec bash "$(dirname "$0")/test_small_vehicles.sh" "$@"
