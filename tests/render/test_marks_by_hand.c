/* Marks on ground whose past is written down here, so that each of them has a value on paper: shadows of what stood,
 * the sky that it hid, its exhaust, trails, burnt ground, and where each of them ends. labels: physics */
#include "tests/check.h"

#include "render/heat/heat.h"
#include "render/heat/surface_flux_private.h"
#include "render/heat/vehicle_load_private.h"

enum { kind = SURFACE_SAND, grown = SURFACE_GRASS };
static const double exercise_s = 50000, now_s = 100000, up[3] = {0, 0, 1};

static HeatNow    now;
static LocalFrame frame;
static Arena     *arena;

/* Three intervals before now_s: 600, 600 and 1800 s. One W/m2 over each left 0.5, 0.3 and 0.2 K; the direct sun on what
 * faces it 4, 2 and 1 K; the sky -1, -0.5 and -0.25 K. The grid's two times are alike but for the share between them.
 */
static void write_past(const double sun_d_enu[3])
{
    static const double span_s[3] = {600, 600, 1800}, watt_k[3] = {0.5, 0.3, 0.2}, sun_k[3] = {4, 2, 1},
                        sky_k[3] = {-1, -0.5, -0.25};
    memset(&now, 0, sizeof now);
    now.table.facets = 3, now.table.air_k = 288, now.share = 0.25;
    for (int t = 0; t < 2; t++) {
        HeatPast *p = &now.past[t];
        double    end_s = now_s;
        p->count = 3;
        for (int i = 0; i < 3; i++) {
            p->unix_s[i] = end_s - 0.5 * span_s[i], p->span_s[i] = span_s[i];
            end_s -= span_s[i];
            memcpy(p->sun_d_enu[i], sun_d_enu, sizeof p->sun_d_enu[i]);
            for (int k = 1; k < ground_kinds; k++) {
                p->watt_k[k][i] = (float)watt_k[i], p->sun_k[k][i] = (float)sun_k[i], p->sky_k[k][i] = (float)sky_k[i];
                p->effusivity[k] = 1000;
            }
        }
    }
}

/* Sun and sky of the kind count for so much of their responses: sunlit less shaded ground over the sum of the sun's,
 * and shaded less hidden ground over that of the sky's. */
static void write_scales(double sun, double sky)
{
    const HeatPast *p = &now.past[1];
    double          sun_k = 0, sky_k = 0;
    for (int i = 0; i < 3; i++)
        sun_k += (double)p->sun_k[kind][i] * p->sun_d_enu[i][2], sky_k += (double)p->sky_k[kind][i];
    for (int i = 0; i < heat_ups; i++) now.table.shade_k[kind][i] = now.table.dark_k[kind][i] = 288;
    for (int i = 0; i < 9; i++) now.table.sun_k[kind][i] = (float)(288 + sun * sun_k);
    now.table.hidden_k[kind] = (float)(288 - sky * sky_k);
}

static int open_arena(void **state)
{
    (void)state;
    arena = arena_create();
    return arena == NULL || local_frame_at(&frame, &(Geodetic){0.785, 0.2, 0}) != STATUS_OK;
}

static int close_arena(void **state)
{
    (void)state;
    arena_destroy(arena);
    return 0;
}

/* A box about the origin whose nose is to the north. Exercise times are 50000 s before Unix time. */
static GroundStand box(double length_m, double width_m, double height_m, double from_s, double to_s)
{
    static const double enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    GroundStand         s = {.from_s = from_s - exercise_s, .to_s = to_s - exercise_s, .owner = 1};
    ecef_from_enu(s.p_ecef, &frame, (const double[3]){0, 0, 0});
    m3_mul(s.r_ecef_from_body, frame.r_ecef_from_enu, enu_from_body);
    s.low_m[0] = (float)(-0.5 * length_m), s.high_m[0] = (float)(0.5 * length_m);
    s.low_m[1] = (float)(-0.5 * width_m), s.high_m[1] = (float)(0.5 * width_m);
    s.low_m[2] = (float)-height_m;
    return s;
}

