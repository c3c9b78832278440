/* A ray's light is its own: the same bits in a list of one, of seven, of a block or of five thousand. And a hit says
 * what it is. */
#include "tests/render/hand_world.h"

#include "tests/render/shade_list.h"

enum { all_rays = 5000 };
static const double sun_enu[3] = {-0.6, 0, 0.8}, eye_enu[3] = {0, 0, 60};

static Arena     *arena; /* of the scene */
static ShadeScene scene;
static Shader    *shader;
static Samples    block;
static double     o_enu[3][all_rays], d_enu[3][all_rays];
static uint64_t   key[all_rays];

static int open_world(void **state)
{
    (void)state;
    if (hand_open(true) != 0) return -1;
    arena = arena_create();
    return arena && (shader = arena_alloc(arena, 1, sizeof *shader)) &&
                   shade_samples_create(&block, hits_capacity, arena) == STATUS_OK
               ? 0
               : -1;
}

static int close_world(void **state)
{
    arena_destroy(arena);
    return hand_close(state);
}

static void pose(int sky_samples)
{
    const View    view = hand_view(eye_enu, (const double[3]){1, 0, -0.3}, 64, 64, 60);
    RenderRequest request = hand_request(&view);
    double        r[9];
    hand_air_on(sun_enu, 60);
    hand_clear();
    for (int k = 0; k < 6; k++) {
        const double p_enu[3] = {30 + 3 * k, -9 + 4 * k, 50 + k};
        hand_attitude(r, pi_rad + 0.3 * k, 0);
        hand_add(k % 2 ? hand_sphere_model : hand_plate_model, p_enu, r);
    }
    request.sky_samples = sky_samples;
    scene = (ShadeScene){.world = &hand.world, .snapshot = &hand.snapshot, .air = &hand.air};
    assert_int_equal(shade_scene_create(&scene, &request, (1u << AIR_BAND_COUNT) - 1, NULL, arena), STATUS_OK);
    for (int i = 0; i < all_rays; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = random_uniform(3, (uint32_t)k, 0, (uint64_t)i) - 0.5;
        if (i % 2) { /* towards the models */
            const int    e = i / 2 % 6;
            const double to[3] = {30 + 3 * e, -9 + 4 * e, 50 + e + 0.9};
            for (int k = 0; k < 3; k++) d[k] = 2 * d[k] + to[k] - eye_enu[k];
        }
        v3_normalize(d, d);
        for (int k = 0; k < 3; k++) o_enu[k][i] = eye_enu[k] + (i % 3), d_enu[k][i] = d[k];
        key[i] = (uint64_t)i * 77;
    }
}

static RayList list_from(int first, int count)
{
    return (RayList){.count = count,
                     .o_enu = {o_enu[0] + first, o_enu[1] + first, o_enu[2] + first},
                     .d_enu = {d_enu[0] + first, d_enu[1] + first, d_enu[2] + first},
                     .key = key + first,
                     .per_rad = 60,
                     .channels = (1u << AIR_BAND_COUNT) - 1,
                     .radar = true,
                     .temperature = true};
}

static void compare(const ShadedRays *all, const ShadedRays *some, int first, int count)
{
    const size_t n = (size_t)count;
    assert_memory_equal(all->range_m + first, some->range_m, n * sizeof(double));
    assert_memory_equal(all->entity + first, some->entity, n * sizeof(uint32_t));
    assert_memory_equal(all->material + first, some->material, n * sizeof(uint16_t));
    assert_memory_equal(all->sun + first, some->sun, n * sizeof(float));
    assert_memory_equal(all->temp_k + first, some->temp_k, n * sizeof(float));
    assert_memory_equal(all->radar_power + first, some->radar_power, n * sizeof(float));
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        assert_memory_equal(all->radiance[b] + first, some->radiance[b], n * sizeof(float));
}

