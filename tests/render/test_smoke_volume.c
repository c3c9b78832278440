/* Smoke along a ray, against what is known on paper: balls of one density, balls that fall off, two of them in either
 * order, a wall inside, a cavity of one temperature. labels: physics */
#include "tests/check.h"
#include "render/smoke/smoke.h"

static Rays           rays;
static double         far_m[hits_capacity];
static SmokeRays      out;
static const unsigned all_bands = (1u << smoke_bands) - 1;

static void one_ray(double x, double y, double far)
{
    rays.count = 1;
    rays.o_enu[0][0] = x, rays.o_enu[1][0] = y, rays.o_enu[2][0] = 0;
    rays.d_enu[0][0] = rays.d_enu[1][0] = 0, rays.d_enu[2][0] = 1;
    far_m[0] = far;
}

/* A ball above the origin; k is the same in all bands unless a test sets it. */
static SmokeVolume ball(double z_m, double radius_m, bool even, double k_per_m, double source)
{
    SmokeVolume v = {.p_enu = {0, 0, z_m},
                     .axis_enu = {1, 0, 0},
                     .along_m = radius_m,
                     .across_m = radius_m,
                     .range_m = z_m,
                     .even = even,
                     .d_sun_enu = {0, 0.6, 0.8}};
    for (int b = 0; b < smoke_bands; b++) v.extinction_per_m[b] = k_per_m, v.source[b] = source;
    return v;
}

static void look(const SmokeVolume *volume, int count)
{
    int list[256];
    CHECK(count <= 256);
    for (int i = 0; i < count; i++) list[i] = i;
    smoke_trace_rays(&out, volume, list, count, &rays, far_m, all_bands);
}

/* exp(-2 a k) through the centre, exp(-2 sqrt(a^2 - b^2) k) beside it, whatever the distance; thick ones read their
 * source. 1e-6: a float. */
static void even_ball_is_exact(void **state)
{
    (void)state;
    static const double radius_m[] = {0.3, 2, 40}, k_per_m[] = {0.001, 0.1, 2};
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < 3; k++)
            for (double off = 0; off < 1; off += 0.13)
                for (double z = 100; z < 3e4; z *= 7) {
                    const SmokeVolume v = ball(z, radius_m[r], true, k_per_m[k], 30);
                    one_ray(off * radius_m[r], 0, INFINITY);
                    look(&v, 1);
                    const double tau = exp(-2 * radius_m[r] * sqrt(1 - off * off) * k_per_m[k]);
                    CHECK_NEAR(out.transmittance[0][0], tau, 1e-6);
                    CHECK_NEAR(out.added[smoke_bands - 1][0], 30 * (1 - tau), 30 * 1e-6);
                }
    const SmokeVolume thick = ball(500, 5, true, 10, 38.5004239);
    one_ray(0, 0, INFINITY);
    look(&thick, 1);
    CHECK_NEAR(out.added[0][0], 38.5004239, 1e-5); /* 43 e-foldings: black */
    one_ray(5.01, 0, INFINITY);
    look(&thick, 1);
    CHECK(!out.any);
}

/* More volumes than are composed together: none is lost, whether one behind the other or all in one place. */
static void no_volume_is_lost(void **state)
{
    (void)state;
    enum { count = 250 };
    static SmokeVolume row[count];
    for (int apart = 0; apart < 2; apart++) {
        for (int i = 0; i < count; i++) row[i] = ball(100 + apart * 5.0 * i, 2, true, 0.005, 30);
        one_ray(0, 0, INFINITY);
        look(row, count);
        const double tau = exp(-count * 4 * 0.005);
        CHECK_NEAR(out.transmittance[0][0], tau, 1e-6);
        CHECK_NEAR(out.added[smoke_bands - 1][0], 30 * (1 - tau), 30 * 1e-6);
    }
    one_ray(0, 0, 100 + 5.0 * 100 + 2.5); /* a wall behind the first 101 */
    look(row, count);
    CHECK_NEAR(out.transmittance[0][0], exp(-101 * 4 * 0.005), 1e-6);
}