static bool mark_at(MarkedGround *out, const GroundMarks *marks, int of, double x, double y, double z,
                    const double n_enu[3], double lit)
{
    MarkHeat    *heat;
    const double p_enu[3] = {x, y, z};
    arena_reset(arena);
    CHECK(heat_marks_create(&heat, marks, &frame, exercise_s, now_s, &now, arena) == STATUS_OK && heat);
    return heat_marks_at(out, heat, of, p_enu, n_enu, lit);
}

static double stand_add_k(const GroundStand *s, double x, double y, double z, const double n_enu[3], double lit)
{
    const GroundMarks marks = {.stands = 1, .stand = s};
    MarkedGround      m;
    mark_at(&m, &marks, kind, x, y, z, n_enu, lit);
    return m.add_k;
}

/* A box 3.4 m wide and 2.4 m high, the sun in the south, 0.8 up over 0.6 level. Ground north of it at y is in its shade
 * while the ray from 0.02 m over it passes the near face (y = 1.7) below its top: y - 1.7 < (2.4 - 0.02) 0.6 / 0.8, y <
 * 3.485: there half of the sun's disc is hidden, 50 mm off all or none of it. It takes the cosine, 0.8, times the sun's
 * kelvins of each interval, by the share of it that the box stood there, times what relief left of the sun, times the
 * scale. None of its sky counts here: it has no response. */
static void a_shadow_ends_where_the_ray_passes_the_top(void **state)
{
    (void)state;
    const double      south[3] = {0, -0.6, 0.8}, west[3] = {-0.6, 0, 0.8}, slope[2][3] = {{0, 0.6, 0.8}, {0.6, 0, 0.8}};
    const GroundStand all = box(3.4, 3.4, 2.4, 0, 2e5), some = box(3.4, 3.4, 2.4, now_s - 900, now_s - 150),
                      before = box(3.4, 3.4, 2.4, now_s - 1500, now_s - 1300),
                      long_ago = box(3.4, 3.4, 2.4, 0, now_s - 3100);
    write_past(south);
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++) now.past[t].sky_k[kind][i] = 0;
    write_scales(1.5, 1);
    CHECK_NEAR(stand_add_k(&all, 0, 3.435, 0, up, 0.7), -1.5 * 0.7 * 0.8 * 7, 1e-5);
    CHECK_NEAR(stand_add_k(&all, 0, 3.485, 0, up, 0.7), -0.5 * 1.5 * 0.7 * 0.8 * 7, 1e-4);
    CHECK(stand_add_k(&all, 0, 3.535, 0, up, 0.7) == 0);
    CHECK_NEAR(stand_add_k(&all, 1.65, 2, 0, up, 1), -1.5 * 0.8 * 7, 1e-5);
    CHECK(stand_add_k(&all, 1.75, 2, 0, up, 1) == 0 && stand_add_k(&all, -1.75, 2, 0, up, 1) == 0);
    CHECK(stand_add_k(&all, 0, -1.75, 0, up, 1) == 0); /* the sun's side */
    /* from 900 to 150 s ago: 450 of the newest 600 s, 300 of the next 600 */
    CHECK_NEAR(stand_add_k(&some, 0, 2, 0, up, 1), -1.5 * 0.8 * (0.75 * 4 + 0.5 * 2), 1e-5);
    CHECK_NEAR(stand_add_k(&before, 0, 2, 0, up, 1), -1.5 * 0.8 * 200 / 1800.0, 1e-5);
    CHECK(stand_add_k(&long_ago, 0, 2, 0, up, 1) == 0);
    /* a slope to the north: 0.02 m along its normal is 0.012 m north and 0.016 m up; y + 0.012 < 1.7 + 2.384 * 0.75;
     * its cosine is 0.8 * 0.8 - 0.6 * 0.6 */
    CHECK_NEAR(stand_add_k(&all, 0, 3.476, 0, slope[0], 1), -0.5 * 1.5 * 0.28 * 7, 1e-4);
    CHECK(stand_add_k(&all, 0, 3.526, 0, slope[0], 1) == 0);
    write_past(west);
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++) now.past[t].sky_k[kind][i] = 0;
    write_scales(1.5, 1);
    CHECK_NEAR(stand_add_k(&all, 3.476, 0, 0, slope[1], 1), -0.5 * 1.5 * 0.28 * 7, 1e-4);
    CHECK(stand_add_k(&all, 3.526, 0, 0, slope[1], 1) == 0);
    /* a shadow that the grid's first time did not have: a quarter of the way to the second */
    for (int i = 0; i < 3; i++) now.past[0].sun_k[kind][i] = 0;
    CHECK_NEAR(stand_add_k(&all, 3, 0, 0, up, 1), -1.5 * 0.25 * 0.8 * 7, 1e-5);
}

