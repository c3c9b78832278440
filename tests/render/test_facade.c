/* Walls and roofs to a radar, piece by piece: triangles cut along a grid; plates and walls over ground against closed
 * forms, near ones against an integral of the test's own; what is scattered against Lambert's law. labels: physics */
#include "tests/check.h"

#include "render/scattering/built/facade_echo.h"
#include "render/scattering/built/thing_table.h"

#include <stdlib.h>
#include <unistd.h>

static const double frequency_hz = 35e9;
static double       k_rad_m;

static const RadarSurface metal = {.kind = RADAR_METAL};
static FacadeRow          even = {.material = "other", .uneven_length_m = 1};

static double dice(uint64_t n) { return random_uniform(7, 91, 0, n); }

/* ---- cutting -------------------------------------------------------------------------------------- */

typedef struct Sum {
    const PiecePlane *plane;
    double            area_m2, first[3]; /* integral of the place */
    int               pieces;
    double            side_m[2];
} Sum;

static void add_piece(void *user, const Piece *piece)
{
    Sum   *s = user;
    double p[3];
    piece_place(p, s->plane, piece->middle[0], piece->middle[1]);
    v3_add_scaled(s->first, s->first, piece->area_m2, p);
    s->area_m2 += piece->area_m2;
    s->pieces++;
    CHECK(piece->area_m2 <= s->side_m[0] * s->side_m[1] * (1 + 1e-9) && piece->corners <= piece_corners_most);
    for (int i = 0; i < piece->corners; i++) /* within its cell */
        for (int a = 0; a < 2; a++) {
            const double cell = a ? piece->j : piece->i;
            CHECK(piece->corner[i][a] >= cell * s->side_m[a] - 1e-9 &&
                  piece->corner[i][a] <= (cell + 1) * s->side_m[a] + 1e-9);
        }
}

/* Pieces of any triangle have its area and its centroid, by its corners. */
static void pieces_make_up_a_triangle(void **state)
{
    (void)state;
    double worst = 0;
    int    pieces = 0;
    for (int n = 0; n < 400; n++) {
        double     corner[3][3], a[3], b[3], cross[3];
        PiecePlane plane;
        const bool flat = n % 5 == 0 && n % 7 != 3;
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++)
                corner[v][c] = flat && c == 2 ? 3 : 100 * (n % 3) + 8 * dice((uint64_t)(9 * n + 3 * v + c));
        if (n % 7 == 3) corner[1][0] = corner[0][0] = 0.5, corner[1][1] = corner[0][1] = 1; /* upright edge on a line */
        const double area_m2 = piece_plane(&plane, (const double(*)[3])corner);
        Sum          sum = {.plane = &plane, .side_m = {0.25 * (1 << n % 4), 0.5}};
        CHECK(pieces_cut(&plane, (const double(*)[3])corner, sum.side_m, add_piece, &sum));
        v3_sub(a, corner[1], corner[0]);
        v3_sub(b, corner[2], corner[0]);
        v3_cross(cross, a, b);
        CHECK_NEAR(area_m2, 0.5 * v3_length(cross), 1e-12 * area_m2);
        CHECK(sum.pieces <= pieces_bound(&plane, (const double(*)[3])corner, sum.side_m));
        if (area_m2 < 2) continue; /* slivers under 1e-6 of a cell are left out */
        worst = fmax(worst, fabs(sum.area_m2 / area_m2 - 1));
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(sum.first[c] / sum.area_m2, (corner[0][c] + corner[1][c] + corner[2][c]) / 3, 1e-3);
        pieces += sum.pieces;
    }
    print_message("%d pieces of 400 triangles: areas to %.1e\n", pieces, worst);
    CHECK(worst < 1e-4);
}