/* The quartic: 16/15 a through the centre, and a stretched one along its axis against numbers by Simpson's rule. */
static void soft_column_is_exact(void **state)
{
    (void)state;
    const double      o[3] = {0, 0, 0}, z[3] = {0, 0, 1};
    const SmokeVolume v = ball(50, 3, false, 1, 0);
    CHECK_NEAR(smoke_column_m(&v, o, z, 0, INFINITY), 16.0 / 15 * 3, 1e-12);
    SmokeVolume s = ball(50, 2, false, 1, 0);
    s.along_m = 9;
    s.axis_enu[0] = 0.48, s.axis_enu[1] = 0.6, s.axis_enu[2] = 0.64;
    double worst = 0;
    for (int i = 0; i < 200; i++) {
        double d[3] = {0.1 * (random_uniform(1, 1, 0, 3 * (uint64_t)i) - 0.5),
                       0.1 * (random_uniform(1, 1, 0, 3 * (uint64_t)i + 1) - 0.5), 1};
        v3_normalize(d, d);
        const double from = 40 + 10 * random_uniform(1, 1, 0, 3 * (uint64_t)i + 2), to = from + 8;
        double       sum = 0;
        enum { steps = 2000 };
        for (int n = 0; n <= steps; n++) {
            double       off[3], q2 = 0;
            const double at = from + (to - from) * n / steps;
            for (int k = 0; k < 3; k++) off[k] = at * d[k] - s.p_enu[k];
            const double along = v3_dot(off, s.axis_enu);
            q2 = along * along / 81 + (v3_dot(off, off) - along * along) / 4;
            const double f = q2 < 1 ? (1 - q2) * (1 - q2) : 0;
            sum += f * (n == 0 || n == steps ? 1 : n % 2 ? 4 : 2);
        }
        worst = fmax(worst, fabs(sum * (to - from) / steps / 3 - smoke_column_m(&s, o, d, from, to)));
    }
    /* the kink at the rim costs Simpson's rule about step^3 */
    CHECK(worst < 1e-6);
}

/* Two slabs (broad balls, seen through the middle) apart: the near one hides the far one, whichever is listed first. */
static void order_is_by_depth(void **state)
{
    (void)state;
    for (int swap = 0; swap < 2; swap++) {
        SmokeVolume v[2] = {ball(100, 2, true, 0.3, 10), ball(200, 5, true, 0.15, 70)};
        if (swap) {
            const SmokeVolume first = v[0];
            v[0] = v[1], v[1] = first;
        }
        one_ray(0, 0, INFINITY);
        look(v, 2);
        const double near = exp(-1.2), far = exp(-1.5);
        CHECK_NEAR(out.transmittance[3][0], near * far, 1e-6);
        CHECK_NEAR(out.added[3][0], 10 * (1 - near) + near * 70 * (1 - far), 1e-5);
    }
    /* a small one inside a large one: three stretches, the middle one mixed by depth */
    SmokeVolume v[2] = {ball(100, 5, true, 0.1, 10), ball(100, 2, true, 0.4, 70)};
    one_ray(0, 0, INFINITY);
    look(v, 2);
    const double outer = exp(-0.3), inner = exp(-2.0);
    CHECK_NEAR(out.transmittance[0][0], outer * inner * outer, 1e-6);
    CHECK_NEAR(out.added[0][0],
               10 * (1 - outer) + outer * (0.1 * 10 + 0.4 * 70) / 0.5 * (1 - inner) + outer * inner * 10 * (1 - outer),
               1e-5);
}