/* Under a sun that stands still, what a past interval took is smeared by conduction alone, of an age t a Gaussian of
 * variance 2 a t, and by the sun's disc: an edge is the mean over the interval's ages, 1200 to 3000 s, of the normal
 * distribution. 2 cm of the disc's deviation come from 5 m of way (half of 4.65 mrad, along ground twice as long). */
static void conduction_softens_edges(void **state)
{
    (void)state;
    static const double diffusivity_m2_s = 5e-7;
    const double        south[3] = {0, -0.6, 0.8};
    const GroundStand   all = box(3.4, 3.4, 2.4, 0, 2e5);
    write_past(south);
    for (int t = 0; t < 2; t++) {
        HeatPast *p = &now.past[t];
        for (int i = 0; i < 3; i++) {
            p->sky_k[kind][i] = 0;
            if (i < 2) p->sun_k[kind][i] = 0;
        }
        p->diffusivity[kind] = (float)diffusivity_m2_s;
    }
    write_scales(1.5, 1);
    for (double off_m = -0.15; off_m < 0.16; off_m += 0.03) {
        const double to_centre_m = 0.6 * (3.485 + off_m) + 0.8 * 1.18; /* along the ray */
        const double disc_m = 0.5 * 0.00465 * to_centre_m / 0.8;
        double       want = 0;
        for (int k = 0; k < 500; k++) {
            const double age_s = 1200 + 1800 * (k + 0.5) / 500;
            want += 0.5 * erfc(off_m / sqrt(2 * (2 * diffusivity_m2_s * age_s + disc_m * disc_m))) / 500;
        }
        CHECK_NEAR(stand_add_k(&all, 0, 3.485 + off_m, 0, up, 1), -1.5 * 0.8 * want, 2e-3);
    }
    CHECK(fabs(stand_add_k(&all, 0, 3.535, 0, up, 1)) > 0.02); /* where the disc alone leaves nothing */
}

/* The sun crosses the sky: towards it at any time is straight through the middles of two intervals. It stood at (0, -1,
 * 2) at the newest middle, 300 s ago, and at (0, -1, 2.6) 900 s ago (to scale): the box's edge, 2.4 m up, shades ground
 * at y north of its face while up over level is below 2.38 / y. What was taken counts by the root of its age: the mean
 * over even steps of that, of the cosine where it was hidden. */
static void the_sun_moves_between_intervals(void **state)
{
    (void)state;
    const double      at[3][3] = {{0, -1, 2}, {0, -1, 2.6}, {0, -1, 2.6}};
    const GroundStand all = box(3.4, 3.4, 2.4, 0, 2e5);
    int               partly = 0;
    write_past(up);
    for (int t = 0; t < 2; t++) {
        HeatPast *p = &now.past[t];
        for (int i = 0; i < 3; i++) {
            CHECK(v3_normalize(p->sun_d_enu[i], at[i]));
            p->sky_k[kind][i] = 0;
            if (i > 0) p->sun_k[kind][i] = 0;
        }
    }
    for (int i = 0; i < 9; i++) now.table.sun_k[kind][i] = 0; /* scale: nothing to compare, 0.5 */
    double scale, sky;
    heat_scales(&scale, &sky, &now, kind);
    for (double y = 0.7; y < 1.6; y += 0.1) {
        double want = 0, hidden = 0;
        for (int k = 0; k < 4000; k++) {
            const double age_s = 600 * pow((k + 0.5) / 4000, 2), share = (age_s - 300) / 600;
            double       d[3];
            for (int i = 0; i < 3; i++)
                d[i] =
                    now.past[1].sun_d_enu[0][i] + share * (now.past[1].sun_d_enu[1][i] - now.past[1].sun_d_enu[0][i]);
            CHECK(v3_normalize(d, d));
            if (0.02 + y * d[2] / -d[1] < 2.4) want += d[2] / 4000, hidden += 1.0 / 4000;
        }
        partly += hidden > 0.1 && hidden < 0.9;
        CHECK_NEAR(stand_add_k(&all, 0, 1.7 + y, 0, up, 1), -scale * 4 * want, 0.03 * scale * 4);
    }
    CHECK(partly >= 2);
}

