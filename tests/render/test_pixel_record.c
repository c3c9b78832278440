/* The record of a pixel: its terms, added up in the order of the program, are the planes' values to the bit, whatever
 * the passes did to it; and the picture is the same with and without it. labels: slow */
#include "tests/render/hand_plants.h"
#include "tests/render/strewn_world.h"
#include "render/frame/pixel_record.h"

enum { width = 72, height = 48, pixels = width * height, trees = 1500 };

static Plant       plant[trees];
static Woods       woods;
static EffectTable effects;
static EffectPuff  puff;

static int open_all(void **state)
{
    static const double zero[3] = {0, 0, 0};
    char                path[4096];
    if (open_world(state) != 0 || !etc_path(path, sizeof path, "effects.csv")) return -1;
    if (effect_table_open(&effects, path) != STATUS_OK) return -1;
    woods = hand_stand(plant, trees, zero, 60);
    for (int i = 0; i < trees; i++)
        plant[i].p_m[2] = (float)ground_at((double)plant[i].p_m[0], (double)plant[i].p_m[1]);
    return world_plant(&hand.world, &woods, &(ForestConfig){.leaves = true}, "avx2", hand.pool) == STATUS_OK ? 0 : -1;
}

/* Things before a wood, some of them behind smoke. */
static RenderRequest smoky_request(void)
{
    View   view = strew(30, width, height);
    double p_enu[3] = {-200, 3, ground_at(-200, 3) + 2};
    puff = (EffectPuff){.kind = EFFECT_SMOKE, .age_s = 6, .throw_s = 1, .scale = 2, .mass_kg = 3};
    ecef_from_enu(puff.p_ecef, &hand.world.frame, p_enu);
    for (int i = 0; i < 3; i++) puff.up_ecef[i] = puff.axis_ecef[i] = hand.world.frame.r_ecef_from_enu[3 * i + 2];
    hand.snapshot.puff = &puff, hand.snapshot.puff_count = 1, hand.snapshot.effect_table = &effects;
    RenderRequest request = request_of(&view);
    request.profile_bins = 0, request.optical = OPTICAL_RGB;
    return request;
}

/* What the recorded pixels had between them. */
typedef struct Met {
    int pixels, kinds[PIXEL_TARGET + 1], surfaces[hit_plant + 1], smoky, split, refined, colours;
} Met;

static void count(Met *met, const PixelRecord *r)
{
    for (int k = 0; k < r->steps; k++) {
        met->kinds[r->step[k].kind]++;
        met->split += r->step[k].several, met->refined += r->step[k].n > 1;
    }
    for (int i = 0; i < r->samples; i++) {
        met->surfaces[r->sample[i].kind]++;
        for (int b = 0; b < AIR_BAND_COUNT; b++) met->smoky += r->sample[i].light[b].smoky;
    }
}

/* Records a pixel; every plane must be what it is without, and its value the sum of its terms. */
static void record(Met *met, RenderRequest request, const Picture *plain, int x, int y)
{
    PixelRecord  record[pixel_records];
    const size_t px = picture_index(plain, x, y);
    for (int k = 0; k < pixel_records; k++) pixel_record_open(&record[k], x, y);
    request.record = record;
    arena_reset(hand.arena);
    const Picture picture = hand_render(&request, hand.pool);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = picture_plane(&picture, plane);
        if (!value) continue;
        const int  colour = plane == picture_optical && record[1].steps ? 1 : plane == picture_optical + 2 ? 2 : 0;
        const bool own = colour && record[colour].steps > 0;
        const PixelRecord *r = own ? &record[colour] : &record[0];
        const int          of = own ? picture_optical : plane;
        const float        sum = pixel_record_value(NULL, NULL, r, of, r->steps);
        CHECK((value[px] != 0 || plane == picture_radar) && memcmp(&sum, &value[px], sizeof sum) == 0);
        assert_memory_equal(value, picture_plane(plain, plane), pixels * sizeof *value);
        /* the twin: another term, another sum */
        for (int i = 0; i < r->samples && plane == picture_lwir; i++) r->sample[i].light[AIR_LWIR].path *= 1.0001f;
        const float other = pixel_record_value(NULL, NULL, r, of, r->steps);
        CHECK(plane != picture_lwir || other != sum || r->samples == 0);
    }
    met->pixels++;
    met->colours += record[1].steps > 0 && record[2].steps > 0;
    for (int k = 0; k < pixel_records; k++) {
        CHECK(!record[k].lost && (record[k].samples > 0) == (record[k].steps > 0));
        count(met, &record[k]);
        pixel_record_close(&record[k]);
    }
}

