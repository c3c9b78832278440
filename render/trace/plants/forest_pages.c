/* render/trace/plants/forest_pages.c: the plants of pages (woods_page): made when a ray needs them, freed when no open
 * frame does. */
#include "render/trace/plants/forest_private.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>

enum { span_unknown, span_none, span_known };

typedef struct ForestPage {
    pthread_mutex_t lock; /* of making and freeing */
    uint64_t        used; /* atomic: serial of the latest frame that needed it; set before made is read */
    int             made; /* atomic */
    int             span; /* under the lock of all, as what follows */
    double          low_m, high_m;
    int             seen;          /* atomic: it was made before, and what follows is known for good */
    double          box_enu[2][3]; /* of its plants; lowest above highest: it has none */
    WoodsPage       woods;
    PlantList       list;
} ForestPage;

struct ForestPages {
    int             count;
    ForestPage     *page; /* [count] */
    pthread_mutex_t lock;
    uint64_t        serial;      /* of the newest frame */
    PagesInReach   *open;        /* frames that are open */
    int64_t         octets;      /* atomic: plants and Embree's trees */
    uint64_t        made, freed; /* atomic */
    int             lost;        /* atomic: there was no memory for a page */
};

/* ---- all pages ---------------------------------------------------------------------------------- */

static bool count_octets(void *user, ssize_t octets, bool post)
{
    ForestPages *pages = user;
    (void)post;
    __atomic_fetch_add(&pages->octets, (int64_t)octets, __ATOMIC_RELAXED);
    return true;
}

Status forest_pages_create(Forest *forest, const char *isa)
{
    char         settings[96] = "threads=1,start_threads=0,set_affinity=0"; /* pages are built side by side */
    const Woods *woods = forest->woods;
    if (woods->pages_x <= 0 || woods->pages_y <= 0 || !(forest->config.far_m > 0)) return STATUS_OK;
    ForestPages *pages = calloc(1, sizeof *pages);
    if (!pages) return STATUS_NO_MEMORY;
    pages->count = woods->pages_x * woods->pages_y;
    pages->page = calloc((size_t)pages->count, sizeof *pages->page);
    if (isa && *isa && strlen(isa) < 16) strcat(strcat(settings, ",isa="), isa);
    forest->page_device = pages->page ? rtcNewDevice(settings) : NULL;
    if (!forest->page_device) {
        free(pages->page), free(pages);
        return STATUS_NO_MEMORY;
    }
    rtcSetDeviceErrorFunction(forest->page_device, forest_latch_error, forest);
    rtcSetDeviceMemoryMonitorFunction(forest->page_device, count_octets, pages);
    pthread_mutex_init(&pages->lock, NULL);
    for (int k = 0; k < pages->count; k++) pthread_mutex_init(&pages->page[k].lock, NULL);
    forest->pages = pages;
    return STATUS_OK;
}

static void free_page(ForestPages *pages, ForestPage *page)
{
    plant_list_close(&page->list);
    __atomic_fetch_sub(&pages->octets, (int64_t)page->woods.count * (int64_t)sizeof(Plant), __ATOMIC_RELAXED);
    woods_page_free(&page->woods);
    __atomic_store_n(&page->made, 0, __ATOMIC_RELEASE);
}

void forest_pages_destroy(Forest *forest)
{
    ForestPages *pages = forest->pages;
    if (!pages) return;
    if (pages->made > 0)
        log_detail("woods: pages made %" PRIu64 " times, freed %" PRIu64 " times; %.1f MB at the end", pages->made,
                   pages->freed, 1e-6 * (double)pages->octets);
    for (int k = 0; k < pages->count; k++) {
        if (pages->page[k].made) free_page(pages, &pages->page[k]);
        pthread_mutex_destroy(&pages->page[k].lock);
    }
    rtcReleaseDevice(forest->page_device);
    pthread_mutex_destroy(&pages->lock);
    free(pages->page);
    free(pages);
}

ForestPagesUse forest_pages_use(const Forest *forest)
{
    const ForestPages *p = forest->pages;
    if (!p) return (ForestPagesUse){0};
    return (ForestPagesUse){(size_t)__atomic_load_n(&p->octets, __ATOMIC_RELAXED),
                            __atomic_load_n(&p->made, __ATOMIC_RELAXED), __atomic_load_n(&p->freed, __ATOMIC_RELAXED)};
}