/* Sky hidden by a wall 80 m long and 2 m high, at a place 0.02 m over level ground beside its middle: twice the share
 * of a perpendicular rectangle from its corner (Hamilton & Morgan 1952): (atan(L / a) - a / c atan(L / c)) / 2 pi, c
 * the distance of its top. All of it below the wall. */
static void a_wall_hides_the_sky(void **state)
{
    (void)state;
    const GroundStand wall = box(0.2, 80, 2, 0, 2e5); /* along the east */
    write_past(up);
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++) now.past[t].sun_k[kind][i] = 0;
    write_scales(1, 0.8);
    for (double away_m = 0.1; away_m < 4; away_m *= 1.04) {
        const double top_m = hypot(away_m, 2 - 0.02);
        const double want = (atan(40 / away_m) - away_m / top_m * atan(40 / top_m)) / pi_rad;
        CHECK_NEAR(stand_add_k(&wall, 0, 0.1 + away_m, 0, up, 1), 0.8 * 1.75 * want, 1e-5);
    }
    CHECK_NEAR(stand_add_k(&wall, 0, 0, 0, up, 1), 0.8 * 1.75, 1e-5);
}

/* A shadow reaches half of the box's diagonal and ten times its height, 120 m at most: 0.5 * 4.808 + 24 = 26.404 m of a
 * box 3.4 m wide and 2.4 m high. The sun's rays here, 0.08 up over 1 level, would pass below its top to 31 m. */
static void shadows_reach_so_far(void **state)
{
    (void)state;
    const double      level = 1 / hypot(1, 0.08), low[3] = {0, -level, 0.08 * level};
    const GroundStand one = box(3.4, 3.4, 2.4, 0, 2e5), tower = box(3.4, 3.4, 60, 0, 2e5);
    write_past(low);
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++) now.past[t].sky_k[kind][i] = 0;
    for (int i = 0; i < 9; i++) now.table.sun_k[kind][i] = 0;
    CHECK(stand_add_k(&one, 0, 26.3, 0, up, 1) != 0 && stand_add_k(&one, 0, 26.5, 0, up, 1) == 0);
    CHECK(stand_add_k(&tower, 0, 119, 0, up, 1) != 0 && stand_add_k(&tower, 0, 121, 0, up, 1) == 0);
}

/* The exhaust of what stands, by the film of its speed above that of calm air: film excess now / (1 + film ended), for
 * one W/m2: now by what each interval's share of the blowing left, ended by what as long a blowing up to now leaves. It
 * blew from 1500 to 450 s ago: a quarter of the newest interval, all of the second, 300 s of the third; as long up to
 * now: all of the newest, 450 s of the second. The jet is jet_path's, which has tests of its own. */
