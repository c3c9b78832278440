/* tests/render/test_vehicle_nodes.c: nodes and surfaces of vehicles' networks besides their skin in the air: a skin
 * as its sidecar says, fuel, the ground under tracks and wheels, water about hulls.
 * labels: physics */
#include "tests/render/vehicle_stage.h"

#include "render/heat/surface_flux_private.h"

#include <sys/stat.h>
#include <unistd.h>

static PlaceHeat weather;

static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)unix_s, (void)p_enu, (void)present;
    *out = weather;
    return STATUS_OK;
}

/* All around at one temperature; no sun. */
static void enclose(double temp_k)
{
    weather = (PlaceHeat){.air_k = temp_k,
                          .air_density = 1,
                          .longwave_w_m2 = stefan_w_m2k4 * pow(temp_k, 4),
                          .ground_k = temp_k,
                          .under_k = temp_k,
                          .water_k = temp_k,
                          .ground_rho = 0.2,
                          .sun_d_enu = {0, 0, 1}};
}

static VehicleHeat *start(void)
{
    return stage_start(&(VehicleHeatConfig){.step_s = 30, .window_us = INFINITY, .place = everywhere}, NULL);
}

static void run(VehicleHeat *heat, Scene *s, double from_s, double to_s)
{
    for (s->snapshot.t_s = from_s; s->snapshot.t_s < to_s; s->snapshot.t_s += 10)
        CHECK(vehicle_heat_tick(heat, &s->snapshot) == STATUS_OK);
    s->snapshot.t_s = to_s;
    CHECK(vehicle_heat_tick(heat, &s->snapshot) == STATUS_OK);
    CHECK(vehicle_heat_counters(heat)->failed == 0);
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 7, 1, 0, 0},
                           ship = {1, 3, 225, 6, 1, 0, 0}, jet = {1, 2, 225, 1, 0, 0, 0};

/* Range over the outer patches of a role (HEAT_ROLE_COUNT: all) whose centres lie between two heights over the base. */
static void range_k(double *low_k, double *high_k, const VehicleHeat *heat, Scene *s, HeatRole role, double above_m,
                    double below_m)
{
    CHECK(vehicle_heat_show(heat, &s->snapshot, stage.arena) == STATUS_OK && s->entity.first_patch == 0);
    const Patches *p = &stage.patches.of[s->entity.model];
    const Model   *m = tracer_model(stage.tracer, s->entity.model);
    NodePose      *pose = calloc((size_t)m->node_count, sizeof *pose);
    int            count = 0;
    model_pose(pose, m, NULL);
    *low_k = INFINITY, *high_k = -INFINITY;
    for (int i = 0; i < p->count; i++) {
        double p_body[3];
        if ((role != HEAT_ROLE_COUNT && p->patch[i].role != role) || !(p->patch[i].open_share > 0)) continue;
        m3_mul_v3(p_body, pose[p->patch[i].node].r_body_from_node, p->patch[i].p_node);
        v3_add(p_body, p_body, pose[p->patch[i].node].p_body);
        if (-p_body[2] < above_m || -p_body[2] > below_m) continue;
        *low_k = fmin(*low_k, (double)s->snapshot.patch_k[i]), *high_k = fmax(*high_k, (double)s->snapshot.patch_k[i]);
        count++;
    }
    CHECK(count > 0);
    free(pose);
}

/* A cube of 1 m by OBJ, material and thickness by its sidecar: capacity is density times heat capacity times
 * thickness times area, conduction through it and along it conductivity's. */
