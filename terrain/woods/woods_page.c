/* terrain/woods/woods_page.c: pages of the plants that are not in Woods.plant, each placed when it is asked for. */
#include "terrain/woods/woods_private.h"

#include <stdlib.h>

/* What pages follow from. */
typedef struct WoodsPages {
    WoodsSource *source; /* of the square of far_half_m, in whole pages */
    Cache       *cache;  /* NULL: pages are not kept */
    char         name[sha256_text_size];
} WoodsPages;

/* ---- where pages are ---------------------------------------------------------------------------- */

static double half_of(const WoodsConfig *config)
{
    return fmin(config->far_half_m, 0.5 * (woods_most_pages_side - 1) * woods_page_m - woods_square_m);
}

static int64_t page_before(int64_t square)
{
    return square >= 0 ? square / woods_page_squares : -((-square + woods_page_squares - 1) / woods_page_squares);
}

Status woods_pages_open(Woods *out, const WoodsConfig *config)
{
    if (!(config->far_half_m > config->half_width_m) || config->most_trees == 0) return STATUS_OK;
    WoodsPages *pages = calloc(1, sizeof *pages);
    Status      status = pages ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = woods_source_open(&pages->source, out->landscape, config, half_of(config));
    if (status != STATUS_OK) {
        free(pages);
        return status;
    }
    const WoodsSource *s = pages->source;
    const int64_t      i0 = page_before(s->i0), j0 = page_before(s->j0);
    out->pages_x = (int)(page_before(s->i0 + s->nx - 1) - i0 + 1);
    out->pages_y = (int)(page_before(s->j0 + s->ny - 1) - j0 + 1);
    out->pages_enu[0] = (double)i0 * woods_page_m, out->pages_enu[1] = (double)j0 * woods_page_m;
    if (config->cache && config->follows) {
        CacheKey     key = woods_key("pages of woods", config);
        const double half_m = config->far_half_m;
        cache_key_add(&key, &half_m, sizeof half_m);
        if (sha256_end(pages->name, key.digest, key.good) == STATUS_OK) pages->cache = config->cache;
    }
    out->far = pages;
    return STATUS_OK;
}

void woods_pages_close(Woods *woods)
{
    WoodsPages *pages = woods->far;
    if (!pages) return;
    woods_source_free(pages->source);
    free(pages);
}

static void corner_of(double p_m[2], const Woods *woods, int page)
{
    p_m[0] = woods->pages_enu[0] + page % woods->pages_x * woods_page_m;
    p_m[1] = woods->pages_enu[1] + page / woods->pages_x * woods_page_m;
}

int woods_page_at(const Woods *woods, double x_m, double y_m)
{
    const double i = floor((x_m - woods->pages_enu[0]) / woods_page_m),
                 j = floor((y_m - woods->pages_enu[1]) / woods_page_m);
    if (!(i >= 0 && j >= 0 && i < woods->pages_x && j < woods->pages_y)) return -1;
    return (int)j * woods->pages_x + (int)i;
}

/* The ground's posts are looked at every 32 m; what rises by more between two of them is not in the page. */
bool woods_page_span(double *low_m, double *high_m, const Woods *woods, int page)
{
    enum { looks = 33 };
    static const double room_m = 8;
    const Elevation    *elevation = &woods->landscape->elevation;
    double              corner[2], low = INFINITY, high = -INFINITY;
    corner_of(corner, woods, page);
    for (int k = 0; k < looks * looks; k++) {
        const double step_m = woods_page_m / (looks - 1);
        const double z_m =
            elevation_height(elevation, corner[0] + k % looks * step_m, corner[1] + k / looks * step_m, NULL);
        if (!isfinite(z_m)) continue;
        low = fmin(low, z_m), high = fmax(high, z_m);
    }
    *low_m = low - 2 * room_m, *high_m = high + room_m + woods_page_tall_m;
    return low <= high;
}

/* ---- a page's plants ------------------------------------------------------------------------------ */

/* Bits of two numbers of 8 bits in turns: places whose codes are near are near each other (Morton, 1966). */
static uint32_t code_of(const Plant *p)
{
    const uint32_t x = (uint32_t)clamp((double)p->p_m[0] / woods_cell_m, 0, 255),
                   y = (uint32_t)clamp((double)p->p_m[1] / woods_cell_m, 0, 255);
    uint32_t code = 0;
    for (int k = 0; k < 8; k++) code |= (x >> k & 1) << 2 * k | (y >> k & 1) << (2 * k + 1);
    return code;
}