static void an_exhaust_blows_on_the_ground(void **state)
{
    (void)state;
    const ExhaustJet jet = {.radius_m = 0.15, .speed_mps = 20, .excess_k = 200};
    GroundStand      s = box(0.02, 0.02, 0.02, 0, 2e5);
    JetPath          path;
    double           excess_k, speed_mps;
    const double     north[3] = {0, 1, 0}, still[3] = {0, 0, 0};
    write_past((const double[3]){0, 0, -1}); /* night */
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++) now.past[t].sky_k[kind][i] = 0;
    write_scales(1, 1);
    s.blow = (GroundBlow){.at_m = {0.5f, 0, -0.4f},
                          .d = {1, 0, 0},
                          .radius_m = 0.15f,
                          .speed_mps = 20,
                          .excess_k = 200,
                          .from_s = now_s - 1500 - exercise_s,
                          .to_s = now_s - 450 - exercise_s};
    jet_path(&path, &jet, (const double[3]){0, 0.5, (double)0.4f}, north, still, 288);
    CHECK(jet_path_at(&excess_k, &speed_mps, NULL, &path, (const double[3]){0, 4, 0}, true));
    const double film = 6.1 * pow(speed_mps, 0.8);
    const double at_now = 0.5 * 150 / 600 + 0.3 + 0.2 * 300 / 1800, ended = 0.5 + 0.3 * 450 / 600;
    CHECK(film * excess_k > 10);
    CHECK_NEAR(stand_add_k(&s, 0, 4, 0, up, 1), film * excess_k * at_now / (1 + film * ended), 2e-4);
    for (int i = 0; i < 3; i++) now.past[0].watt_k[kind][i] = 0; /* the grid's first time did not have it */
    CHECK_NEAR(stand_add_k(&s, 0, 4, 0, up, 1), 0.25 * film * excess_k * at_now / (1 + film * ended), 2e-4);
    CHECK(stand_add_k(&s, 0, -2, 0, up, 1) == 0); /* behind the outlet */
    /* a jet whose lowest part is 1.55 m over the ground does not count, one of 1.45 m does */
    for (int high = 0; high < 2; high++) {
        const double      low_m = path.box.low_m[2] - (double)0.4f, at_m = (high ? 1.55 : 1.45) - low_m;
        const GroundMarks marks = {.stands = 1, .stand = &s};
        MarkedGround      m;
        s.blow.at_m[2] = (float)-at_m;
        mark_at(&m, &marks, kind, 0, 4, at_m, up, 1);
        CHECK(high ? m.add_k == 0 : m.add_k > 0);
    }
}

/* A trail of 40 m to the east, two tracks 0.6 m wide, 2.6 m apart: 1 to 1.6 m from its middle. It left 20 kJ/m2 where
 * it was passed, from 1000 to 600 s ago. Pulses fade by the intervals: at their middles watt_k over the span, straight
 * between; before the newest middle q / (1000 sqrt(pi t)). What grows is pressed into soil of its own response. */