/* Only what is before the hit counts; from inside, only what is before the eye. */
static void solids_cut_it_off(void **state)
{
    (void)state;
    const SmokeVolume v = ball(100, 4, true, 0.2, 50);
    one_ray(0, 0, 101);
    look(&v, 1);
    CHECK_NEAR(out.transmittance[0][0], exp(-0.2 * 5), 1e-6);
    one_ray(0, 0, 95);
    look(&v, 1);
    CHECK(!out.any);
    const SmokeVolume about = ball(1, 4, true, 0.2, 50);
    one_ray(0, 0, INFINITY);
    look(&about, 1);
    CHECK_NEAR(out.transmittance[0][0], exp(-0.2 * 5), 1e-6);
    const SmokeVolume behind = ball(-10, 4, true, 0.2, 50);
    look(&behind, 1);
    CHECK(!out.any);
}

/* Many, textured, overlapping, at the temperature of what is behind them: nothing shows. */
static void one_temperature_shows_nothing(void **state)
{
    (void)state;
    SmokeVolume v[200];
    double      thinnest = 1;
    for (int i = 0; i < 200; i++) {
        v[i] = ball(80 + 40 * random_uniform(2, 1, 0, (uint64_t)i), 1 + 6 * random_uniform(2, 2, 0, (uint64_t)i), false,
                    0.01 + 0.1 * random_uniform(2, 3, 0, (uint64_t)i), 38.5);
        v[i].billow = 0.9;
        v[i].pattern[0] = 7.3 * i;
    }
    for (double x = -5; x < 5; x += 0.7) {
        one_ray(x, 0.3, 115 + 5 * x);
        look(v, 200);
        CHECK(out.any);
        float wall = 38.5f;
        smoke_apply(&wall, &out, 6, 1);
        CHECK_NEAR(wall, 38.5, 4e-5); /* some float steps of 38.5 */
        thinnest = fmin(thinnest, out.transmittance[6][0]);
    }
    CHECK(thinnest < 0.3);
}

/* More boundaries than cuts: the transmittance stays that of all columns together. */
static void joined_cuts_keep_the_column(void **state)
{
    (void)state;
    SmokeVolume v[60];
    double      depth = 0;
    for (int i = 0; i < 60; i++) {
        v[i] = ball(100 + 0.37 * i, 3, false, 0.005 + 0.0001 * i, i);
        depth += (0.005 + 0.0001 * i) * 16.0 / 15 * 3;
    }
    one_ray(0, 0, INFINITY);
    look(v, 60);
    CHECK_NEAR(out.transmittance[2][0], exp(-depth), 1e-6);
    /* and what it shows, against steps of a millimetre */
    double through = 1, added = 0;
    for (double at = 97; at < 126; at += 0.001) {
        double k = 0, shown = 0;
        for (int i = 0; i < 60; i++) {
            const double q = (at + 0.0005 - v[i].p_enu[2]) / 3, f = fabs(q) < 1 ? (1 - q * q) * (1 - q * q) : 0;
            k += v[i].extinction_per_m[0] * f;
            shown += v[i].extinction_per_m[0] * f * i;
        }
        if (!(k > 0)) continue;
        added += through * -expm1(-k * 0.001) * shown / k;
        through *= exp(-k * 0.001);
    }
    CHECK_NEAR(out.added[0][0], added, 0.01 * added); /* 24 cuts over 60 balls: 0.2 % here */
    CHECK_NEAR(out.transmittance[0][0], through, 1e-5);
}

/* The pattern moves the medium about; on the whole it is neither made nor lost. */
static void pattern_keeps_the_mass(void **state)
{
    (void)state;
    double sum = 0, plain = 0;
    for (int seed = 0; seed < 40; seed++) {
        SmokeVolume v = ball(100, 1, false, 1e-3, 0);
        for (int textured = 0; textured < 2; textured++) {
            v.billow = 0.9 * textured;
            v.pattern[0] = 31.7 * seed, v.pattern[1] = 5.1 * seed;
            for (double x = -0.975; x < 1; x += 0.05)
                for (double y = -0.975; y < 1; y += 0.05) {
                    one_ray(x, y, INFINITY);
                    look(&v, 1);
                    if (out.any) *(textured ? &sum : &plain) -= log(out.transmittance[0][0]);
                }
        }
    }
    CHECK_NEAR(sum / plain, 1, 0.15); /* over 40 seeds; the constant of pattern_stretch is set by this */
}