/* ---- one page ----------------------------------------------------------------------------------- */

/* The box of its plants; whatever is freed, it stays. */
static void keep_box(ForestPage *page)
{
    struct RTCBounds b = {.lower_x = INFINITY, .upper_x = -INFINITY};
    if (page->seen) return;
    if (page->list.scene) rtcGetSceneBounds(page->list.scene, &b);
    const float low[3] = {b.lower_x, b.lower_y, b.lower_z}, high[3] = {b.upper_x, b.upper_y, b.upper_z};
    for (int c = 0; c < 3; c++) {
        page->box_enu[0][c] = page->list.origin_enu[c] + (double)low[c];
        page->box_enu[1][c] = page->list.origin_enu[c] + (double)high[c];
    }
    __atomic_store_n(&page->seen, 1, __ATOMIC_RELEASE);
}

static bool make(Forest *forest, ForestPage *page, int number)
{
    enum { neighbours = 4 }; /* to a box: a quarter of Embree's memory and of the time to build it */
    ForestPages *pages = forest->pages;
    Status       status = woods_page(&page->woods, forest->woods, number);
    __atomic_fetch_add(&pages->octets, (int64_t)page->woods.count * (int64_t)sizeof(Plant), __ATOMIC_RELAXED);
    page->list = (PlantList){.forest = forest,
                             .plant = page->woods.plant,
                             .base = woods_page_number(number),
                             .count = page->woods.count,
                             .per_box = neighbours,
                             .far = true};
    memcpy(page->list.origin_enu, page->woods.origin_enu, sizeof page->list.origin_enu);
    if (status == STATUS_OK) status = plant_list_commit(&page->list, forest, true);
    if (status != STATUS_OK) {
        free_page(pages, page);
        return false;
    }
    keep_box(page);
    __atomic_fetch_add(&pages->made, 1, __ATOMIC_RELAXED);
    __atomic_store_n(&page->made, 1, __ATOMIC_RELEASE);
    return true;
}

/* The page, made if need be; it stays until every frame of this serial or an earlier one is closed. */
static const ForestPage *need(Forest *forest, int number, uint64_t serial)
{
    ForestPages *pages = forest->pages;
    ForestPage  *page = &pages->page[number];
    if (__atomic_load_n(&page->used, __ATOMIC_ACQUIRE) >= serial && __atomic_load_n(&page->made, __ATOMIC_ACQUIRE))
        return page;
    pthread_mutex_lock(&page->lock);
    if (page->used < serial) __atomic_store_n(&page->used, serial, __ATOMIC_RELEASE);
    const bool there = page->made || make(forest, page, number);
    pthread_mutex_unlock(&page->lock);
    if (there) return page;
    if (!__atomic_exchange_n(&pages->lost, 1, __ATOMIC_SEQ_CST))
        log_error("forest: no memory for a page of plants; terrain.woods_far_m: less");
    return NULL;
}

const PlantList *far_page_need(const PagesInReach *in_reach, int page)
{
    const ForestPage *p = need(in_reach->forest, page, in_reach->serial);
    return p ? &p->list : NULL;
}

Status forest_page_plants(const WoodsPage **out, const Forest *forest, int page)
{
    static const WoodsPage none = {.count = 0};
    ForestPages           *pages = forest->pages;
    *out = &none;
    if (!pages || page < 0 || page >= pages->count) return STATUS_OK;
    const uint64_t    serial = __atomic_load_n(&pages->serial, __ATOMIC_ACQUIRE);
    const ForestPage *p = need((Forest *)forest, page, serial); /* pages alone change */
    if (p) *out = &p->woods;
    return p ? STATUS_OK : STATUS_NO_MEMORY;
}

const PlantList *forest_list_of(const ForestFrame *frame, const ForestHit *hit)
{
    if (hit->plant & forest_low_bit) return low_plants_list(frame);
    const int page = woods_page_of(hit->plant);
    return page >= 0 ? &frame->forest->pages->page[page].list : &frame->forest->standing;
}

/* ---- freeing ------------------------------------------------------------------------------------ */