static void trails(void **state)
{
    (void)state;
    GroundTrack       t = {.a_s = now_s - 1000 - exercise_s,
                           .b_s = now_s - 600 - exercise_s,
                           .width_m = 0.6f,
                           .apart_m = 2.6f,
                           .heat_j_m2 = 20e3f};
    const GroundMarks marks = {.tracks = 1, .track = &t};
    MarkedGround      m;
    write_past(up);
    for (int i = 0; i < 3; i++) now.past[1].watt_k[SURFACE_PLOUGHED][i] *= 2;
    ecef_from_enu(t.a_ecef, &frame, (const double[3]){-20, 5, 1});
    ecef_from_enu(t.b_ecef, &frame, (const double[3]){20, 5, 1});
    static const double in[] = {6.01, 6.59, 3.99, 3.41}, out[] = {5.99, 6.61, 4.01, 3.39, 5};
    for (int k = 0; k < 4; k++) {
        mark_at(&m, &marks, kind, -10, in[k], 1, up, 1); /* 900 s ago: the second middle */
        CHECK_NEAR(m.add_k, 20e3 * 0.3 / 600, 1e-4);
        CHECK(m.loose == 0.3 && m.burnt == 0);
    }
    for (int k = 0; k < 5; k++) {
        mark_at(&m, &marks, kind, -10, out[k], 1, up, 1);
        CHECK(m.add_k == 0 && m.loose == 0);
    }
    mark_at(&m, &marks, kind, 5, 6.3, 1, up, 1); /* 750 s ago: three quarters from the first middle to the second */
    CHECK_NEAR(m.add_k, 20e3 * (0.25 * 0.5 + 0.75 * 0.3) / 600, 1e-4);
    mark_at(&m, &marks, kind, 49 - 20, 6.3, 1, up, 1); /* beyond its end */
    CHECK(m.add_k == 0);
    mark_at(&m, &marks, grown, -10, 6.3, 1, up, 1);
    CHECK_NEAR(m.add_k, 2 * 20e3 * 0.3 / 600, 2e-4);
    for (int side = -1; side <= 1; side += 2) {
        mark_at(&m, &marks, kind, side * 19.99, 6.3, 1, up, 1);
        CHECK(m.add_k > 0);
        mark_at(&m, &marks, kind, side * 20.01, 6.3, 1, up, 1);
        CHECK(m.add_k == 0);
        /* 1.5 m and half of its length over or below it */
        mark_at(&m, &marks, kind, 0, 6.3, 1 + side * 21.4, up, 1);
        CHECK(m.add_k > 0);
        mark_at(&m, &marks, kind, 0, 6.3, 1 + side * 21.6, up, 1);
        CHECK(m.add_k == 0);
    }
    t.tracked = true, t.a_s = t.b_s = now_s - 200 - exercise_s;
    mark_at(&m, &marks, kind, 0, 6.3, 1, up, 1);
    CHECK_NEAR(m.add_k, 20e3 / (1000 * sqrt(pi_rad * 200)), 1e-4);
    CHECK(m.loose == 0.6);
    t.a_s = t.b_s = now_s - 310 - exercise_s; /* a sixtieth of the way from the first middle to the second */
    mark_at(&m, &marks, kind, 0, 6.3, 1, up, 1);
    CHECK_NEAR(m.add_k, 20e3 * (0.5 - 0.2 / 60) / 600, 1e-4);
    t.a_s = t.b_s = now_s + 5 - exercise_s; /* not yet */
    mark_at(&m, &marks, kind, 0, 6.3, 1, up, 1);
    CHECK(m.add_k == 0);
    t.a_s = t.b_s = now_s - 0.5 - exercise_s; /* within a second: as a second after */
    mark_at(&m, &marks, kind, 0, 6.3, 1, up, 1);
    CHECK_NEAR(m.add_k, 20 / sqrt(pi_rad), 1e-4);
    /* older than the oldest middle: as there; one of a decimetre is one, one of half a millimetre none */
    t.a_s = t.b_s = now_s - 9000 - exercise_s;
    mark_at(&m, &marks, kind, 0, 6.3, 1, up, 1);
    CHECK_NEAR(m.add_k, 20e3 * 0.2 / 1800, 1e-4);
    ecef_from_enu(t.b_ecef, &frame, (const double[3]){-19.9, 5, 1});
    CHECK(mark_at(&m, &marks, kind, -19.95, 6.3, 1, up, 1) && m.add_k > 0);
    ecef_from_enu(t.b_ecef, &frame, (const double[3]){-19.9995, 5, 1});
    CHECK(!mark_at(&m, &marks, kind, -19.9998, 6.3, 1, up, 1));
}

/* Burnt ground of 5 m about (16, 16), 100 kJ/m2, 900 s ago, in the response of bare soil: 1 - (r / 5)^4 of it, and of
 * being burnt; its crater of 1 m is loose soil. A burst of half a metre is as large as that. */
static void burns(void **state)
{
    (void)state;
    GroundBurn        b = {.t_s = now_s - 900 - exercise_s, .radius_m = 5, .crater_m = 1, .heat_j_m2 = 1e5f};
    const GroundMarks marks = {.burns = 1, .burn = &b};
    MarkedGround      m;
    write_past(up);
    for (int i = 0; i < 3; i++) now.past[1].watt_k[SURFACE_PLOUGHED][i] *= 2;
    ecef_from_enu(b.p_ecef, &frame, (const double[3]){16, 16, 0});
    CHECK(mark_at(&m, &marks, kind, 18.4, 19.2, 0, up, 1)); /* 4 m away: 0.8^4 = 0.4096 */
    CHECK_NEAR(m.burnt, 0.5904, 1e-6);
    CHECK_NEAR(m.add_k, 0.5904 * 2 * 1e5 * 0.3 / 600, 1e-3);
    CHECK(m.loose == 0);
    CHECK(mark_at(&m, &marks, kind, 16.6, 16.7, 0, up, 1) && m.loose == 1 && m.burnt == 0);
    CHECK(mark_at(&m, &marks, kind, 16.8, 16.8, 0, up, 1) && m.loose == 0 && m.burnt > 0.99);
    CHECK(mark_at(&m, &marks, kind, 21.01, 16, 0, up, 1) && m.burnt == 0 && m.add_k == 0);
    b.radius_m = 0.5f, b.crater_m = 0;
    CHECK(mark_at(&m, &marks, kind, 16.4, 16, 0, up, 1));
    CHECK_NEAR(m.burnt, 1 - 0.8 * 0.8 * 0.8 * 0.8, 1e-4);
    CHECK(mark_at(&m, &marks, kind, 16.51, 16, 0, up, 1) && m.burnt == 0);
}

