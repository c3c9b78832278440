/* Change of the light at a point by what is near (hemisphere_change), where paper knows it: a sphere overhead, a closed
 * room, white bodies, the bright ring about the sun; and what meets nothing changes nothing. labels: physics */
#include "tests/render/change_stage.h"

static Hits             hits;
static HemisphereChange change[hits_capacity];

static const double up_enu[3] = {0, 0, 1}, overhead_enu[3] = {0, 0, 1};

/* ---- a sphere over level ground --------------------------------------------------------------- */

/* Means over the hemisphere above the origin, weighted by the cosine, of what a sphere of 1 m, its middle at `middle`,
 * hides and shows: a surface of n that reflects diffusely what the sky, the ground and the sun send it. */
typedef struct Quadrature {
    double hidden, sunlit, shown;
} Quadrature;

static Quadrature sphere_by_quadrature(const double middle[3], double rho, double sky, double ground,
                                       const double sun[3], double sun_w_m2)
{
    enum { steps = 600 };
    Quadrature sum = {0};
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < steps; k++) {
            const double u = (i + 0.5) / steps, turn = 2 * pi_rad * (k + 0.5) / steps;
            const double d[3] = {sqrt(u) * cos(turn), sqrt(u) * sin(turn), sqrt(1 - u)};
            const double b = v3_dot(d, middle), root = b * b - v3_dot(middle, middle) + sphere_m * sphere_m;
            if (!(b > 0 && root > 0)) continue;
            double n[3];
            for (int c = 0; c < 3; c++) n[c] = ((b - sqrt(root)) * d[c] - middle[c]) / sphere_m;
            const double facing = fmax(v3_dot(n, sun), 0);
            sum.hidden += 1, sum.sunlit += facing > 0;
            sum.shown += rho * (0.5 * (1 + n[2]) * sky + 0.5 * (1 - n[2]) * ground + facing * sun_w_m2 / pi_rad);
        }
    const double per = 1.0 / steps / steps;
    return (Quadrature){sum.hidden * per, sum.sunlit * per, sum.shown * per};
}

static void points_below(int count)
{
    hits.count = 0;
    for (int i = 0; i < count; i++) put_point(&hits, (const double[3]){0, 0, 0}, up_enu, 0);
}

static double mean_change(int band)
{
    double sum = 0;
    for (int i = 0; i < hits.count; i++) sum += (double)change[i].w_m2[band];
    return sum / hits.count;
}

/* Straight overhead it hides (R / h)^2 of a level plane's sky; elsewhere by quadrature. Optical: what it hides of the
 * sky less what it shows of sky, sun and sunlit ground. Thermal: it emits as the air and hides the sky. */
static void sphere_overhead(void **state)
{
    (void)state;
    enum { points = 8, samples = 512 };
    static const double middle[2][3] = {{0, 0, 3}, {1.5, -0.6, 2}};
    const double        sun[3] = {0.48, 0.36, 0.8}, night[3] = {0, 0.6, -0.8};
    for (int k = 0; k < 2; k++)
        for (int day = 0; day < 2; day++) {
            clear_bodies();
            add_body(model_sphere, middle[k], NULL);
            pose_bodies();
            set_rho(0.4, 0.25);
            set_air(day ? sun : night, day ? 500 : 0, 20, 12);
            points_below(points);
            change_of(change, &hits, 1u << AIR_R | 1u << AIR_LWIR, samples, 50, 50, 3, NULL);
            const double     ground = 0.25 * ((day ? 500 * 0.8 : 0) + 20 * pi_rad) / pi_rad;
            const Quadrature q = sphere_by_quadrature(middle[k], 0.4, 20, ground, day ? sun : night, day ? 500 : 0);
            if (k == 0) CHECK_NEAR(q.hidden, 1.0 / 9, 1e-3);
            double blocked = 0, sunlit = 0;
            for (int i = 0; i < points; i++) {
                blocked += (double)change[i].blocked / points, sunlit += (double)change[i].sunlit / points;
                CHECK(change[i].inside == 0 && change[i].w_m2[AIR_G] == 0 && change[i].w_m2[AIR_MWIR] == 0);
            }
            CHECK_NEAR(blocked / q.hidden, 1, 0.01);
            if (day) CHECK_NEAR(sunlit, q.sunlit, 0.02 * q.hidden);
            CHECK_NEAR(mean_change(AIR_R), pi_rad * (q.shown - 20 * q.hidden), 0.012 * 20 * q.hidden * pi_rad);
            const double     of_air = planck_table_radiance(stage.lwir, stage.air.light.weather.air_temp_k);
            const Quadrature warm = sphere_by_quadrature(middle[k], 0.4, 20, 12, night, 0);
            CHECK_NEAR(mean_change(AIR_LWIR), pi_rad * (warm.shown + (0.6 * of_air - 20) * q.hidden),
                       0.012 * 20 * q.hidden * pi_rad);
        }
}

