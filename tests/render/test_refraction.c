/* Ships over the horizon of a spherical sea, by rays that air bends: dip, hull-down and the places of hits by closed
 * forms; the same bits without skips and with any number of threads. labels: physics */
#include "tests/render/hand_sea.h"

/* k = 1.149 (terrain/earth/refraction.h), less by half a per cent of the air under the eye: 1 - exp(-h / 11 km). */
/* Of k = 1.149 (terrain/earth/refraction.h), less half a per cent of the air under the eye: (1 - 1/k) (1 - h / 22 km).
 */
static const double refracted = 0.12968 * 0.9955;

/* Distance of the horizon, and what it hides of a thing at y_m, by an Earth of the radius that makes rays straight. */
static double horizon_m(bool bent) { return sqrt(2 * earth_m * eye_m / (1 - (bent ? refracted : 0))); }
static double hidden_m(bool bent, double y_m)
{
    const double beyond_m = y_m - horizon_m(bent);
    return beyond_m > 0 ? beyond_m * beyond_m * (1 - (bent ? refracted : 0)) / (2 * earth_m) : 0;
}

/* North, 1 px = 0.02 mrad: a metre at 50 km. */
static View north(void)
{
    return hand_view((const double[3]){0, 0, eye_m}, (const double[3]){0, 1, -0.0052}, 200, 100, 50000);
}

static RenderRequest request_of(bool bent)
{
    const View    view = north();
    RenderRequest request = hand_request(&view);
    request.bands = 1 << BAND_OPTICAL;
    request.refraction = bent;
    return request;
}

/* The lowest line of sight that meets no sea, below the horizontal. */
static double find_dip_rad(const Visibility *v, bool bent)
{
    double low = 0, high = 0.02;
    for (int n = 0; n < 40; n++) {
        const double middle = 0.5 * (low + high), d_enu[3] = {0, cos(middle), -sin(middle)};
        if (hand_look(v, eye_m, d_enu, bent)->kind[0] == hit_ground) high = middle;
        else low = middle;
    }
    return low;
}

static const Visibility *see(bool bent, unsigned skips_off) { return hand_see(eye_m, bent, skips_off); }

/* The Nautical Almanac's dip is 1.76' sqrt(100 m) = 17.6' (k 1.198); of k 1.149 it is 17.97', without air 19.26'. */
static void the_horizon_dips(void **state)
{
    (void)state;
    hand_clear();
    arena_reset(hand.arena);
    const double bent = find_dip_rad(see(true, 0), true) / rad_per_deg * 60;
    CHECK_NEAR(bent, 17.6, 0.025 * 17.6);
    CHECK_NEAR(bent, 17.97, 0.02);
    CHECK_NEAR(find_dip_rad(see(true, 0), false) / rad_per_deg * 60, 19.26, 0.02); /* straight rays of the same frame */
    CHECK_NEAR(find_dip_rad(see(false, 0), true) / rad_per_deg * 60, 19.26, 0.02);
}

/* Of a ship 30 m high at 44 km the horizon at 38.3 km hides (44 - 38.3)^2 / (2 k R) = 2.3 m, without air 5.4 m. */
static void hulls_go_down(void **state)
{
    (void)state;
    for (int bent = 0; bent < 2; bent++)
        for (double y_m = 30e3; y_m < 57e3; y_m += 7e3) {
            hand_clear();
            put_ship(0, 0, y_m);
            arena_reset(hand.arena);
            const RenderRequest request = request_of(bent);
            const Picture       picture = hand_render(&request, hand.pool);
            const double        near_m = y_m - ship_half_m; /* the side that faces the eye */
            const double        want = 1 - hidden_m(bent, near_m) / tall_m;
            CHECK_NEAR(picture.target[0].visible / picture.target[0].amodal, want, 0.015);
        }
}

/* A ship 5 m high at 44 km: behind the horizon of straight rays, before that of bent ones. In the picture its metal
 * shines in the sun, where the sea is black. */
static void low_ships_come_into_sight(void **state)
{
    (void)state;
    hand_clear();
    put_ship(1, 0, 44e3);
    CHECK(hidden_m(false, 44e3) > low_m && hidden_m(true, 44e3) < 0.5 * low_m);
    for (int bent = 0; bent < 2; bent++) {
        const RenderRequest request = request_of(bent);
        double              lit = 0, pixels = 0;
        arena_reset(hand.arena);
        const Picture picture = hand_render(&request, hand.pool);
        for (int px = 0; px < picture.width * picture.height; px++) {
            pixels += picture.entity[px] == 1;
            if (picture.entity[px] == 1) lit += (double)picture.optical[0][px];
        }
        CHECK(bent ? picture.target[0].visible > 10 : picture.target[0].visible == 0);
        CHECK(bent ? pixels > 10 && lit > 0 : pixels == 0);
        CHECK(picture.target[0].projected);
        /* the top of its image: 50000 px times the slope to the far side of its deck, raised by 0.12968 d^2 / 2R */
        const double y_m = 44e3 + boat_half_m, lift_m = bent ? refracted * 44e3 * 44e3 / (2 * earth_m) : 0;
        const double deck_px = 50 + 50000 * ((eye_m - sea_m(0, 44e3) - low_m - lift_m) / y_m - 0.0052);
        CHECK_NEAR(picture.target[0].projected_box[1], deck_px, 0.1);
    }
}

/* Where things are, they are hit: the sea on its sphere, beyond the horizon of straight rays too, with its upper side;
 * a ship's side on that side. */
