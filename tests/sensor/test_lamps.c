/* Lamps by night against closed forms: a street lamp of known flux and height over level ground, below it and to its
 * side; panes as discs on their axis; headlamps' flux; what shines itself; the radiance of ground of known reflectance;
 * hours; and none by day. */
#include "tests/check.h"

#include "entities/scenery/scenery_buildings.h"
#include "entities/shapes/parametric.h"
#include "render/light/lamps.h"

#include <stdio.h>
#include <stdlib.h>

static const double lat_rad = 0.82, ground_m = 100;

static struct {
    Culture        culture;
    Scenery        scenery;
    SceneryTracer *tracer;
    SceneryFrame  *frame;
    Materials      materials;
    LampTypes      types;
    Arena         *arena;
} stage;

/* Towards the sun at a solar hour, of declination 0. */
static void sun_at_hour(double d[3], double hour)
{
    const double angle = (hour - 12) * pi_rad / 12;
    d[0] = -sin(angle), d[1] = -cos(angle) * sin(lat_rad), d[2] = cos(angle) * cos(lat_rad);
}

/* A house, a street lamp 200 m east of it, and a car that drives along the north 400 m east of it. */
static int open_stage(void **state)
{
    (void)state;
    static const double outline_m[4][2] = {{0, 0}, {12, 0}, {12, 8}, {0, 8}};
    static const double path_m[2][3] = {{400, -500, 100}, {400, 500, 100}};
    char                path[512], surfaces[512], lamps[512];
    const Building      house = {.id = 7,
                                 .base_m = (float)ground_m,
                                 .eaves_m = 5.5F,
                                 .ridge_m = 9,
                                 .use = BUILDING_HOUSE,
                                 .roof = ROOF_GABLED,
                                 .wall_fabric = FABRIC_BRICK,
                                 .roof_fabric = FABRIC_TILE,
                                 .levels = 2,
                                 .heated = true};
    const CulturePoint  post = {
         .id = 9, .x_m = 200, .y_m = 0, .base_m = (float)ground_m, .size_m = {0.2F, 0.2F, 8}, .kind = CULTURE_LAMP};
    Scenery *s = &stage.scenery;
    stage.arena = arena_create();
    if (culture_add_building(&stage.culture, &house, outline_m, 4) != STATUS_OK ||
        culture_add_point(&stage.culture, &post) != STATUS_OK || culture_index(&stage.culture) != STATUS_OK ||
        scenery_add_buildings(s, &stage.culture, NULL, NULL) != STATUS_OK)
        return -1;
    s->model = realloc(s->model, (size_t)(s->models + 1) * sizeof *s->model);
    s->object = realloc(s->object, (size_t)(s->objects + 1) * sizeof *s->object);
    s->part_first = realloc(s->part_first, (size_t)(s->models + 1) * sizeof *s->part_first);
    s->mover = calloc(1, sizeof *s->mover), s->path_enu = calloc(2, sizeof *s->path_enu);
    s->part_first[s->models] = -1;
    if (parametric_build(&s->model[s->models], "car", 0.01) != STATUS_OK) return -1;
    s->object[s->objects] = (SceneryObject){.id = 3, .kind = SCENERY_CLUTTER, .class = CLUTTER_CAR, .model = s->models};
    memcpy(s->path_enu, path_m, sizeof path_m);
    s->mover[0] = (SceneryMover){.object = s->objects, .count = 2, .speed_mps = 10, .phase_m = 500};
    s->models++, s->objects++, s->movers = 1, s->paths = 2;
    return etc_path(path, sizeof path, "materials.csv") && etc_path(surfaces, sizeof surfaces, "surfaces.csv") &&
                   etc_path(lamps, sizeof lamps, "lamps.csv") &&
                   materials_open(&stage.materials, path, surfaces, NULL) == STATUS_OK &&
                   lamp_types_read(&stage.types, lamps) == STATUS_OK && scenery_add_lamps(s, 5) == STATUS_OK &&
                   scenery_tracer_create(&stage.tracer, s, "avx2") == STATUS_OK &&
                   scenery_frame_create(&stage.frame, stage.tracer, &(SceneryFrameOf){0}, stage.arena) == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    scenery_tracer_destroy(stage.tracer);
    materials_close(&stage.materials);
    scenery_free(&stage.scenery);
    culture_free(&stage.culture);
    arena_destroy(stage.arena);
    return 0;
}

