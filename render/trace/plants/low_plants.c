/* render/trace/plants/low_plants.c: the low plants of a frame: squares about the eye, thinned out towards their reach.
 * What grows on a square is the same in every frame, so that the last squares are kept. */
#include "render/trace/plants/forest_private.h"

#include <pthread.h>
#include <stdlib.h>

/* ---- squares that are kept -------------------------------------------------------------------- */

enum { low_slots_side = 32 }; /* 256 m: of a frame that reaches 120 m each square has a slot of its own */

typedef struct LowSquare {
    pthread_mutex_t lock;
    bool            known;
    int64_t         i, j;
    int             count;
    Plant          *plant; /* malloc'd */
} LowSquare;

struct LowSquares {
    LowSquare slot[low_slots_side * low_slots_side];
};

LowSquares *low_squares_create(void)
{
    LowSquares *squares = calloc(1, sizeof *squares);
    for (int k = 0; squares && k < low_slots_side * low_slots_side; k++)
        pthread_mutex_init(&squares->slot[k].lock, NULL);
    return squares;
}

void low_squares_destroy(LowSquares *squares)
{
    for (int k = 0; squares && k < low_slots_side * low_slots_side; k++) {
        pthread_mutex_destroy(&squares->slot[k].lock);
        free(squares->slot[k].plant);
    }
    free(squares);
}

/* What woods_low_plants gives. Without memory a square is not kept. */
static int plants_of(Plant plant[woods_low_most], const Forest *forest, int64_t i, int64_t j)
{
    LowSquare *slot = &forest->squares->slot[(j & (low_slots_side - 1)) * low_slots_side + (i & (low_slots_side - 1))];
    int        count = -1;
    pthread_mutex_lock(&slot->lock);
    if (slot->known && slot->i == i && slot->j == j) {
        count = slot->count;
        if (count > 0) memcpy(plant, slot->plant, (size_t)count * sizeof *plant);
    }
    pthread_mutex_unlock(&slot->lock);
    if (count >= 0) return count;

    count = woods_low_plants(plant, forest->woods, i, j);
    Plant *copy = count > 0 ? malloc((size_t)count * sizeof *copy) : NULL;
    if (count > 0 && !copy) return count;
    if (copy) memcpy(copy, plant, (size_t)count * sizeof *copy);
    pthread_mutex_lock(&slot->lock);
    free(slot->plant);
    slot->known = true, slot->i = i, slot->j = j, slot->count = count, slot->plant = copy;
    pthread_mutex_unlock(&slot->lock);
    return count;
}

/* ---- a frame ---------------------------------------------------------------------------------- */

typedef struct LowPlants {
    PlantList          list;
    int                squares, columns;
    int64_t            i0, j0;
    const ForestFrame *frame;
    Plant            **kept;   /* [squares] malloc'd */
    uint32_t         **number; /* [squares] */
    int               *count;  /* [squares] */
    bool              *lost;   /* [squares]: no memory */
    Plant             *plant;  /* all */
    uint32_t          *numbers;
} LowPlants;

/* Squares of a map of 1024 x 512 of them have numbers of their own. */
static uint32_t number_of(int64_t i, int64_t j, int k)
{
    return forest_low_bit | (uint32_t)((i & 0x3ff) << 21 | (j & 0x1ff) << 12 | (k & 0xfff));
}

/* How far the eye is above everything on a square, at least: above its highest post about the middle and its corners,
 * and room_m more for what rises between them and for the plants themselves. */
static double above_square_m(const ForestFrame *frame, const double corner_m[2])
{
    static const double room_m = 10;
    const Woods        *woods = frame->forest->woods;
    double              top_m = -INFINITY;
    if (!woods->landscape) return 0;
    for (int k = 0; k < 5; k++) {
        const double x_m = woods->origin_enu[0] + corner_m[0] + (k == 4 ? 0.5 : k % 2) * woods_low_m;
        const double y_m = woods->origin_enu[1] + corner_m[1] + (k == 4 ? 0.5 : k / 2) * woods_low_m;
        const double z_m = elevation_height(&woods->landscape->elevation, x_m, y_m, NULL);
        if (!isfinite(z_m)) return 0;
        top_m = fmax(top_m, z_m);
    }
    return fmax(0, frame->eye_enu[2] - top_m - room_m);
}