/* The sunlit side is the brighter one, and a thick cloud before the sun takes light away. */
static void lit_from_the_sun(void **state)
{
    (void)state;
    SmokeVolume v = ball(100, 5, false, 3, 0);
    v.d_sun_enu[0] = 1, v.d_sun_enu[1] = 0, v.d_sun_enu[2] = 0;
    for (int b = 0; b < smoke_bands; b++) v.sun[b][0] = 4, v.sun[b][1] = 2, v.sun[b][2] = 1;
    one_ray(3.5, 0, INFINITY);
    look(&v, 1);
    const double sunny = out.added[0][0];
    one_ray(-3.5, 0, INFINITY);
    look(&v, 1);
    CHECK(sunny > 3 * out.added[0][0] && sunny <= 7);
    v.sun_depth[0] = 2;
    one_ray(3.5, 0, INFINITY);
    look(&v, 1);
    CHECK(out.added[0][0] < 0.6 * sunny && out.added[0][0] > exp(-2.0) * sunny);
    /* hardly there: nothing shades it, and it shows its whole source for its depth */
    v = ball(100, 5, false, 1e-5, 0);
    v.sun[0][0] = 4, v.sun[0][1] = 2, v.sun[0][2] = 1;
    one_ray(0, 0, INFINITY);
    look(&v, 1);
    CHECK_NEAR(out.added[0][0], 7 * 1e-5 * 16.0 / 15 * 5, 4e-8); /* of the sun, 5e-5 is taken on its way in */
}

/* Whatever a block's rays meet is in its list; and a list leaves out most of a wide field. */
static void lists_miss_nothing(void **state)
{
    (void)state;
    enum { count = 300, side = 32 };
    static SmokeVolume v[count];
    View               view = {.width = 320, .height = 224, .focal_px = 300};
    const double       r[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0}; /* columns x right, y down, z north */
    memcpy(view.r_enu_from_cam, r, sizeof r);
    for (int i = 0; i < count; i++) {
        v[i] = ball(0, 0.5 + 5 * random_uniform(3, 1, 0, (uint64_t)i), false, 0.01, 1);
        v[i].along_m *= 1 + 3 * random_uniform(3, 5, 0, (uint64_t)i);
        for (int k = 0; k < 3; k++) v[i].p_enu[k] = 160 * (random_uniform(3, 2, (uint32_t)k, (uint64_t)i) - 0.5);
        v[i].range_m = v3_length(v[i].p_enu);
    }
    int listed = 0, blocks = 0;
    for (int y = 0; y < view.height; y += side)
        for (int x = 0; x < view.width; x += side, blocks++) {
            int         list[count], n = smoke_cull_block(list, v, count, &view, x, y, x + side, y + side);
            static bool in[count];
            memset(in, 0, sizeof in);
            for (int i = 0; i < n; i++) in[list[i]] = true;
            listed += n;
            for (int p = 0; p < 64; p++) {
                double       d[3];
                const double o[3] = {0, 0, 0};
                view_ray(d, &view, x + (p % 8 + 0.5) * side / 8, y + (p / 8 + 0.5) * side / 8);
                for (int i = 0; i < count; i++)
                    if (smoke_column_m(&v[i], o, d, 0, INFINITY) > 0) CHECK(in[i]);
            }
        }
    CHECK(listed < blocks * count / 10);
}

/* The list of a block holds the volumes whose balls, of their longer half axis and a thousandth, meet the cone about
 * its corners, and no others: of a centre at distance d and angle a off the cone's axis, d sin(a - half angle) is its
 * distance from the cone's side. Those whose ball lies behind the eye are not in it. Through a lens the corners are
 * those of the straight box about its curved sides. */