static void a_ray_is_shaded_the_same_in_any_list(void **state)
{
    static const int length[] = {1, 7, 1024}, until[] = {40, 700, all_rays};
    (void)state;
    for (int gathered = 0; gathered < 2; gathered++) {
        const int  rays = gathered ? 1400 : all_rays;
        ShadedRays all, some;
        arena_reset(hand.arena);
        pose(gathered ? 2 : 0);
        assert_int_equal(shaded_rays_create(&all, rays, hand.arena), STATUS_OK);
        assert_int_equal(shaded_rays_create(&some, hits_capacity, hand.arena), STATUS_OK);
        const RayList whole = list_from(0, rays);
        shade_list(&all, &whole, shader, &scene, &block);
        for (int n = 0; n < 3; n++)
            for (int first = 0; first < rays && first < until[n]; first += length[n]) {
                const int     count = rays - first < length[n] ? rays - first : length[n];
                const RayList part = list_from(first, count);
                shade_list(&some, &part, shader, &scene, &block);
                compare(&all, &some, first, count);
            }
    }
}

static void a_hit_says_what_it_is(void **state)
{
    (void)state;
    int        kinds[3] = {0};
    ShadedRays all;
    arena_reset(hand.arena);
    pose(0);
    assert_int_equal(shaded_rays_create(&all, all_rays, hand.arena), STATUS_OK);
    const RayList whole = list_from(0, all_rays);
    shade_list(&all, &whole, shader, &scene, &block);
    const Materials *m = &hand.world.materials;
    for (int i = 0; i < all_rays; i++) {
        kinds[all.kind[i]]++;
        const HitKind want = !(all.range_m[i] < INFINITY) ? hit_sky : all.entity[i] ? hit_part : hit_ground;
        assert_int_equal(all.kind[i], want);
        if (want == hit_part) {
            const Model *model = catalog_model(hand.catalog, hand.entity[all.entity[i] - 1].model);
            assert_string_equal(m->material[all.material[i]].name, "brick_red");
            assert_int_equal(model->triangle_part[all.facet[i]], all.part[i] - 1);
        } else {
            assert_int_equal(all.material[i], want == hit_ground ? m->surface[all.surface[i]] : 0);
        }
        CHECK(all.sun[i] == 0 || all.sun[i] == 1);
    }
    CHECK(kinds[hit_sky] > 100 && kinds[hit_ground] > 100 && kinds[hit_part] > 100);

    /* a place on a part turns with it: the last block's hits on spheres lie on a sphere about the node's origin */
    int spheres = 0;
    for (int i = 0; i < block.hits.count; i++) {
        double p_node[3];
        if (block.hits.kind[i] != hit_part || (block.hits.entity[i] - 1) % 2 == 0) continue;
        double n_node[3];
        visibility_on_part(p_node, n_node, scene.visibility, &block.hits, i, (const double[3]){0, 0, 1});
        CHECK_NEAR(v3_length(p_node), hand_sphere_m, 0.01 * hand_sphere_m);
        /* and on the plane of its own facet, which no other shares */
        const Model    *model = catalog_model(hand.catalog, hand.entity[block.hits.entity[i] - 1].model);
        const uint32_t *corner = model->triangle[block.hits.facet[i]];
        double          origin[3], ab[3], ac[3], n[3];
        v3_scale(origin, 1, model->vertex[corner[0]]);
        v3_sub(ab, model->vertex[corner[1]], origin);
        v3_sub(ac, model->vertex[corner[2]], origin);
        v3_cross(n, ab, ac);
        CHECK(v3_normalize(n, n));
        v3_sub(p_node, p_node, origin);
        CHECK_NEAR(v3_dot(p_node, n), 0, 1e-9);
        spheres++;
    }
    CHECK(spheres > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_is_shaded_the_same_in_any_list),
        cmocka_unit_test(a_hit_says_what_it_is),
    };
    return cmocka_run_group_tests(tests, open_world, close_world);
}