/* A black sphere that a wall sees whole, at a distance h and an angle t from its normal, hides (R / h)^2 cos t of the
 * wall's light. Above the horizontal that is the sky's, below it the ground's; a level plane has none from below. */
static void sphere_above_or_below(void **state)
{
    (void)state;
    const double sun[3] = {0, 0.6, 0.8}, wall_enu[3] = {1, 0, 0};
    set_rho(0, 0.3);
    set_air(sun, 400, 20, 0);
    for (int k = 0; k < 3; k++) {
        const double middle[3][3] = {{3, 0.5, 2}, {3, 0.5, -2}, {0, 0, 3}}, *m = middle[k];
        const double h2 = v3_dot(m, m), hidden = (k == 2 ? m[2] : m[0]) / sqrt(h2) / h2;
        const double ground = 0.3 * (400 * 0.8 + 20 * pi_rad) / pi_rad;
        clear_bodies();
        add_body(model_sphere, (const double[3]){m[0], m[1], m[2] + 10}, NULL);
        pose_bodies();
        hits.count = 0;
        double all = 0, below = 0;
        for (int i = 0; i < 8; i++) put_point(&hits, (const double[3]){0, 0, 10}, k == 2 ? up_enu : wall_enu, 2);
        change_of(change, &hits, 1u << AIR_R, 4096, 50, 50, 11, NULL);
        for (int i = 0; i < 8; i++)
            all += (double)change[i].w_m2[AIR_R] / 8, below += (double)change[i].below_w_m2[AIR_R] / 8;
        CHECK_NEAR(all / (-pi_rad * hidden * (k == 1 ? ground : 20)), 1, 0.015);
        CHECK_NEAR(below / (-pi_rad * hidden * ground), k == 1, k == 1 ? 0.015 : 0);
        CHECK(change[0].below_w_m2[AIR_G] == 0);
    }
}

/* Radiance seen below the horizontal over level ground's: of a wall, half of whose hemisphere is ground; of a plane
 * that looks up, as if a sixteenth were. */
static void factor_below(void **state)
{
    (void)state;
    CHECK_NEAR(hemisphere_below(-0.25 * pi_rad * 8, 8, 0), 0.5, 1e-15);
    CHECK_NEAR(hemisphere_below(pi_rad * 8, 8, -1), 2, 1e-15);
    CHECK_NEAR(hemisphere_below(-pi_rad / 64, 1, 1), 0.75, 1e-15);
    CHECK_NEAR(hemisphere_below(-pi_rad / 64, 1, 0.95), 0.75, 1e-15);
    CHECK(hemisphere_below(-9, 1, 0) == 0 && hemisphere_below(1e6, 1, 0) == 100 && hemisphere_below(5, 0, 0) == 1);
}

/* What is beyond the reach of a ray changes nothing, nor, for a point on the ground, what is beyond the list's. */
static void reach_is_an_end(void **state)
{
    (void)state;
    clear_bodies();
    add_body(model_sphere, (const double[3]){0, 0, 6}, NULL);
    pose_bodies();
    set_rho(0, 0);
    set_air(overhead_enu, 0, 20, 20);
    points_below(4);
    static const double reach_m[6][2] = {{50, 50}, {5.1, 50}, {4.9, 50}, {50, 5.1}, {50, 4.9}, {5.6, 5.1}};
    static const bool   met[6] = {true, true, false, true, false, true};
    for (int k = 0; k < 6; k++) {
        change_of(change, &hits, 1u << AIR_R, 256, reach_m[k][0], reach_m[k][1], 1, NULL);
        CHECK(met[k] ? change[0].blocked > 0 : change[0].blocked == 0 && change[0].w_m2[AIR_R] == 0);
        if (reach_m[k][0] > 5.5) CHECK(!met[k] || fabs((double)change[0].blocked - 1.0 / 36) < 0.006);
    }
    /* a point on a body is not asked whose reach it is in */
    hits.entity[0] = hits.entity[1] = 1;
    change_of(change, &hits, 1u << AIR_R, 256, 50, 1, 1, NULL);
    CHECK(change[0].blocked > 0 && change[2].blocked == 0);
}

/* ---- many orders ------------------------------------------------------------------------------ */

/* Inside a closed room as warm as the air, of reflectance r, three bounces show B (1 - r^3) and, of the quick form, r^3
 * of sky and ground; of light from outside, r^3 of that alone. Of even surroundings L the change is pi (1 - r^3)(B - L)
 * without noise: half of the paths go on, with double weight. All of it is met from within. */