static void lists_hold_what_meets_the_cone(void **state)
{
    (void)state;
    enum { count = 300, side = 40 };
    static SmokeVolume v[count];
    const double       r[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0}; /* columns x right, y down, z north */
    for (int i = 0; i < count; i++) {
        v[i] = ball(0, 0.5 + 4 * random_uniform(5, 1, 0, (uint64_t)i), false, 0.01, 1);
        *(i % 2 ? &v[i].along_m : &v[i].across_m) *= 1 + 3 * random_uniform(5, 5, 0, (uint64_t)i);
        for (int k = 0; k < 3; k++)
            v[i].p_enu[k] = (i % 3 ? 100 : 30) * (random_uniform(5, 2, (uint32_t)k, (uint64_t)i) - 0.5);
    }
    for (int lens = 0; lens < 2; lens++) {
        View view = {.p_enu = {3, -4, 2}, .width = 320, .height = 240, .focal_px = 200};
        memcpy(view.r_enu_from_cam, r, sizeof r);
        if (lens) {
            const double k[3] = {-0.15, 0.02, 0}, p[2] = {0.002, -0.003}, half[2] = {0.8, 0.6};
            CHECK(view_lens_make(&view.lens, k, p, half) == STATUS_OK);
        }
        int within = 0, behind = 0;
        for (int y = 0; y < view.height; y += side)
            for (int x = 0; x < view.width; x += side) {
                int list[count], n = smoke_cull_block(list, v, count, &view, x, y, x + side, y + side), next = 0;
                const double edge_px[4] = {x, y, x + side, y + side};
                double       middle[3], box[4], half_rad = 0;
                view_ray(middle, &view, x + 0.5 * side, y + 0.5 * side);
                view_box_tangents(box, &view, edge_px);
                for (int c = 0; c < 4; c++) {
                    double       d[3];
                    const double d_cam[3] = {box[c % 2 ? 2 : 0], box[c > 1 ? 3 : 1], 1};
                    m3_mul_v3(d, view.r_enu_from_cam, d_cam);
                    half_rad = fmax(half_rad, acos(v3_dot(d, middle) / v3_length(d)));
                }
                for (int i = 0; i < count; i++) {
                    double       off[3];
                    const double reach = 1.001 * fmax(v[i].along_m, v[i].across_m);
                    v3_sub(off, v[i].p_enu, view.p_enu);
                    const double far = v3_length(off), off_rad = acos(v3_dot(off, middle) / far);
                    const double beside = far * sin(off_rad - half_rad) - reach, along = far * cos(off_rad) + reach;
                    const bool   in = next < n && list[next] == i;
                    next += in;
                    if (fabs(beside) < 1e-4 || fabs(along) < 1e-4) continue; /* half_rad from an arc cosine: 1e-8 rad */
                    CHECK(in == (beside < 0 && along > 0));
                    within += in, behind += beside < 0 && along < 0;
                }
                CHECK(next == n);
            }
        CHECK(within > 1000 && behind > 50);
    }
}

/* Volumes are looked up for sixteen rays from one point together, by a cone about them. To the bit they meet what each
 * meets beside a ray from elsewhere, for which no cone is made; those that only the outermost ray grazes, by 1e-4 of
 * the radius, and those about the eye among them. */
