/* sensor/score/score_file.c: writes score.json. */
#include "sensor/score/score.h"
#include "pitviper_output.h"
#include "sensor/frame/json_object.h"
#include "sensor/score/score_fields.h"

#include <errno.h>

Status score_write_json(const ScoreReport *report, const char *path)
{
    FILE   *file = output_begin(path, 0);
    json_t *object = file ? field_object(&score_fields, report) : NULL;
    bool    good = object && json_dumpf(object, file, JSON_INDENT(1) | JSON_REAL_PRECISION(15)) == 0;
    good = good && fputc('\n', file) != EOF;
    json_decref(object);
    if (good) good = output_end(file, path);
    else if (file) output_abandon(file, path);
    if (good) return STATUS_OK;
    log_error("score: cannot write %s: %s; choose another folder with --out", path, output_reason(errno));
    return STATUS_IO;
}
