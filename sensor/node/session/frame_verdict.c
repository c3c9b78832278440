/* sensor/node/session/frame_verdict.c: what frames of a live node gave up, written to and read from the notes of its
 * recording. */
#include "sensor/node/session/frame_verdict.h"

#include <stdlib.h>

static const char   begin[] = "pitviper: ";
static const double near_s = 1e-4;

typedef struct Verdict {
    int      number;
    double   t_s;
    unsigned given_up; /* one of them */
} Verdict;

struct FrameVerdicts {
    int     count;
    Verdict verdict[]; /* by number */
};

/* The words of a note, the name in truth.jsonl, and the step of sampling, by bit. */
static const struct {
    const char *note, *name;
    Sampling    sampling;
} kind[verdict_count] = {[0] = {"no radar", NULL, SAMPLING_ALL},
                         [1] = {"no grids of small targets", "target_grids", SAMPLING_ALL},
                         [2] = {"targets alone refined", "targets", SAMPLING_TARGETS},
                         [3] = {"ground sampled as a checkerboard", "checkerboard", SAMPLING_CHECKERBOARD},
                         [4] = {"ground sampled by quarters", "quarter", SAMPLING_QUARTER},
                         [5] = {"coarse radar", "radar_detail", SAMPLING_ALL}};

unsigned frame_verdict_of_sampling(Sampling sampling)
{
    for (int i = 0; i < verdict_count; i++)
        if (sampling != SAMPLING_ALL && kind[i].sampling == sampling) return 1u << i;
    return 0;
}

void frame_verdict_apply(RenderRequest *request, unsigned verdict)
{
    if (verdict & VERDICT_NO_TARGET_GRIDS) request->target_samples = 0;
    for (int i = 0; i < verdict_count; i++)
        if (verdict >> i & 1 && kind[i].sampling > request->sampling) request->sampling = kind[i].sampling;
}

void frame_verdict_names(char out[frame_verdict_names_size], unsigned verdict)
{
    size_t n = 0;
    *out = 0;
    for (int i = 0; i < verdict_count; i++)
        if (verdict >> i & 1 && kind[i].name && n < frame_verdict_names_size)
            n += (size_t)snprintf(out + n, frame_verdict_names_size - n, "%s%s", n ? "," : "", kind[i].name);
}

void frame_verdict_text(char out[frame_verdict_text_size], unsigned one, int number, double t_s)
{
    int i = 0;
    while (one >> (i + 1)) i++;
    snprintf(out, frame_verdict_text_size, "%s%s in frame %d at %.6f s", begin, kind[i].note, number, t_s);
}

/* A line that is, to the octet, what frame_verdict_text writes. */
static bool read_line(Verdict *out, const char *line)
{
    char         text[frame_verdict_text_size], again[frame_verdict_text_size];
    const size_t length = strcspn(line, "\n");
    if (length >= sizeof text) return false;
    memcpy(text, line, length);
    text[length] = 0;
    const char *at = strstr(text, " in frame ");
    double      number, t_s;
    if (!at || sscanf(at, " in frame %lf at %lf s", &number, &t_s) != 2) return false;
    if (!(number >= 0 && number <= INT32_MAX && fabs(t_s) < 1e9)) return false;
    for (int i = 0; i < verdict_count; i++) {
        if (!kind[i].note) continue;
        *out = (Verdict){(int)number, t_s, 1u << i};
        frame_verdict_text(again, out->given_up, out->number, out->t_s);
        if (strcmp(text, again) == 0) return true;
    }
    return false;
}

static int by_number(const void *a, const void *b)
{
    const Verdict *p = a, *q = b;
    return p->number < q->number ? -1 : p->number > q->number;
}

Status frame_verdicts_read(FrameVerdicts **out, const char *notes)
{
    int     lines = 0;
    Verdict one;
    *out = NULL;
    for (const char *at = notes; at; at = text_next_line(at)) lines += read_line(&one, at);
    if (lines == 0) return STATUS_OK;
    FrameVerdicts *v = malloc(sizeof *v + (size_t)lines * sizeof *v->verdict);
    if (!v) return STATUS_NO_MEMORY;
    v->count = 0;
    for (const char *at = notes; at; at = text_next_line(at))
        if (read_line(&one, at)) v->verdict[v->count++] = one;
    qsort(v->verdict, (size_t)v->count, sizeof *v->verdict, by_number);
    *out = v;
    return STATUS_OK;
}

void frame_verdicts_free(FrameVerdicts *v) { free(v); }

unsigned frame_verdicts_of(const FrameVerdicts *v, int number, double t_s)
{
    unsigned verdict = 0;
    int      low = 0, high = v ? v->count : 0;
    while (low < high) { /* the first of that number */
        const int middle = low + (high - low) / 2;
        if (v->verdict[middle].number < number) low = middle + 1;
        else high = middle;
    }
    for (; v && low < v->count && v->verdict[low].number == number; low++)
        if (fabs(v->verdict[low].t_s - t_s) < near_s) verdict |= v->verdict[low].given_up;
    return verdict;
}