/* Those of a square that are kept: all within half the reach, none at it. */
static void fill_square(void *user, int worker, int square)
{
    LowPlants         *low = user;
    const ForestFrame *frame = low->frame;
    const Woods       *woods = frame->forest->woods;
    const int64_t      i = low->i0 + square % low->columns, j = low->j0 + square / low->columns;
    const double       corner_m[2] = {(double)i * woods_low_m, (double)j * woods_low_m};
    double             near2 = 0;
    (void)worker;
    for (int k = 0; k < 2; k++) {
        const double eye_m = frame->eye_enu[k] - woods->origin_enu[k];
        const double off_m = fmax(fmax(corner_m[k] - eye_m, eye_m - corner_m[k] - woods_low_m), 0);
        near2 += off_m * off_m;
    }
    const double above_m = above_square_m(frame, corner_m);
    if (near2 + above_m * above_m > frame->low_reach_m * frame->low_reach_m) return;
    Plant    *plant = malloc(woods_low_most * sizeof *plant);
    uint32_t *number = malloc(woods_low_most * sizeof *number);
    low->kept[square] = plant, low->number[square] = number;
    low->lost[square] = !plant || !number;
    if (low->lost[square]) return;
    const int found = plants_of(plant, frame->forest, i, j);
    int       kept = 0;
    for (int k = 0; k < found; k++) {
        Plant  p = plant[k];
        double away2 = 0;
        for (int c = 0; c < 3; c++) {
            if (c < 2) p.p_m[c] += (float)corner_m[c];
            const double off_m = (double)p.p_m[c] + woods->origin_enu[c] - frame->eye_enu[c];
            away2 += off_m * off_m;
        }
        const double share = sqrt(away2) / frame->low_reach_m;
        number[kept] = number_of(i, j, k);
        if (2 * (1 - share) > plant_rank(&p)) plant[kept++] = p;
    }
    low->count[square] = kept;
}

static Status gather(LowPlants *low, Arena *arena)
{
    size_t all = 0, at = 0;
    for (int s = 0; s < low->squares; s++) {
        if (low->lost[s]) return STATUS_NO_MEMORY;
        all += (size_t)low->count[s];
    }
    low->plant = arena_alloc(arena, all + 1, sizeof *low->plant);
    low->numbers = arena_alloc(arena, all + 1, sizeof *low->numbers);
    if (!low->plant || !low->numbers) return STATUS_NO_MEMORY;
    for (int s = 0; s < low->squares; s++) {
        if (low->count[s] == 0) continue;
        memcpy(low->plant + at, low->kept[s], (size_t)low->count[s] * sizeof *low->plant);
        memcpy(low->numbers + at, low->number[s], (size_t)low->count[s] * sizeof *low->numbers);
        at += (size_t)low->count[s];
    }
    low->list.plant = low->plant, low->list.number = low->numbers, low->list.count = (int)all;
    return STATUS_OK;
}

Status low_plants_open(ForestFrame *frame, double reach_m, Pool *pool, Arena *arena)
{
    const Woods *woods = frame->forest->woods;
    LowPlants   *low = arena_alloc(arena, 1, sizeof *low);
    double       from[2], end[2];
    if (!low) return STATUS_NO_MEMORY;
    *low = (LowPlants){.frame = frame, .list = {.forest = frame->forest, .frame = frame}};
    memcpy(low->list.origin_enu, woods->origin_enu, sizeof low->list.origin_enu);
    for (int k = 0; k < 2; k++) {
        const double eye_m = frame->eye_enu[k] - woods->origin_enu[k];
        from[k] = floor((eye_m - reach_m) / woods_low_m), end[k] = floor((eye_m + reach_m) / woods_low_m) + 1;
    }
    low->i0 = (int64_t)from[0], low->j0 = (int64_t)from[1];
    low->columns = (int)(end[0] - from[0]);
    low->squares = low->columns * (int)(end[1] - from[1]);
    const size_t n = (size_t)low->squares;
    low->kept = arena_alloc(arena, n, sizeof *low->kept);
    low->number = arena_alloc(arena, n, sizeof *low->number);
    low->count = arena_alloc(arena, n, sizeof *low->count);
    low->lost = arena_alloc(arena, n, sizeof *low->lost);
    if (!low->kept || !low->number || !low->count || !low->lost) return STATUS_NO_MEMORY;
    for (size_t s = 0; s < n; s++) low->kept[s] = NULL, low->number[s] = NULL, low->count[s] = 0, low->lost[s] = false;
    if (pool) pool_run(pool, low->squares, fill_square, low);
    else
        for (int s = 0; s < low->squares; s++) fill_square(low, 0, s);
    Status status = gather(low, arena);
    for (size_t s = 0; s < n; s++) free(low->kept[s]), free(low->number[s]);
    if (status == STATUS_OK) status = plant_list_commit(&low->list, frame->forest, true);
    if (status == STATUS_OK) frame->low = low;
    else plant_list_close(&low->list);
    return status;
}

void low_plants_close(ForestFrame *frame)
{
    LowPlants *low = frame->low;
    if (low) plant_list_close(&low->list);
    frame->low = NULL;
}

const PlantList *low_plants_list(const ForestFrame *frame)
{
    const LowPlants *low = frame->low;
    return low && low->list.count > 0 ? &low->list : NULL;
}
