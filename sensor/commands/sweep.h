/* sensor/commands/sweep.h: `replay --sweep FILE`: many runs of one log.
 *
 *     OUT/vXXXXXXXXXX/       a run, named after its settings: the same ones keep their name when axes grow
 *         settings.yaml      all of them; `replay LOG -c settings.yaml` makes this run again, with the options that
 *                            its second line names
 *         log.txt            what the run said
 *         variant.json       its line of the manifest; there when the run is whole
 *         coco.json          with publish.coco
 *     OUT/manifest.jsonl     a line a variant: status made, kept or failed, settings, folder, hashes of its frames
 *     OUT/manifest.html      thumbnails and settings
 *     OUT/coco.json          of all variants that have one (sensor/publish/coco_merge.h)
 *
 * A variant is the run of the user's own options with the values of the axes over them: what is a setting goes through
 * settings.yaml, which must read back the same, and every other option goes to the variant's command line as it was given
 * (options_variant). Several --host are refused.
 *
 * Every variant is tried (settings that go together, sensors) before the first runs. Each is a process of its own, one
 * after another, with all threads: what crashes or fails takes nothing with it, and no variant can leak into the next.
 * The price is that log, models and ground are made anew, about 0.7 s of a run. A variant is kept when a whole run of these
 * settings (span and products too), this log and this version lies in its folder; pictures taken out of it, and changes
 * of etc/ or of terrain files, are not noticed. */
#ifndef SENSOR_COMMANDS_SWEEP_H
#define SENSOR_COMMANDS_SWEEP_H

#include "sensor/settings/options.h"

/* Exit code: 0; 1: a variant failed, or the sweep could not be written; 2: the file or a variant's settings are wrong. */
int sweep_replay(const Options *options);

#endif
