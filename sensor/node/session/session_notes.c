/* sensor/node/session/session_notes.c: the frames of a live node that had no radar, written to and read from the
 * notes of its recording. */
#include "sensor/node/session/session.h"

#include <stdlib.h>

static const char   begin[] = "pitviper: no radar in frame ";
static const double near_s = 1e-4;

typedef struct Absent {
    int    number;
    double t_s;
} Absent;

struct RadarAbsent {
    int    count;
    Absent frame[]; /* by number */
};

void session_radar_absent_text(char out[session_radar_absent_size], int number, double t_s)
{
    snprintf(out, session_radar_absent_size, "%s%d at %.6f s", begin, number, t_s);
}

static bool read_line(Absent *out, const char *line)
{
    int  end = 0;
    char text[session_radar_absent_size];
    if (strncmp(line, begin, sizeof begin - 1) != 0) return false;
    double number;
    if (sscanf(line + sizeof begin - 1, "%lf at %lf s%n", &number, &out->t_s, &end) != 2 || end == 0) return false;
    if (!(number >= 0 && number <= INT32_MAX && fabs(out->t_s) < 1e9)) return false;
    out->number = (int)number;
    session_radar_absent_text(text, out->number, out->t_s);
    const size_t length = strlen(text);
    return strncmp(line, text, length) == 0 && (line[length] == '\n' || line[length] == 0);
}

static int by_number(const void *a, const void *b)
{
    const Absent *p = a, *q = b;
    return p->number < q->number ? -1 : p->number > q->number;
}

Status session_radar_absent_read(RadarAbsent **out, const char *notes)
{
    int    lines = 0;
    Absent one;
    *out = NULL;
    if (!notes) return STATUS_OK;
    for (const char *at = notes; at && *at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL)
        lines += read_line(&one, at);
    if (lines == 0) return STATUS_OK;
    RadarAbsent *a = malloc(sizeof *a + (size_t)lines * sizeof *a->frame);
    if (!a) return STATUS_NO_MEMORY;
    a->count = 0;
    for (const char *at = notes; at && *at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL)
        if (read_line(&one, at)) a->frame[a->count++] = one;
    qsort(a->frame, (size_t)a->count, sizeof *a->frame, by_number);
    *out = a;
    return STATUS_OK;
}

void session_radar_absent_free(RadarAbsent *a) { free(a); }

bool session_radar_absent_in(const RadarAbsent *a, int number, double t_s)
{
    if (!a) return false;
    const Absent  key = {number, t_s};
    const Absent *found = bsearch(&key, a->frame, (size_t)a->count, sizeof *a->frame, by_number);
    return found && fabs(found->t_s - t_s) < near_s;
}