static void rays_together_are_rays_alone(void **state)
{
    (void)state;
    enum { count = 60, most = 40 };
    static SmokeRays alone;
    int              list[count], grazed = 0, inside = 0;
    for (int i = 0; i < count; i++) list[i] = i;
    for (uint32_t trial = 0; trial < 150; trial++) {
        static SmokeVolume v[count];
        static Rays        two;
        const int          many = trial % 5 == 0 ? 2 : 3 + (int)(random_uniform(6, 1, trial, 0) * (most - 3));
        const double  width = trial % 7 == 0 ? 1e-3 : 0.05 + 1.3 * random_uniform(6, 2, trial, 0), o[3] = {3, -2, 5};
        static double d[most][3];
        rays.count = many, two.count = 2;
        for (int n = 0; n < many; n++) { /* in one plane, so that the outermost are those of the cone */
            const double at = width * ((double)n / (many - 1) - 0.5);
            d[n][0] = sin(at), d[n][1] = 0, d[n][2] = cos(at);
            for (int k = 0; k < 3; k++) rays.o_enu[k][n] = o[k], rays.d_enu[k][n] = d[n][k];
            far_m[n] = INFINITY;
        }
        for (int i = 0; i < count; i++) {
            double u[6];
            for (int k = 0; k < 6; k++) u[k] = random_uniform(6, 3, trial, (uint64_t)(6 * i + k));
            v[i] = ball(0, 1 + 4 * u[3], true, 0.02, i);
            v[i].axis_enu[0] = 0, v[i].axis_enu[1] = 1;
            for (int k = 0; k < 3; k++) v[i].p_enu[k] = o[k] + 80 * (u[k] - 0.5);
            if (i % 3 ==
                0) { /* beside one of the outermost rays of this sixteen or that, its longer half axis towards it */
                const int    of = 16 * (int)(u[4] * (many - 1) / 16) + (u[5] < 0.5 ? 0 : 15);
                const double at = width * ((double)(of < many ? of : many - 1) / (many - 1) - 0.5);
                const double far = 1 + 60 * u[0], by = (u[5] < 0.5 ? -1 : 1) * (1 - 1e-4) * v[i].across_m;
                v[i].p_enu[0] = o[0] + far * sin(at) + by * cos(at), v[i].p_enu[1] = o[1];
                v[i].p_enu[2] = o[2] + far * cos(at) - by * sin(at);
                v[i].along_m *= u[1]; /* across is the longer */
            } else if (i % 7 == 1) {
                for (int k = 0; k < 3; k++) v[i].p_enu[k] = o[k] + (u[k] - 0.5) * v[i].across_m;
            }
            v[i].range_m = hypot(hypot(v[i].p_enu[0] - o[0], v[i].p_enu[1] - o[1]), v[i].p_enu[2] - o[2]);
        }
        smoke_trace_rays(&out, v, list, count, &rays, far_m, all_bands);
        for (int n = 0; n < many; n++) {
            for (int k = 0; k < 3; k++) {
                two.o_enu[k][0] = o[k], two.d_enu[k][0] = d[n][k];
                two.o_enu[k][1] = 1e5, two.d_enu[k][1] = k == 2;
            }
            smoke_trace_rays(&alone, v, list, count, &two, far_m, all_bands);
            for (int b = 0; b < smoke_bands && alone.any; b++) {
                CHECK(out.transmittance[b][n] == alone.transmittance[b][0]);
                CHECK(out.added[b][n] == alone.added[b][0]);
            }
            if (!alone.any) CHECK(!out.any || out.transmittance[0][n] == 1);
            for (int i = 0; i < count; i++) {
                const double column_m = smoke_column_m(&v[i], o, d[n], 0, INFINITY);
                grazed += column_m > 0 && column_m < 0.1, inside += v[i].range_m < v[i].across_m && column_m > 0;
            }
        }
    }
    CHECK(grazed > 500 && inside > 500);
}

/* More volumes than are prepared together, 512, from one point and from two: every one of them counts, and so does each
 * about that number. Every eleventh is a stretched one beside the rays, which meet its ball alone. */
