/* sensor/score/worst.c: a short list of the worst cases, of each kind one. */
#include "sensor/score/worst.h"

enum { frames_alike = 25 };

static int by_text(const char *a, const char *b) { return strcmp(a, b); }

/* 0: they look alike. */
static int compare_kind(const WorstCase *a, const WorstCase *b)
{
    int order = by_text(a->sequence, b->sequence);
    if (!order) order = (int)a->band - (int)b->band;
    if (!order) order = by_text(a->id, b->id);
    if (!order) order = (a->track > b->track) - (a->track < b->track);
    if (!order && !a->id[0]) {
        order = by_text(a->name, b->name);
        if (!order && !a->track) order = a->frame / frames_alike - b->frame / frames_alike;
    }
    return order;
}

/* Below 0: a is worse. Cases that differ in anything shown have an order. */
static int compare(const WorstCase *a, const WorstCase *b)
{
    if (a->weight != b->weight) return a->weight > b->weight ? -1 : 1;
    int order = compare_kind(a, b);
    if (!order) order = (a->frame > b->frame) - (a->frame < b->frame);
    if (!order) order = by_text(a->name, b->name);
    for (int k = 0; k < 4 && !order; k++) order = (a->box_px[k] > b->box_px[k]) - (a->box_px[k] < b->box_px[k]);
    return order;
}

void worst_add(WorstCases *cases, const WorstCase *one)
{
    if (!isfinite(one->weight)) return;
    int alike = 0;
    while (alike < cases->count && compare_kind(&cases->one[alike], one)) alike++;
    if (alike < cases->count) { /* it goes, unless it is worse */
        if (compare(&cases->one[alike], one) <= 0) return;
        cases->count--;
        memmove(&cases->one[alike], &cases->one[alike + 1], (size_t)(cases->count - alike) * sizeof *cases->one);
    }
    int at = cases->count;
    while (at > 0 && compare(one, &cases->one[at - 1]) < 0) at--;
    if (at == worst_most) return;
    if (cases->count < worst_most) cases->count++;
    memmove(&cases->one[at + 1], &cases->one[at], (size_t)(cases->count - 1 - at) * sizeof *cases->one);
    cases->one[at] = *one;
}
