/* tests/sensor/score_fixture.h: folders of products made by hand, for tests of scoring: the fields of truth.jsonl that
 * it reads. The sensor is at 0 N 0 E and looks north, 640 x 480 pixels, 4 by 3 degrees. */
#ifndef TESTS_SENSOR_SCORE_FIXTURE_H
#define TESTS_SENSOR_SCORE_FIXTURE_H

#include "tests/check.h"

#include "sensor/score/score.h"

#include <sys/stat.h>

typedef struct ScoreFolder {
    char  path[64];
    FILE *truth, *answers;
} ScoreFolder;

static inline FILE *score_file(const ScoreFolder *f, const char *name)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", f->path, name);
    FILE *file = fopen(path, "w");
    CHECK(file);
    return file;
}

static inline void score_folder_open(ScoreFolder *f)
{
    strcpy(f->path, "/tmp/pitviper-score-XXXXXX");
    CHECK(mkdtemp(f->path));
    f->truth = score_file(f, "truth.jsonl");
    f->answers = score_file(f, "answers.jsonl");
}

static inline void score_folder_remove(const ScoreFolder *f)
{
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", f->path);
    CHECK(strncmp(f->path, "/tmp/pitviper-score-", 20) == 0 && system(command) == 0);
}

/* A frame; its targets follow, each but the first with a comma before it, then score_frame_end. */
static inline void score_frame(const ScoreFolder *f, int frame, const char *bands)
{
    fprintf(
        f->truth,
        "{\"frame\":%d,\"time_s\":%d,\"host\":{\"lat_deg\":0,\"lon_deg\":0,\"height_m\":100},"
        "\"sun\":{\"azimuth_deg\":180,\"elevation_deg\":60},\"sensors\":[{\"bands\":[%s],\"width_px\":640,"
        "\"height_px\":480,\"hfov_deg\":4,\"vfov_deg\":3,\"ecef_from_cam\":[0,-1,0,1,0,0,0,0,1],\"ground_km2\":0.25}],"
        "\"targets\":[",
        frame, frame, bands);
}

/* box: left, top, right, bottom, whole. pixels 0: hidden. */
static inline void score_target(const ScoreFolder *f, const char *before, int number, const char *kind,
                                const int box[4], double pixels)
{
    fprintf(f->truth,
            "%s{\"entity\":\"1:2:%d\",\"class\":\"%s\",\"range_m\":1200,\"aspect_deg\":350,\"pixels\":%g,"
            "\"visible_fraction\":0.95,\"foliage_fraction\":0,\"amodal_box_px\":[%d,%d,%d,%d],",
            before, number, kind, pixels, box[0], box[1], box[2], box[3]);
    if (pixels > 0) fprintf(f->truth, "\"box_px\":[%d,%d,%d,%d],", box[0], box[1], box[2], box[3]);
    fprintf(f->truth, "\"bands\":{\"lwir\":{\"snr\":-4}}}");
}

static inline void score_frame_end(const ScoreFolder *f) { fprintf(f->truth, "]}\n"); }

static inline void score_folder_close(ScoreFolder *f)
{
    if (f->truth) fclose(f->truth);
    if (f->answers) fclose(f->answers);
    f->truth = f->answers = NULL;
}

/* Scores it with these rules, NULL: the default ones. */
static inline Status score_folder_run(ScoreReport *report, const ScoreFolder *f, const ScoreRules *rules)
{
    const ScoreRequest request = {.out = f->path, .rules = rules ? *rules : score_default_rules()};
    return score_run(report, &request);
}

#endif