static void closed_room(void **state)
{
    (void)state;
    static const double rho[] = {0, 0.3, 0.7, 1};
    clear_bodies();
    add_body(model_room, (const double[3]){3, 2, 5}, NULL);
    pose_bodies();
    for (int r = 0; r < 4; r++) {
        set_rho(rho[r], 1);
        set_air((const double[3]){0.6, 0, 0.8}, 0, 5, 5);
        hits.count = 0;
        for (int i = 0; i < 12; i++) {
            double n[3];
            hand_direction(n);
            put_point(&hits,
                      (const double[3]){3 + hand_uniform(-9, 9), 2 + hand_uniform(-9, 9), 5 + hand_uniform(-9, 9)}, n,
                      1 - i % 2);
        }
        change_of(change, &hits, 1u << AIR_B | 1u << AIR_LWIR, 64, 50, 50, (uint64_t)r, NULL);
        const double r3 = pow((float)rho[r], 3),
                     b = planck_table_radiance(stage.lwir, stage.air.light.weather.air_temp_k);
        for (int i = 0; i < hits.count; i++) {
            CHECK_NEAR(change[i].w_m2[AIR_LWIR], pi_rad * (1 - r3) * (b - 5), 2e-4);
            CHECK_NEAR(change[i].w_m2[AIR_B], -pi_rad * (1 - r3) * 5, 2e-5);
            CHECK(change[i].blocked == 1 && change[i].inside == 1 && change[i].sunlit == 0);
            /* of 64 directions those below, to within four */
            const double down = 0.5 * (1 - (double)hits.n_enu[2][i]);
            CHECK_NEAR(change[i].below_w_m2[AIR_LWIR], pi_rad * (1 - r3) * (b - 5) * down,
                       4.0 / 64 * pi_rad * (1 - r3) * fabs(b - 5) + 2e-4);
        }
    }
}

/* Bodies that reflect all, in even surroundings, change nothing, whatever stands about. */
static void white_bodies_vanish(void **state)
{
    (void)state;
    clear_bodies();
    hand_draw = 11;
    for (int k = 0; k < 6; k++) {
        double r[9];
        hand_rotation(r);
        add_body(k % 2 ? model_sphere : model_brick,
                 (const double[3]){hand_uniform(-5, 5), hand_uniform(-5, 5), hand_uniform(1, 5)}, r);
    }
    pose_bodies();
    set_rho(1, 1);
    set_air((const double[3]){0.6, 0, -0.8}, 0, 5, 5);
    hits.count = 0;
    for (int i = 0; i < 20; i++)
        put_point(&hits, (const double[3]){hand_uniform(-8, 8), hand_uniform(-8, 8), 0}, up_enu, i % 2);
    change_of(change, &hits, 1u << AIR_NIR, 64, 50, 50, 7, NULL);
    double blocked = 0;
    for (int i = 0; i < hits.count; i++) {
        CHECK_NEAR(change[i].w_m2[AIR_NIR], 0, 2e-5);
        blocked += (double)change[i].blocked;
    }
    CHECK(blocked > 2);
}

/* ---- rays that may meet ----------------------------------------------------------------------- */

/* From the ground only rays that may meet a body are traced, from a body all: the same, to the bit, of the same point.
 */
static void rays_left_out_meet_nothing(void **state)
{
    (void)state;
    hand_draw = 5;
    for (int round = 0; round < 6; round++) {
        static HemisphereChange all[hits_capacity];
        clear_bodies();
        for (int k = 0; k < 5; k++) {
            double r[9];
            hand_rotation(r);
            add_body(k == 4 ? model_sphere : model_brick,
                     (const double[3]){hand_uniform(-9, 9), hand_uniform(-9, 9), hand_uniform(-3, 6)}, r);
        }
        pose_bodies();
        set_rho(0.5, 0.3);
        set_air((const double[3]){0.6, 0, 0.8}, 300, 5, 5);
        for (int body = 0; body < 2; body++) {
            hand_draw = 1000 + (uint64_t)round;
            hits.count = 0;
            for (int i = 0; i < 40; i++) {
                double n[3];
                hand_direction(n);
                n[2] = fabs(n[2]);
                put_point(&hits, (const double[3]){hand_uniform(-12, 12), hand_uniform(-12, 12), hand_uniform(0, 2)}, n,
                          body);
            }
            change_of(body ? all : change, &hits, 1u << AIR_PAN, 64, round < 3 ? 50 : 6, 60, 9, NULL);
        }
        for (int i = 0; i < hits.count; i++)
            CHECK(change[i].blocked == all[i].blocked && change[i].w_m2[AIR_PAN] == all[i].w_m2[AIR_PAN] &&
                  change[i].inside == all[i].inside);
    }
}

/* ---- the ring about the sun ------------------------------------------------------------------- */

