/* sensor/publish/coco_mask.c: pixels of each entity in the truth plane, and their run lengths as text. */
#include "sensor/publish/coco_mask.h"

void mask_extents(MaskExtent *extent, int count, const uint32_t *plane, int width, int height)
{
    memset(extent, 0, (size_t)count * sizeof *extent);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint32_t value = plane[(size_t)y * (size_t)width + (size_t)x];
            if (value == 0 || value > (uint32_t)count) continue;
            MaskExtent *e   = &extent[value - 1];
            int        *box = e->box;
            if (e->pixels++ == 0) box[0] = x, box[1] = y; /* rows come in order */
            if (x < box[0]) box[0] = x;
            if (x + 1 > box[2]) box[2] = x + 1;
            box[3] = y + 1;
        }
}

size_t mask_text_size(const MaskExtent *extent)
{
    /* a column begins and ends a run at most once in two of its rows; one more run on either side of the box */
    const size_t columns = (size_t)(extent->box[2] - extent->box[0]), rows = (size_t)(extent->box[3] - extent->box[1]);
    return mask_run_characters * (columns * (rows + 1) + 2) + 1;
}

typedef struct RunText {
    char     *at;
    long long before[2]; /* the run before, and the one before that */
    int       count;
} RunText;

static void put_run(RunText *t, long long run)
{
    long long rest = t->count > 2 ? run - t->before[1] : run;
    bool      more = true;
    while (more) {
        const int group = (int)(rest & 31);
        rest >>= 5; /* of negative numbers too: gcc and clang shift arithmetically */
        more    = group & 16 ? rest != -1 : rest != 0;
        *t->at++ = (char)(48 + (group | (more ? 32 : 0)));
    }
    t->before[1] = t->before[0];
    t->before[0] = run;
    t->count++;
}

void mask_text(char *text, const uint32_t *plane, uint32_t value, int width, int height, const MaskExtent *extent)
{
    RunText   t   = {.at = text};
    long long end = 0; /* of the last run */
    bool      on  = false;
    for (int x = extent->box[0]; x < extent->box[2]; x++) {
        /* from row 0 on where the previous column ended within the mask, to the row after the box or the last row of
         * the image */
        const int first = on ? 0 : extent->box[1], behind = extent->box[3] < height ? extent->box[3] + 1 : height;
        for (int y = first; y < behind; y++) {
            if ((plane[(size_t)y * (size_t)width + (size_t)x] == value) == on) continue;
            const long long at = (long long)x * height + y;
            put_run(&t, at - end);
            end = at;
            on  = !on;
        }
    }
    const long long rest = (long long)width * height - end;
    if (on && extent->box[2] < width) { /* its last column ends with the last row of the image */
        put_run(&t, (long long)extent->box[2] * height - end);
        end = (long long)extent->box[2] * height;
        if ((long long)width * height > end) put_run(&t, (long long)width * height - end);
    } else if (rest > 0) {
        put_run(&t, rest);
    }
    *t.at = 0;
}

void mask_box_text(char *text, int width, int height, const MaskExtent *extent)
{
    const int *box = extent->box, columns = box[2] - box[0], rows = box[3] - box[1];
    const bool whole = rows == height; /* its columns follow each other without a gap */
    RunText    t = {.at = text};
    long long  end = (long long)box[0] * height + box[1];
    put_run(&t, end);
    for (int x = 0; x < (whole ? 1 : columns); x++) {
        const long long run = whole ? (long long)columns * height : rows;
        if (x > 0) put_run(&t, height - rows);
        put_run(&t, run);
        end += run + (x > 0 ? height - rows : 0);
    }
    if ((long long)width * height > end) put_run(&t, (long long)width * height - end);
    *t.at = 0;
}