static LampLight *at_hour(double hour)
{
    LampLight *light;
    double     sun[3];
    sun_at_hour(sun, hour);
    assert_int_equal(lamp_light_create(&light, &stage.types, stage.frame, sun, lat_rad, stage.arena), STATUS_OK);
    return light;
}

static const SceneryLamp *lamp_of_kind(SceneryLampKind kind)
{
    for (int k = 0; k < stage.scenery.lamps; k++)
        if (stage.scenery.lamp[k].kind == kind) return &stage.scenery.lamp[k];
    return NULL;
}

/* A diffuse plane of flux F that faces down from h: F / (pi h^2) cos^4 on level ground, to 2 % to 2 h beside it. */
static void a_street_lamp_lights_the_ground(void **state)
{
    (void)state;
    const LampLight   *light = at_hour(23);
    const SceneryLamp *l = lamp_of_kind(LAMP_STREET);
    const double       up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
    double             worst = 0;
    CHECK(l && light);
    const LampType *type = lamp_type_of(&stage.types, l);
    const double    high_m = l->p[2] - ground_m;
    CHECK(fabs(high_m - 7.86) < 0.02 && fabs(l->p[1] - 1.2) < 0.02 && fabs((double)l->area_m2 - 0.6 * 0.24) < 1e-3);
    for (double beside_m = 0; beside_m < 2 * high_m; beside_m += 0.7) {
        const double p[3] = {l->p[0] + 0.6 * beside_m, l->p[1] - 0.8 * beside_m, ground_m};
        const double c2 = high_m * high_m / (high_m * high_m + beside_m * beside_m);
        const double lux = type->flux_lm / (pi_rad * high_m * high_m) * c2 * c2;
        worst = fmax(worst, fabs(lamp_light_lux(light, p, up) / lux - 1));
        CHECK(lamp_light_lux(light, p, down) == 0);
    }
    print_message("street lamp of %.0f lm at %.2f m: within %.2f %%\n", type->flux_lm, high_m, 100 * worst);
    CHECK(worst < 0.02);
    const double above[3] = {l->p[0], l->p[1], l->p[2] + 2}, far[3] = {l->p[0] + 81, l->p[1], ground_m};
    CHECK(lamp_light_lux(light, above, down) == 0 && lamp_light_lux(light, far, up) == 0);
    /* by channel: the type's spectrum */
    double       w_m2[optical_channel_count];
    const double p[3] = {l->p[0], l->p[1], ground_m};
    lamp_light_irradiance(w_m2, light, p, up);
    for (int c = 0; c < optical_channel_count; c++)
        CHECK(fabs(w_m2[c] - lamp_light_lux(light, p, up) * type->w_lm[c]) <= 1e-12 * w_m2[c]);
    CHECK(w_m2[optical_channel_pan] > 2.2e-3 * lamp_light_lux(light, p, up));
}

