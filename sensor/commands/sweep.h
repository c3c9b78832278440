/* sensor/commands/sweep.h: `replay --sweep FILE`: many runs of one log.
 *
 *     OUT/vXXXXXXXXXX/       a run, named by its settings: unchanged when axes are added
 *         settings.yaml      all settings; `replay LOG -c settings.yaml` with the options in its second line
 *                            reproduces the run
 *         log.txt            messages of the run
 *         variant.json       its line of the manifest; exists when the run is complete
 *         coco.json          with publish.coco
 *     OUT/manifest.jsonl     a line per variant: status made, kept or failed, settings, folder, hashes of its frames
 *     OUT/manifest.html      thumbnails and settings
 *     OUT/coco.json          of all variants that have one (sensor/publish/coco_merge.h)
 *
 * A variant is a run with the given options and the values of the axes over them: settings are passed in
 * settings.yaml, which must read back equal, every other option on the command line of the variant (options_variant).
 * Several --host are refused.
 *
 * Every variant is validated (combinations of settings, sensors) before the first run. Each runs in a process of its
 * own, one after another, with all threads: a crash affects one variant only, and no state is carried over. The cost
 * is that log, models and terrain are loaded for each, about 0.7 s. A variant is kept when its folder holds a complete
 * run of these settings (time span and products included), this log and this version; deleted images, and changes of
 * etc/ or of terrain files, are not detected. */
#ifndef SENSOR_COMMANDS_SWEEP_H
#define SENSOR_COMMANDS_SWEEP_H

#include "sensor/node/host_run.h"

/* What replay knows of a run before its world is set up: log, hosts, span. Logged; the caller calls run_close. */
typedef Status SweepLook(Run *run);

/* Exit code: 0; 1: a variant failed, or the sweep could not be written, or look refuses what no axis changes; 2: the file or
 * settings of a variant are invalid. */
int sweep_replay(const Options *options, SweepLook *look);

#endif
