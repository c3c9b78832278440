/* sensor/node/run/run_end.c: the end of a host's run: the messages that say what there is. */
#include "sensor/node/run/host_run_private.h"

#include "sensor/instruments/radar.h"
#include "sensor/score/score.h"

/* What `pitviper score` says of the answers that came. */
static void score_answers(const Run *run, const RunEnd *end)
{
    enum { frames_most = 100000 }; /* some ten seconds */
    const Config *config = &run->options.config;
    ScoreRequest  asked = {.out = end->folder, .rules = score_default_rules()};
    ScoreReport   report;
    if (!config->publish.detections_port || !config->publish.truth || end->result->answers.lines == 0) return;
    if (log_is_quiet()) return;
    if (end->result->frames > frames_most) {
        log_print("the answers in %s/answers.jsonl are scored by `pitviper score %s`\n", end->folder, end->folder);
        return;
    }
    asked.rules.min_pixels = config->publish.coco_min_pixels;
    asked.rules.min_visible = config->publish.coco_min_visible;
    asked.rules.min_snr = config->publish.coco_min_snr;
    if (score_run(&report, &asked) != STATUS_OK) return; /* which has been logged, and is no failure of the run */
    score_print(stdout, &report, false);
    fflush(stdout);
    score_report_free(&report);
}

Status run_conclude(const Run *run, const RunEnd *end)
{
    const Config        *config = &run->options.config;
    const SessionResult *result = end->result;
    const char          *name = options_command(&run->options);
    const Status         status = run_write(run, end);
    if (run->stopped && !run->live) log_warn("%s: stopped before its last frame; run.json says so", name);
    if (config->publish.files) log_print("%d frames in %s/frames\n", result->frames, end->folder);
    else if (!config->publish.truth) log_print("%d frames; figures in %s/run.json\n", result->frames, end->folder);
    else log_print("%d frames; their truth is in %s/truth.jsonl\n", result->frames, end->folder);
    fflush(stdout);
    for (int i = 0; i < instruments_most; i++) {
        const InstrumentCount *lacking = &result->instrument[i];
        if (lacking->left_out > 0)
            log_warn("%s: %d of %d frames are without %s: %s", name, lacking->left_out, result->frames, lacking->name,
                     lacking->why);
    }
    if (result->at_limit > 0) /* its warning came when it was */
        log_print("the aim was beyond the gimbal in %d of %d frames (sensor.gimbal_limit_deg)\n", result->at_limit,
                  result->frames);
    score_answers(run, end);
    if (result->buried > 0)
        log_warn("%s: the eye was below the ground in %d of %d frames and saw nothing of use%s", name, result->buried,
                 result->frames,
                 *config->terrain.elevation && config->terrain.ground != TERRAIN_GROUND_FIT
                     ? "; over other ground than the exercise's, terrain.ground=fit leads it through"
                     : "");
    return status;
}