/* Ground of reflectance rho: rho E / pi; a lit pane its luminance; a dark pane, and its wall, what falls on them. */
static void hits_shine(void **state)
{
    (void)state;
    static Hits        hits;
    static Rays        rays;
    static float       ones[hits_capacity];
    const LampLight   *light = at_hour(21);
    const SceneryLamp *l = lamp_of_kind(LAMP_STREET);
    const uint16_t     grass = (uint16_t)materials_find(&stage.materials, "grass_green");
    const float       *texture[AIR_BAND_COUNT] = {ones, ones, ones, ones, ones};
    double             w[optical_channel_count], got[optical_channel_count];
    int                lit = 0, dark = 0;
    for (int i = 0; i < hits_capacity; i++) ones[i] = 1;
    hits.count = 1, hits.kind[0] = hit_ground, hits.n_enu[2][0] = hits.n_geo[2][0] = 1, hits.range_m[0] = 50;
    const double p[3] = {l->p[0] + 3, l->p[1], ground_m}, up[3] = {0, 0, 1};
    for (int k = 0; k < 3; k++) hits.p_enu[k][0] = p[k];
    lamp_light_irradiance(w, light, p, up);
    lamp_light_at(got, light, &stage.materials, grass, texture, 31, &hits, &rays, 0);
    for (int c = 0; c < optical_channel_count; c++) {
        const double expected = (double)stage.materials.material[grass].rho[c] * w[c] / pi_rad;
        CHECK(expected > 0 && fabs(got[c] / expected - 1) < 1e-6);
    }
    for (int k = 0; k < stage.scenery.lamps; k++) {
        const SceneryLamp *pane = &stage.scenery.lamp[k];
        const double       out[3] = {pane->n[0], pane->n[1], pane->n[2]};
        if (pane->kind != LAMP_WINDOW) continue;
        hits.kind[0] = hit_scenery, hits.instance[0] = (uint32_t)pane->object + 1,
        hits.facet[0] = (uint32_t)pane->facet + 1;
        for (int c = 0; c < 3; c++) hits.p_enu[c][0] = pane->p[c], hits.n_geo[c][0] = hits.n_enu[c][0] = (float)out[c];
        lamp_light_at(got, light, &stage.materials, grass, texture, 31, &hits, &rays, 0);
        const LampType *type = lamp_type_of(&stage.types, pane);
        const double    own = type->luminance_cd_m2 * type->w_lm[optical_channel_g];
        const bool      shines = got[optical_channel_g] > 0.5 * own;
        lit += shines, dark += !shines;
        CHECK(!shines || fabs(got[optical_channel_g] / own - 1) < 0.05);
        /* on its axis, of a pane as a disc: L A / (r^2 + A / pi) */
        const double r_m = 2, before[3] = {pane->p[0] + r_m * out[0], pane->p[1] + r_m * out[1], pane->p[2]};
        const double back[3] = {-out[0], -out[1], -out[2]}, a_m2 = (double)pane->area_m2;
        const double lux = type->luminance_cd_m2 * a_m2 / (r_m * r_m + a_m2 / pi_rad);
        CHECK(!shines || lamp_light_lux(light, before, back) > 0.98 * lux);
    }
    print_message("%d panes lit, %d dark at 21 h\n", lit, dark);
    CHECK(lit > 0 && dark > 0);
    /* what met nothing has none */
    hits.range_m[0] = INFINITY;
    lamp_light_at(got, light, &stage.materials, 0, texture, 31, &hits, &rays, 0);
    for (int c = 0; c < optical_channel_count; c++) CHECK(got[c] == 0);
}

/* All that two headlamps shed: on a sphere of 5 m about them, to what the cut-off leaves and the dip takes. */
static void headlamps_have_their_flux(void **state)
{
    (void)state;
    const LampLight   *light = at_hour(3);
    const SceneryLamp *l = lamp_of_kind(LAMP_VEHICLE);
    const PosedEntity *e = scenery_frame_posed(stage.frame, l->object);
    double             p[3], sum_lm = 0, below_lm = 0, most_lx = 0;
    const double       r_m = 5;
    m3_mul_v3(p, e->r_enu_from_body, l->p);
    for (int k = 0; k < 3; k++) p[k] += e->p_enu[k];
    for (int i = 0; i < 720; i++)
        for (int j = 0; j < 360; j++) {
            const double up = (j + 0.5 - 180) * pi_rad / 360, az = i * pi_rad / 360;
            const double d[3] = {cos(up) * sin(az), cos(up) * cos(az), sin(up)}, in[3] = {-d[0], -d[1], -d[2]};
            const double at[3] = {p[0] + r_m * d[0], p[1] + r_m * d[1], p[2] + r_m * d[2]};
            const double lux = lamp_light_lux(light, at, in);
            const double lm = lux * (r_m * r_m + (double)l->area_m2 / pi_rad) * cos(up) * pi_rad / 360 * pi_rad / 360;
            sum_lm += lm, below_lm += up < 0 ? lm : 0;
            most_lx = fmax(most_lx, lux);
        }
    const double flux_lm = lamp_type_of(&stage.types, l)->flux_lm, kcd = 1e-3 * most_lx * r_m * r_m;
    print_message("headlamps: %.0f lm of %.0f, %.0f of it below the horizontal, %.1f kcd\n", sum_lm, flux_lm, below_lm,
                  kcd);
    CHECK(sum_lm > 0.5 * flux_lm && sum_lm < 0.65 * flux_lm && below_lm > 0.97 * sum_lm);
    CHECK(kcd > 12.1 && kcd < 44.1); /* UN R112, at the point of the main beam's greatest */
}