static void hits_are_where_things_are(void **state)
{
    (void)state;
    static Rays        rays;
    static Hits        hits;
    VisibilityCounters unused = {0};
    hand_clear();
    put_ship(0, 500, 20e3);
    arena_reset(hand.arena);
    int sea = 0, beyond = 0, ship = 0;
    rays.count = 600, rays.bent = true;
    for (int i = 0; i < rays.count; i++) {
        const double slope = i < 300 ? 0.0052 + 1e-6 * i : 0.0048 + 5e-6 * (i - 300);
        const double to[3] = {i < 300 ? -400 : 490, 20e3, eye_m - 20e3 * slope};
        double       d[3];
        v3_sub(d, to, (double[3]){0, 0, eye_m});
        v3_normalize(d, d);
        for (int k = 0; k < 3; k++) rays.o_enu[k][i] = k == 2 ? eye_m : 0, rays.d_enu[k][i] = d[k];
        rays.far_m[i] = INFINITY;
    }
    visibility_first_hit(&hits, see(true, 0), &rays, visibility_all_but(-1), &unused);
    for (int i = 0; i < rays.count; i++) {
        const double x = hits.p_enu[0][i], y = hits.p_enu[1][i], z = hits.p_enu[2][i];
        if (hits.kind[i] == hit_ground) {
            sea++, beyond += y > horizon_m(false);
            CHECK_NEAR(z, sea_m(x, y), 0.01);
            CHECK(hits.n_geo[2][i] > 0.99f && hits.n_enu[2][i] > 0.99f);
        } else if (hits.kind[i] == hit_part) {
            ship++;
            const double high_m = z - sea_m(500, 20e3); /* its side, or its deck */
            if (fabs(high_m - tall_m) > 1e-6) CHECK_NEAR(y, 20e3 - ship_half_m, 1e-6);
            CHECK(high_m > -1e-6 && high_m < tall_m + 1e-6 && fabs(y - 20e3) < ship_half_m + 1e-6);
            CHECK(!hits.inside[i]);
        }
    }
    CHECK(sea > 100 && beyond > 5 && ship > 100);
}

/* With two ships, and with so many that the tree is asked. */
static void skips_and_threads_change_nothing(void **state)
{
    (void)state;
    for (int many = 0; many < 2; many++) {
        hand_clear();
        for (int k = 0; k < (many ? 80 : 2); k++) put_ship(k % 7 > 0, 18 * (k % 9 - 4), 32e3 + 211 * k);
        RenderRequest request = request_of(true);
        Pool         *one;
        assert_int_equal(pool_create(&one, 1), STATUS_OK);
        arena_reset(hand.arena);
        const Picture a = hand_render(&request, hand.pool), b = hand_render(&request, one);
        request.skips_off = skips_all_off;
        const Picture c = hand_render(&request, hand.pool), *other[2] = {&b, &c};
        const size_t  px = (size_t)a.width * (size_t)a.height;
        for (int k = 0; k < 2; k++) {
            assert_memory_equal(a.entity, other[k]->entity, px * sizeof *a.entity);
            assert_memory_equal(a.range_m, other[k]->range_m, px * sizeof *a.range_m);
            assert_memory_equal(a.optical[0], other[k]->optical[0], px * sizeof(float));
            for (int e = 0; e < hand.snapshot.count; e++) {
                CHECK(a.target[e].visible == other[k]->target[e].visible);
                CHECK(a.target[e].amodal == other[k]->target[e].amodal);
            }
        }
        pool_destroy(one);
    }
}

/* Boats that are asked by the tree, with boxes about those that are posed; against one after the other. */
static void crowds_are_the_same(void **state)
{
    (void)state;
    static Rays        rays;
    static Hits        hits[2];
    VisibilityCounters unused = {0};
    int                met = 0;
    hand_clear();
    for (int k = 0; k < 80; k++) put_ship(1, 7 * (k % 27 - 13), 20e3 + 97 * k);
    arena_reset(hand.arena);
    const Visibility *v[2] = {see(true, 0), see(true, skips_all_off)};
    for (int k = 0; k < 80; k++) (void)visibility_posed(v[0], k);
    visibility_tighten(v[0]);
    rays.count = 960, rays.bent = true;
    for (int i = 0; i < rays.count; i++) { /* at 12 points of the face of each */
        const double x_m = 7 * (i / 12 % 27 - 13), y_m = 20e3 + 97 * (i / 12), up_m = 0.5 + i % 12 * 0.38;
        const double lift_m = refracted * (x_m * x_m + y_m * y_m) / (2 * earth_m);
        double       d[3] = {x_m, y_m - boat_half_m, sea_m(x_m, y_m) + up_m + lift_m - eye_m};
        v3_normalize(d, d);
        for (int k = 0; k < 3; k++) rays.o_enu[k][i] = k == 2 ? eye_m : 0, rays.d_enu[k][i] = d[k];
        rays.far_m[i] = INFINITY;
    }
    for (int k = 0; k < 2; k++) visibility_first_hit(&hits[k], v[k], &rays, visibility_all_but(-1), &unused);
    for (int i = 0; i < rays.count; i++) {
        met += hits[0].entity[i] == (uint32_t)(i / 12) + 1;
        CHECK(hits[0].entity[i] == hits[1].entity[i] && hits[0].range_m[i] == hits[1].range_m[i]);
    }
    CHECK(met > 900); /* few are hidden by others */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_horizon_dips),
        cmocka_unit_test(hulls_go_down),
        cmocka_unit_test(low_ships_come_into_sight),
        cmocka_unit_test(hits_are_where_things_are),
        cmocka_unit_test(skips_and_threads_change_nothing),
        cmocka_unit_test(crowds_are_the_same),
    };
    return cmocka_run_group_tests(tests, open_sea, hand_close);
}