static uint64_t oldest_open(const ForestPages *pages)
{
    uint64_t oldest = UINT64_MAX;
    for (const PagesInReach *r = pages->open; r; r = r->next) oldest = r->serial < oldest ? r->serial : oldest;
    return oldest;
}

/* Frees the least recently used until what is left takes no more than far_mb, or every page is in use. */
static void free_unused(Forest *forest)
{
    ForestPages  *pages = forest->pages;
    const int64_t most = (int64_t)(1e6 * forest->config.far_mb);
    while (__atomic_load_n(&pages->octets, __ATOMIC_RELAXED) > most) {
        uint64_t    least = oldest_open(pages);
        ForestPage *of = NULL;
        for (int k = 0; k < pages->count; k++) {
            ForestPage    *p = &pages->page[k];
            const uint64_t used = __atomic_load_n(&p->used, __ATOMIC_ACQUIRE);
            if (__atomic_load_n(&p->made, __ATOMIC_ACQUIRE) && used < least) least = used, of = p;
        }
        if (!of) return;
        pthread_mutex_lock(&of->lock);
        const bool idle = of->made && of->used == least; /* no other call has asked for it since */
        if (idle) free_page(pages, of);
        pthread_mutex_unlock(&of->lock);
        if (idle) __atomic_fetch_add(&pages->freed, 1, __ATOMIC_RELAXED);
    }
}

/* ---- frames ------------------------------------------------------------------------------------- */

/* How far from the eye, in far_m, a plant of this number stands at most. */
static double reach_of(uint32_t number)
{
    uint32_t h = number * 0x9e3779b1u;
    h = (h ^ h >> 15) * 0x85ebca77u, h = (h ^ h >> 13) * 0xc2b2ae3du;
    return forest_far_full + (1 - forest_far_full) * ((double)(h ^ h >> 16) * 0x1p-32);
}

bool far_page_lacks(const ForestFrame *frame, const PlantList *list, uint32_t place)
{
    const Plant *plant = &list->plant[place];
    const double far_m = frame->forest->config.far_m, full_m = forest_far_full * far_m;
    const double x = list->origin_enu[0] + (double)plant->p_m[0] - frame->eye_enu[0],
                 y = list->origin_enu[1] + (double)plant->p_m[1] - frame->eye_enu[1], square = x * x + y * y;
    if (square <= full_m * full_m) return false;
    const double reach_m = far_m * reach_of(plant_number(list, place));
    return square > reach_m * reach_m;
}

double forest_far_share(const ForestFrame *frame, double x_m, double y_m)
{
    const PagesInReach *r = frame->far;
    if (!r || woods_page_at(r->forest->woods, x_m, y_m) < 0) return 0;
    const double away = hypot(x_m - frame->eye_enu[0], y_m - frame->eye_enu[1]) / r->forest->config.far_m;
    return clamp((1 - away) / (1 - forest_far_full), 0, 1);
}

static void bounds_of_page(const struct RTCBoundsFunctionArguments *a)
{
    static const double room_m = 5; /* of bent rays' pieces */
    const PagesInReach *r = a->geometryUserPtr;
    const PageInReach  *page = &r->page[a->primID];
    float              *low = &a->bounds_o->lower_x, *high = &a->bounds_o->upper_x;
    for (int c = 0; c < 3; c++) {
        low[c] = (float)(page->low_enu[c] - r->origin_enu[c] - room_m);
        high[c] = (float)(page->high_enu[c] - r->origin_enu[c] + room_m);
    }
}

static Status commit(PagesInReach *r)
{
    static const BoxCalls calls = {bounds_of_page, page_intersect, page_occlude};
    if (r->count == 0) return STATUS_OK;
    r->scene = forest_boxes(r->forest->page_device, r->count, &calls, r);
    if (!r->scene) return STATUS_NO_MEMORY;
    rtcCommitScene(r->scene);
    return forest_status(r->forest);
}

/* Distance on the map from the eye to the nearest place of a page. */
static double away_m(const Woods *woods, const double eye_enu[3], int page)
{
    const double at[2] = {page % woods->pages_x, page / woods->pages_x};
    double       off[2];
    for (int c = 0; c < 2; c++) {
        const double low = woods->pages_enu[c] + at[c] * woods_page_m - eye_enu[c];
        off[c] = fmax(fmax(low, -low - woods_page_m), 0);
    }
    return hypot(off[0], off[1]);
}