static void hundreds_are_all_crossed(void **state)
{
    (void)state;
    enum { most = 1100 };
    static SmokeVolume row[most];
    static int         list[most];
    for (int i = 0; i < most; i++) {
        row[i] = ball(100 + 5.0 * i, 2, true, 0.0005, 30), list[i] = i;
        if (i % 11 == 0) row[i].p_enu[1] = 3, row[i].along_m = 4, row[i].across_m = 0.5;
    }
    for (int apart = 0; apart < 2; apart++)
        for (int k = 0; k < 7; k++) {
            const int count = (const int[]){511, 512, 513, 1023, 1024, 1025, most}[k];
            one_ray(0, 0, INFINITY);
            rays.count = 2, far_m[1] = INFINITY;
            for (int c = 0; c < 3; c++) rays.o_enu[c][1] = c == 0 ? 0.1 * apart : 0, rays.d_enu[c][1] = c == 2;
            smoke_trace_rays(&out, row, list, count, &rays, far_m, all_bands);
            for (int n = 0; n < 2; n++) {
                const double tau = exp(-(count - (count + 10) / 11) * 0.0005 * (n && apart ? 2 * sqrt(4 - 0.01) : 4));
                CHECK_NEAR(out.transmittance[0][n], tau, 1e-6);
                CHECK_NEAR(out.added[smoke_bands - 1][n], 30 * (1 - tau), 30 * 1e-6);
            }
        }
}

/* Rays beside the smoke keep their light in every band, those that cross it have it in the bands that were asked for,
 * and a source seen through 14 optical depths is still there: 1e6 exp(-14) = 0.8315 of it. */
static void only_what_crosses_changes(void **state)
{
    (void)state;
    const SmokeVolume v[2] = {ball(100, 2, true, 3.5, 1), ball(110, 2, true, 10, 1e6)};
    const int         list[2] = {0, 1};
    for (int b = -1; b < smoke_bands; b++) {
        one_ray(9, 0, INFINITY);
        rays.count = 3;
        for (int n = 1; n < 3; n++) {
            for (int k = 0; k < 3; k++) rays.o_enu[k][n] = rays.o_enu[k][0], rays.d_enu[k][n] = rays.d_enu[k][0];
            far_m[n] = INFINITY;
        }
        rays.o_enu[0][1] = 0;
        for (int k = 0; k < smoke_bands; k++)
            for (int n = 0; n < 3; n++) out.transmittance[k][n] = out.added[k][n] = 0.25f;
        smoke_trace_rays(&out, v, list, 2, &rays, far_m, b < 0 ? all_bands : 1u << b);
        CHECK(out.any);
        for (int k = 0; k < smoke_bands; k++) {
            for (int n = 0; n < 3; n += 2) CHECK(out.transmittance[k][n] == 1 && out.added[k][n] == 0);
            const bool asked = b < 0 || k == b;
            CHECK_NEAR(out.transmittance[k][1], asked ? exp(-54) : 1, 1e-12);
            CHECK_NEAR(out.added[k][1], asked ? 1 - exp(-14) + 1e6 * exp(-14) : 0, 1e-5);
            float light[3] = {8, 8, 8};
            smoke_apply(light, &out, k, 3);
            CHECK(light[0] == 8 && light[2] == 8);
            CHECK_NEAR(light[1], asked ? 1 - exp(-14) + 1e6 * exp(-14) : 8, 1e-5);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_ball_is_exact),
        cmocka_unit_test(no_volume_is_lost),
        cmocka_unit_test(soft_column_is_exact),
        cmocka_unit_test(order_is_by_depth),
        cmocka_unit_test(solids_cut_it_off),
        cmocka_unit_test(one_temperature_shows_nothing),
        cmocka_unit_test(joined_cuts_keep_the_column),
        cmocka_unit_test(pattern_keeps_the_mass),
        cmocka_unit_test(lit_from_the_sun),
        cmocka_unit_test(lists_miss_nothing),
        cmocka_unit_test(lists_hold_what_meets_the_cone),
        cmocka_unit_test(rays_together_are_rays_alone),
        cmocka_unit_test(hundreds_are_all_crossed),
        cmocka_unit_test(only_what_crosses_changes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