static void a_skin_is_as_its_sidecar_says(void **state)
{
    (void)state;
    static const struct {
        const char *yaml, *material;
        double      thickness_m;
    } c[] = {
        {"materials: {\"*\": paint_olive}\nroles: {\"*\": hull}\nthickness_mm: {\"*\": 8}\n", "paint_olive", 0.008},
        {"materials: {\"*\": paint_olive}\nroles: {\"*\": hull}\nthickness_mm: {other: 8}\n", "paint_olive",
         0.025}, /* by role */
        {"node_materials: {block: rubber_black}\nroles: {\"*\": hull}\nthickness_mm: {\"*\": 3, block: 50}\n",
         "rubber_black", 0.05},
        {"materials: {\"*\": metal_aluminium_bare}\nroles: {\"*\": passive}\nthickness_mm: {\"*\": 1.5}\n",
         "metal_aluminium_bare", 0.0015}};
    char obj[text_file_size + 8], yaml[text_file_size + 8], catalog_path[text_file_size], text[512], materials[512],
        surfaces[512], stem[text_file_size];
    text_file(stem, "");
    snprintf(obj, sizeof obj, "%s.obj", stem), snprintf(yaml, sizeof yaml, "%s.yaml", stem);
    FILE *f = fopen(obj, "w");
    CHECK(
        f &&
        fputs(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\no block\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\n"
            "f 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
            f) >= 0 &&
        fclose(f) == 0);
    snprintf(text, sizeof text, "type,model,origin\n1.1.*,%s,base\n", obj);
    text_file(catalog_path, text);
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        Catalog     *catalog = NULL;
        Materials    of = {0};
        VehicleShape shape = {0};
        Patches      patches;
        f = fopen(yaml, "w");
        CHECK(f && fputs(c[k].yaml, f) >= 0 && fclose(f) == 0);
        CHECK(catalog_open(&catalog, catalog_path, 0.01) == STATUS_OK);
        CHECK(etc_path(materials, sizeof materials, "materials.csv") &&
              etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
        CHECK(materials_open(&of, materials, surfaces, catalog) == STATUS_OK);
        const int index = catalog_find(catalog, tank, NULL, NULL);
        Tracer   *tracer;
        CHECK(tracer_create(&tracer, catalog, "avx2") == STATUS_OK && tracer_need(tracer, index) == STATUS_OK);
        const Model *model = tracer_model(tracer, index);
        CHECK_NEAR(model->part[0].thickness_m, k == 1 ? 0 : c[k].thickness_m, 1e-15);
        CHECK(patches_create(&patches, model) == STATUS_OK);
        CHECK(vehicle_shape_create(&shape, &patches, model, index, &stage.table, &of) == STATUS_OK);
        const Material *m = NULL;
        for (int i = 0; i < of.count; i++)
            if (strcmp(of.material[i].name, c[k].material) == 0) m = &of.material[i];
        CHECK(m != NULL);
        const double rho_c = (double)m->density_kg_m3 * (double)m->heat_capacity_j_kgk;
        double       skin_j_k = 0;
        for (int n = 0; n < shape.nodes; n++)
            if (n != shape.engine && n != shape.cabin && n != shape.fuel) skin_j_k += shape.capacity_j_k[n];
        CHECK_NEAR(skin_j_k / (rho_c * c[k].thickness_m * 6), 1, 1e-9);
        const double w_mk = (double)m->conductivity_w_mk;
        const bool   thick = 25 * c[k].thickness_m > 0.1 * w_mk;
        CHECK((shape.skin[0].inner != shape.skin[0].surface) == thick);
        double through_k_w = 0; /* a face of 1 m2, from its surface to its inner face: thickness / conductivity */
        for (int n = shape.skin[0].surface; n < shape.skin[0].inner; n++)
            for (int l = 0; l < shape.links; l++)
                if (shape.link[l].a == n && shape.link[l].b == n + 1) through_k_w += 1 / shape.link[l].conductance_w_k;
        CHECK_NEAR(through_k_w, thick ? c[k].thickness_m / w_mk : 0, 1e-9);
        int along = 0;
        for (int l = 0; l < shape.links; l++) /* edges of 1 m between faces whose middles are sqrt(0.5) m apart */
            for (int i = 0; i < patches.links; i++)
                if (shape.link[l].a == shape.skin[patches.link[i].a].surface &&
                    shape.link[l].b == shape.skin[patches.link[i].b].surface) {
                    CHECK_NEAR(shape.link[l].conductance_w_k / (w_mk * c[k].thickness_m * sqrt(2)), 1, 1e-6);
                    along++;
                }
        assert_int_equal(along, 12);
        vehicle_shape_destroy(&shape);
        patches_destroy(&patches);
        tracer_destroy(tracer);
        materials_close(&of);
        catalog_close(catalog);
    }
    unlink(obj), unlink(yaml), unlink(stem), unlink(catalog_path);
}

/* What flows into a tank's fuel over ten minutes, by the temperatures of engine and hull about it and the figures of
 * etc/heat_machines.csv, is what it keeps; it takes hours, after its engine and before its hull. */
