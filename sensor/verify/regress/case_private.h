/* sensor/verify/regress/case_private.h: a case of the regression: exercise, settings, frames and tolerances.
 *
 * A case is a folder:
 *
 *     case.yaml   what to run and what to look at (below)
 *     record/     the baseline: the approved products; written only by `pitviper regress --update`
 *     card.md     when and why the baseline changed, newest first; written with it
 *
 * Other files in the folder are left alone. case.yaml:
 *
 *     purpose: a missile flies at a truck in a column of five     # one sentence
 *     scenario: demo              # a name that `pitviper exercise` knows, or a YAML file in this folder
 *     scenario_set: seed=7 dis.version=6    # its --set, separated by blanks or lines
 *     # log: column.pcap          # or a recording, in this folder or as ${PITVIPER_DATA}/logs/column.pcap
 *     config: |                   # settings of `pitviper replay`, as in a file of --config
 *       sensor:
 *         width_px: 96
 *         height_px: 64
 *     # config_file: node.yaml    # or such a file in this folder
 *     frames: [3, 7, 12]          # numbers, as replay gives them
 *     causal: true                # --causal; false by default
 *     log_may_be_absent: true     # then the case is skipped; by default it fails
 *     timeout_s: 300              # a process that takes longer is ended, and the case fails
 *     tolerance:                  # overrides of the defaults, whose reasons are in case_default
 *       lwir_k: 0.05
 *
 * record/ holds NNNNNN.exr for each frame, all planes in one (range_m, entity, part, material, temp_k, nx, ny, nz,
 * optical.R ..., mwir.Y, lwir.Y, radar.Y), rounded and coded as sensor/verify/regress/verdict_private.h says;
 * NNNNNN.profile.exr, a row of range bins; truth.jsonl as the run wrote it, and run.json without times. */
#ifndef SENSOR_VERIFY_REGRESS_CASE_PRIVATE_H
#define SENSOR_VERIFY_REGRESS_CASE_PRIVATE_H

#include "pitviper.h"

enum { case_path_size = 4096, case_frames_max = 64 };

/* The largest accepted differences, and the share of pixels that may be beyond them. */
typedef struct Tolerance {
    double range_rel; /* range: relative */
    double normal;    /* each component */
    double temp_k;
    double optical_rel, optical_w_m2_sr; /* both added */
    double mwir_k, lwir_k;               /* apparent temperature */
    double radar_db, profile_db;
    double radar_span_db; /* power this far below the brightest counts as zero */
    double share;         /* of pixels, temperature and radiance */
    double edge_share;    /* of edge pixels whose ids may differ; only under other libraries or another ISA */
    double truth; /* factor on the tolerances of the fields of truth.jsonl (sensor/verify/regress/verdict_truth.c) */
} Tolerance;

typedef struct Case {
    char       folder[case_path_size], name[128];
    char       purpose[400];
    char       log[1024], scenario[1024], scenario_set[4096];
    char       config[16384], config_file[1024];
    NumberList frames;
    bool       causal, log_may_be_absent;
    double     timeout_s;
    Tolerance  tolerance;
} Case;

Case case_default(void);
/* case.yaml of this folder. Any bytes; on failure logs file, line, key, value, range and what to do. */
Status case_read(Case *out, const char *folder);
/* The same for a file outside of a case folder. On failure *out is untouched. */
Status case_read_file(Case *out, const char *path);
/* Path of a file that the case names: ${NAME} from the environment, else relative to the folder. False, with the
 * reason, when that variable is not set or the path too long. */
bool case_path(char out[case_path_size], char reason[256], const Case *c, const char *name);
/* Replaces, in text on the heap, absolute paths in the case's folder by relative ones and those in $PITVIPER_DATA by
 * ${PITVIPER_DATA}/..., so that a baseline is the same wherever it was made. */
Status case_relative(char **text, const Case *c);
/* Prints the keys of case.yaml with ranges and meaning, for --help. */
void case_write_keys(FILE *to);

#endif