/* Hours: nothing under the sun, street lamps all night, most windows after sunset, hardly any at three. */
static void lamps_have_hours(void **state)
{
    (void)state;
    double sun[3];
    int    of_hour[24] = {0};
    for (int h = 0; h < 24; h++) {
        const LampLight *light = at_hour(h + 0.5);
        of_hour[h] = lamp_light_count(light);
        sun_at_hour(sun, h + 0.5);
        CHECK(fabs(scenery_solar_hour(sun, lat_rad) - h - 0.5) < 1e-9);
        if (sun[2] > 0) CHECK(light == NULL);
        else CHECK(of_hour[h] >= 2);
    }
    CHECK(of_hour[20] > of_hour[3] && of_hour[12] == 0);
    SceneryLamp l = {.kind = LAMP_WINDOW, .bed_h = 22.7F, .rise_h = 6.7F};
    int         share[3] = {0};
    for (int k = 0; k < 1000; k++) {
        l.draw = ((float)k + 0.5F) / 1000;
        share[0] += scenery_lamp_lit(&l, -0.3, 20), share[1] += scenery_lamp_lit(&l, -0.5, 2);
        share[2] += scenery_lamp_lit(&l, -0.1, 7);
        CHECK(!scenery_lamp_lit(&l, 0.01, 20));
    }
    CHECK(share[0] == 400 && share[1] == 20 && share[2] == 250);
    l.kind = LAMP_STREET;
    CHECK(!scenery_lamp_lit(&l, -0.05, 20) && scenery_lamp_lit(&l, -0.08, 20));
}

/* The same again, to the bit; each facet of a pane is its own's. */
static void lamps_are_found_by_facet(void **state)
{
    (void)state;
    Scenery again = stage.scenery;
    int     kinds[LAMP_KINDS] = {0};
    again.lamp = NULL, again.lamps = 0;
    assert_int_equal(scenery_add_lamps(&again, 5), STATUS_OK);
    CHECK(again.lamps == stage.scenery.lamps);
    for (int k = 0; k < again.lamps; k++) {
        const SceneryLamp *a = &again.lamp[k], *b = &stage.scenery.lamp[k];
        CHECK(a->object == b->object && a->facet == b->facet && a->draw == b->draw && a->p[0] == b->p[0]);
        kinds[a->kind]++;
        for (int t = 0; t < a->facets; t++) CHECK(scenery_lamp_of(&again, a->object, a->facet + t) == k);
    }
    CHECK(scenery_lamp_of(&again, 0, 0) < 0 || again.lamp[scenery_lamp_of(&again, 0, 0)].facet == 0);
    print_message("%d windows, %d street lamps, %d vehicles\n", kinds[0], kinds[1], kinds[2]);
    CHECK(kinds[LAMP_WINDOW] > 8 && kinds[LAMP_STREET] == 1 && kinds[LAMP_VEHICLE] == 1);
    /* a burnt-out house is dark */
    Culture  c = {0};
    Scenery  ruin = {0};
    Building b = stage.culture.building[0];
    b.damage = 2;
    CHECK(culture_add_building(&c, &b, (const double(*)[2])stage.culture.corner_m, 4) == STATUS_OK);
    CHECK(scenery_add_buildings(&ruin, &c, NULL, NULL) == STATUS_OK);
    assert_int_equal(scenery_add_lamps(&ruin, 5), STATUS_OK);
    CHECK(ruin.lamps == 0);
    scenery_free(&ruin);
    culture_free(&c);
    free(again.lamp);
}

static void a_table_is_checked(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        "a,window,1,10,5,0,x\n", "a,street,1,10,5,0,x\n", "a,street,1,10,0,3,x\n",  "a,vehicle,1,10,0,0,x\n",
        "a,attic,1,10,0,0,x\n",  "a,street,2,10,0,0,x\n", "a,street,1,nan,0,0,x\n",
    };
    char      path[text_file_size], text[256];
    LampTypes types;
    log_suppress(true);
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        snprintf(text, sizeof text, "name,where,share,flux_lm,luminance_cd_m2,beam_deg,source\n%s", wrong[k]);
        text_file(path, text);
        CHECK(lamp_types_read(&types, path) == STATUS_BAD_VALUE);
        remove(path);
    }
    log_suppress(false);
    text_file(path, "name,where,share,flux_lm,luminance_cd_m2,beam_deg,source\na,street,1,10,0,0,x\n");
    CHECK(lamp_types_read(&types, path) == STATUS_OK && types.count == 1 && types.type[0].w_lm[0] == 0);
    remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_street_lamp_lights_the_ground), cmocka_unit_test(hits_shine),
        cmocka_unit_test(headlamps_have_their_flux),       cmocka_unit_test(lamps_have_hours),
        cmocka_unit_test(lamps_are_found_by_facet),        cmocka_unit_test(a_table_is_checked)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