/* The picture in memory of its own: the arena is that of the next. */
static Picture kept(const RenderRequest *request)
{
    static float    plane[picture_plane_count][pixels], covered[pixels];
    static uint32_t entity[pixels], instance[pixels];
    arena_reset(hand.arena);
    Picture p = hand_render(request, hand.pool);
    float **planes[] = {&p.optical[0], &p.optical[1], &p.optical[2], &p.mwir, &p.lwir, &p.radar};
    for (int k = 0; k < picture_plane_count; k++)
        if (*planes[k]) *planes[k] = memcpy(plane[k], *planes[k], sizeof plane[k]);
    p.covered = p.covered ? memcpy(covered, p.covered, sizeof covered) : NULL;
    p.entity = memcpy(entity, p.entity, sizeof entity);
    p.instance = memcpy(instance, p.instance, sizeof instance);
    return p;
}

/* Every `step`-th pixel, and of those with targets or plants every `shown_step`-th. */
static Met record_some(const RenderRequest *request, int step, int shown_step)
{
    Met           met = {0};
    const Picture plain = kept(request);
    for (int i = 0, shown = 0; i < pixels; i++) {
        const bool more = plain.entity[i] || (plain.covered && plain.covered[i] > 0);
        shown += more;
        if (i % step == 0 || (more && shown % shown_step == 0)) record(&met, *request, &plain, i % width, i / width);
    }
    return met;
}

static void terms_are_the_pixel(void **state)
{
    (void)state;
    const RenderRequest request = smoky_request();
    const Met           met = record_some(&request, 79, 12);
    print_message(
        "%d pixels; means %d (%d split, %d refined), smoothed %d, small targets %d and what hides them %d; rays "
        "to the sky %d, ground %d, parts %d, plants %d; %d behind smoke\n",
        met.pixels, met.kinds[PIXEL_MEAN], met.split, met.refined, met.kinds[PIXEL_SMOOTHED], met.kinds[PIXEL_TARGET],
        met.kinds[PIXEL_BEFORE], met.surfaces[hit_sky], met.surfaces[hit_ground], met.surfaces[hit_part],
        met.surfaces[hit_plant], met.smoky);
    CHECK(met.pixels > 40 && met.split > 0 && met.refined > 0 && met.smoky > 0);
    for (int k = 0; k <= PIXEL_TARGET; k++) CHECK(met.kinds[k] > 0);
    for (int k = 0; k <= hit_plant; k++) CHECK(met.surfaces[k] > 0);
}

/* Light from all round, two rays a side; and lateral colour: R and B of other rays. */
static void in_every_mode(void **state)
{
    (void)state;
    RenderRequest request = smoky_request();
    request.sky_samples = 4, request.samples = 2;
    Met met = record_some(&request, 997, 32);
    CHECK(met.refined > 0 && met.kinds[PIXEL_TARGET] > 0 && met.colours == 0);
    request = smoky_request();
    request.sky_visibility = true;
    request.lateral[0] = 0.002, request.lateral[1] = -0.002;
    met = record_some(&request, 997, 32);
    CHECK(met.colours == met.pixels && met.kinds[PIXEL_TARGET] > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(terms_are_the_pixel),
        cmocka_unit_test(in_every_mode),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_all, hand_close);
}