/* Where marks are looked for: in cells of 32 m that they touch, a trail's with 4 m to spare; places beyond 500 km, or
 * 50 km up, are no places of ground. */
static void marks_are_near_or_not(void **state)
{
    (void)state;
    GroundBurn        b = {.t_s = now_s - 900 - exercise_s, .radius_m = 5, .heat_j_m2 = 1e5f};
    GroundTrack       t = {.a_s = 1, .b_s = 2, .width_m = 0.6f, .apart_m = 2.6f, .heat_j_m2 = 20e3f};
    const GroundMarks burn = {.burns = 1, .burn = &b}, track = {.tracks = 1, .track = &t};
    MarkedGround      m;
    write_past(up);
    ecef_from_enu(b.p_ecef, &frame, (const double[3]){16, 16, 0});
    CHECK(mark_at(&m, &burn, kind, 31.9, 0.1, 0, up, 1) && mark_at(&m, &burn, kind, 0.1, 31.9, 0, up, 1));
    CHECK(!mark_at(&m, &burn, kind, 32.1, 16, 0, up, 1) && !mark_at(&m, &burn, kind, 16, 32.1, 0, up, 1));
    CHECK(!mark_at(&m, &burn, kind, -0.1, 16, 0, up, 1) && !mark_at(&m, &burn, kind, 16, -0.1, 0, up, 1));
    ecef_from_enu(b.p_ecef, &frame, (const double[3]){26.9, 5.1, 0}); /* just within its cell */
    CHECK(!mark_at(&m, &burn, kind, 33, 16, 0, up, 1) && !mark_at(&m, &burn, kind, 16, -1, 0, up, 1));
    ecef_from_enu(b.p_ecef, &frame, (const double[3]){27.1, 4.9, 0}); /* and beyond it */
    CHECK(mark_at(&m, &burn, kind, 33, 16, 0, up, 1) && mark_at(&m, &burn, kind, 16, -1, 0, up, 1));
    /* 0.5 (2.6 + 0.6) + 4 = 5.6 m from a trail along the east */
    static const double y[2] = {26.35, 26.45};
    for (int k = 0; k < 2; k++) {
        ecef_from_enu(t.a_ecef, &frame, (const double[3]){10, y[k], 0});
        ecef_from_enu(t.b_ecef, &frame, (const double[3]){20, y[k], 0});
        CHECK(mark_at(&m, &track, kind, 16, 33, 0, up, 1) == (k == 1));
        CHECK(mark_at(&m, &track, kind, 16, 31, 0, up, 1) && !mark_at(&m, &track, kind, 40, 20, 0, up, 1));
        ecef_from_enu(t.a_ecef, &frame, (const double[3]){32 - y[k], 10, 0});
        ecef_from_enu(t.b_ecef, &frame, (const double[3]){32 - y[k], 20, 0});
        CHECK(mark_at(&m, &track, kind, -1, 16, 0, up, 1) == (k == 1));
    }
    for (int k = 0; k < 2; k++) { /* on the south side, and on the east */
        ecef_from_enu(t.a_ecef, &frame, (const double[3]){10, 32 - y[k], 0});
        ecef_from_enu(t.b_ecef, &frame, (const double[3]){20, 32 - y[k], 0});
        CHECK(mark_at(&m, &track, kind, 16, -1, 0, up, 1) == (k == 1));
        ecef_from_enu(t.a_ecef, &frame, (const double[3]){y[k], 10, 0});
        ecef_from_enu(t.b_ecef, &frame, (const double[3]){y[k], 20, 0});
        CHECK(mark_at(&m, &track, kind, 33, 16, 0, up, 1) == (k == 1));
    }
    /* a long one on the slant: all along it */
    ecef_from_enu(t.a_ecef, &frame, (const double[3]){-300, -150, 0});
    ecef_from_enu(t.b_ecef, &frame, (const double[3]){300, 150, 0});
    for (double s = -0.999; s < 1; s += 0.037) CHECK(mark_at(&m, &track, kind, 300 * s, 150 * s, 0, up, 1));
    static const double far_m[][3] = {{4.9e5, 0, 0},  {-4.9e5, 0, 0}, {0, 4.9e5, 0},
                                      {0, -4.9e5, 0}, {0, 0, 4.9e4},  {0, 0, -4.9e4}};
    for (int k = 0; k < 6; k++)
        for (int beyond = 0; beyond < 2; beyond++) {
            double            p[3];
            GroundStand       s = box(4, 4, 2, 0, 2e5);
            const GroundMarks stand = {.stands = 1, .stand = &s};
            v3_scale(p, beyond ? 5.1 / 4.9 : 1, far_m[k]);
            ecef_from_enu(b.p_ecef, &frame, p), ecef_from_enu(s.p_ecef, &frame, p);
            CHECK(mark_at(&m, &burn, kind, p[0], p[1], p[2], up, 1) == !beyond);
            CHECK(mark_at(&m, &stand, kind, p[0], p[1], p[2], up, 1) == !beyond);
        }
}