static void fuel_follows_its_engine(void **state)
{
    (void)state;
    Scene        s;
    VehicleNodes n;
    enclose(288);
    VehicleHeat *heat = start();
    place(&s, tank, (EntityDrives){0});
    run(heat, &s, 0, 10);
    CHECK(vehicle_heat_nodes(&n, heat, s.entity.id) && n.shape->fuel >= 0);
    CHECK_NEAR(n.shape->capacity_j_k[n.shape->fuel], 1.1e6, 1);
    CHECK_NEAR(n.temp_k[n.shape->fuel], 288, 1e-3);
    s.entity.drives.engine = 0.6f;
    double gone_j = 0, before_k = 0, before_w = 0, half_hour_k = 0;
    for (int k = 0; k <= 360; k++) { /* an hour */
        run(heat, &s, 20 + 10 * k, 20 + 10 * k);
        CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
        const VehicleShape *shape = n.shape;
        const double        fuel_k = n.temp_k[shape->fuel];
        double              w = 140 * 0.6 * (n.temp_k[shape->engine] - fuel_k);
        for (int i = 0; i < shape->patches->count; i++)
            if (shape->patches->patch[i].role == HEAT_HULL && shape->patches->patch[i].open_share > 0)
                w += 0.1 * 30 * patch_open_m2(&shape->patches->patch[i]) * (n.temp_k[shape->skin[i].inner] - fuel_k);
        if (k > 60) gone_j += 0.5 * (w + before_w) * 10; /* once steps are short of it */
        if (k == 60) before_k = fuel_k;
        if (k == 180) half_hour_k = fuel_k;
        before_w = w;
    }
    const double fuel_k = n.temp_k[n.shape->fuel], engine_k = n.temp_k[n.shape->engine];
    print_message("fuel half an hour after the start %.1f K, an hour %.1f K, engine %.1f K over the air\n",
                  half_hour_k - 288, fuel_k - 288, engine_k - 288);
    CHECK_NEAR(1.1e6 * (fuel_k - before_k) / gone_j, 1, 0.02); /* own times are up to 30 s apart */
    /* In half an hour 84 W/K from an engine of 75 K over the air would give it 10.3 K; the engine is warm after some
     * minutes, and the hull takes a third. */
    CHECK(half_hour_k > 288 + 5 && half_hour_k < 288 + 10.3 && fuel_k > half_hour_k && fuel_k < engine_k);
    vehicle_heat_destroy(heat);
    heat = start();
    place(&s, truck, (EntityDrives){.engine = 1});
    run(heat, &s, 0, 10);
    CHECK(vehicle_heat_nodes(&n, heat, s.entity.id) && n.shape->fuel < 0); /* its row has none */
    vehicle_heat_destroy(heat);
}

/* Ground warmer than all else warms what stands on it, and not what is lifted from it; one that drives gives the
 * ground the heat of its tracks and tyres. */
static void ground_touches_tracks_and_wheels(void **state)
{
    (void)state;
    const DisEntityType types[2] = {tank, truck};
    const HeatRole      role[2] = {HEAT_TRACK, HEAT_WHEEL};
    for (int t = 0; t < 2; t++) {
        double low_k, high_k[3], rolls_k[2], print_m2 = 0;
        Scene  s;
        for (int c = 0; c < 3; c++) { /* on cold ground, on warm ground, over it */
            enclose(288);
            weather.under_k = c ? 318 : 288, weather.above_m = c == 2 ? 0.8 : 0;
            VehicleHeat *heat = start();
            place(&s, types[t], (EntityDrives){0});
            run(heat, &s, 0, 3600);
            range_k(&low_k, &high_k[c], heat, &s, role[t], -1, 0.3 + 0.4 * t);
            vehicle_heat_destroy(heat);
        }
        for (int c = 0; c < 2; c++) { /* tracks and tyres in motion: on the ground, and over it */
            enclose(288);
            weather.above_m = c ? 0.8 : 0;
            VehicleHeat *heat = start();
            place(&s, types[t], (EntityDrives){.engine = 1, .speed_mps = 10});
            run(heat, &s, 0, 1800);
            range_k(&low_k, &rolls_k[c], heat, &s, role[t], -1, 3);
            VehicleNodes n;
            CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
            for (int i = 0; i < n.shape->patches->count && c == 0; i++) print_m2 += n.shape->skin[i].ground_m2;
            vehicle_heat_destroy(heat);
        }
        print_message(
            "%s: print %.2f m2; an hour on ground 30 K warmer %.2f K, 0.8 m over it %.2f K; driving on it %.1f K, over it %.1f K\n",
            t ? "truck" : "tank", print_m2, high_k[1] - 288, high_k[2] - 288, rolls_k[0] - 288, rolls_k[1] - 288);
        CHECK_NEAR(high_k[0], 288, 1e-3);
        /* contact gives 16 W/(m2 K) in an hour (17.5 of two bodies, in series with gaps of 200), radiation of warm
         * ground 6, where the air takes 9: beneath, tracks come up by a seventh to a half of the ground's 30 K */
        CHECK(high_k[1] > high_k[2] + 2 && high_k[1] > 288 + 30.0 / 7 && high_k[1] < 288 + 15);
        CHECK(rolls_k[0] < rolls_k[1] - 3 && rolls_k[0] > 288 + 20);
        /* prints of the kinds: a tank of 40 t has some 0.8 bar under its tracks (5 m2, of which pads are a third to
         * all), a truck of 10 t some 3 to 6 bar in its tyres */
        CHECK(t ? print_m2 > 0.35 && print_m2 < 0.8
                : print_m2 > 1.5 && print_m2 < 3); /* the model's: pads, six tyres */
    }
}