static void find_span(void *user, int worker, int k)
{
    const PagesInReach *r = user;
    ForestPage         *p = &r->forest->pages->page[r->page[k].page];
    (void)worker;
    if (p->span == span_unknown)
        p->span = woods_page_span(&p->low_m, &p->high_m, r->forest->woods, r->page[k].page) ? span_known : span_none;
}

/* Where its plants are, or can be. False: it has none. */
static bool find_box(PageInReach *out, const Forest *forest)
{
    static const double crown_m = 16;
    const ForestPage   *page = &forest->pages->page[out->page];
    const Woods        *woods = forest->woods;
    const double        room_m = crown_m + (forest->config.sway > 0 ? 1.1 * most_sway_rad * woods_page_tall_m : 0);
    const double        at[2] = {out->page % woods->pages_x, out->page / woods->pages_x};
    if (__atomic_load_n(&page->seen, __ATOMIC_ACQUIRE)) {
        memcpy(out->low_enu, page->box_enu[0], sizeof out->low_enu);
        memcpy(out->high_enu, page->box_enu[1], sizeof out->high_enu);
        return out->low_enu[0] <= out->high_enu[0];
    }
    for (int c = 0; c < 2; c++) {
        out->low_enu[c] = woods->pages_enu[c] + at[c] * woods_page_m - room_m;
        out->high_enu[c] = out->low_enu[c] + woods_page_m + 2 * room_m;
    }
    out->low_enu[2] = page->low_m - room_m, out->high_enu[2] = page->high_m + room_m;
    return page->span == span_known;
}

/* Under the lock of all. */
static Status find_reach(PagesInReach *r, const ForestFrame *frame, Pool *pool)
{
    const ForestPages *pages = r->forest->pages;
    int                kept = 0;
    r->page = malloc((size_t)pages->count * sizeof *r->page);
    if (!r->page) return STATUS_NO_MEMORY;
    for (int k = 0; k < pages->count; k++)
        if (away_m(r->forest->woods, frame->eye_enu, k) < r->forest->config.far_m) r->page[r->count++].page = k;
    if (pool) pool_run(pool, r->count, find_span, r);
    else
        for (int k = 0; k < r->count; k++) find_span(r, 0, k);
    for (int k = 0; k < r->count; k++)
        if (find_box(&r->page[k], r->forest)) r->page[kept++] = r->page[k];
    r->count = kept;
    return STATUS_OK;
}

static void close_reach(PagesInReach *r)
{
    if (r->scene) rtcReleaseScene(r->scene);
    free(r->page);
    free(r);
}

Status far_pages_open(ForestFrame *frame, Pool *pool)
{
    Forest      *forest = (Forest *)frame->forest; /* pages alone change */
    ForestPages *pages = forest->pages;
    if (!pages) return STATUS_OK;
    if (__atomic_load_n(&pages->lost, __ATOMIC_SEQ_CST)) return STATUS_NO_MEMORY;
    PagesInReach *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    r->forest = forest;
    memcpy(r->origin_enu, frame->eye_enu, sizeof r->origin_enu);
    pthread_mutex_lock(&pages->lock);
    r->serial = pages->serial + 1;
    __atomic_store_n(&pages->serial, r->serial, __ATOMIC_RELEASE);
    Status status = find_reach(r, frame, pool);
    r->next = pages->open, pages->open = r;
    pthread_mutex_unlock(&pages->lock);
    frame->far = r;
    if (status == STATUS_OK) status = commit(r);
    if (status != STATUS_OK) far_pages_close(frame);
    return status;
}

void far_pages_close(ForestFrame *frame)
{
    PagesInReach *r = frame->far;
    frame->far = NULL;
    if (!r) return;
    ForestPages *pages = r->forest->pages;
    pthread_mutex_lock(&pages->lock);
    for (PagesInReach **at = &pages->open; *at; at = &(*at)->next)
        if (*at == r) {
            *at = r->next;
            break;
        }
    free_unused(r->forest);
    pthread_mutex_unlock(&pages->lock);
    close_reach(r);
}