static void triangles_without_area_are_none(void **state)
{
    (void)state;
    PiecePlane plane;
    CHECK(piece_plane(&plane, (const double[3][3]){{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}) == 0);
    CHECK(piece_plane(&plane, (const double[3][3]){{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}) == 0);
    CHECK(piece_plane(&plane, (const double[3][3]){{NAN, 0, 0}, {1, 1, 1}, {2, 2, 0}}) == 0);
}

/* ---- a rectangle by its pieces ---------------------------------------------------------------------- */

/* A rectangle that faces north (+y), its middle at p, wide along x and high along z. */
typedef struct Wall {
    double         p[3], wide_m, high_m;
    Facade         facade;
    FacadeLook     look;
    GroundSurface  ground;
    bool           by_ground;
    double complex hh, vv; /* sum over its pieces, as if from the middle of its foot */
    double         reference_m;
    int            pieces;
} Wall;

static void sum_piece(void *user, const Piece *piece)
{
    Wall         *w = user;
    double        p[3], to[3], path_m;
    ScatterMatrix s;
    piece_place(p, &w->facade.plane, piece->middle[0], piece->middle[1]);
    v3_sub(to, p, w->look.p_enu);
    path_m = 2 * v3_length(to);
    if (w->by_ground) {
        static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
        FacadeGround        ground;
        CHECK(facade_ground(&ground, &w->facade, piece, &w->look, origin, up));
        facade_by_ground(&s, &w->facade, piece, &w->look, &ground, &w->ground);
        path_m += ground.extra_m;
    } else {
        facade_echo(&s, &w->facade, piece, &w->look, true);
    }
    const double complex turn = cexp(-I * w->look.k * (path_m - 2 * w->reference_m));
    w->hh += s.hh * turn, w->vv += s.vv * turn;
    w->pieces++;
}

/* azimuth: of the antenna off the wall's normal; elevation: over the level. */
static void sum_wall(Wall *w, double azimuth_rad, double elevation_rad, double range_m, const double side_m[2])
{
    const double x0 = w->p[0] - 0.5 * w->wide_m, x1 = x0 + w->wide_m, z0 = w->p[2] - 0.5 * w->high_m,
                 z1 = z0 + w->high_m, y = w->p[1];
    const double triangle[2][3][3] = {{{x1, y, z0}, {x0, y, z0}, {x0, y, z1}}, {{x1, y, z0}, {x0, y, z1}, {x1, y, z1}}};
    const double foot[3] = {w->p[0], y, 0};
    w->look = (FacadeLook){.frequency_hz = frequency_hz, .k = k_rad_m, .band = CLUTTER_KA};
    w->look.p_enu[0] = foot[0] + range_m * cos(elevation_rad) * sin(azimuth_rad);
    w->look.p_enu[1] = foot[1] + range_m * cos(elevation_rad) * cos(azimuth_rad);
    w->look.p_enu[2] = foot[2] + range_m * sin(elevation_rad);
    w->look.right[0] = -cos(azimuth_rad), w->look.right[1] = sin(azimuth_rad), w->look.right[2] = 0;
    w->reference_m = range_m;
    w->hh = w->vv = 0;
    w->pieces = 0;
    for (int t = 0; t < 2; t++) {
        CHECK(piece_plane(&w->facade.plane, triangle[t]) > 0);
        CHECK_NEAR(w->facade.plane.n[1], 1, 1e-12);
        CHECK(pieces_cut(&w->facade.plane, triangle[t], side_m, sum_piece, w));
    }
}

static double sinc(double x) { return fabs(x) < 1e-9 ? 1 : sin(x) / x; }
static double db(double complex s) { return 10 * log10(4 * pi_rad * creal(s * conj(s))); }

/* From afar: 4 pi (a b / lambda)^2 cos^2 sinc^2 sinc^2, in the main lobe, the side lobes, any size of piece. */
static void a_plate_is_a_plate(void **state)
{
    (void)state;
    const double lambda_m = 2 * pi_rad / k_rad_m, a = 3, b = 2, far_m = 1e8;
    double       worst = 0;
    for (int size = 0; size < 3; size++)
        for (int n = 0; n < 9; n++) {
            const double az = (n % 3) * 0.31 * lambda_m / a, el = n / 3 * 0.37 * lambda_m / b;
            const double side_m[2] = {0.125 * (1 << 2 * size), 0.125 * (1 << size)};
            Wall         w = {.p = {0, 0, 1}, .wide_m = a, .high_m = b, .facade = {.row = &even, .surface = metal}};
            sum_wall(&w, az, el, far_m, side_m);
            const double s = cos(el) * sin(az), t = sin(el);
            const double want =
                4 * pi_rad *
                pow(a * b / lambda_m * cos(el) * cos(az) * sinc(k_rad_m * a * s) * sinc(k_rad_m * b * t), 2);
            worst = fmax(worst, fmax(fabs(db(w.hh) - 10 * log10(want)), fabs(db(w.vv) - 10 * log10(want))));
        }
    print_message("a plate of 3 by 2 m, normal and side lobes, HH and VV: %.4f dB from its closed form\n", worst);
    CHECK(worst < 0.1);
}

/* What a dielectric mirrors at this angle, by Fresnel's equations, written anew. */
static double complex fresnel(double complex eps, double cosine, bool te)
{
    const double complex q = csqrt(eps - (1 - cosine * cosine));
    return te ? (cosine - q) / (cosine + q) : (eps * cosine - q) / (eps * cosine + q);
}

/* On its foot: 16 pi (a b cos e / lambda)^2 of metal on metal, by its sinc over azimuth alone; of concrete on a rough
 * road by Fresnel's coefficients of both and Ament's factors. */
static void a_wall_on_the_ground_is_a_dihedral(void **state)
{
    (void)state;
    const double         lambda_m = 2 * pi_rad / k_rad_m, a = 4, b = 2.5, far_m = 1e8, side_m[2] = {0.25, 0.5};
    const double complex concrete = 5.24 - 0.38 * I, road = 4 - 0.2 * I;
    const double         wall_rms_m = 0.3e-3, road_rms_m = 1e-3;
    double               worst = 0, worst_off = 0, worst_rough = 0;
    for (int n = 0; n < 8; n++) {
        const double el = (4 + 6 * n) * rad_per_deg, az = n % 2 ? 0.4 * lambda_m / a : 0;
        Wall         w = {.p = {3, -2, 0.5 * b},
                          .wide_m = a,
                          .high_m = b,
                          .by_ground = true,
                          .facade = {.row = &even, .surface = metal},
                          .ground = {.eps = 1 - 1e12 * I}};
        sum_wall(&w, az, el, far_m, side_m);
        const double peak = 16 * pi_rad * pow(a * b * cos(el) * cos(az) / lambda_m, 2),
                     off = sinc(k_rad_m * a * cos(el) * sin(az)), want_db = 10 * log10(peak * off * off);
        double *const of = az > 0 ? &worst_off : &worst;
        *of = fmax(*of, fmax(fabs(db(w.hh) - want_db), fabs(db(w.vv) - want_db)));
        if (az > 0) continue;
        w.facade.surface = (RadarSurface){.kind = RADAR_HALF_SPACE, .eps = concrete, .rough_m = wall_rms_m};
        w.ground = (GroundSurface){.eps = road, .rms_m = road_rms_m};
        sum_wall(&w, az, el, far_m, side_m);
        const double rough =
            exp(-2 * pow(k_rad_m * wall_rms_m * cos(el), 2) - 2 * pow(k_rad_m * road_rms_m * sin(el), 2));
        for (int te = 0; te < 2; te++) {
            const double both = cabs(fresnel(concrete, cos(el), te) * fresnel(road, sin(el), te)) * rough;
            if (both < ground_least_coherence) continue;
            worst_rough = fmax(worst_rough, fabs(db(te ? w.hh : w.vv) - 10 * log10(peak * both * both)));
        }
    }
    print_message(
        "a wall on the ground, 4 to 46 degrees: metal %.4f dB, off its normal %.4f dB, concrete on a road %.4f dB\n",
        worst, worst_off, worst_rough);
    CHECK(worst < 0.1 && worst_off < 0.1 && worst_rough < 0.1);
}

/* From near, against an integral over the wall of exact paths: the image's path for what goes by the ground. */
static void near_walls_are_summed_as_waves_are_bent(void **state)
{
    (void)state;
    const double lambda_m = 2 * pi_rad / k_rad_m, a = 6, b = 4, el = 12 * rad_per_deg, az = 2e-3;
    double       worst = 0;
    for (int n = 0; n < 6; n++) {
        const double range_m = 300 * (1 << n / 2), side_m[2] = {0.25, 0.25};
        Wall         w = {.p = {0, 0, 0.5 * b},
                          .wide_m = a,
                          .high_m = b,
                          .by_ground = n % 2,
                          .facade = {.row = &even, .surface = metal},
                          .ground = {.eps = 1 - 1e12 * I}};
        CHECK(side_m[0] <= facade_piece_m(k_rad_m, range_m));
        const double tilt = w.by_ground ? el : 1e-3;
        sum_wall(&w, az, tilt, range_m, side_m);
        double complex sum = 0;
        const double   step_m = 0.02;
        const double  *e = w.look.p_enu;
        for (double x = -0.5 * a + 0.5 * step_m; x < 0.5 * a; x += step_m)
            for (double z = 0.5 * step_m; z < b; z += step_m) {
                const double there_m = sqrt(pow(e[0] - x, 2) + e[1] * e[1] + pow(e[2] - z, 2)),
                             image_m = sqrt(pow(e[0] - x, 2) + e[1] * e[1] + pow(e[2] + z, 2));
                sum += cexp(-I * k_rad_m * (there_m + (w.by_ground ? image_m : there_m) - 2 * range_m));
            }
        sum *= step_m * step_m * cos(tilt) / lambda_m * (w.by_ground ? 2 : 1);
        worst = fmax(worst, fabs(db(w.hh) - db(sum)));
        print_message("%s at %.0f m: %.2f dBsm, integral %.2f, from afar %.2f\n",
                      w.by_ground ? "by the ground" : "directly", range_m, db(w.hh), db(sum),
                      10 * log10((w.by_ground ? 16 : 4) * pi_rad * pow(a * b * cos(tilt) / lambda_m, 2)));
    }
    CHECK(worst < 0.1);
}

/* ---- what is scattered, and bumps ------------------------------------------------------------------ */

static void what_is_scattered_is_lamberts(void **state)
{
    (void)state;
    const RadarSurface brick = {.kind = RADAR_HALF_SPACE, .eps = 3.91 - 0.02 * I, .rough_m = 0.4e-3};
    const FacadeRow    row = {.scattered = {0.3, 0.4, 0.5}, .hv = 0.2, .uneven_length_m = 1};
    for (int n = 0; n < 3; n++) {
        const double cosine = cos(20 * n * rad_per_deg), s = 0.4;
        const double rough = exp(-4 * pow(k_rad_m * brick.rough_m * cosine, 2)), share = 1 - (1 - s * s) * rough;
        const double te = cabs(fresnel(brick.eps, cosine, true)), tm = cabs(fresnel(brick.eps, cosine, false));
        const double want = 4 * share * 0.5 * (te * te + tm * tm) * cosine * cosine;
        double       sum[3] = {0, 0, 0};
        const int    pieces = 20000;
        Facade       f = {
                  .plane = {.n = {0, 1, 0}, .s = {-1, 0, 0}, .t = {0, 0, 1}}, .row = &row, .surface = brick, .bumps = 5};
        FacadeLook look = {.p_enu = {0, 1e6 * cosine, 1e6 * sqrt(1 - cosine * cosine)},
                           .frequency_hz = frequency_hz,
                           .k = k_rad_m,
                           .band = CLUTTER_KA};
        for (int i = 0; i < pieces; i++) {
            const Piece   piece = {.i = i % 100,
                                   .j = i / 100,
                                   .corners = 4,
                                   .area_m2 = 0.25,
                                   .corner = {{0, 0}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}},
                                   .middle = {0.25, 0.25}};
            ScatterMatrix m, again;
            facade_echo(&m, &f, &piece, &look, false);
            facade_echo(&again, &f, &piece, &look, false);
            CHECK(memcmp(&m, &again, sizeof m) == 0 && m.hv == m.vh);
            sum[0] += 4 * pi_rad * scatter_power(m.hh) / 0.25, sum[1] += 4 * pi_rad * scatter_power(m.vv) / 0.25;
            sum[2] += 4 * pi_rad * scatter_power(m.hv) / 0.25;
        }
        CHECK_NEAR(facade_sigma0(&row, CLUTTER_KA, &brick, k_rad_m, cosine), want, 1e-12);
        print_message("scattered at %d degrees: sigma0 %.2f dB; of pieces %.2f, %.2f, HV %.2f\n", 20 * n,
                      10 * log10(want), 10 * log10(sum[0] / pieces), 10 * log10(sum[1] / pieces),
                      10 * log10(sum[2] / pieces));
        for (int p = 0; p < 3; p++) /* four standard errors of 20,000 exponential powers */
            CHECK_NEAR(sum[p] / pieces / want / (p == 2 ? 0.2 : 1), 1, 4 / sqrt(pieces));
    }
    CHECK(facade_sigma0(&row, CLUTTER_KA, &brick, k_rad_m, -0.1) == 0);
}

static void bumps_are_of_their_height_and_continuous(void **state)
{
    (void)state;
    const FacadeRow row = {.uneven_m = 3e-3, .uneven_length_m = 0.7};
    double          sum = 0, step = 0;
    const int       count = 40000;
    for (int n = 0; n < count; n++) {
        const double s = 700 * dice((uint64_t)n), t = 700 * dice((uint64_t)n + 1000000);
        const double h = facade_height(&row, 3, s, t);
        sum += h * h;
        step = fmax(step, fabs(facade_height(&row, 3, s + 1e-6, t) - h));
    }
    print_message("bumps: rms %.3f mm of 3; over a micrometre %.1e m\n", 1e3 * sqrt(sum / count), step);
    CHECK_NEAR(sqrt(sum / count) / row.uneven_m, 1, 0.02);
    CHECK(step < 1e-7); /* slopes of some tenths at most */
    CHECK(facade_height(&even, 3, 1, 2) == 0);
}

/* Bumps take from a wall's mirror what they should: exp(-(2 k h)^2) of the power, on average over walls. */
static void bumps_take_from_the_mirror(void **state)
{
    (void)state;
    const double   lambda_m = 2 * pi_rad / k_rad_m, a = 8, b = 8, side_m[2] = {0.125, 0.125};
    FacadeRow      row = {.material = "other", .uneven_m = 0.4e-3, .uneven_length_m = 0.5};
    double complex sum = 0;
    const int      walls = 12;
    for (int n = 0; n < walls; n++) {
        Wall w = {.p = {0, 0, 0.5 * b},
                  .wide_m = a,
                  .high_m = b,
                  .facade = {.row = &row, .surface = metal, .bumps = (uint64_t)n + 1}};
        sum_wall(&w, 0, 0, 1e8, side_m);
        sum += w.hh / walls;
    }
    const double want = exp(-0.5 * pow(2 * k_rad_m * row.uneven_m, 2)) * a * b / lambda_m;
    print_message("bumps of 0.4 mm: mean field %.3f of a plane's, %.3f by theory\n", cabs(sum) / (a * b / lambda_m),
                  want / (a * b / lambda_m));
    CHECK_NEAR(cabs(sum) / want, 1, 0.03); /* 12 walls of some 256 bumps */
}

/* ---- tables ----------------------------------------------------------------------------------------- */

static void tables_are_read_and_refused(void **state)
{
    (void)state;
    char        path[4096];
    FacadeTable table;
    ThingTable  things;
    CHECK(etc_path(path, sizeof path, "radar/facades.csv") && facade_table_open(&table, path) == STATUS_OK);
    assert_string_equal(facade_row(&table, "brick_red")->material, "brick");
    assert_string_equal(facade_row(&table, "no such thing")->material, "other");
    CHECK(etc_path(path, sizeof path, "radar/things.csv") && thing_table_open(&things, path) == STATUS_OK);
    const ThingRow *car = thing_row(&things, "car");
    CHECK(car && !thing_row(&things, "elephant"));
    const double side_m2 = pow(10, 0.1 * car->dbsm[CLUTTER_KA][3]);
    CHECK_NEAR(thing_rcs_m2(car, CLUTTER_KA, (const double[3]){0, -1, 0}), side_m2, 1e-9 * side_m2);
    CHECK_NEAR(thing_rcs_m2(car, CLUTTER_KA, (const double[3]){0, 1, 0}), side_m2, 1e-9 * side_m2);
    CHECK_NEAR(
        10 * log10(thing_rcs_m2(car, CLUTTER_KA, (const double[3]){cos(15 * rad_per_deg), sin(15 * rad_per_deg), 0})),
        0.5 * (car->dbsm[CLUTTER_KA][0] + car->dbsm[CLUTTER_KA][1]), 1e-9);
    static const char *const wrong[] = {
        "material,scattered_ku,scattered_ka,scattered_w,hv_vv_db,uneven_mm,uneven_m\nbrick,0.1,0.1,0.1,-8,1,1\n",
        "material,scattered_ku,scattered_ka,scattered_w,hv_vv_db,uneven_mm,uneven_m\nother,1.1,0.1,0.1,-8,1,1\n",
        "material,scattered_ku,scattered_ka,scattered_w,hv_vv_db,uneven_mm,uneven_m\nother,0,0,0,-8,1,1\nbrick,0,0,0,-8,1,1\n",
        "name,band,dbsm_0,dbsm_30,dbsm_60,dbsm_90,dbsm_120,dbsm_150,dbsm_180\ncar,Ka,1,1,1,1,1,1,1\n",
        "name,band,dbsm_0,dbsm_30,dbsm_60,dbsm_90,dbsm_120,dbsm_150,dbsm_180\ncar,Ka,1,1,1,1,1,1,1\ncar,Ka,1,1,1,1,1,1,1\n",
    };
    for (int n = 0; n < 5; n++) {
        strcpy(path, "/tmp/pitviper_facade_XXXXXX");
        const int fd = mkstemp(path);
        CHECK(fd >= 0 && write(fd, wrong[n], strlen(wrong[n])) == (ssize_t)strlen(wrong[n]) && close(fd) == 0);
        CHECK((n < 3 ? facade_table_open(&table, path) : thing_table_open(&things, path)) == STATUS_BAD_VALUE);
        CHECK(unlink(path) == 0);
    }
    CHECK(table.count > 10 && things.count > 5); /* as they were */
}

int main(void)
{
    k_rad_m = 2 * pi_rad * frequency_hz / light_mps;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_make_up_a_triangle),
        cmocka_unit_test(triangles_without_area_are_none),
        cmocka_unit_test(a_plate_is_a_plate),
        cmocka_unit_test(a_wall_on_the_ground_is_a_dihedral),
        cmocka_unit_test(near_walls_are_summed_as_waves_are_bent),
        cmocka_unit_test(what_is_scattered_is_lamberts),
        cmocka_unit_test(bumps_are_of_their_height_and_continuous),
        cmocka_unit_test(bumps_take_from_the_mirror),
        cmocka_unit_test(tables_are_read_and_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