/* Sorts by code; those of one cell keep their order. */
static Status sort_by_place(Plant *plant, int count)
{
    enum { codes = 1 << 16 };
    uint32_t *first = calloc(codes + 1, sizeof *first);
    Plant    *sorted = malloc(((size_t)count + 1) * sizeof *sorted);
    if (!first || !sorted) {
        free(first), free(sorted);
        return STATUS_NO_MEMORY;
    }
    for (int k = 0; k < count; k++) first[code_of(&plant[k]) + 1]++;
    for (int c = 0; c < codes; c++) first[c + 1] += first[c];
    for (int k = 0; k < count; k++) sorted[first[code_of(&plant[k])]++] = plant[k];
    if (count > 0) memcpy(plant, sorted, (size_t)count * sizeof *plant);
    free(first), free(sorted);
    return STATUS_OK;
}

/* Leaves out what the page's box has no room for, and what its numbers do not reach. */
static void keep_within(SquarePlants *all, double high_m)
{
    int kept = 0;
    for (int k = 0; k < all->count && kept < woods_page_most; k++)
        if ((double)all->plant[k].p_m[2] + plant_height_m(&all->plant[k]) <= high_m) all->plant[kept++] = all->plant[k];
    all->count = kept;
}

static Status place(WoodsPage *out, const Woods *woods, double high_m)
{
    const WoodsPages *pages = woods->far;
    WoodsSource       s = *pages->source; /* with another origin; what it points to is only read */
    SquarePlants      all = {0};
    const int64_t i0 = llrint(out->origin_enu[0] / woods_square_m), j0 = llrint(out->origin_enu[1] / woods_square_m);
    memcpy(s.origin_enu, out->origin_enu, sizeof s.origin_enu);
    for (int k = 0; k < woods_page_squares * woods_page_squares; k++) {
        const int64_t i = i0 + k % woods_page_squares, j = j0 + k / woods_page_squares;
        if (i < s.i0 || j < s.j0 || i >= s.i0 + s.nx || j >= s.j0 + s.ny) continue;
        if (woods_is_planted(woods, ((double)i + 0.5) * woods_square_m, ((double)j + 0.5) * woods_square_m)) continue;
        woods_fill_square(&all, &s, (int)(i - s.i0), (int)(j - s.j0));
    }
    keep_within(&all, high_m - out->origin_enu[2]);
    const Status status = all.lost ? STATUS_NO_MEMORY : sort_by_place(all.plant, all.count);
    if (status != STATUS_OK || all.count == 0) {
        free(all.plant);
        return status;
    }
    Plant *fitting = realloc(all.plant, (size_t)all.count * sizeof *fitting);
    out->plant = fitting ? fitting : all.plant, out->count = all.count;
    return STATUS_OK;
}

/* Octets of a page are its plants: their number is the length's. */
static bool from_octets(WoodsPage *out, void *octets, size_t count, double high_m)
{
    Plant       *plant = octets;
    const size_t plants = count / sizeof *plant;
    if (count % sizeof *plant != 0 || plants > woods_page_most) return false;
    for (size_t k = 0; k < plants; k++) {
        const Plant *p = &plant[k];
        if (!woods_is_plant(p) || !(p->p_m[0] >= 0 && p->p_m[1] >= 0) || (double)p->p_m[0] > woods_page_m ||
            (double)p->p_m[1] > woods_page_m || (double)p->p_m[2] + plant_height_m(p) > high_m - out->origin_enu[2])
            return false;
    }
    out->plant = plants > 0 ? plant : NULL, out->count = (int)plants;
    if (plants == 0) free(octets);
    return true;
}

Status woods_page(WoodsPage *out, const Woods *woods, int page)
{
    const WoodsPages *pages = woods->far;
    double            corner[2], low_m, high_m;
    void             *octets;
    size_t            count;
    corner_of(corner, woods, page);
    *out = (WoodsPage){.origin_enu = {corner[0], corner[1], 0}};
    if (!woods_page_span(&low_m, &high_m, woods, page)) return STATUS_OK;
    out->origin_enu[2] = rint(0.5 * (low_m + high_m));
    if (!pages->cache) return place(out, woods, high_m);
    CacheKey      key = cache_key("page of woods");
    const int32_t number = page;
    cache_key_add(&key, pages->name, sizeof pages->name);
    cache_key_add(&key, &number, sizeof number);
    if (cache_fetch(&octets, &count, pages->cache, &key)) {
        if (from_octets(out, octets, count, high_m)) return STATUS_OK;
        free(octets);
    }
    const Status status = place(out, woods, high_m);
    if (status == STATUS_OK)
        cache_keep(pages->cache, &key, out->plant ? (const void *)out->plant : "",
                   (size_t)out->count * sizeof *out->plant);
    return status;
}

void woods_page_free(WoodsPage *page)
{
    free(page->plant);
    page->plant = NULL, page->count = 0;
}