/* Two of each sort at once, each where it is. */
static void all_sorts_at_once(void **state)
{
    (void)state;
    const double south[3] = {0, -0.6, 0.8};
    GroundStand  stand[2];
    GroundTrack  track[2];
    GroundBurn   burn[2];
    MarkedGround m;
    write_past(south);
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 3; i++) now.past[t].sky_k[kind][i] = 0;
    write_scales(1, 1);
    for (int k = 0; k < 2; k++) {
        const double x = 500 * k;
        stand[k] = box(3.4, 3.4, 2.4, 0, 2e5);
        track[k] = (GroundTrack){.a_s = now_s - 900 - exercise_s,
                                 .b_s = now_s - 900 - exercise_s,
                                 .width_m = 0.6f,
                                 .apart_m = 2.6f,
                                 .heat_j_m2 = (float)(10e3 * (k + 1)),
                                 .tracked = k};
        burn[k] = (GroundBurn){.t_s = now_s - 900 - exercise_s, .radius_m = 5, .crater_m = 1, .heat_j_m2 = 1e5f};
        ecef_from_enu(stand[k].p_ecef, &frame, (const double[3]){x, 0, 0});
        ecef_from_enu(track[k].a_ecef, &frame, (const double[3]){x, 100, 0});
        ecef_from_enu(track[k].b_ecef, &frame, (const double[3]){x + 20, 100, 0});
        ecef_from_enu(burn[k].p_ecef, &frame, (const double[3]){x, 200, 0});
    }
    const GroundMarks marks = {.stands = 2, .stand = stand, .tracks = 2, .track = track, .burns = 2, .burn = burn};
    for (int k = 0; k < 2; k++) {
        CHECK(mark_at(&m, &marks, kind, 500 * k, 2, 0, up, 1));
        CHECK_NEAR(m.add_k, -0.8 * 7, 1e-5);
        CHECK(mark_at(&m, &marks, kind, 500 * k + 10, 101.3, 0, up, 1) && m.loose == (k ? 0.6 : 0.3));
        CHECK_NEAR(m.add_k, 10e3 * (k + 1) * 0.3 / 600, 1e-4);
        CHECK(mark_at(&m, &marks, kind, 500 * k, 200, 0, up, 1) && m.loose == 1 && m.burnt == 0);
        CHECK(!mark_at(&m, &marks, kind, 500 * k, 300, 0, up, 1));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_shadow_ends_where_the_ray_passes_the_top),
        cmocka_unit_test(conduction_softens_edges),
        cmocka_unit_test(the_sun_moves_between_intervals),
        cmocka_unit_test(a_wall_hides_the_sky),
        cmocka_unit_test(shadows_reach_so_far),
        cmocka_unit_test(an_exhaust_blows_on_the_ground),
        cmocka_unit_test(trails),
        cmocka_unit_test(burns),
        cmocka_unit_test(marks_are_near_or_not),
        cmocka_unit_test(all_sorts_at_once),
    };
    return cmocka_run_group_tests(tests, open_arena, close_arena);
}