/* A sky of 5 and a ring of 30 (1 - sqrt(angle / edge)) more within the edge, pi (6 / 24)^2 = 0.196 rad: nodes of its
 * table. A plane facing the sun has from it 2 pi int 30 (1 - sqrt(a / edge)) cos a sin a da; one that is tilted the
 * cosine of that. */
static const double edge_rad = pi_rad / 16;

static double ring_by_quadrature(void)
{
    enum { steps = 20000 };
    double sum = 0;
    for (int k = 0; k < steps; k++) {
        const double a = edge_rad * (k + 0.5) / steps;
        sum += 2 * pi_rad * 30 * (1 - sqrt(a / edge_rad)) * cos(a) * sin(a) * edge_rad / steps;
    }
    return sum;
}

static void set_ring(void)
{
    AirSky *sky = &stage.air.light.sky[AIR_R];
    for (int i = 0; i <= air_sky_ups; i++)
        for (int a = 0; a <= air_sky_azimuths; a++) sky->scattered_w_m2_sr[i][a] = 1;
    for (int k = 0; k < air_sky_angles + 2; k++) sky->around_sun[k] = k < 6 ? 5 * (6 - (float)k) : 0;
}

/* A black sphere before the sun takes the ring and what it hides of the even sky; one beside it, of the same size, the
 * latter alone. A grey plane of bricks in the shadow of another loses the ring by its cosine. */
static void ring_goes_with_the_sun(void **state)
{
    (void)state;
    enum { points = 100 };
    const double sun[3] = {0, 0.6, 0.8};
    for (int before = 0; before < 2; before++) {
        const double towards[3] = {before ? 0 : 0.6, before ? 0.6 : 0, 0.8};
        clear_bodies();
        add_body(model_sphere, (const double[3]){3 * towards[0], 3 * towards[1], 3 * towards[2]}, NULL);
        pose_bodies();
        set_rho(0, 0);
        set_air(sun, 500, 5, 5);
        set_ring();
        points_below(points);
        change_of(change, &hits, 1u << AIR_R, 256, 50, 50, 2, NULL);
        /* a sphere all above the horizon hides (R / h)^2 of a plane that faces it */
        const double hidden = 5 * pi_rad * 0.8 / 9, ring = before ? 0.8 * ring_by_quadrature() : 0;
        CHECK_NEAR(mean_change(AIR_R), -hidden - ring, 0.015 * (hidden + ring));
    }
    /* by night there is none, and below the horizon no ray goes */
    set_air((const double[3]){0, 0.6, -0.8}, 0, 5, 5);
    set_ring();
    change_of(change, &hits, 1u << AIR_R, 256, 50, 50, 2, NULL);
    CHECK_NEAR(mean_change(AIR_R), -5 * pi_rad * 0.8 / 9, 0.02 * 5 * pi_rad * 0.8 / 9);
}

/* A brick of reflectance 0.5 whose level top, 4 m square below, faces a sun that another brick hides: seen from a point
 * that faces down, straight above it, it shows what it does under this sky less 0.5 of the ring by the sun's cosine.
 * The change is that of the same sky without its ring, less that. */
static void shadows_lose_the_ring(void **state)
{
    (void)state;
    const double sun[3] = {0, 0.6, 0.8}, down_enu[3] = {0, 0, -1};
    double       found[2], blocked = 0;
    for (int ring = 0; ring < 2; ring++) {
        clear_bodies();
        add_body(model_brick, (const double[3]){0, 0, 0}, NULL);               /* its top at 1 m */
        add_body(model_brick, (const double[3]){0, 0.3 + 6, 8.4 + 0.3}, NULL); /* between that and the sun */
        pose_bodies();
        set_rho(0.5, 0);
        set_air(sun, 0, 5, 0);
        if (ring) set_ring();
        hits.count = 0;
        for (int i = 0; i < 40; i++) put_point(&hits, (const double[3]){0.5, 0.25, 1.4}, down_enu, 1);
        change_of(change, &hits, 1u << AIR_R, 128, 50, 50, 4, NULL);
        found[ring] = mean_change(AIR_R), blocked = (double)change[0].blocked;
        CHECK(change[0].sunlit == 0);
    }
    CHECK(blocked > 0.7);
    CHECK_NEAR((found[1] - found[0]) / (-0.5 * blocked * 0.8 * ring_by_quadrature()), 1, 0.012);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_overhead),
        cmocka_unit_test(sphere_above_or_below),
        cmocka_unit_test(factor_below),
        cmocka_unit_test(reach_is_an_end),
        cmocka_unit_test(closed_room),
        cmocka_unit_test(white_bodies_vanish),
        cmocka_unit_test(rays_left_out_meet_nothing),
        cmocka_unit_test(ring_goes_with_the_sun),
        cmocka_unit_test(shadows_lose_the_ring),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