/* A ship between air of 300 K and water of 280 K, an hour: below its waterline it is as warm as the water, well
 * above as the air. Its waterline is where the water is; what it has inside is no part of dt_k. */
static void water_cools_hulls(void **state)
{
    (void)state;
    double       low_k, high_k;
    Scene        s;
    VehicleNodes n;
    enclose(300);
    weather.water_k = 280, weather.water = true;
    VehicleHeat *heat = start();
    place(&s, ship, (EntityDrives){0});
    run(heat, &s, 0, 3600);
    range_k(&low_k, &high_k, heat, &s, HEAT_ROLE_COUNT, -20, -1);
    print_message("ship: below the water %.2f .. %.2f K", low_k, high_k);
    CHECK(low_k > 279.9 && high_k < 280.5); /* a film of 200 W/(m2 K) against 4 from inside */
    range_k(&low_k, &high_k, heat, &s, HEAT_ROLE_COUNT, 8, 60);
    print_message(", its upper works %.2f .. %.2f K\n", low_k, high_k);
    CHECK(low_k > 299.5 && high_k < 300.01); /* well above the waterline no heat comes up through the plates */
    CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
    double sum = 0, m2 = 0, all_m2 = 0;
    for (int i = 0; i < n.shape->patches->count; i++) {
        const double open_m2 = patch_open_m2(&n.shape->patches->patch[i]);
        sum += open_m2 * (double)s.snapshot.patch_k[s.entity.first_patch + i], m2 += open_m2,
            all_m2 += n.shape->patches->patch[i].area_m2;
    }
    CHECK_NEAR((double)s.entity.dt_k, sum / m2 - 300, 1e-3);
    CHECK(m2 < 0.5 * all_m2);
    vehicle_heat_destroy(heat);

    enclose(300); /* the same, in the enclosure: water as warm as all else */
    heat = start();
    place(&s, ship, (EntityDrives){0});
    run(heat, &s, 0, 600);
    range_k(&low_k, &high_k, heat, &s, HEAT_ROLE_COUNT, -20, 60);
    CHECK(low_k > 300 - 1e-3 && high_k < 300 + 1e-3);
    vehicle_heat_destroy(heat);

    for (int c = 0; c < 3; c++) { /* a tank: on land, that swims 1 m deep, on a bridge over water */
        enclose(300);
        weather.water_k = 280, weather.water = c > 0, weather.above_m = c == 1 ? -1 : c == 2 ? 6 : 0;
        heat = start();
        place(&s, tank, (EntityDrives){0});
        run(heat, &s, 0, 3600);
        range_k(&low_k, &high_k, heat, &s, HEAT_ROLE_COUNT, -1, 0.8);
        print_message("tank %d: its lower half %.1f .. %.1f K\n", c, low_k, high_k);
        CHECK(c == 1 ? low_k < 281 : low_k > 299.99);
        vehicle_heat_destroy(heat);
    }
}

/* Heat that came in is what nodes keep, with fuel, ground and water among them. */
static void energy_closes(void **state)
{
    (void)state;
    const DisEntityType types[3] = {tank, ship, jet};
    for (int t = 0; t < 3; t++) {
        Scene        s;
        VehicleNodes n;
        enclose(285);
        weather.sun_d_enu[2] = 1, weather.direct_w_m2 = 800, weather.water = t == 1, weather.water_k = 279,
        weather.ground_k = 300, weather.under_k = 292;
        VehicleHeat *heat = start();
        place(&s, types[t], (EntityDrives){.engine = 0.7f, .speed_mps = 6});
        run(heat, &s, 0, 0);
        CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
        const double held_j = heat_network_heat_j(n.shape->network, n.temp_k), in_j = n.heat_in_j;
        CHECK((n.shape->fuel >= 0) == (t != 1));
        run(heat, &s, 10, 900);
        CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
        const double gained_j = heat_network_heat_j(n.shape->network, n.temp_k) - held_j;
        CHECK(fabs(gained_j) > 1e5);
        CHECK_NEAR((gained_j - (n.heat_in_j - in_j)) / held_j, 0, 1e-6);
        vehicle_heat_destroy(heat);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_skin_is_as_its_sidecar_says),
        cmocka_unit_test(fuel_follows_its_engine),
        cmocka_unit_test(ground_touches_tracks_and_wheels),
        cmocka_unit_test(water_cools_hulls),
        cmocka_unit_test(energy_closes),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
