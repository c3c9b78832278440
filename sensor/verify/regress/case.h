/* sensor/verify/regress/case.h: a case of the regression: exercise, settings, frames and tolerances.
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
 *     tolerance:                  # overrides of the defaults, whose reasons are in CASE_TOLERANCE
 *       lwir_k: 0.05
 *     scores:                     # a recogniser's answers, scored against the truth of the frames
 *       command: python3 recogniser.py      # run as `COMMAND OUT` in this folder; writes OUT/answers.jsonl
 *       # answers: answers.jsonl            # or answers that were recorded, in this folder
 *
 * record/ holds NNNNNN.exr for each frame, all planes in one (range_m, entity, part, material, temp_k, nx, ny, nz,
 * optical.R ..., mwir.Y, lwir.Y, radar.Y), rounded and coded as sensor/verify/regress/verdict.h says;
 * NNNNNN.profile.exr, a row of range bins; truth.jsonl as the run wrote it, and run.json without times; scores.json
 * (sensor/verify/regress/case_scores.c), with scores. */
#ifndef SENSOR_VERIFY_REGRESS_CASE_H
#define SENSOR_VERIFY_REGRESS_CASE_H

#include "pitviper_settings.h"

enum { case_path_size = 4096, case_frames_max = 64 };

/* The keys, as pitviper_settings.h says. The tolerances are below any significance for a user of the products, above
 * the rounding of sensor/verify/regress/verdict.h: a value that crosses from one step to the next is still
 * within. No allowance for threads, ISAs and builds, which give the same bits (tests/system/test_determinism*.sh). */
/* clang-format off */
#define CASE_TOP(ROW) \
    ROW(TEXT, , purpose, "", 400, "", "purpose of the case, in one sentence") \
    ROW(TEXT, , scenario, "", 1024, "", \
        "scenario of `pitviper exercise`: a name, or a YAML file in the case's folder") \
    ROW(TEXT, , scenario_set, "", 4096, "", "settings of the scenario: KEY=VALUE, separated by blanks or lines") \
    ROW(TEXT, , log, "", 1024, "", "recording, in place of a scenario: in the case's folder, or ${PITVIPER_DATA}/...") \
    ROW(TEXT, , config, "", 16384, "", \
        "settings of `pitviper replay`, indented below `config: |`; paths in them are relative to the case's " \
        "folder") \
    ROW(TEXT, , config_file, "", 1024, "", "file of settings in the case's folder, in place of config") \
    ROW(NUMBERS, , frames, {0}, 0, 999999, "", "numbers of the frames to compare, as in replay") \
    ROW(BOOL, , causal, false, "replay --causal") \
    ROW(BOOL, , log_may_be_absent, false, "a missing log skips the case instead of failing it") \
    ROW(DOUBLE, , timeout_s, 300, 0.1, 86400, "s", "time limit of each process of the case")

#define CASE_SCORES(ROW) \
    ROW(TEXT, scores., command, "", 1024, "", \
        "recogniser's command, run by the shell in the case's folder with the folder of the run behind it, without " \
        "network; it writes answers.jsonl there") \
    ROW(TEXT, scores., answers, "", 1024, "", "its recorded answers, in place of a command: in the case's folder, or " \
        "${PITVIPER_DATA}/...") \
    ROW(DOUBLE, scores., timeout_s, 300, 0.1, 86400, "s", "time limit of the command")

#define CASE_TOLERANCE(ROW) \
    /* 6 cm in 2 km: two steps of the baseline */ \
    ROW(DOUBLE, tolerance., range_rel, 3e-5, 0, 1, "", "range, relative") \
    /* 0.2 degree: two steps of the baseline */ \
    ROW(DOUBLE, tolerance., normal, 0.004, 0, 2, "", "each component of a normal") \
    /* surface temperature: as in the thermal bands */ \
    ROW(DOUBLE, tolerance., temp_k, 0.05, 0, 1000, "K", "surface temperature") \
    /* a step of the baseline is 0.8 %; the sun 0.1 degree off is 7 x .share */ \
    ROW(DOUBLE, tolerance., optical_rel, 0.01, 0, 10, "", "optical radiance, relative") \
    /* half a step of 8 bits on a screen; a dark night */ \
    ROW(DOUBLE, tolerance., optical_w_m2_sr, 1e-3, 0, 1e4, "W/(m2 sr)", "optical radiance, absolute, in addition") \
    ROW(DOUBLE, tolerance., mwir_k, 0.05, 0, 1000, "K", "apparent temperature") \
    ROW(DOUBLE, tolerance., lwir_k, 0.05, 0, 1000, "K", "apparent temperature") /* NETD of the sensors of this band */ \
    ROW(DOUBLE, tolerance., radar_db, 0.1, 0, 100, "dB", "radar image") \
    /* stated accuracy of the radar models: Mie, trihedral */ \
    ROW(DOUBLE, tolerance., profile_db, 0.1, 0, 100, "dB", "range profile") \
    /* range of the display */ \
    ROW(DOUBLE, tolerance., radar_span_db, 60, 1, 200, "dB", \
        "radar: power this far below the brightest counts as zero") \
    /* 6 pixels of 96 x 64 */ \
    ROW(DOUBLE, tolerance., share, 0.001, 0, 1, "", \
        "share of pixels that may be beyond tolerance, of temperature and radiance") \
    /* ISAs of the ray tracer differ in t for 5 % of the rays, in ids for none */ \
    ROW(DOUBLE, tolerance., edge_share, 0.02, 0, 1, "", \
        "share of edge pixels whose ids may differ, with different libraries or ISA") \
    ROW(DOUBLE, tolerance., truth, 1, 0, 1e6, "", "factor on the tolerances of truth.jsonl") \
    /* recorded answers, and a recogniser that is repeatable, score the same of the same truth */ \
    ROW(DOUBLE, tolerance., detection, 0, 0, 1, "", "detection rate, of all bands and of each") \
    ROW(DOUBLE, tolerance., false_alarms, 0, 0, 1e6, "", "false alarms per frame and band") \
    ROW(DOUBLE, tolerance., ap, 0, 0, 1, "", "average precision, over classes")

/* The largest accepted differences, and the share of pixels that may be beyond them. */
typedef struct Tolerance { CASE_TOLERANCE(SETTING_MEMBER) } Tolerance;

typedef struct Case {
    char folder[case_path_size], name[128];
    CASE_TOP(SETTING_MEMBER)
    struct { CASE_SCORES(SETTING_MEMBER) } scores;
    Tolerance tolerance;
} Case;
/* clang-format on */

Case case_default(void);
/* case.yaml of this folder. Any bytes; on failure logs file, line, key, value, range and what to do. */
Status case_read(Case *out, const char *folder);
/* The same for a file outside of a case folder. On failure *out is untouched. */
Status case_read_file(Case *out, const char *path);
/* Path of a file that the case names: ${NAME} from the environment, else relative to the folder. False, with the
 * reason, when that variable is not set or the path too long. */
bool case_path(char out[case_path_size], char reason[256], const Case *c, const char *name);
bool case_has_scores(const Case *c);
/* Replaces, in text on the heap, absolute paths in the case's folder by relative ones and those in $PITVIPER_DATA by
 * ${PITVIPER_DATA}/..., so that a baseline is the same wherever it was made. */
Status case_relative(char **text, const Case *c);
/* Prints the keys of case.yaml with ranges and meaning, for --help. */
void case_write_keys(FILE *to);

#endif
